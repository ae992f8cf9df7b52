// Pictures to a film file, through the video module.
#pragma once
#include <atomic>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rt::formats {

enum class Container : std::uint8_t { mp4, avi, mkv, webm };
enum class VideoCodec : std::uint8_t { h264, h265, vp9, mpeg4, mjpeg, ffv1 };

/// By the lower-cased suffix of `path`; nothing for any other.
std::optional<Container> containerOf(std::string_view path);

/// "h264", …, in the order of the enumeration.
const std::vector<std::string>& videoCodecNames();

/// Those that players expect in a container; the first is what it gets unless told otherwise.
std::span<const VideoCodec> codecsOf(Container container);

struct VideoSettings {
    Container container = Container::mp4;
    VideoCodec codec = VideoCodec::h264;
    std::uint32_t width = 0, height = 0;
    double fps = 24;  // from 0.001 to 1000
    int quality = 80; // 1 to 100, on each codec's own scale; FFV1 is lossless
};

/// Tagged BT.709 primaries and matrix with the sRGB curve; the same bytes for the same frames. Everything throws
/// std::runtime_error with a clause such as "cannot be written: No space left on device".
class VideoWriter {
public:
    VideoWriter(const std::string& path, const VideoSettings& settings);
    ~VideoWriter();
    VideoWriter(const VideoWriter&) = delete;
    VideoWriter& operator=(const VideoWriter&) = delete;

    /// 8-bit R G B, rows from the top without gaps.
    void add(std::span<const std::uint8_t> rgb);
    /// Completes the file. Without it the file is no film.
    void finish();

private:
    void* video_ = nullptr;
    std::size_t frameBytes_;
};

struct VideoFacts {
    std::uint64_t frames; // that can be decoded
    std::uint32_t width, height;
};

/// Decodes the whole film, or as much as there is time for until `stop`. Throws std::runtime_error where that fails.
VideoFacts inspectVideo(const std::string& path, const std::atomic<bool>& stop);

} // namespace rt::formats
