// rt render: the street from the scene file to the picture file.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/film.hpp>
#include <core/cli/interrupt.hpp>
#include <core/cli/load_scene.hpp>
#include <core/cli/output.hpp>
#include <core/cli/output_lock.hpp>
#include <core/cli/progress.hpp>
#include <core/cli/ray_tree_text.hpp>
#include <core/cli/statistics.hpp>
#include <core/film/frame.hpp>
#include <core/octree/octree.hpp>
#include <core/parallel/parallel.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/trace/ray_tree.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include <unistd.h>

namespace rt::cli {

namespace {

constexpr scene::Code kEncodeFailed{606};
constexpr std::uint32_t kPreviewDivisor = 4;
constexpr double kLeastError = 0.00001; // as the scene language has it

std::vector<std::string> previewOverrides(const scene::Image& image) {
    const auto quarter = [](std::uint32_t side) {
        return std::to_string(std::max(1u, side / kPreviewDivisor));
    };
    return {"image.width=" + quarter(image.width), "image.height=" + quarter(image.height),
            "render.antialias=none", "render.depth=1"};
}

void requireInside(const scene::Image& image, const RenderOptions& options) {
    const std::string size = std::to_string(image.width) + "x" + std::to_string(image.height);
    if (options.crop && ((*options.crop)[2] > image.width || (*options.crop)[3] > image.height))
        throw UsageError("--crop: must lie inside the picture, which is " + size);
    if (options.pixel &&
        ((*options.pixel)[0] >= image.width || (*options.pixel)[1] >= image.height))
        throw UsageError("--pixel: must lie inside the picture, which is " + size);
}

/// A size of other proportions stretches the picture of a camera with a fixed screen.
void warnOfStretching(const RenderOptions& options, const scene::Description& description,
                      scene::Diagnostics& diagnostics) {
    constexpr double kVisible = 0.01;
    const double pixelWidth = description.camera.screenWidth / description.image.width;
    const double pixelHeight = description.camera.screenHeight / description.image.height;
    if (options.resized && std::abs(pixelWidth / pixelHeight - 1) > kVisible)
        diagnostics.warning(wholeFile(options.scene),
                            "--size has other proportions than camera.screen: the picture is "
                            "stretched");
}

/// Encodes for each output first, so that nothing is written when one of them cannot be.
bool write(const image::Framebuffer& frame, const std::vector<Output>& outputs,
           const RenderOptions& options, const scene::Image& image, const Console& console,
           scene::Diagnostics& diagnostics) {
    std::vector<std::vector<std::byte>> encoded;
    try {
        for (const Output& output : outputs)
            encoded.push_back(encodePicture(frame, output.format, options, image));
    } catch (const std::runtime_error& error) {
        diagnostics.error(kEncodeFailed, wholeFile(outputs[encoded.size()].path), error.what());
        return false;
    }
    for (std::size_t i = 0; i < outputs.size(); ++i)
        if (!writeOutput(outputs[i].path, encoded[i], console, diagnostics)) return false;
    return true;
}

std::vector<OutputLock> lockAll(const std::vector<Output>& outputs,
                                scene::Diagnostics& diagnostics) {
    std::vector<OutputLock> locks;
    std::set<std::string> locked{"-"}; // the same file may be named twice
    for (const Output& output : outputs)
        if (locked.insert(output.path).second)
            if (auto lock = OutputLock::take(output.path, diagnostics))
                locks.push_back(std::move(*lock));
    return locks;
}

/// What was drawn until the signal goes beside where the picture would have been.
int finishInterrupted(const image::Framebuffer& frame, double share, std::vector<Output> outputs,
                      const RenderOptions& options, const scene::Image& image, Console& console) {
    scene::Diagnostics diagnostics;
    std::erase_if(outputs, [](const Output& output) { return output.path == "-"; });
    std::string names;
    for (Output& output : outputs) {
        output.path = partialName(output.path);
        names += (names.empty() ? "" : ", ") + output.path;
    }
    const bool written =
        !outputs.empty() && write(frame, outputs, options, image, console, diagnostics);
    console.report(diagnostics);
    console.fail("render", interruptExitCode(),
                 "interrupted after " + std::to_string(static_cast<int>(share * 100)) +
                     " % of the picture",
                 written ? "what was drawn is in " + names : "");
    return interruptExitCode();
}

std::optional<LoadedScene> load(const RenderOptions& options, plugin_host::Catalog& catalog,
                                scene::Diagnostics& diagnostics) {
    auto loaded = loadScene(options.scene, options, catalog, diagnostics);
    if (loaded && options.preview)
        loaded = loadScene(options.scene, options, catalog, diagnostics,
                           previewOverrides(loaded->description.image));
    if (loaded && options.timeBudget) {
        auto& antialias = loaded->description.render.antialias;
        if (!std::holds_alternative<scene::AntialiasMaxError>(antialias))
            antialias = scene::AntialiasMaxError{kLeastError};
    }
    return loaded;
}

std::string errorReached(double estimate) {
    char text[32];
    char* const end = std::to_chars(text, text + sizeof text, std::max(estimate, kLeastError)).ptr;
    return "estimated error " + std::string(text, end) + ": --max-error " + std::string(text, end) +
           " draws the same picture\n";
}

void requireSense(const RenderOptions& options) {
    if (options.timeBudget) {
        const char* const hint = "--time-budget chooses the samples of the full picture itself";
        if (!options.samples.empty() && !options.samples.starts_with("max_error="))
            throw UsageError(
                "--time-budget and --antialias " + options.samples + " exclude each other", hint);
        if (options.preview || options.shade != trace::Shade::full || options.trace)
            throw UsageError("--time-budget goes without --preview, --shade and --trace", hint);
    }
    if (options.trace != options.pixel.has_value())
        throw UsageError(options.trace ? "--trace needs --pixel X,Y" : "--pixel needs --trace",
                         "such as --pixel 320,240 --trace");
    if (std::count(options.outputs.begin(), options.outputs.end(), "-") && ::isatty(STDOUT_FILENO))
        throw UsageError("a picture is not written to a terminal", "try: -o - > picture.png");
}

} // namespace

int render(const RenderOptions& options, Console& console) {
    requireSense(options);
    Phases phases;
    phases.begin("read");
    scene::Diagnostics diagnostics;
    const auto finish = [&] {
        console.report(diagnostics);
        return diagnostics.exitCode();
    };
    plugin_host::Catalog catalog(plugin_host::searchPath(options.pluginDirs));
    auto loaded = load(options, catalog, diagnostics);
    if (!loaded) return finish();
    const scene::Description& description = loaded->description;
    requireInside(description.image, options);
    warnOfStretching(options, description, diagnostics);
    if (const auto plan = planFilm(options, description, diagnostics))
        return diagnostics.failed() ? finish()
                                    : renderFilm(*plan, options, description, catalog, console);
    std::vector<Output> outputs;
    if (!options.trace) outputs = planOutputs(options, description, diagnostics);
    if (!options.statisticsFile.empty()) checkWritable(options.statisticsFile, diagnostics);
    if (diagnostics.failed()) return finish();
    const std::vector<OutputLock> locks = lockAll(outputs, diagnostics);
    if (diagnostics.failed()) return finish();

    std::vector<std::shared_future<void>> codecs; // open while the picture is traced
    for (const Output& output : outputs) codecs.push_back(formats::openCodec(output.format));

    phases.begin("load");
    const auto lower = [&](const scene::Description& lowered, scene::Diagnostics& problems) {
        return plugin_host::lower(lowered, catalog, problems,
                                  {.allowMissing = options.allowMissing,
                                   .limits = options.limits,
                                   .threads = options.threads});
    };
    auto world = lower(loaded->description, diagnostics);
    if (!world) return finish();
    if (loaded->description.animation) {
        auto frame = film::frameAt(loaded->description, *world, pictureFrame(options, description),
                                   lower, diagnostics);
        if (!frame) return finish();
        world = std::move(frame->world);
        loaded->description = std::move(frame->description);
    }
    console.report(diagnostics);
    diagnostics = {};
    for (const plugin_host::ModuleInfo& module : catalog.opened())
        console.detail("plugin " + module.name + ": " + module.path.string());

    phases.begin("build");
    const int threads = options.threads ? options.threads : parallel::availableThreads();
    const auto tree =
        octree::Octree::build(world->primitives, {.maxObjects = description.render.octreeMaxObjects,
                                                  .minSize = description.render.octreeMinSize,
                                                  .threads = threads});
    if (options.trace) {
        const auto [x, y] = *options.pixel;
        const auto rays = trace::tracePixel(tree, *world, description, x, y);
        console.result(rayTreeText(rays, x, y, *world, description));
        return kExitOk;
    }

    phases.begin("trace");
    console.detail(std::to_string(world->primitives.count()) + " primitives, " +
                   std::to_string(threads) + " threads, " +
                   std::string(octree::Octree::simdLevel()));
    const bool silent = console.quiet() || console.jsonErrors();
    Progress progress(silent ? ProgressStyle::none : options.progress, options.scene);
    double share = 0;
    const Interruptible interruptible; // to the end: a complete picture is still written
    trace::Options traceOptions;
    traceOptions.threads = threads;
    traceOptions.shade = options.shade;
    traceOptions.crop = options.crop;
    traceOptions.stop = &stopRequested();
    traceOptions.progress = [&](double done) { progress.show(share = done); };
    traceOptions.count = options.statistics;
    traceOptions.timeBudget = options.timeBudget;
    traceOptions.markNotFinite = options.strict;
    trace::Result result = trace::render(tree, *world, description, traceOptions);
    progress.finish(result.complete ? 1 : share);
    if (options.crop) result.frame = cut(result.frame, *options.crop);
    if (!result.complete)
        return finishInterrupted(result.frame, share, outputs, options, description.image, console);
    const std::string notFinite =
        std::to_string(result.counts.notFinite) + " samples were not a finite number and are ";
    if (result.counts.notFinite != 0 && !options.strict)
        diagnostics.warning(wholeFile(options.scene), notFinite + "black");

    phases.begin("write");
    if (!write(result.frame, outputs, options, description.image, console, diagnostics))
        return finish();
    phases.end();
    for (const Output& output : outputs)
        if (output.path != "-") console.result(output.path + "\n");
    if (options.timeBudget) console.table(errorReached(*result.estimatedError));
    if (options.statistics)
        reportStatistics({phases, options, description, *world, tree.statistics(), result, threads},
                         console, diagnostics);
    const int exitCode = finish();
    if (exitCode != kExitOk || result.counts.notFinite == 0 || !options.strict) return exitCode;
    console.fail("render", kExitInternal, notFinite + "magenta", "");
    return kExitInternal;
}

} // namespace rt::cli
