// A picture to bytes, by the suffix of its file. (Bytes to a file: atomic_file.hpp.)
#pragma once
#include <core/image/framebuffer.hpp>
#include <core/scene/description.hpp>
#include <formats/atomic_file.hpp>

#include <cstddef>
#include <future>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace rt::formats {

enum class ImageFormat : std::uint8_t { png, jpeg, bmp, exr, pfm };

/// By the lower-cased suffix of `path`; nothing for any other.
std::optional<ImageFormat> imageFormatOf(std::string_view path);

/// PFM is written by this program; the others by codec modules (PNG: libpng, JPEG: libjpeg, EXR: OpenEXR, BMP: OpenCV), which
/// this opens on a thread of their own. Call before tracing starts; get() throws std::runtime_error when the module
/// cannot be opened.
std::shared_future<void> openCodec(ImageFormat format);

struct Encoding {
    scene::Encoding transfer =
        scene::Encoding::srgb; // ignored by EXR and PFM, which are linear f32
    std::uint32_t bits = 8;    // PNG: 8 or 16; ignored by the others
    int quality = 95;          // JPEG: 1 to 100
};

/// Encoded in memory; the same bytes on every machine with the same libraries. Integers as core/image/quantize.hpp
/// rounds them (NaN is 0); f32 to nearest, NaN and infinities as they are. A PNG in sRGB says so in a chunk; a linear
/// one is left untagged, so that viewers show its numbers as the original program's were. Throws std::runtime_error.
std::vector<std::byte> encodeImage(const image::Framebuffer& frame, ImageFormat format,
                                   const Encoding& encoding);

} // namespace rt::formats
