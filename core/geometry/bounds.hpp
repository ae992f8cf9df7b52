// How far primitives reach. Rounded to nearest: for reports and distances; the octree rounds outward for itself.
#pragma once
#include <core/geometry/primitives.hpp>

namespace rt::geometry {

Box3d boundsOf(const Primitives& primitives, const Segment& segment);
Box3d boundsOf(const Primitives& primitives);

} // namespace rt::geometry
