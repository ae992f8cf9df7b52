// `--frames 10-20,30,40-200:5`: which images of a film.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace rt::cli {

struct FrameRange {
    std::uint32_t first, last, step; // every step-th from first, up to last
};
using FrameSelection = std::vector<FrameRange>;

/// Throws UsageError.
FrameSelection parseFrames(std::string_view word);

/// The frames, rising, each once. Throws UsageError where the film, of `count` frames, does not have one.
std::vector<std::uint32_t> framesOf(const FrameSelection& selection, std::uint32_t count);

/// "0-57,60": rising frames as --frames takes them.
std::string spelledFrames(const std::vector<std::uint32_t>& frames);

} // namespace rt::cli
