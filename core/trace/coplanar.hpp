// Faces of different objects in one plane: which of them is seen, everywhere the same.
#pragma once
#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>

#include <vector>

namespace rt::trace {

/// By PrimitiveId: planar primitives that lie, within the error bounds of both, on one of an object with a lower id and
/// overlap it. Empty when there are none.
std::vector<bool> primitivesThatTie(const geometry::Primitives& primitives);

/// The lowest of the planar primitives that `ray` meets together with `hit`, within the error bounds of both. Rounding
/// orders such hits at random; the scene's order does not. `hit` answers `ray`, on a primitive that ties.
geometry::Hit lowestOfTied(const octree::Octree& octree, const geometry::Primitives& primitives,
                           const geometry::Ray& ray, const geometry::Hit& hit,
                           std::vector<geometry::Crossing>& scratch, octree::Visits* visits);

} // namespace rt::trace
