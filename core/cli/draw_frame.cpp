#include <core/cli/draw_frame.hpp>

#include <core/cli/film_settings.hpp>
#include <core/cli/interrupt.hpp>
#include <core/cli/output.hpp>
#include <core/film/frame.hpp>
#include <core/parallel/parallel.hpp>
#include <core/plugin_host/lower.hpp>

namespace rt::cli {

std::optional<world::World> FrameDrawer::lower(const scene::Description& description,
                                               scene::Diagnostics& diagnostics,
                                               std::set<std::string>* files) const {
    return plugin_host::lower(description, catalog_, diagnostics,
                              {.allowMissing = options_.allowMissing, .files = files});
}

bool FrameDrawer::load(scene::Diagnostics& diagnostics) {
    rest_ = lower(description_, diagnostics, &files_);
    return rest_.has_value();
}

formats::Settings FrameDrawer::settings() const {
    return filmSettings(options_, description_, *rest_, files_, catalog_);
}

std::optional<image::Framebuffer> FrameDrawer::draw(std::uint32_t number,
                                                    const std::function<void(double share)>& show,
                                                    scene::Diagnostics& diagnostics) const {
    if (stopRequested()) return {};
    scene::Diagnostics problems; // warnings of the rest pose are not said again for each frame
    const auto frame = film::frameAt(
        description_, *rest_, number,
        [&](const auto& still, auto& found) { return lower(still, found, nullptr); }, problems);
    if (!frame) return diagnostics.add(problems), std::nullopt;
    const int threads = options_.threads ? options_.threads : parallel::availableThreads();
    const auto tree = octree::Octree::build(frame->world.primitives,
                                            {.maxObjects = description_.render.octreeMaxObjects,
                                             .minSize = description_.render.octreeMinSize,
                                             .threads = threads});
    trace::Options traceOptions;
    traceOptions.threads = threads;
    traceOptions.shade = options_.shade;
    traceOptions.crop = options_.crop;
    traceOptions.stop = &stopRequested();
    traceOptions.progress = show;
    trace::Result result = trace::render(tree, frame->world, frame->description, traceOptions);
    if (!result.complete) return {};
    if (result.counts.notFinite)
        diagnostics.warning(wholeFile(options_.scene),
                            "frame " + std::to_string(number) + ": " +
                                std::to_string(result.counts.notFinite) +
                                " samples were not a finite number and are black");
    if (options_.crop) return cut(result.frame, *options_.crop);
    return std::move(result.frame);
}

} // namespace rt::cli
