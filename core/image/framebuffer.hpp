// The linear picture that tracing fills and formats encode. Row 0 is the top.
#pragma once
#include <core/image/huge_pages.hpp>
#include <core/numeric/colour.hpp>

#include <cstdint>
#include <vector>

namespace rt::image {

using numeric::LinearRgb;

struct Framebuffer {
    std::uint32_t width = 0, height = 0;
    std::vector<LinearRgb, HugePages<LinearRgb>> pixels; // width * height, row by row

    Framebuffer() = default;
    Framebuffer(std::uint32_t w, std::uint32_t h)
        : width(w), height(h), pixels(std::size_t(w) * h, LinearRgb{}) {}
    /// Precondition: whoever asked for it writes every pixel before any is read.
    static Framebuffer unwritten(std::uint32_t w, std::uint32_t h) {
        Framebuffer frame;
        frame.width = w, frame.height = h;
        frame.pixels.resize(std::size_t(w) * h);
        return frame;
    }
    LinearRgb& at(std::uint32_t x, std::uint32_t y) { return pixels[std::size_t(y) * width + x]; }
    const LinearRgb& at(std::uint32_t x, std::uint32_t y) const {
        return pixels[std::size_t(y) * width + x];
    }
};

} // namespace rt::image
