// Geometric predicates whose sign is never wrong [Shewchuk 1997].
#pragma once
#include <rt/plugin.hpp>

namespace rt::loaders {

/// Sign of twice the signed area of the triangle a, b, c: +1 counter-clockwise, -1 clockwise, 0 exactly
/// collinear. Exact for coordinates between 1e-140 and 1e150 in size, and 0.
int orientation(Vector2 a, Vector2 b, Vector2 c);

/// Do the three points lie exactly on one line? Same range.
bool collinear(Vector3 a, Vector3 b, Vector3 c);

} // namespace rt::loaders
