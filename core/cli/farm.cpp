// rt farm: films and huge pictures by many processes or nodes. What they do is rt task run.
#include <core/cli/commands.hpp>
#include <core/cli/encode_film.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/film.hpp>
#include <core/cli/interrupt.hpp>
#include <core/cli/job_scene.hpp>
#include <core/cli/output.hpp>
#include <core/cli/progress.hpp>
#include <core/farm/engines.hpp>
#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>

namespace rt::cli {
namespace {

namespace fs = std::filesystem;

constexpr scene::Code kUnfinished{612}, kFarmFailed{613};
constexpr double kChunkSeconds = 30; // Slurm spends 0.1 s on a task, loading a scene up to 1 s

/// About the seconds that a frame takes with all that is done for each, from the middle 64th of its pixels.
double secondsOfFrame(JobScene& scene, std::uint32_t frame) {
    using Clock = std::chrono::steady_clock;
    constexpr std::uint32_t kPart = 8; // of each side
    const std::uint32_t width = scene.description().image.width,
                        height = scene.description().image.height;
    scene::Diagnostics ignored; // the task will say it
    const auto secondsOf = [&](std::uint32_t columns, std::uint32_t rows) {
        const auto start = Clock::now();
        const std::uint32_t x = (width - columns) / 2, y = (height - rows) / 2;
        scene.options.crop = {{x, y, x + columns, y + rows}};
        scene.drawer().draw(
            frame, [](double) {}, ignored);
        return std::chrono::duration<double>(Clock::now() - start).count();
    };
    const double fixed = secondsOf(1, 1);
    const double part =
        secondsOf(std::max(1u, width / kPart), std::max(1u, height / kPart)) - fixed;
    scene.options.crop.reset();
    return fixed + std::max(part, 0.0) * kPart * kPart;
}

class Farm {
public:
    Farm(const FarmOptions& options, Console& console) : options_(options), console_(console) {}

    int run() {
        if (options_.action == "submit") return submit();
        if (!options_.render.empty()) throw UsageError(options_.render.front() + " is for submit");
        job_ = farm::read(options_.what, diagnostics_);
        if (!job_) return finish();
        if (options_.action == "status") return status();
        if (options_.action == "cancel") return cancel();
        if (options_.action == "resume") return resume();
        return complete();
    }

private:
    // ---- submitting ----------------------------------------------------------------------------------------

    int submit() {
        std::vector<std::string> words{"render", options_.what};
        words.insert(words.end(), options_.render.begin(), options_.render.end());
        const auto scene = JobScene::load(words, diagnostics_);
        if (!scene) return finish();
        job_.emplace();
        job_->words = words;
        job_->workingFolder = fs::current_path().string();
        job_->settings = scene->drawer().settings();
        job_->threads = options_.threads;
        const bool planned = options_.tiles ? planTiles(*scene) : planFrames(*scene);
        if (!planned || diagnostics_.failed()) return finish();
        job_->folder = fs::absolute(options_.job.empty() ? name_ + ".job" : options_.job)
                           .lexically_normal()
                           .string();
        if (!farm::create(*job_, diagnostics_)) return finish();
        report();
        return launch();
    }

    bool planTiles(JobScene& scene) {
        const scene::Description& description = scene.description();
        if (planFilm(scene.options, description, diagnostics_))
            throw UsageError("--tiles is for one picture", "such as --frames 0 -o frame.png");
        if (std::holds_alternative<scene::AntialiasMaxError>(description.render.antialias))
            throw UsageError("--tiles cannot keep max_error, a promise about the whole picture",
                             "use antialias: {grid: N}");
        const auto outputs = planOutputs(scene.options, description, diagnostics_);
        if (outputs.empty()) return false;
        const std::uint32_t frame =
            description.animation ? pictureFrame(scene.options, description) : 0;
        const std::uint32_t width = description.image.width, height = description.image.height;
        job_->size = {width, height};
        const std::size_t limit = engine() == Engine::slurm ? farm::slurmArrayLimit() : SIZE_MAX;
        std::uint32_t side = options_.tiles;
        do {
            job_->tasks = farm::inTiles(frame, width, height, side++);
        } while (job_->tasks.size() > limit);
        name_ = fs::path(outputs.front().path).stem().string();
        return true;
    }

    bool planFrames(JobScene& scene) {
        const auto plan = planFilm(scene.options, scene.description(), diagnostics_);
        if (!plan)
            throw UsageError("a farm renders films, and one picture with --tiles",
                             "such as -o film.mp4");
        if (diagnostics_.failed()) return false;
        std::vector<std::uint32_t> missing; // of the frames that rt render may have left there
        {
            const auto store = formats::FrameStore::open(
                plan->place, job_->settings, formats::FrameStore::Mode::resume, diagnostics_);
            if (!store) return false;
            for (const std::uint32_t frame : plan->frames)
                if (!store->isDone(frame)) missing.push_back(frame);
        }
        job_->frameSuffix = plan->place.after;
        job_->size = {scene.description().image.width, scene.description().image.height};
        job_->tasks = farm::inChunks(missing, chunkOf(scene, missing));
        name_ = plan->films.empty() ? "frames" : fs::path(plan->films.front()).stem().string();
        return true;
    }

    std::size_t chunkOf(JobScene& scene, const std::vector<std::uint32_t>& frames) {
        std::size_t chunk = options_.chunk;
        if (chunk == 0 && !frames.empty()) {
            scene.options.threads = options_.threads;
            const double seconds = secondsOfFrame(scene, frames[frames.size() / 2]);
            chunk = std::max<std::size_t>(
                1, static_cast<std::size_t>(std::ceil(kChunkSeconds / std::max(seconds, 0.001))));
            if (engine() == Engine::local) // every process has something to do
                chunk = std::min(chunk, (frames.size() + processes() - 1) / processes());
        }
        if (engine() == Engine::slurm) {
            const std::size_t limit = farm::slurmArrayLimit();
            chunk = std::max(chunk, (frames.size() + limit - 1) / limit);
        }
        return std::max<std::size_t>(chunk, 1);
    }

    /// A job that was given to Slurm goes on there.
    Engine engine() const {
        const bool inSlurm = !job_->folder.empty() && farm::isInSlurm(*job_);
        return options_.engine.value_or(inSlurm ? Engine::slurm : Engine::local);
    }

    std::size_t processes() const { return static_cast<std::size_t>(options_.jobs); }

    // ---- running -------------------------------------------------------------------------------------------

    int launch() {
        farm::setCancelled(*job_, false);
        const std::vector<std::uint32_t> missing = farm::missingTasks(*job_);
        switch (engine()) {
        case Engine::print:
            for (const std::uint32_t task : missing)
                console_.result(farm::taskCommand(*job_, task) + "\n");
            console_.result(farm::finishCommand(*job_) + "\n");
            return kExitOk;
        case Engine::slurm:
            if (missing.empty()) return complete();
            farm::submitToSlurm(*job_, missing);
            console_.result(job_->folder + "\n");
            return kExitOk;
        case Engine::local:
            break;
        }
        const Interruptible interruptible;
        runHere(missing);
        if (stopRequested()) {
            console_.fail("farm", interruptExitCode(), "interrupted",
                          "to go on: rt farm resume " + job_->folder);
            return interruptExitCode();
        }
        if (farm::isCancelled(*job_)) {
            console_.fail("farm", kExitTransient, "the job was cancelled",
                          "to go on: rt farm resume " + job_->folder);
            return kExitTransient;
        }
        return complete();
    }

    void runHere(const std::vector<std::uint32_t>& tasks) {
        const bool silent = console_.quiet() || console_.jsonErrors();
        Progress progress(silent ? ProgressStyle::none : ProgressStyle::automatic, name());
        std::size_t done = 0;
        if (!job_->threads) shareThreads();
        farm::runLocally(
            *job_, tasks, options_.jobs, stopRequested(), [&](std::uint32_t task, int code) {
                if (code != 0)
                    console_.detail("task " + std::to_string(task) + " ended with " +
                                    std::to_string(code));
                if (code == 0)
                    progress.show(static_cast<double>(++done) / static_cast<double>(tasks.size()));
            });
        progress.finish(static_cast<double>(done) /
                        static_cast<double>(std::max<std::size_t>(tasks.size(), 1)));
    }

    /// Tasks that run at once divide the machine; Slurm's own variable says so to them.
    void shareThreads() const {
        const int each = std::max(1, parallel::availableThreads() / options_.jobs);
        ::setenv("SLURM_CPUS_PER_TASK", std::to_string(each).c_str(), 0);
    }

    std::string name() const { return fs::path(job_->folder).filename().string(); }

    int resume() {
        if (!JobScene::of(*job_, diagnostics_)) return finish();
        report();
        return launch();
    }

    int cancel() {
        farm::setCancelled(*job_, true);
        if (farm::isInSlurm(*job_)) farm::cancelInSlurm(*job_);
        return kExitOk;
    }

    // ---- status --------------------------------------------------------------------------------------------

    int status() {
        std::size_t doneTasks = 0, doneFrames = 0, frames = 0, timed = 0, running = 0;
        double seconds = 0;
        std::string rows;
        for (std::size_t i = 0; i < job_->tasks.size(); ++i) {
            const farm::Task& task = job_->tasks[i];
            const std::vector<farm::Attempt> attempts = farm::attemptsAt(*job_, i);
            const bool done = farm::isDone(*job_, i);
            frames += task.frames.size();
            if (done) ++doneTasks, doneFrames += task.frames.size();
            if (done && !attempts.empty() && attempts.back().exitCode == kExitOk)
                seconds += attempts.back().seconds, ++timed;
            if (!done && !attempts.empty() && !attempts.back().exitCode) ++running;
            if (!done || attempts.size() > 1) rows += row(i, task, attempts, done);
        }
        std::string text = name() + ": " + std::to_string(doneTasks) + " of " +
                           std::to_string(job_->tasks.size()) +
                           (job_->hasTiles() ? " tiles"
                                             : " tasks, " + std::to_string(doneFrames) + " of " +
                                                   std::to_string(frames) + " frames");
        const std::size_t left = job_->tasks.size() - doneTasks;
        if (farm::isCancelled(*job_)) text += "; cancelled";
        if (left > 0 && timed > 0) {
            const double work = seconds / static_cast<double>(timed) * static_cast<double>(left);
            text += "; " + spokenDuration(work) + " of work left";
            if (running > 1)
                text += ", " + spokenDuration(work / static_cast<double>(running)) + " by the " +
                        std::to_string(running) + " tasks at a time that run now";
        }
        console_.result(text + "\n" + rows);
        return kExitOk;
    }

    static std::string row(std::size_t index, const farm::Task& task,
                           const std::vector<farm::Attempt>& attempts, bool done) {
        constexpr int kNone = -1; // it runs, or was killed
        const int last = attempts.empty() ? kNone : attempts.back().exitCode.value_or(kNone);
        const std::string state = done               ? "done"
                                  : attempts.empty() ? "waiting"
                                  : last == kNone    ? "running, or killed"
                                  : last == kExitOk  ? "lost or damaged since"
                                                     : "failed";
        std::string text = "task " + std::to_string(index) + ", " +
                           (task.tile ? "tile at " + std::to_string((*task.tile)[0]) + "," +
                                            std::to_string((*task.tile)[1])
                                      : "frames " + spelledFrames(task.frames)) +
                           ": " + state;
        if (!attempts.empty())
            text += ", attempt " + std::to_string(attempts.size()) + " on " + attempts.back().host;
        if (last > kExitOk) text += ", exit " + std::to_string(last);
        for (std::size_t i = 0; i + 1 < attempts.size(); ++i) {
            const farm::Attempt& attempt = attempts[i];
            text +=
                "; attempt " + std::to_string(i + 1) + " on " + attempt.host +
                (!attempt.exitCode              ? " was killed"
                 : *attempt.exitCode == kExitOk ? " was done, and then lost or damaged"
                                                : ", exit " + std::to_string(*attempt.exitCode));
        }
        return text + "\n";
    }

    // ---- finishing -----------------------------------------------------------------------------------------

    int complete() {
        const std::vector<std::uint32_t> missing = farm::missingTasks(*job_);
        if (!missing.empty()) return handleMissing(missing);
        const auto scene = JobScene::of(*job_, diagnostics_);
        if (!scene) return finish();
        report();
        const Interruptible interruptible;
        const bool written = job_->hasTiles() ? mergeTiles(*scene) : encodeFrames(*scene);
        if (written || diagnostics_.failed()) return finish();
        console_.fail("farm", interruptExitCode(), "interrupted",
                      "to go on: rt farm finish " + job_->folder);
        return interruptExitCode();
    }

    /// Resubmits what Slurm lost, a few times; else says what is not there.
    int handleMissing(const std::vector<std::uint32_t>& missing) {
        std::optional<int> blame; // an exit code that repeating does not change
        std::size_t most = 0;
        for (const std::uint32_t task : missing) {
            const std::vector<farm::Attempt> attempts = farm::attemptsAt(*job_, task);
            most = std::max(most, attempts.size());
            const int code = attempts.empty() ? 0 : attempts.back().exitCode.value_or(0);
            if (code != 0 && !farm::isTransient(code)) blame = code;
        }
        if (farm::isInSlurm(*job_) && !blame && most < farm::kMostAttempts &&
            !farm::isCancelled(*job_)) {
            farm::submitToSlurm(*job_, missing);
            console_.detail("resubmitted tasks " + spelledFrames(missing));
            return kExitOk;
        }
        diagnostics_.error(
            kUnfinished, wholeFile(job_->folder),
            std::to_string(missing.size()) + " of " + std::to_string(job_->tasks.size()) +
                " tasks are not done: " + spelledFrames(missing),
            "their logs are in " + job_->folder + "/log; to go on: rt farm resume " + job_->folder);
        finish();
        return blame.value_or(int(kExitTransient));
    }

    bool encodeFrames(JobScene& scene) {
        const auto plan = planFilm(scene.options, scene.description(), diagnostics_);
        if (!plan || diagnostics_.failed()) return false;
        auto store = formats::FrameStore::open(plan->place, job_->settings,
                                               formats::FrameStore::Mode::resume, diagnostics_);
        if (!store) return false;
        for (std::size_t i = 0; i < job_->tasks.size(); ++i) {
            const auto done = formats::FrameStore::read(job_->placeOf(i), diagnostics_);
            for (const std::uint32_t frame : job_->tasks[i].frames) {
                if (stopRequested()) return false;
                if (!store->isDone(frame)) store->commit(frame, done->load(frame).value());
            }
        }
        const ProgressStyle style = console_.quiet() || console_.jsonErrors()
                                        ? ProgressStyle::none
                                        : ProgressStyle::automatic;
        for (const std::string& film : plan->films) {
            const FilmFile file{film,
                                plan->frames,
                                scene.options.codec,
                                scene.options.quality,
                                {},
                                scene.options.limits.pixels};
            if (!encodeFilm(*store, file, style, diagnostics_)) return false;
            console_.result(film + "\n");
        }
        return true;
    }

    bool mergeTiles(JobScene& scene) {
        image::Framebuffer whole(job_->size[0], job_->size[1]);
        for (std::size_t i = 0; i < job_->tasks.size(); ++i) {
            const auto done = formats::FrameStore::read(job_->placeOf(i), diagnostics_);
            const auto bytes = done->load(0).value();
            const auto& [x0, y0, x1, y1] = *job_->tasks[i].tile;
            const std::size_t rowBytes = (x1 - x0) * sizeof(numeric::LinearRgb);
            if (bytes.size() != rowBytes * (y1 - y0))
                throw std::runtime_error("a tile has another size than its task");
            for (std::uint32_t y = y0; y < y1; ++y)
                std::memcpy(&whole.at(x0, y), bytes.data() + rowBytes * (y - y0), rowBytes);
        }
        for (const Output& output : planOutputs(scene.options, scene.description(), diagnostics_)) {
            const auto bytes =
                encodePicture(whole, output.format, scene.options, scene.description().image);
            if (!writeOutput(output.path, bytes, console_, diagnostics_)) return false;
            console_.result(output.path + "\n");
        }
        return !diagnostics_.failed();
    }

    void report() {
        console_.report(diagnostics_);
        diagnostics_ = {};
    }
    int finish() {
        console_.report(diagnostics_);
        return diagnostics_.exitCode();
    }

    const FarmOptions& options_;
    Console& console_;
    scene::Diagnostics diagnostics_;
    std::optional<farm::Job> job_;
    std::string name_; // of what is made, without its suffix
};

} // namespace

int farm(const FarmOptions& options, Console& console) {
    const std::vector<std::string> actions{"submit", "status", "resume", "cancel", "finish"};
    if (std::ranges::find(actions, options.action) == actions.end())
        throw UsageError("ACTION must be " + listed(actions) + " (got " +
                         scene::quoted(options.action) + ")");
    try {
        return Farm(options, console).run();
    } catch (const UsageError&) {
        throw;
    } catch (const std::runtime_error& failure) {
        scene::Diagnostics diagnostics;
        diagnostics.error(kFarmFailed, wholeFile(options.what), failure.what());
        console.report(diagnostics);
        return diagnostics.exitCode();
    }
}

} // namespace rt::cli
