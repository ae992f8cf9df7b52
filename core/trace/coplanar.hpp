// Faces of different objects in one plane: which of them is seen, everywhere the same.
#pragma once
#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>

#include <vector>

namespace rt::trace {

/// Planar primitives of different objects that lie, within the error bounds of both, on one another and overlap.
struct Ties {
    // By PrimitiveId; empty when there are none.
    std::vector<bool> isHigher;     // it lies on one of an object with a lower id
    std::vector<float> errorBeside; // bound on the error of what it lies on; 0: alone

    bool none() const { return isHigher.empty(); }
    /// A small face may lie on a large one, whose bound is the larger.
    double errorBesideOf(geometry::PrimitiveId id) const {
        return none() ? 0 : static_cast<double>(errorBeside[static_cast<std::uint32_t>(id)]);
    }
};

Ties tiesOf(const geometry::Primitives& primitives);

/// The lowest of the planar primitives that `ray` meets together with `hit`, within the error bounds of both. Rounding
/// orders such hits at random; the scene's order does not. `hit` answers `ray`, on a primitive that ties.
geometry::Hit lowestOfTied(const octree::Octree& octree, const geometry::Primitives& primitives,
                           const Ties& ties, const geometry::Ray& ray, const geometry::Hit& hit,
                           std::vector<geometry::Crossing>& scratch, octree::Visits* visits);

} // namespace rt::trace
