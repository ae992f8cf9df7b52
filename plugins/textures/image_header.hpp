// What the first bytes of an image file say: format and size, before a decoder sees it.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

struct ImageHeader {
    const char* format;
    std::uint64_t width, height;
};

/// The header of a PNG, JPEG, BMP, Radiance HDR, OpenEXR, PFM, PGM or PPM file, or why it has none: a clause such as
/// "is not a PNG, …". A JPEG is walked to its end: decoders fill what is missing with grey and say nothing.
std::variant<ImageHeader, std::string> readImageHeader(std::string_view file);
