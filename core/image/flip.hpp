// The perceptual error that an observer sees who flips between two pictures.
#pragma once
#include <core/image/framebuffer.hpp>

namespace rt::image {

/// Pixels per degree of visual angle: a 3840 pixels wide display of 0.7 m, seen from 0.7 m.
inline constexpr double kFlipPixelsPerDegree = 67.02064327658225;

/// Mean of the error map, in [0, 1], of the pictures as they are shown: on 8-bit sRGB values. [Andersson, Nilsson,
/// Akenine-Möller, Oskarsson, Åström, Fairchild, FLIP: A Difference Evaluator for Alternating Images, PACMCGIT 3(2),
/// 2020] Different sizes: std::invalid_argument.
double meanFlip(const Framebuffer& picture, const Framebuffer& reference,
                double pixelsPerDegree = kFlipPixelsPerDegree);

} // namespace rt::image
