// Structural similarity of pictures as they are shown: on 8-bit sRGB values. [Wang, Bovik, Sheikh, Simoncelli 2004]
#pragma once
#include <core/image/metrics.hpp>

namespace rt::image {

/// Mean over R, G, B of the mean over 8x8 windows at every fourth pixel, equal weights, sample (n - 1) variances,
/// C2 = (0.03 * 255)^2 and, as x264 and ffmpeg have it, C1 = (0.01 * 255)^2 / 64: what ffmpeg's ssim filter prints for two
/// 8-bit RGB pictures. A window counts where the mask holds all of it. Nothing for a region without a window. Throws as
/// checkedRegion does.
std::optional<double> ssimBlocks(const Framebuffer& picture, const Framebuffer& reference,
                                 const CompareOptions& options = {});

/// The paper's own: luma (Rec. 601 weights, as in its reference program), 11x11 Gaussian windows of sigma 1.5 that lie
/// wholly inside, K1 = 0.01, K2 = 0.03. Nothing for pictures under 11x11.
std::optional<double> ssimGaussian(const Framebuffer& picture, const Framebuffer& reference);

} // namespace rt::image
