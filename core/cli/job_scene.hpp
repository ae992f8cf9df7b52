// The film or picture of a job: its command line read again, its scene loaded as every worker loads it.
#pragma once
#include <core/cli/draw_frame.hpp>
#include <core/cli/load_scene.hpp>
#include <core/farm/job.hpp>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rt::cli {

class JobScene {
public:
    /// `words` are those behind `rt`: render SCENE …. Throws UsageError. Nothing after an error.
    static std::unique_ptr<JobScene> load(const std::vector<std::string>& words,
                                          scene::Diagnostics& diagnostics);
    /// The same for a job, in the job's working folder, which becomes the current one. Error E0610 where the scene or what
    /// it names has changed since the job was made; the message names the field.
    static std::unique_ptr<JobScene> of(const farm::Job& job, scene::Diagnostics& diagnostics);

    JobScene(const JobScene&) = delete;
    JobScene& operator=(const JobScene&) = delete;

    RenderOptions options;
    const scene::Description& description() const { return scene_->description; }
    FrameDrawer& drawer() { return *drawer_; }

private:
    JobScene() = default;

    std::optional<plugin_host::Catalog> catalog_;
    std::optional<LoadedScene> scene_;
    std::optional<FrameDrawer> drawer_;
};

} // namespace rt::cli
