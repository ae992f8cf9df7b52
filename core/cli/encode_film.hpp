// Finished frames to a film file, which is read back before it takes its name.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/scene/diagnostic.hpp>
#include <formats/frame_store.hpp>
#include <formats/video.hpp>

#include <optional>
#include <string>
#include <vector>

namespace rt::cli {

struct FilmFile {
    std::string path;
    std::vector<std::uint32_t> frames;
    std::optional<formats::VideoCodec> codec;
    std::optional<int> quality;
    std::optional<double> fps;                        // none: as the manifest says
    std::uint64_t maxPixels = scene::Limits().pixels; // of a frame
};

/// Throws UsageError where the container does not take the codec, or is none.
void requireContainer(const std::string& path, const std::optional<formats::VideoCodec>& codec);

/// False after an error, or when a signal came: the old file is then as it was. E0407 frames missing or broken; E0605,
/// E0606 the film cannot be written.
bool encodeFilm(const formats::FrameStore& store, const FilmFile& file, ProgressStyle progress,
                scene::Diagnostics& diagnostics);

} // namespace rt::cli
