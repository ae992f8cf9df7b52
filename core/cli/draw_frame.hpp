// One frame of a film at a time: the film is loaded once, each frame is a function of it and its number.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/film/frame.hpp>
#include <core/image/framebuffer.hpp>
#include <core/octree/octree.hpp>
#include <core/plugin_host/catalog.hpp>
#include <core/scene/description.hpp>
#include <core/world/world.hpp>
#include <formats/frame_store.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

namespace rt::cli {

/// What the frames drawn so far took, in seconds of wall time, and how the octree came from one to the next. Whichever
/// way was taken, the pictures are the same.
struct FilmStatistics {
    std::uint64_t frames = 0;
    double poseSeconds = 0, buildSeconds = 0, updateSeconds = 0, traceSeconds = 0;
    std::uint64_t built = 0, updated = 0;              // frames
    std::uint64_t lowered = 0;                         // of those built: keyframes changed shapes
    std::uint64_t foreseen = 0;                        // of those built: an update would be slower
    std::uint64_t moved = 0, entered = 0, rebuilt = 0; // primitives, by updates
    std::uint64_t gaveUp = 0;                          // updates that built the whole anew
    std::uint64_t primitives = 0;
    double fastestBuild = 0, fastestUpdate = 0; // of the latter, per moved primitive; 0: none yet

    /// By what was measured so far; false as long as nothing was.
    bool foreseesSlowerUpdate(std::uint64_t toMove) const {
        return static_cast<double>(toMove) * fastestUpdate > fastestBuild;
    }
};

class FrameDrawer {
public:
    /// Keeps references to all of them.
    FrameDrawer(const RenderOptions& options, const scene::Description& description,
                plugin_host::Catalog& catalog)
        : options_(options), description_(description), catalog_(catalog) {}

    /// Lowers the scene at rest. False after an error.
    bool load(scene::Diagnostics& diagnostics);
    /// What the frames depend on, once loaded.
    formats::Settings settings() const;
    /// Nothing after an error, or when a signal came. The picture has the pixels of --crop only.
    std::optional<image::Framebuffer> draw(std::uint32_t frame,
                                           const std::function<void(double share)>& show,
                                           scene::Diagnostics& diagnostics);

    const FilmStatistics& statistics() const { return statistics_; }

private:
    std::optional<world::World> lower(const scene::Description& description,
                                      scene::Diagnostics& diagnostics,
                                      std::set<std::string>* files) const;

    /// The octree follows from the frame before; its answers are those of a fresh one.
    void raise(std::unique_ptr<const film::Frame> frame, int threads);
    void build(const geometry::Primitives& primitives, int threads);
    void update(const geometry::Primitives& primitives,
                const std::vector<geometry::PrimitiveId>& moved);

    const RenderOptions& options_;
    const scene::Description& description_;
    plugin_host::Catalog& catalog_;
    std::optional<world::World> rest_;
    std::set<std::string> files_;               // that the scene names
    std::unique_ptr<const film::Frame> before_; // which tree_ is of
    std::optional<octree::Octree> tree_;
    FilmStatistics statistics_;
};

} // namespace rt::cli
