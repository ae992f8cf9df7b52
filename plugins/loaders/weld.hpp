// Vertices that lie at exactly the same position.
#pragma once
#include <rt/plugin.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace rt::loaders {

/// Per position the index of the first that equals it; -0 equals 0. Positions are finite.
std::vector<std::uint32_t> weldEqual(std::span<const Vector3> positions);

} // namespace rt::loaders
