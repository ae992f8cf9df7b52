#include <core/cli/draw_frame.hpp>

#include <core/cli/film_settings.hpp>
#include <core/cli/interrupt.hpp>
#include <core/cli/output.hpp>
#include <core/parallel/parallel.hpp>
#include <core/plugin_host/lower.hpp>

#include <chrono>

namespace rt::cli {
namespace {

template <class Work> double secondsOf(const Work& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void keepLeast(double& least, double seconds) {
    if (least == 0 || seconds < least) least = seconds;
}

} // namespace

std::optional<world::World> FrameDrawer::lower(const scene::Description& description,
                                               scene::Diagnostics& diagnostics,
                                               std::set<std::string>* files) const {
    return plugin_host::lower(description, catalog_, diagnostics,
                              {.allowMissing = options_.allowMissing,
                               .files = files,
                               .limits = options_.limits,
                               .threads = options_.threads});
}

bool FrameDrawer::load(scene::Diagnostics& diagnostics) {
    rest_ = lower(description_, diagnostics, &files_);
    return rest_.has_value();
}

formats::Settings FrameDrawer::settings() const {
    return filmSettings(options_, description_, *rest_, files_, catalog_);
}

void FrameDrawer::build(const geometry::Primitives& primitives, int threads) {
    const double seconds = secondsOf([&] {
        tree_.reset();
        tree_ =
            octree::Octree::build(primitives, {.maxObjects = description_.render.octreeMaxObjects,
                                               .minSize = description_.render.octreeMinSize,
                                               .threads = threads,
                                               .movable = true});
    });
    ++statistics_.built;
    statistics_.buildSeconds += seconds;
    keepLeast(statistics_.fastestBuild, seconds);
}

void FrameDrawer::update(const geometry::Primitives& primitives,
                         const std::vector<geometry::PrimitiveId>& moved) {
    octree::UpdateReport report;
    const double seconds = secondsOf([&] { report = tree_->update(primitives, moved); });
    ++statistics_.updated;
    statistics_.updateSeconds += seconds;
    statistics_.moved += report.moved;
    statistics_.entered += report.entered;
    statistics_.rebuilt += report.rebuilt;
    statistics_.gaveUp += report.whole;
    if (!moved.empty())
        keepLeast(statistics_.fastestUpdate, seconds / static_cast<double>(moved.size()));
}

void FrameDrawer::raise(std::unique_ptr<const film::Frame> frame, int threads) {
    const geometry::Primitives& primitives = frame->world.primitives;
    statistics_.primitives = primitives.count();
    if (!tree_) {
        build(primitives, threads);
    } else if (animation::keyframesReachTheWorld(description_)) {
        // Lowered anew, a frame may have other primitives than the one before.
        ++statistics_.lowered;
        build(primitives, threads);
    } else if (const auto moved = film::movedBetween(*before_, *frame);
               statistics_.foreseesSlowerUpdate(moved.size())) {
        ++statistics_.foreseen;
        build(primitives, threads);
    } else {
        update(primitives, moved);
    }
    before_ = std::move(frame);
}

std::optional<image::Framebuffer> FrameDrawer::draw(std::uint32_t number,
                                                    const std::function<void(double share)>& show,
                                                    scene::Diagnostics& diagnostics) {
    if (stopRequested()) return {};
    scene::Diagnostics problems; // warnings of the rest pose are not said again for each frame
    std::optional<film::Frame> frame;
    statistics_.poseSeconds += secondsOf([&] {
        frame = film::frameAt(
            description_, *rest_, number,
            [&](const auto& still, auto& found) { return lower(still, found, nullptr); }, problems);
    });
    if (!frame) return diagnostics.add(problems), std::nullopt;
    const int threads = options_.threads ? options_.threads : parallel::availableThreads();
    raise(std::make_unique<const film::Frame>(std::move(*frame)), threads);
    trace::Options traceOptions;
    traceOptions.threads = threads;
    traceOptions.shade = options_.shade;
    traceOptions.crop = options_.crop;
    traceOptions.stop = &stopRequested();
    traceOptions.progress = show;
    trace::Result result;
    statistics_.traceSeconds += secondsOf([&] {
        result = trace::render(*tree_, before_->world, before_->description, traceOptions);
    });
    if (!result.complete) return {};
    ++statistics_.frames;
    if (result.counts.notFinite)
        diagnostics.warning(wholeFile(options_.scene),
                            "frame " + std::to_string(number) + ": " +
                                std::to_string(result.counts.notFinite) +
                                " samples were not a finite number and are black");
    if (options_.crop) return cut(result.frame, *options_.crop);
    return std::move(result.frame);
}

} // namespace rt::cli
