// What the builder starts from: every primitive's box in octree space.
#pragma once
#include <core/octree/cells.hpp>

#include <memory>
#include <vector>

namespace rt::octree {

struct References {
    std::unique_ptr<Reference[]> bounded;
    std::uint32_t boundedCount = 0;
    std::vector<Reference> unbounded; // without finite bounds; boxes not set
    double center[3] = {0, 0, 0};     // of octree space, world units
    double scale = 1;                 // octree units per world unit, a power of two
};

References referencesOf(const geometry::Primitives& primitives);

} // namespace rt::octree
