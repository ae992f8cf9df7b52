// A picture to bytes by file suffix, and bytes to a file that is either the old one or the complete new one.
#pragma once
#include <core/image/framebuffer.hpp>
#include <core/scene/description.hpp>

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

/// PFM is written by this program; the others by the codec module, which this opens on a thread of its own.
/// Call before tracing starts; throws std::runtime_error from get() when the module cannot be opened.
std::shared_future<void> openCodec(ImageFormat format);

struct Encoding {
    scene::Encoding transfer = scene::Encoding::srgb; // ignored by EXR and PFM, which are linear f32
    std::uint32_t bits = 8;                           // PNG: 8 or 16
    int quality = 95;                                 // JPEG
};

/// Encoded in memory. Throws std::runtime_error.
std::vector<std::byte> encodeImage(const image::Framebuffer& frame, ImageFormat format, const Encoding& encoding);

/// Temporary name beside `path`, write, fsync, rename, fsync of the folder. Throws std::system_error and leaves the
/// old file untouched.
void writeFileAtomically(const std::string& path, const std::vector<std::byte>& bytes);

} // namespace rt::formats
