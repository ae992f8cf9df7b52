// Linear light to the integers of a file and back. Values outside [0, 1] go to the nearer end, NaN goes to 0.
#pragma once
#include <core/image/framebuffer.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace rt::image {

/// round(255 c), halves to even.
std::uint8_t linear8(double linear);
/// round(65535 c), halves to even.
std::uint16_t linear16(double linear);

/// The code whose sRGB-encoded value k / 255 is nearest: k such that c lies between linearFromSrgb((k - 1/2) / 255) and
/// linearFromSrgb((k + 1/2) / 255); on such a limit itself the even k. Never decreases with c.
std::uint8_t srgb8(double linear);
/// srgb8 and linear8 of each; codes has room for as many.
void toSrgb8(std::span<const double> linear, std::uint8_t* codes);
void toLinear8(std::span<const double> linear, std::uint8_t* codes);
/// Every channel of a picture through one of these, row by row from the top, R G B.
std::vector<std::uint8_t> codesOf(const Framebuffer& frame,
                                  void (*encode)(std::span<const double>, std::uint8_t*));
/// round(65535 srgbFromLinear(c)), halves to even.
std::uint16_t srgb16(double linear);

/// linearFromSrgb(code / 255).
double linearFromSrgb8(std::uint8_t code);

} // namespace rt::image
