// Names of the numbered pictures of a film.
#pragma once
#include <cstdint>
#include <optional>
#include <string>

namespace rt::formats {

/// FOLDER/BEFORE<frame>AFTER, the frame's number with zeros up to `digits`, and FOLDER/MANIFEST.
struct FramePlace {
    std::string folder = ".", manifest = "manifest";
    std::string before = "frame_";
    unsigned digits = 4;
    std::string after = ".png";

    std::string fileOf(std::uint32_t frame) const; // within the folder
    std::string pathOf(const std::string& file) const;
};

/// "out/film.mp4" -> out/film.frames/frame_0000.png …
FramePlace framesBeside(const std::string& film);

/// Of "out/shot_%04d.png" or "%d.exr": the pictures in `out`, with a hidden manifest. Nothing if the file name does not
/// have exactly one number; %% is a percent sign.
std::optional<FramePlace> framePattern(const std::string& pattern);

} // namespace rt::formats
