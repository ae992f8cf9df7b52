#include <core/cli/film_options.hpp>

namespace rt::cli {
namespace {

void addFrames(OptionRows& rows, std::optional<FrameSelection>& frames, const char* text) {
    rows.option("--frames", "LIST", text,
                [&frames](const std::string& word) { frames = parseFrames(word); });
}

void addCodec(OptionRows& rows, std::optional<formats::VideoCodec>& codec) {
    rows.option("--codec", choiceName(formats::videoCodecNames()),
                "Of a film; by default h264 in mp4 and mkv, mpeg4 in avi, vp9 in webm.",
                [&codec](const std::string& word) {
                    codec = static_cast<formats::VideoCodec>(
                        parseChoice(word, formats::videoCodecNames()));
                });
}

} // namespace

void addFilmOptions(OptionRows& rows, RenderOptions& options) {
    addFrames(rows, options.frames,
              "Images of a film, from 0: 10-20,30 or, every fifth, 10-200:5; all by default.");
    addCodec(rows, options.codec);
    rows.flag("--resume", "Render only the frames that are missing or broken.", options.resume);
    rows.flag("--overwrite", "Delete the frames of an earlier run and start again.",
              options.overwrite);
}

void addEncodeOptions(OptionRows& rows, EncodeOptions& options) {
    rows.argument("frames", "DIR",
                  "The folder NAME.frames of a film, or a pattern such as frame_%04d.png that it "
                  "was rendered to.",
                  options.place);
    rows.option("-o,--output", "FILE",
                "Write here; the suffix chooses mp4, avi, mkv or webm. May be given more than "
                "once. Default: ./NAME.mp4.",
                [&options](const std::string& word) {
                    if (word.empty()) throw UsageError("must not be empty");
                    options.outputs.push_back(word);
                });
    addFrames(rows, options.frames, "The frames of the film, such as 0-99; all by default.");
    addCodec(rows, options.codec);
    rows.option("--quality", "N", "1 to 100; 80 by default. Not for ffv1, which is lossless.",
                [&options](const std::string& word) {
                    options.quality = static_cast<int>(parseWhole(word, 1, 100));
                });
    rows.option("--fps", "RATE", "Images per second; by default what the scene says.",
                [&options](const std::string& word) {
                    options.fps = parseReal(word, kLeastFps, kMostFps);
                });
    rows.option("--limit-pixels", "N", "Refuse larger frames; 268435456 by default.",
                [&options](const std::string& word) {
                    options.maxPixels = parseWhole(word, 1, 0xFFFFFFFF);
                });
    rows.option("--progress", choiceName(progressStyleNames()),
                "How progress is shown on stderr; auto is a bar on a terminal and nothing "
                "elsewhere.",
                [&options](const std::string& word) {
                    options.progress =
                        static_cast<ProgressStyle>(parseChoice(word, progressStyleNames()));
                });
}

} // namespace rt::cli
