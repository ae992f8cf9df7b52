// Shadow rays of a batch, put in an order in which sixteen at once gain.
#pragma once
#include <core/octree/kernel.hpp>

#include <cstdint>
#include <span>

namespace rt::octree {

/// Kernel::occludedBatch of coherent rays, those that start close together next to each other. Where primitives are strewn
/// about, neighbouring pixels see some that are far apart.
void occludedByOrigin(const Kernel& kernel, const TreeView& tree,
                      std::span<const geometry::Ray> rays, std::span<std::uint8_t> answers,
                      Visits* visits);

} // namespace rt::octree
