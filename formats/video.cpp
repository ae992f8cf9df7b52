#include <formats/video.hpp>

#include <formats/module_file.hpp>
#include <formats/video_module/video_module.h>

#include <array>
#include <cmath>
#include <stdexcept>

namespace rt::formats {
namespace {

using enum VideoCodec;

struct Kind {
    const char *suffix, *muxer;
    std::vector<VideoCodec> codecs;
};
const std::array<Kind, 4> kKinds{{{"mp4", "mp4", {h264, h265, mpeg4}},
                                  {"avi", "avi", {mpeg4, mjpeg, ffv1}},
                                  {"mkv", "matroska", {h264, h265, vp9, mpeg4, mjpeg, ffv1}},
                                  {"webm", "webm", {vp9}}}};
constexpr std::array kEncoders{"libx264", "libx265", "libvpx-vp9", "mpeg4", "mjpeg", "ffv1"};

const Kind& kindOf(Container container) { return kKinds[static_cast<std::size_t>(container)]; }

const rt_video_module& videoModule() {
    static const rt_video_module& module = []() -> const rt_video_module& {
        constexpr const char *kFile = "rt_video.so", *kWhat = "the video module";
        const auto* table =
            static_cast<const rt_video_module*>(openModule(kFile, "rt_video_entry", kWhat));
        if (table->version != RT_VIDEO_MODULE_VERSION || table->struct_size != sizeof *table)
            refuseForeignModule(kFile, kWhat);
        return *table;
    }();
    return module;
}

struct Fraction {
    std::uint32_t numerator, denominator;
};

/// The fraction nearest to `value` among those with a small denominator, which every codec takes: 23.976 is 2997/125.
Fraction fractionOf(double value) {
    constexpr std::uint32_t kMaxDenominator = 1001; // of 24000/1001
    Fraction best{1, 1};
    double bestError = HUGE_VAL;
    for (std::uint32_t denominator = 1; denominator <= kMaxDenominator; ++denominator) {
        const double numerator = std::fmax(1, std::nearbyint(value * denominator));
        const double error = std::fabs(numerator / denominator - value);
        if (error < bestError) {
            best = {static_cast<std::uint32_t>(numerator), denominator};
            bestError = error;
        }
    }
    return best;
}

/// Calls a function of the module, which says why where it fails.
template <class Call> void require(Call call) {
    std::array<char, 512> error{};
    if (!call(error.data(), error.size())) throw std::runtime_error(error.data());
}

} // namespace

std::optional<Container> containerOf(std::string_view path) {
    const std::size_t dot = path.rfind('.');
    if (dot == std::string_view::npos) return {};
    std::string suffix(path.substr(dot + 1));
    for (char& c : suffix)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    for (std::size_t i = 0; i < kKinds.size(); ++i)
        if (suffix == kKinds[i].suffix) return static_cast<Container>(i);
    return {};
}

const std::vector<std::string>& videoCodecNames() {
    static const std::vector<std::string> names{"h264", "h265", "vp9", "mpeg4", "mjpeg", "ffv1"};
    return names;
}

std::span<const VideoCodec> codecsOf(Container container) { return kindOf(container).codecs; }

VideoWriter::VideoWriter(const std::string& path, const VideoSettings& settings)
    : frameBytes_(std::size_t(3) * settings.width * settings.height) {
    const Fraction fps = fractionOf(settings.fps);
    const rt_video_settings passed{path.c_str(),
                                   kindOf(settings.container).muxer,
                                   kEncoders[static_cast<std::size_t>(settings.codec)],
                                   settings.width,
                                   settings.height,
                                   fps.numerator,
                                   fps.denominator,
                                   settings.quality};
    require([&](char* error, std::size_t size) {
        return videoModule().open(&passed, &video_, error, size);
    });
}

VideoWriter::~VideoWriter() { videoModule().close(video_); }

void VideoWriter::add(std::span<const std::uint8_t> rgb) {
    if (rgb.size() != frameBytes_) throw std::runtime_error("has frames of different sizes");
    require([&](char* error, std::size_t size) {
        return videoModule().add(video_, rgb.data(), error, size);
    });
}

void VideoWriter::finish() {
    require(
        [&](char* error, std::size_t size) { return videoModule().finish(video_, error, size); });
}

VideoFacts inspectVideo(const std::string& path, const std::atomic<bool>& stop) {
    rt_video_facts facts{};
    const auto poll = [](void* flag) -> std::int32_t {
        return *static_cast<const std::atomic<bool>*>(flag) ? 1 : 0;
    };
    auto* const flag = const_cast<std::atomic<bool>*>(&stop);
    require([&](char* error, std::size_t size) {
        return videoModule().inspect(path.c_str(), poll, flag, &facts, error, size);
    });
    return {facts.frames, facts.width, facts.height};
}

} // namespace rt::formats
