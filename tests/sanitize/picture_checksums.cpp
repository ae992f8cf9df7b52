// picture_checksums SCENE...: a line for each picture, and each frame of a film, with a checksum of its linear pixels. Drawn on four
// threads, in a tree that follows the film; every compiler, optimisation and sanitizer must print the same.
#include <core/film/frame.hpp>
#include <core/octree/octree.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/scene/validate.hpp>
#include <core/trace/render.hpp>
#include <formats/checksum.hpp>
#include <formats/yaml_reader.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>

namespace rt {
namespace {

constexpr int kThreads = 4;

class Scene {
public:
    explicit Scene(const char* file) : name_(std::filesystem::path(file).stem().string()) {
        const auto nodes = formats::readYaml(file, diagnostics_);
        if (nodes) description_ = scene::validate(*nodes, catalog_, diagnostics_);
        if (description_) rest_ = lower(*description_, diagnostics_);
    }

    bool print() {
        if (!rest_) return complain();
        const std::uint32_t frames = description_->animation ? description_->animation->frames : 1;
        for (std::uint32_t frame = 0; frame < frames; ++frame)
            if (!draw(frame)) return complain();
        return true;
    }

private:
    std::optional<world::World> lower(const scene::Description& description,
                                      scene::Diagnostics& diagnostics) {
        return plugin_host::lower(description, catalog_, diagnostics, {.threads = kThreads});
    }

    bool draw(std::uint32_t number) {
        auto drawn = film::frameAt(
            *description_, *rest_, number,
            [&](const auto& still, auto& found) { return lower(still, found); }, diagnostics_);
        if (!drawn) return false;
        auto frame = std::make_unique<const film::Frame>(std::move(*drawn));
        const geometry::Primitives& primitives = frame->world.primitives;
        if (number == 0) {
            tree_ = octree::Octree::build(primitives, {.threads = kThreads, .movable = true});
        } else {
            tree_.update(primitives, film::movedBetween(*before_, *frame));
        }
        before_ = std::move(frame);
        trace::Options options;
        options.threads = kThreads;
        const trace::Result result =
            trace::render(tree_, before_->world, before_->description, options);
        std::printf("%s %u %s\n", name_.c_str(), number,
                    formats::checksum(std::as_bytes(std::span(result.frame.pixels))).c_str());
        return true;
    }

    bool complain() const {
        for (const scene::Diagnostic& d : diagnostics_.all())
            std::fputs(scene::format(d, false).c_str(), stderr);
        return false;
    }

    std::string name_;
    plugin_host::Catalog catalog_{plugin_host::searchPath({})};
    scene::Diagnostics diagnostics_;
    std::optional<scene::Description> description_;
    std::optional<world::World> rest_;
    octree::Octree tree_;
    std::unique_ptr<const film::Frame> before_;
};

} // namespace
} // namespace rt

int main(int argc, char** argv) {
    bool good = argc > 1;
    for (int i = 1; i < argc; ++i) good &= rt::Scene(argv[i]).print();
    return good ? 0 : 1;
}
