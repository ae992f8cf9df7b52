#include <core/cli/film.hpp>

#include <core/cli/draw_frame.hpp>
#include <core/cli/encode_film.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/interrupt.hpp>
#include <core/cli/output.hpp>
#include <core/cli/progress.hpp>
#include <core/cli/statistics.hpp>

#include <algorithm>
#include <filesystem>
#include <system_error>

namespace rt::cli {
namespace {

namespace fs = std::filesystem;

constexpr scene::Code kWriteFailed{605}, kEncodeFailed{606};

bool isFilm(const std::string& path) {
    return formats::containerOf(path) || formats::framePattern(path);
}

/// Those of the command line; else the scene's own file, else ./<stem>.mp4, where that means a film.
std::vector<std::string> outputsOf(const RenderOptions& options,
                                   const scene::Description& description) {
    if (!options.outputs.empty()) return options.outputs;
    const bool moves = description.animation && description.animation->frames > 1;
    const bool onePicture = options.trace || options.pixel || options.format ||
                            (options.frames && options.frames->size() == 1 &&
                             options.frames->front().first == options.frames->front().last);
    if (!moves || onePicture) return {};
    const std::string& said = description.image.file;
    if (isFilm(said)) return {said};
    if (formats::imageFormatOf(said)) return {};
    return {fs::path(options.scene).stem().string() + ".mp4"};
}

void refuseFilmOptions(const RenderOptions& options) {
    const char* const given = options.resume      ? "--resume"
                              : options.overwrite ? "--overwrite"
                              : options.codec     ? "--codec"
                                                  : nullptr;
    if (given) throw UsageError(std::string(given) + " is for films", "such as -o film.mp4");
}

/// For a shell.
std::string quotedWord(const std::string& word) {
    const bool plain = !word.empty() &&
                       word.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                              "0123456789_-+=.,:/%@") == std::string::npos;
    if (plain) return word;
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
}

std::string resumeCommand(const RenderOptions& options) {
    std::string command = "rt";
    for (const std::string& word : options.words)
        if (word != "--overwrite" && word != "--resume") command += " " + quotedWord(word);
    return command + " --resume";
}

class FilmRenderer {
public:
    FilmRenderer(const FilmPlan& plan, const RenderOptions& options,
                 const scene::Description& description, plugin_host::Catalog& catalog,
                 Console& console)
        : plan_(plan), options_(options), image_(description.image),
          drawer_(options, description, catalog), console_(console) {}

    int run() {
        const auto codec = formats::openCodec(plan_.format); // while the scene is loaded
        if (!drawer_.load(diagnostics_)) return finish();
        using Mode = formats::FrameStore::Mode;
        auto store = formats::FrameStore::open(plan_.place, drawer_.settings(),
                                               options_.resume      ? Mode::resume
                                               : options_.overwrite ? Mode::overwrite
                                                                    : Mode::fresh,
                                               diagnostics_);
        if (!store) return finish();
        report();

        const Interruptible interruptible;
        std::vector<std::uint32_t> missing;
        for (const std::uint32_t frame : plan_.frames)
            if (!store->isDone(frame)) missing.push_back(frame);
        console_.detail(std::to_string(missing.size()) + " of " +
                        std::to_string(plan_.frames.size()) + " frames to render");
        const bool isRendered = renderFrames(missing, *store);
        if (drawer_.statistics().frames) sayWhatItTook();
        if (!isRendered) return ended(*store);
        return encodeFilms(*store);
    }

private:
    ProgressStyle progressStyle() const {
        return console_.quiet() || console_.jsonErrors() ? ProgressStyle::none : options_.progress;
    }

    /// False after an error or a signal.
    bool renderFrames(const std::vector<std::uint32_t>& frames, formats::FrameStore& store) {
        Progress progress(progressStyle(), options_.scene);
        double done = 0;
        for (const std::uint32_t frame : frames) {
            progress.setTitle(options_.scene + " frame " + std::to_string(frame));
            const auto show = [&](double share) {
                progress.show((done + share) / static_cast<double>(frames.size()));
            };
            const auto bytes = picture(frame, show);
            if (!bytes || !commit(frame, *bytes, store)) {
                progress.finish(done / static_cast<double>(frames.size()));
                return false;
            }
            show(1), ++done;
        }
        progress.finish(1);
        return true;
    }

    void sayWhatItTook() {
        if (options_.statistics)
            reportStatistics(drawer_.statistics(), options_, console_, diagnostics_);
        else
            console_.detail(octreeSummary(drawer_.statistics()));
    }

    /// The file of one frame; nothing after an error or a signal.
    std::optional<std::vector<std::byte>> picture(std::uint32_t frame,
                                                  const std::function<void(double)>& show) {
        const auto drawn = drawer_.draw(frame, show, diagnostics_);
        if (!drawn) return {};
        try {
            return encodePicture(*drawn, plan_.format, options_, image_);
        } catch (const std::runtime_error& error) {
            diagnostics_.error(kEncodeFailed, wholeFile(plan_.place.folder), error.what());
            return {};
        }
    }

    bool commit(std::uint32_t frame, const std::vector<std::byte>& bytes,
                formats::FrameStore& store) {
        try {
            store.commit(frame, bytes);
            return true;
        } catch (const std::system_error& failure) {
            diagnostics_.error(kWriteFailed,
                               wholeFile(plan_.place.pathOf(plan_.place.fileOf(frame))),
                               "frame " + std::to_string(frame) + " cannot be written: " +
                                   failure.code().message() + "; the frames before it are kept",
                               "to go on: " + resumeCommand(options_));
            return false;
        }
    }

    int encodeFilms(const formats::FrameStore& store) {
        for (const std::string& film : plan_.films) {
            const FilmFile file{film, plan_.frames,          options_.codec, options_.quality,
                                {},   options_.limits.pixels};
            if (!encodeFilm(store, file, progressStyle(), diagnostics_)) return ended(store);
            report();
            console_.result(film + "\n");
        }
        if (plan_.films.empty())
            for (const std::uint32_t frame : plan_.frames)
                console_.result(plan_.place.pathOf(plan_.place.fileOf(frame)) + "\n");
        return finish();
    }

    /// After an error, or after a signal.
    int ended(const formats::FrameStore& store) {
        if (diagnostics_.failed() || !stopRequested()) return finish();
        report();
        const auto done =
            std::ranges::count_if(plan_.frames, [&](auto frame) { return store.isListed(frame); });
        console_.fail("render", interruptExitCode(),
                      "interrupted after " + std::to_string(done) + " of " +
                          std::to_string(plan_.frames.size()) + " frames",
                      "to go on: " + resumeCommand(options_));
        return interruptExitCode();
    }

    void report() {
        console_.report(diagnostics_);
        diagnostics_ = {};
    }
    int finish() {
        console_.report(diagnostics_);
        return diagnostics_.exitCode();
    }

    const FilmPlan& plan_;
    const RenderOptions& options_;
    const scene::Image& image_;
    FrameDrawer drawer_;
    Console& console_;
    scene::Diagnostics diagnostics_;
};

} // namespace

std::optional<FilmPlan> planFilm(const RenderOptions& options,
                                 const scene::Description& description,
                                 scene::Diagnostics& diagnostics) {
    if (options.frames && !description.animation)
        throw UsageError("--frames needs a scene with a section 'animation'");
    const std::vector<std::string> outputs = outputsOf(options, description);
    const auto film = std::ranges::find_if(outputs, isFilm);
    if (film == outputs.end() || options.trace) {
        refuseFilmOptions(options);
        return {};
    }
    if (!description.animation)
        throw UsageError("--output: " + scene::quoted(*film) +
                             " is a film, and the scene has no section 'animation'",
                         "for a picture: -o " + fs::path(*film).stem().string() + ".png");
    if (options.timeBudget)
        throw UsageError("--time-budget is for one picture: the frames of a film are the same on "
                         "every machine",
                         "use --max-error");
    if (options.resume && options.overwrite)
        throw UsageError("--resume and --overwrite exclude each other");
    FilmPlan plan;
    std::optional<std::string> pattern;
    for (const std::string& output : outputs) {
        if (formats::containerOf(output)) {
            requireContainer(output, options.codec);
            plan.films.push_back(output);
            checkWritable(output, diagnostics);
        } else if (const auto place = formats::framePattern(output); place && !pattern) {
            pattern = output;
            plan.place = *place;
        } else {
            throw UsageError("--output: " + scene::quoted(output) +
                             (place ? " is a second pattern for the frames"
                                    : " is a picture and " + scene::quoted(*film) + " a film"));
        }
    }
    if (!pattern) plan.place = formats::framesBeside(plan.films.front());
    if (plan.films.empty() && options.codec) refuseFilmOptions(options);
    const std::uint32_t count = description.animation->frames;
    plan.frames = framesOf(options.frames.value_or(FrameSelection{{0, count - 1, 1}}), count);
    const std::string first = plan.place.pathOf(plan.place.fileOf(plan.frames.front()));
    const auto format = options.format ? options.format : formats::imageFormatOf(first);
    if (!format)
        throw UsageError("--output: the suffix of frames must be png, jpg, jpeg, bmp, exr or pfm "
                         "(got " +
                         scene::quoted(*pattern) + ")");
    plan.format = *format;
    if (pattern) checkWritable(first, diagnostics);
    return plan;
}

std::uint32_t pictureFrame(const RenderOptions& options, const scene::Description& description) {
    if (!options.frames) return 0;
    const auto frames = framesOf(*options.frames, description.animation->frames);
    if (frames.size() > 1)
        throw UsageError("--frames: a picture shows one frame, not " +
                             std::to_string(frames.size()),
                         "number them, such as -o frame_%04d.png, or write a film");
    return frames.front();
}

int renderFilm(const FilmPlan& plan, const RenderOptions& options,
               const scene::Description& description, plugin_host::Catalog& catalog,
               Console& console) {
    return FilmRenderer(plan, options, description, catalog, console).run();
}

} // namespace rt::cli
