// Uniform sampling: n x n samples in every pixel.
#pragma once
#include <core/image/framebuffer.hpp>
#include <core/trace/sampler.hpp>
#include <core/trace/tiles.hpp>

namespace rt::trace {

/// Each pixel of `region` becomes the mean of n x n samples, which are the pixels of the picture at
/// n times the size. False when stopped; pixels not reached are black.
bool sampleGrid(const View& view, Sampler sampler, std::uint32_t n, scene::Sampling sampling,
                const Region& region, const Options& options, image::Framebuffer& frame,
                RayCounts& counts);

} // namespace rt::trace
