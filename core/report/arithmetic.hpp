// The tracer once more, in other arithmetic: what the speed of f64 and its error bounds costs, and what they buy.
#pragma once
#include <core/image/framebuffer.hpp>
#include <core/scene/description.hpp>
#include <core/world/world.hpp>

#include <cstdint>

namespace rt::report {

/// What panel A calls scalar. naive: Möller and Trumbore's triangles, the textbook's quadratic, hits nearer than 1/1000 ignored, as in the
/// original program. robust: the product's methods. All share one scalar tracer and one tree of boxes; reference is
/// robust in binary128.
enum class Arithmetic : std::uint8_t { f32Naive, f32Robust, f64Naive, f64Robust, f128Reference };

/// "f32-naive", ...
const char* nameOf(Arithmetic arithmetic);

struct Rendered {
    image::Framebuffer frame;
    std::uint64_t rays = 0; // of all kinds
};

/// Are all primitives such that this tracer knows them? Those of plugins that answer rays themselves are not.
bool isBuiltIn(const world::World& world);

/// One sample in each pixel; depth, sampling, tone and bounds as the scene says. Precondition: isBuiltIn(world).
Rendered renderIn(Arithmetic arithmetic, const world::World& world,
                  const scene::Description& description, int threads);

} // namespace rt::report
