// rt encode: the frames that rt render has kept, to film files.
#include <core/cli/commands.hpp>
#include <core/cli/encode_film.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/interrupt.hpp>
#include <core/cli/output.hpp>

#include <charconv>
#include <filesystem>

namespace rt::cli {
namespace {

constexpr std::string_view kFolderSuffix = ".frames";

formats::FramePlace placeOf(const std::string& word) {
    if (word.find('%') != std::string::npos && !std::filesystem::is_directory(word)) {
        if (auto place = formats::framePattern(word)) return *place;
        throw UsageError(scene::quoted(word) + " is no pattern of frames",
                         "such as frame_%04d.png");
    }
    std::string folder = word;
    while (folder.size() > 1 && folder.back() == '/') folder.pop_back();
    return {.folder = folder};
}

std::vector<std::string> outputsOf(const EncodeOptions& options, const formats::FramePlace& place) {
    if (!options.outputs.empty()) return options.outputs;
    if (!place.folder.ends_with(kFolderSuffix) || place.folder.size() == kFolderSuffix.size())
        throw UsageError("--output is needed: these frames have no name for the film",
                         "such as -o film.mp4");
    return {place.folder.substr(0, place.folder.size() - kFolderSuffix.size()) + ".mp4"};
}

/// Of the whole film: by the scene's animation, whatever of it is there.
std::uint32_t frameCount(const formats::FrameStore& store) {
    const std::string text = store.setting("animation.frames");
    std::uint32_t count = 0;
    std::from_chars(text.data(), text.data() + text.size(), count);
    return std::max(count, 1u);
}

} // namespace

int encode(const EncodeOptions& options, Console& console) {
    const formats::FramePlace place = placeOf(options.place);
    const std::vector<std::string> outputs = outputsOf(options, place);
    scene::Diagnostics diagnostics;
    const auto finish = [&] {
        console.report(diagnostics);
        return diagnostics.exitCode();
    };
    for (const std::string& output : outputs) {
        requireContainer(output, options.codec);
        checkWritable(output, diagnostics);
    }
    if (diagnostics.failed()) return finish();
    const auto store = formats::FrameStore::read(place, diagnostics);
    if (!store) return finish();
    const std::uint32_t count = frameCount(*store);
    const auto frames = framesOf(options.frames.value_or(FrameSelection{{0, count - 1, 1}}), count);
    const ProgressStyle progress =
        console.quiet() || console.jsonErrors() ? ProgressStyle::none : options.progress;
    const Interruptible interruptible;
    for (const std::string& output : outputs) {
        const FilmFile file{output,          frames,      options.codec,
                            options.quality, options.fps, options.maxPixels};
        if (!encodeFilm(*store, file, progress, diagnostics)) {
            if (!stopRequested()) return finish();
            console.report(diagnostics);
            console.fail("encode", interruptExitCode(),
                         "interrupted before " + output + " was done", "");
            return interruptExitCode();
        }
        console.report(diagnostics);
        diagnostics = {};
        console.result(output + "\n");
    }
    return kExitOk;
}

} // namespace rt::cli
