// Nodes, blocks and leaf records from cells.
#pragma once
#include <core/octree/cells.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/tree.hpp>

#include <vector>

namespace rt::octree {

/// The same bytes for any number of threads. `unbounded`: primitives that are in no cell. `movable`: with
/// Tree::leafOf.
Tree emit(const Cells& cells, const std::vector<Reference>& unbounded,
          const geometry::Primitives& primitives, const LeafFormat& format = {},
          bool movable = false);

/// The reference to a subtree made of `cells`, for `slot` of node `parent`, which it is not yet put into.
/// Large ones are appended to the tree, by several threads; others take what `places` has.
std::uint32_t emitSubtree(const Cells& cells, const geometry::Primitives& primitives,
                          const LeafFormat& format, std::uint32_t parent, std::uint32_t slot,
                          Tree& tree, Places& places);

} // namespace rt::octree
