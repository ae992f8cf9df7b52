// Picture files back to linear light: what `rt compare` reads.
#pragma once
#include <core/image/framebuffer.hpp>
#include <core/scene/description.hpp>
#include <core/scene/diagnostic.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rt::formats {

/// By the first bytes of the file, never by its name. PNM: binary grey (P5) or colour (P6).
enum class PictureKind : std::uint8_t { png, jpeg, bmp, hdr, exr, pfm, pnm };

struct Picture {
    image::Framebuffer frame; // linear light; grey fills all channels, alpha is dropped
    PictureKind kind{};
    scene::Encoding encoding{}; // that the samples were decoded from
    std::uint32_t bits = 8;     // per channel: 8 or 16, or 32 for f32 (HDR, EXR, PFM)
};

struct ReadPictureOptions {
    /// How 8- and 16-bit samples are decoded; as sRGB unless this says otherwise. f32 is always linear.
    std::optional<scene::Encoding> encoding;
    std::uint64_t maxPixels = std::uint64_t(1)
                              << 26; // held against the header, before a pixel is decoded
    bool allowNonFinite = true;      // NaN and infinities among f32 samples
};

/// Regular files of at most 2 GiB only. Nothing after an error: what readSource says of the file, E0450 no kind that is read,
/// E0451 truncated or damaged, E0452 a NaN or infinity where none is allowed, E0713 more pixels than the limit.
std::optional<Picture> readPicture(const std::string& path, const ReadPictureOptions& options,
                                   scene::Diagnostics& diagnostics);

/// The same for a file's bytes; its errors stand at `location`.
std::optional<Picture> decodePicture(std::string_view bytes, const ReadPictureOptions& options,
                                     scene::Diagnostics& diagnostics,
                                     const scene::Location& location);

} // namespace rt::formats
