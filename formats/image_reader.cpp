#include <core/image/quantize.hpp>
#include <core/numeric/colour.hpp>
#include <core/scene/source.hpp>
#include <formats/codec_modules.hpp>
#include <formats/image_reader.hpp>

#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <new>
#include <stdexcept>
#include <vector>

namespace rt::formats {
namespace {

constexpr scene::Code kUnknownKind{450}, kDamaged{451}, kNonFinite{452}, kNoMemory{703},
    kTooManyPixels{713};
constexpr std::uint64_t kMaxBytes = std::uint64_t(1) << 31; // 2^26 pixels of three f32 are 0.75 GiB

struct PictureError : std::runtime_error {
    PictureError(scene::Code c, const std::string& sentence)
        : std::runtime_error(sentence), code(c) {}
    scene::Code code;
};

[[noreturn]] void damaged(const std::string& why) {
    throw PictureError(kDamaged, "the picture cannot be read: " + why);
}
[[noreturn]] void truncated() { damaged("the file is truncated"); }

struct Size {
    std::uint64_t width = 0, height = 0;
};

void checkSize(Size size, std::uint64_t maxPixels) {
    if (size.width == 0 || size.height == 0) damaged("it has no pixels");
    if (size.width > maxPixels || size.height > maxPixels || size.width * size.height > maxPixels)
        throw PictureError(kTooManyPixels, "the picture has " + std::to_string(size.width) + " x " +
                                               std::to_string(size.height) +
                                               " pixels, more than the limit of " +
                                               std::to_string(maxPixels));
}

// Headers of the kinds whose decoder allocates before it asks ------------------------------------------------------

class Bytes {
public:
    explicit Bytes(std::string_view all) : all_(all) {}
    std::uint32_t at(std::size_t i) const {
        if (i >= all_.size()) truncated();
        return static_cast<unsigned char>(all_[i]);
    }
    std::uint32_t big16(std::size_t i) const { return at(i) << 8 | at(i + 1); }
    std::uint32_t little16(std::size_t i) const { return at(i) | at(i + 1) << 8; }
    std::uint32_t little32(std::size_t i) const { return little16(i) | little16(i + 2) << 16; }
    std::size_t size() const { return all_.size(); }
    std::string_view text() const { return all_; }

private:
    std::string_view all_;
};

Size bmpSize(const Bytes& bytes) {
    if (bytes.little32(14) == 12) return {bytes.little16(18), bytes.little16(20)}; // OS/2 header
    const auto width = static_cast<std::int32_t>(bytes.little32(18)),
               height = static_cast<std::int32_t>(bytes.little32(22));
    if (width <= 0) damaged("a width that is not positive");
    const std::int64_t rows = height < 0 ? -std::int64_t(height) : height; // negative: from the top
    if (bytes.little32(30) == 0) { // uncompressed: the length is known
        const std::uint64_t stride = (std::uint64_t(width) * bytes.little16(28) + 31) / 32 * 4;
        if (bytes.size() < bytes.little32(10) + stride * std::uint64_t(rows)) truncated();
    }
    return {std::uint64_t(width), std::uint64_t(rows)};
}

std::uint64_t numberOf(std::string_view text) {
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
        damaged("a number in its header is malformed");
    return value;
}

/// The resolution line after the blank line of a Radiance header: "-Y height +X width" in any order and direction.
Size hdrSize(const Bytes& bytes) {
    const std::string_view text = bytes.text();
    const std::size_t blank = text.find("\n\n");
    if (blank == text.npos) truncated();
    const std::size_t end = text.find('\n', blank + 2);
    if (end == text.npos) truncated();
    const std::string_view line = text.substr(blank + 2, end - blank - 2);
    const std::size_t first = line.find(' '), second = line.find(' ', first + 1),
                      third = line.find(' ', second + 1);
    if (first != 2 || second == line.npos || third == line.npos)
        damaged("its resolution line is malformed");
    const std::uint64_t a = numberOf(line.substr(first + 1, second - first - 1)),
                        b = numberOf(line.substr(third + 1));
    return line[1] == 'Y' ? Size{b, a} : Size{a, b};
}

// Samples to light ----------------------------------------------------------------------------------------------

using image::Framebuffer;

template <class Sample, class Decode>
void fill(Framebuffer& frame, const Sample* from, Decode decode) {
    for (auto& pixel : frame.pixels) {
        pixel = {decode(from[0]), decode(from[1]), decode(from[2])};
        from += 3;
    }
}

Framebuffer frameOf(const rt_samples& samples, scene::Encoding encoding) {
    Framebuffer frame(samples.width, samples.height);
    const bool srgb = encoding == scene::Encoding::srgb;
    if (samples.bits == 8)
        fill(frame, static_cast<const std::uint8_t*>(samples.data),
             [srgb](std::uint8_t s) { return srgb ? image::linearFromSrgb8(s) : s / 255.0; });
    else if (samples.bits == 16)
        fill(frame, static_cast<const std::uint16_t*>(samples.data), [srgb](std::uint16_t s) {
            return srgb ? numeric::linearFromSrgb(s / 65535.0) : s / 65535.0;
        });
    else
        fill(frame, static_cast<const float*>(samples.data), [](float s) { return double(s); });
    return frame;
}

// Decoding ------------------------------------------------------------------------------------------------------

struct Destination {
    std::uint64_t maxPixels;
    rt_samples samples{};
    std::vector<std::byte> data;
    std::optional<PictureError> refused; // held while C frames are on the stack
};

void* allocate(void* context, std::uint32_t width, std::uint32_t height, std::uint32_t bits) {
    auto& to = *static_cast<Destination*>(context);
    try {
        checkSize({width, height}, to.maxPixels);
        to.data.resize(std::size_t(width) * height * 3 * (bits / 8));
        to.samples = {width, height, bits, to.data.data()};
        return to.data.data();
    } catch (const PictureError& error) {
        to.refused = error;
    } catch (const std::bad_alloc&) {
        to.refused = PictureError(kNoMemory, "there is not enough memory for the picture");
    }
    return nullptr;
}

void decodeByModule(std::string_view bytes, CodecModule module, std::uint32_t format,
                    Destination& to) {
    const rt_codec_table& codec = *openCodecModule(module).get();
    std::array<char, 256> error{};
    const rt_codec_host host{&to, nullptr, allocate, error.data(), error.size()};
    if (!codec.decode(format, bytes.data(), bytes.size(), &host)) {
        if (to.refused) throw *to.refused;
        damaged(error.data());
    }
}

/// Portable float maps (PF, Pf) and binary PNM (P5, P6): a magic word, width, height and a scale or maximum, parted by
/// white space and # comments; one white space; samples.
class NetpbmHeader {
public:
    explicit NetpbmHeader(const Bytes& bytes) : bytes_(bytes) {}
    std::string_view word() {
        for (;; ++at_) {
            if (bytes_.at(at_) == '#')
                while (bytes_.at(at_) != '\n') ++at_;
            if (!isSpace(bytes_.at(at_))) break;
        }
        const std::size_t start = at_;
        while (!isSpace(bytes_.at(at_))) ++at_;
        return bytes_.text().substr(start, at_ - start);
    }
    std::string_view samples() const { return bytes_.text().substr(at_ + 1); }

private:
    static bool isSpace(std::uint32_t c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
    const Bytes& bytes_;
    std::size_t at_ = 2;
};

void decodePfm(const Bytes& bytes, Destination& to) {
    NetpbmHeader header(bytes);
    const unsigned channels = bytes.at(1) == 'F' ? 3 : 1;
    const std::uint64_t width = numberOf(header.word()), height = numberOf(header.word());
    const std::string_view scaleText = header.word();
    double scale = 0;
    const auto [end, error] =
        std::from_chars(scaleText.data(), scaleText.data() + scaleText.size(), scale);
    if (error != std::errc() || end != scaleText.data() + scaleText.size() ||
        !std::isfinite(scale) || scale == 0)
        damaged("its scale is malformed");
    checkSize({width, height}, to.maxPixels);
    const std::string_view samples = header.samples();
    const std::size_t row = width * channels * sizeof(float);
    if (samples.size() < row * height) truncated();
    if (!allocate(&to, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), 32))
        throw *to.refused;
    auto* out = reinterpret_cast<float*>(to.data.data());
    for (std::size_t y = height; y-- > 0;) // the first row of the file is the lowest
        for (std::size_t x = 0; x < width; ++x)
            for (std::size_t c = 0; c < 3; ++c) {
                std::uint32_t bits = 0;
                std::memcpy(&bits,
                            samples.data() + y * row + (x * channels + (channels == 3 ? c : 0)) * 4,
                            4);
                *out++ = std::bit_cast<float>(
                    scale < 0 ? bits : __builtin_bswap32(bits)); // negative: little-endian
            }
}

void decodePnm(const Bytes& bytes, Destination& to) {
    NetpbmHeader header(bytes);
    const unsigned channels = bytes.at(1) == '6' ? 3 : 1;
    const std::uint64_t width = numberOf(header.word()), height = numberOf(header.word()),
                        most = numberOf(header.word());
    if (most != 255 && most != 65535) damaged("its maximum is neither 255 nor 65535");
    checkSize({width, height}, to.maxPixels);
    const std::size_t sampleBytes = most == 255 ? 1 : 2;
    const std::string_view samples = header.samples();
    if (samples.size() < width * height * channels * sampleBytes) truncated();
    if (!allocate(&to, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height),
                  sampleBytes == 1 ? 8 : 16))
        throw *to.refused;
    const Bytes from(samples);
    for (std::size_t i = 0; i < width * height * 3; ++i) {
        const std::size_t source = channels == 3 ? i : i / 3;
        if (sampleBytes == 1)
            reinterpret_cast<std::uint8_t*>(to.data.data())[i] =
                static_cast<std::uint8_t>(from.at(source));
        else
            reinterpret_cast<std::uint16_t*>(to.data.data())[i] =
                static_cast<std::uint16_t>(from.big16(2 * source));
    }
}

std::optional<PictureKind> kindOf(std::string_view bytes) {
    struct Magic {
        std::string_view start;
        PictureKind kind;
    };
    using namespace std::string_view_literals;
    static constexpr Magic kMagic[] = {{"\x89PNG\r\n\x1a\n"sv, PictureKind::png},
                                       {"\xff\xd8\xff"sv, PictureKind::jpeg},
                                       {"BM"sv, PictureKind::bmp},
                                       {"#?RADIANCE\n"sv, PictureKind::hdr},
                                       {"#?RGBE\n"sv, PictureKind::hdr},
                                       {"\x76\x2f\x31\x01"sv, PictureKind::exr},
                                       {"PF"sv, PictureKind::pfm},
                                       {"Pf"sv, PictureKind::pfm},
                                       {"P5"sv, PictureKind::pnm},
                                       {"P6"sv, PictureKind::pnm}};
    for (const Magic& magic : kMagic)
        if (bytes.starts_with(magic.start)) return magic.kind;
    return {};
}

void decodeSamples(std::string_view text, PictureKind kind, Destination& to) {
    const Bytes bytes(text);
    switch (kind) {
    case PictureKind::png:
        return decodeByModule(text, CodecModule::png, RT_CODEC_PNG, to);
    case PictureKind::exr:
        return decodeByModule(text, CodecModule::exr, RT_CODEC_EXR, to);
    case PictureKind::jpeg:
        return decodeByModule(text, CodecModule::jpeg, RT_CODEC_JPEG, to);
    case PictureKind::bmp:
        checkSize(bmpSize(bytes), to.maxPixels);
        return decodeByModule(text, CodecModule::opencv, RT_CODEC_BMP, to);
    case PictureKind::hdr:
        checkSize(hdrSize(bytes), to.maxPixels);
        return decodeByModule(text, CodecModule::opencv, RT_CODEC_HDR, to);
    case PictureKind::pfm:
        return decodePfm(bytes, to);
    case PictureKind::pnm:
        return decodePnm(bytes, to);
    }
}

Picture decode(std::string_view bytes, const ReadPictureOptions& options) {
    const auto kind = kindOf(bytes);
    if (!kind)
        throw PictureError(
            kUnknownKind,
            "this is no picture that can be read (PNG, JPEG, BMP, HDR, EXR, PFM, PGM or PPM)");
    Destination to{options.maxPixels, {}, {}, {}};
    decodeSamples(bytes, *kind, to);
    const auto encoding = to.samples.bits == 32 ? scene::Encoding::linear
                                                : options.encoding.value_or(scene::Encoding::srgb);
    Picture picture{frameOf(to.samples, encoding), *kind, encoding, to.samples.bits};
    if (!options.allowNonFinite) {
        const Framebuffer& frame = picture.frame;
        for (std::size_t i = 0; i < frame.pixels.size(); ++i)
            if (const auto& p = frame.pixels[i];
                !std::isfinite(p.r) || !std::isfinite(p.g) || !std::isfinite(p.b))
                throw PictureError(kNonFinite, "pixel " + std::to_string(i % frame.width) + "," +
                                                   std::to_string(i / frame.width) +
                                                   " is not finite");
    }
    return picture;
}

} // namespace

std::optional<Picture> decodePicture(std::string_view bytes, const ReadPictureOptions& options,
                                     scene::Diagnostics& diagnostics,
                                     const scene::Location& location) {
    try {
        return decode(bytes, options);
    } catch (const PictureError& error) {
        diagnostics.error(error.code, location, error.what());
        return {};
    }
}

std::optional<Picture> readPicture(const std::string& path, const ReadPictureOptions& options,
                                   scene::Diagnostics& diagnostics) {
    const auto source = scene::readSource(path, kMaxBytes, diagnostics);
    if (!source) return {};
    // The location must not carry the bytes: they are no text to quote.
    return decodePicture(source->text, options, diagnostics,
                         {std::make_shared<scene::Source>(scene::Source{path, {}})});
}

} // namespace rt::formats
