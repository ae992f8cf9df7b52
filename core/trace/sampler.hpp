// Samples of the picture: what is seen through one point of it.
#pragma once
#include <core/trace/camera.hpp>
#include <core/trace/render.hpp>
#include <core/trace/whitted.hpp>

#include <span>

namespace rt::trace {

/// What a sampler reads; shared by all threads.
struct View {
    const Stage& stage;
    Camera camera;
    scene::Tone tone;
    LinearRgb notFinite; // drawn for samples that are no finite number
};

/// colors[i] is what is seen through points[i], after tone. A pure function of the view and the point.
using Sampler = void (*)(const View& view, std::span<const PicturePoint> points, LinearRgb* colors,
                         Scratch& scratch, RayCounts& counts);

/// The kernel that is compiled for what the stage has and the options want.
Sampler samplerFor(const Stage& stage, const Options& options);

} // namespace rt::trace
