// rt task run: one task of a job, under any scheduler. Done again, it does only what is missing.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/interrupt.hpp>
#include <core/cli/job_scene.hpp>
#include <core/cli/output.hpp>

#include <charconv>
#include <cstdlib>
#include <cstring>
#include <system_error>

namespace rt::cli {
namespace {

constexpr scene::Code kWriteFailed{605}, kInUse{608};

/// From Slurm, whose tasks see all processors of the node.
int allottedThreads(int asked) {
    const char* const variable = std::getenv("SLURM_CPUS_PER_TASK");
    int threads = 0;
    if (variable) std::from_chars(variable, variable + std::strlen(variable), threads);
    return threads > 0 ? threads : asked;
}

std::vector<std::byte> bytesOf(const image::Framebuffer& tile) {
    const auto* first = reinterpret_cast<const std::byte*>(tile.pixels.data());
    return {first, first + tile.pixels.size() * sizeof(numeric::LinearRgb)};
}

/// Disks fill and empty, and locks of dead processes go.
bool isTransient(const scene::Diagnostics& diagnostics) {
    for (const scene::Diagnostic& each : diagnostics.all())
        if (each.severity == scene::Severity::error)
            return each.code == kWriteFailed || each.code == kInUse;
    return false;
}

/// False after an error or a signal.
bool runTask(const farm::Job& job, std::size_t index, scene::Diagnostics& diagnostics) {
    const auto scene = JobScene::of(job, diagnostics);
    if (!scene) return false;
    const formats::FramePlace place = job.placeOf(index);
    auto store = formats::FrameStore::open(place, job.settings, formats::FrameStore::Mode::resume,
                                           diagnostics);
    if (!store) return false;
    const farm::Task& task = job.tasks[index];
    scene->options.threads = allottedThreads(job.threads);
    if (task.tile) scene->options.crop = task.tile;
    for (const std::uint32_t result : job.resultsOf(index)) {
        if (store->isDone(result)) continue;
        const std::uint32_t frame = task.tile ? task.frames.front() : result;
        const auto drawn = scene->drawer().draw(
            frame, [](double) {}, diagnostics);
        if (!drawn) return false;
        try {
            store->commit(
                result, task.tile ? bytesOf(*drawn)
                                  : encodePicture(*drawn, *formats::imageFormatOf(job.frameSuffix),
                                                  scene->options, scene->description().image));
        } catch (const std::system_error& failure) {
            diagnostics.error(kWriteFailed, wholeFile(place.pathOf(place.fileOf(result))),
                              "frame " + std::to_string(frame) +
                                  " cannot be written: " + failure.code().message());
            return false;
        }
    }
    return true;
}

} // namespace

int task(const TaskOptions& options, Console& console) {
    if (options.action != "run")
        throw UsageError("ACTION must be run (got " + scene::quoted(options.action) + ")");
    scene::Diagnostics diagnostics;
    const auto job = farm::read(options.job, diagnostics);
    if (!job) return console.report(diagnostics), diagnostics.exitCode();
    const auto last = static_cast<std::uint32_t>(job->tasks.size() - 1);
    std::uint32_t index = 0;
    try {
        index = parseWhole(options.index, 0, last);
    } catch (const UsageError& error) {
        throw UsageError(std::string("INDEX: ") + error.what());
    }
    const Interruptible interruptible;
    farm::noteStart(*job, index);
    const bool done = runTask(*job, index, diagnostics);
    console.report(diagnostics);
    const int code = done                       ? int(kExitOk)
                     : !diagnostics.failed()    ? int(kExitTransient) // a signal
                     : isTransient(diagnostics) ? int(kExitTransient)
                                                : diagnostics.exitCode();
    farm::noteEnd(*job, index, code);
    return code;
}

} // namespace rt::cli
