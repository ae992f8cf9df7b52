// Rays and hits in world space. Nothing here normalises: t means the same in every space.
#pragma once
#include <core/geometry/primitives.hpp>

namespace rt::geometry {

struct Ray {
    Vec3 origin;
    double tMax = numeric::kInfinity;   // hits lie in (0, tMax)
    Vec3 direction;                     // any length but 0
    PrimitiveId exclude = kNoPrimitive; // the planar primitive the ray starts on
};

/// What the octree answers. The exact surface point comes from `surfaceAt`.
struct Hit {
    double t = numeric::kInfinity;
    double
        u = 0,
        v = 0; // triangle: weights of corners 1 and 2; parallelogram: along edgeU, edgeV; sphere: 0
    PrimitiveId id = kNoPrimitive;

    explicit operator bool() const { return id != kNoPrimitive; }
};

/// One passage of a ray through a surface, for coloured shadows and media.
struct Crossing {
    double t;
    PrimitiveId id;
};

} // namespace rt::geometry
