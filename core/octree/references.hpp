// What the builder starts from: every primitive's box in octree space.
#pragma once
#include <core/numeric/box.hpp>
#include <core/octree/cells.hpp>

#include <vector>

namespace rt::octree {

struct References {
    Array<Reference> bounded;
    std::uint32_t boundedCount = 0;
    std::vector<Reference> unbounded; // without finite bounds; boxes not set
    double center[3] = {0, 0, 0};     // of octree space, world units
    double scale = 1;                 // octree units per world unit, a power of two
};

/// `movable`: with room for primitives to move outward, as far again as they reach now.
References referencesOf(const geometry::Primitives& primitives, bool movable = false);

/// A box in octree space, rounded outward. False if it is not finite or leaves the space.
bool inOctreeSpace(const numeric::Box3d& box, const double center[3], double scale, float lower[3],
                   float upper[3]);

/// One of them, in a space that is there already. False if it has no finite bounds or leaves the space.
bool referenceOf(const geometry::Primitives& primitives, std::uint32_t id, const double center[3],
                 double scale, Reference& reference);

} // namespace rt::octree
