// Where shadow rays start on a triangle with interpolated normals.
#pragma once
#include <core/geometry/surface.hpp>

namespace rt::trace {

/// The point on the smooth surface that the facet stands for: the mean, by barycentric weights, of
/// the projections onto the corners' tangent planes [Hanika, Hacking the Shadow Terminator, Ray
/// Tracing Gems II, 2021, ch. 4]. `side` is 1 for the outside, -1 for the inside of the surface;
/// there only tangent planes above the facet count. The surface's own position elsewhere.
geometry::Vec3 smoothPosition(const geometry::Primitives& primitives,
                              const geometry::Surface& surface, const geometry::Hit& hit,
                              double side);

} // namespace rt::trace
