// How far one picture is from another, in linear light.
#pragma once
#include <core/image/framebuffer.hpp>

#include <cstdint>
#include <optional>
#include <vector>

namespace rt::image {

/// Pixels x0 <= x < x1, y0 <= y < y1.
struct Region {
    std::uint32_t x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

struct CompareOptions {
    std::optional<Region> crop; // within the picture; everything otherwise
    const Framebuffer* mask =
        nullptr;          // of the same size; a pixel counts where its mean is over 1/2
    double tolerance = 0; // a pixel is over it when one of its channels differs by more
};

/// Pixels where either picture has a NaN or an infinity count as over the tolerance and take no part in the rest.
/// Means run over channels, three per pixel; the reference is the second picture.
struct Difference {
    std::uint64_t pixels = 0;   // that the crop and the mask leave
    std::uint64_t nan = 0;      // pixels with a NaN in either picture
    std::uint64_t infinite = 0; // pixels with an infinity in either, and no NaN
    std::uint64_t over = 0;     // pixels over the tolerance
    double rmse = 0;
    double rmseOfRest = 0; // of the pixels not over the tolerance: a handful of flipped edges apart
    double meanAbsolute = 0;
    double meanRelativeSquare = 0; // mean of d^2 / (reference^2 + 0.01)
    double energyError = 0; // sum / reference sum - 1; infinite where only the reference is black
    double max = 0;         // largest difference of one channel, at the first such pixel by rows
    std::uint32_t maxX = 0, maxY = 0;
    double peak = 1; // or the largest value of either picture, where that is over 1

    double overShare() const { return pixels ? double(over) / double(pixels) : 0; }
    /// dB: 20 log10(peak / rmse), OpenImageIO's definition; infinite for equal pictures.
    double psnr() const;
};

/// The crop, or all. Both pictures, and the mask, must have one size, and a crop must lie within it: std::invalid_argument.
Region checkedRegion(const Framebuffer& picture, const Framebuffer& reference,
                     const CompareOptions& options);

/// Throws as checkedRegion does.
Difference difference(const Framebuffer& picture, const Framebuffer& reference,
                      const CompareOptions& options = {});

/// |picture - reference| times gain, per channel; white where either is not finite.
Framebuffer differencePicture(const Framebuffer& picture, const Framebuffer& reference,
                              double gain);

} // namespace rt::image
