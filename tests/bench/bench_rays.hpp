// The four classes of rays, the same for every structure that is measured.
#pragma once
#include "bench_meshes.hpp"

#include <core/octree/octree.hpp>

#include <vector>

namespace rt::bench {

enum RayClass { kPrimary, kShadow, kMirror, kRandom, kClasses };
inline constexpr const char* kClassNames[kClasses] = {"primary", "shadow", "mirror", "random"};

/// Every third 16x16 tile of a 1024x1024 pinhole picture in blocks of 4x4, their shadow rays to one
/// light, their mirrored rays, and 300 000 uniform random rays in the box. Components are values that
/// f32 can hold. Each class is a multiple of 16 long.
struct Rays {
    std::vector<geometry::Ray> of[kClasses];
};

Rays makeRays(const octree::Octree& tree, const geometry::Primitives& primitives, const Vec3& eye,
              const Vec3& target, const Vec3& light, double fieldOfView);

} // namespace rt::bench
