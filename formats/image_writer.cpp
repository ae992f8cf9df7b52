#include <core/image/quantize.hpp>
#include <formats/codec_modules.hpp>
#include <formats/image_writer.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <stdexcept>

namespace rt::formats {
namespace {

using image::Framebuffer;

struct Suffix {
    std::string_view text;
    ImageFormat format;
};
constexpr Suffix kSuffixes[] = {{"png", ImageFormat::png},   {"jpg", ImageFormat::jpeg},
                                {"jpeg", ImageFormat::jpeg}, {"bmp", ImageFormat::bmp},
                                {"exr", ImageFormat::exr},   {"pfm", ImageFormat::pfm}};

CodecModule moduleOf(ImageFormat format) {
    switch (format) {
    case ImageFormat::png:
        return CodecModule::png;
    case ImageFormat::jpeg:
        return CodecModule::jpeg;
    case ImageFormat::exr:
        return CodecModule::exr;
    default:
        return CodecModule::opencv;
    }
}

std::uint32_t codecFormatOf(ImageFormat format) {
    switch (format) {
    case ImageFormat::png:
        return RT_CODEC_PNG;
    case ImageFormat::jpeg:
        return RT_CODEC_JPEG;
    case ImageFormat::bmp:
        return RT_CODEC_BMP;
    default:
        return RT_CODEC_EXR;
    }
}

/// Every channel through `convert`, row by row from the top, R G B.
template <class Sample, class Convert>
std::vector<Sample> samplesOf(const Framebuffer& frame, Convert convert) {
    std::vector<Sample> samples(frame.pixels.size() * 3);
    auto to = samples.begin();
    for (const auto& pixel : frame.pixels) {
        *to++ = convert(pixel.r);
        *to++ = convert(pixel.g);
        *to++ = convert(pixel.b);
    }
    return samples;
}

float toFloat(double c) { return static_cast<float>(c); }

/// Portable float map: text header, little-endian binary32, rows from the bottom.
std::vector<std::byte> encodePfm(const Framebuffer& frame) {
    static_assert(std::endian::native == std::endian::little);
    const std::string header =
        "PF\n" + std::to_string(frame.width) + " " + std::to_string(frame.height) + "\n-1.0\n";
    const std::vector<float> samples = samplesOf<float>(frame, toFloat);
    const std::size_t row = std::size_t(frame.width) * 3 * sizeof(float);
    std::vector<std::byte> bytes(header.size() + row * frame.height);
    std::memcpy(bytes.data(), header.data(), header.size());
    for (std::size_t y = 0; y < frame.height; ++y)
        std::memcpy(bytes.data() + header.size() + row * (frame.height - 1 - y),
                    samples.data() + y * frame.width * 3, row);
    return bytes;
}

int appendBytes(void* context, const void* bytes, std::size_t count) {
    auto& out = *static_cast<std::vector<std::byte>*>(context);
    const auto* from = static_cast<const std::byte*>(bytes);
    try {
        out.insert(out.end(), from, from + count);
        return 1;
    } catch (const std::bad_alloc&) {
        return 0;
    }
}

template <class Sample>
std::vector<std::byte> encodeWith(const Framebuffer& frame, ImageFormat format,
                                  const Encoding& encoding, std::vector<Sample> samples) {
    const rt_codec_table& codec = *openCodecModule(moduleOf(format)).get();
    std::vector<std::byte> bytes;
    std::array<char, 256> error{};
    const rt_samples view{frame.width, frame.height, 8 * sizeof(Sample), samples.data()};
    const rt_encode_settings settings{
        encoding.transfer == scene::Encoding::srgb,
        static_cast<std::uint32_t>(std::clamp(encoding.quality, 1, 100))};
    const rt_codec_host host{&bytes, appendBytes, nullptr, error.data(), error.size()};
    if (!codec.encode(codecFormatOf(format), &view, &settings, &host))
        throw std::runtime_error(std::string("the picture cannot be encoded: ") + error.data());
    return bytes;
}

} // namespace

std::optional<ImageFormat> imageFormatOf(std::string_view path) {
    const std::size_t dot = path.rfind('.'), slash = path.rfind('/');
    if (dot == path.npos || (slash != path.npos && dot < slash)) return {};
    std::string suffix(path.substr(dot + 1));
    for (char& c : suffix)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    for (const Suffix& known : kSuffixes)
        if (known.text == suffix) return known.format;
    return {};
}

std::shared_future<void> openCodec(ImageFormat format) {
    if (format == ImageFormat::pfm) {
        std::promise<void> ready;
        ready.set_value();
        return ready.get_future().share();
    }
    const auto module =
        openCodecModule(moduleOf(format)); // runs by itself; the wait below starts at get()
    return std::async(std::launch::deferred, [module] { module.get(); }).share();
}

std::vector<std::byte> encodeImage(const Framebuffer& frame, ImageFormat format,
                                   const Encoding& encoding) {
    if (frame.width == 0 || frame.height == 0)
        throw std::runtime_error("the picture has no pixels");
    const bool srgb = encoding.transfer == scene::Encoding::srgb;
    if (format == ImageFormat::pfm) return encodePfm(frame);
    if (format == ImageFormat::exr)
        return encodeWith(frame, format, encoding, samplesOf<float>(frame, toFloat));
    if (format == ImageFormat::png && encoding.bits == 16)
        return encodeWith(frame, format, encoding,
                          samplesOf<std::uint16_t>(frame, srgb ? image::srgb16 : image::linear16));
    return encodeWith(frame, format, encoding,
                      image::codesOf(frame, srgb ? image::toSrgb8 : image::toLinear8));
}

} // namespace rt::formats
