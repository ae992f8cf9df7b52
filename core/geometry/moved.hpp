// Which primitives differ between two poses of the same scene.
#pragma once
#include <core/geometry/primitives.hpp>

#include <optional>

namespace rt::geometry {

/// By rising id, those whose geometry differs in any bit; corners are compared by value, wherever they
/// stand in the array. Nothing when the segments differ.
std::optional<std::vector<PrimitiveId>> movedBetween(const Primitives& before,
                                                     const Primitives& after);

} // namespace rt::geometry
