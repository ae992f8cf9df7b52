// Surfaces that lie on one another: which of them a ray that passes the first meets at the same point.
#pragma once
#include <core/geometry/surface.hpp>
#include <core/trace/stage.hpp>

#include <optional>
#include <vector>

namespace rt::trace {

/// What a ray crosses together with the surface it hit, within the error bounds of both.
struct Coincident {
    double indexRatio = 1;     // product over the solids: index in front over index behind
    LinearRgb filter{1, 1, 1}; // product of color * transmission
    double error = 0;          // largest error bound among them
    std::optional<geometry::Surface> opaque; // the opaque surface where the passage ends
    geometry::Hit opaqueHit;
    std::vector<geometry::ObjectId> entered, left;             // objects, by rising id
    std::vector<geometry::ObjectId> enteredSolids, leftSolids; // those with an inside
};

/// Everything but the hit's own object. `hit` and `surface` answer `ray`; the surface's error includes that of what it lies on.
void findCoincident(const Stage& stage, const geometry::Ray& ray, const geometry::Hit& hit,
                    const geometry::Surface& surface, std::vector<geometry::Crossing>& scratch,
                    Coincident& found, octree::Visits* visits);

/// `ray` against one primitive.
geometry::Hit hitOn(const geometry::Primitives& primitives, const geometry::Ray& ray,
                    geometry::PrimitiveId id);

/// color of a material where it is textured.
LinearRgb colorAt(const world::World& world, const material::Material& material,
                  const geometry::Surface& surface);

} // namespace rt::trace
