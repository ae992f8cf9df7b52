// Which solids a point lies in.
#pragma once
#include <core/trace/stage.hpp>

#include <vector>

namespace rt::trace {

/// The transmissive solids around `point`, by rising id. For each, the first of its surfaces on one
/// ray from the point says: leaving, the point is inside; entering, outside. Crossings are never
/// counted, so that edges and corners cannot be counted twice.
std::vector<geometry::ObjectId> mediaAt(const Stage& stage, const Vec3& point);

} // namespace rt::trace
