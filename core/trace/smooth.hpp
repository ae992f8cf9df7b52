// The smoothing filter of the scene language's `smooth: true`.
#pragma once
#include <core/image/framebuffer.hpp>

namespace rt::trace {

/// Every pixel becomes the mean of itself and its neighbours right, below, and below right; in the
/// last column of itself and below, in the last row of itself and right; the last pixel stays.
/// All reads are from the unsmoothed picture.
void smooth(image::Framebuffer& frame);

} // namespace rt::trace
