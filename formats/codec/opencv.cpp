// BMP and Radiance HDR by OpenCV.
#include <formats/codec/guarded.hpp>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <stdexcept>
#include <vector>

namespace {

/// OpenCV's channel order is B G R (A), or grey.
template <class Sample> void toRgb(const cv::Mat& from, Sample* to) {
    const int channels = from.channels();
    for (int y = 0; y < from.rows; ++y) {
        const Sample* pixel = from.ptr<Sample>(y);
        for (int x = 0; x < from.cols; ++x, pixel += channels, to += 3)
            for (int c = 0; c < 3; ++c) to[c] = pixel[channels < 3 ? 0 : 2 - c];
    }
}

void encodeOrThrow(const rt_samples& samples, const rt_codec_host& host) {
    cv::Mat bgr(static_cast<int>(samples.height), static_cast<int>(samples.width), CV_8UC3);
    const auto* from = static_cast<const std::uint8_t*>(samples.data);
    for (int y = 0; y < bgr.rows; ++y)
        for (std::uint8_t *to = bgr.ptr(y), *end = to + 3 * bgr.cols; to != end; to += 3, from += 3)
            to[0] = from[2], to[1] = from[1], to[2] = from[0];
    std::vector<std::uint8_t> bytes;
    if (!cv::imencode(".bmp", bgr, bytes)) throw std::runtime_error("OpenCV could not encode it");
    if (!host.append(host.context, bytes.data(), bytes.size())) throw std::bad_alloc();
}

/// OpenCV prints the exceptions that it catches to std::cerr. Nobody else does while a picture is decoded.
class SilentCerr {
public:
    SilentCerr() : before_(std::cerr.rdbuf(nullptr)) {}
    ~SilentCerr() { std::cerr.rdbuf(before_); } // also clears the state
    SilentCerr(const SilentCerr&) = delete;
    SilentCerr& operator=(const SilentCerr&) = delete;

private:
    std::streambuf* before_;
};

void decodeOrThrow(const void* bytes, std::size_t count, const rt_codec_host& host) {
    const cv::Mat raw(1, static_cast<int>(count), CV_8U, const_cast<void*>(bytes));
    const SilentCerr silent;
    const cv::Mat image =
        cv::imdecode(raw, cv::IMREAD_UNCHANGED); // COLOR would turn, narrow and clamp
    if (image.empty()) throw std::runtime_error("it is truncated or damaged");
    const std::uint32_t bits = image.depth() == CV_32F ? 32 : image.depth() == CV_16U ? 16 : 8;
    void* to = host.allocate(host.context, static_cast<std::uint32_t>(image.cols),
                             static_cast<std::uint32_t>(image.rows), bits);
    if (!to) throw std::runtime_error("too large");
    if (image.depth() == CV_32F)
        toRgb(image, static_cast<float*>(to));
    else if (image.depth() == CV_16U)
        toRgb(image, static_cast<std::uint16_t*>(to));
    else if (image.depth() == CV_8U)
        toRgb(image, static_cast<std::uint8_t*>(to));
    else
        throw std::runtime_error("its samples are neither 8 or 16 bits nor binary32");
}

int encode(std::uint32_t, const rt_samples* samples, const rt_encode_settings*,
           const rt_codec_host* host) {
    return guarded(host, [&] { encodeOrThrow(*samples, *host); });
}

int decode(std::uint32_t, const void* bytes, std::size_t count, const rt_codec_host* host) {
    return guarded(host, [&] { decodeOrThrow(bytes, count, *host); });
}

[[maybe_unused]] const auto kSilenced =
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);

} // namespace

extern "C" {
RT_CODEC_EXPORT extern const rt_codec_table rt_codec;
const rt_codec_table rt_codec = {sizeof(rt_codec_table), encode, decode};
}
