// A tree after some of its primitives have moved: only what is around them changes.
//
// 1. Every leaf that holds a moved primitive is written anew. A primitive that would make its leaf much
//    larger leaves it; primitives of a leaf, and leaves of a node, that all moved stay together, so a
//    rigid object keeps its subtree, and leaves its node with all below when it has gone elsewhere.
//    Empty leaves go, nodes with one child become that child.
// 2. What left enters again where it costs least: into a leaf, an empty slot, or a new node above a
//    child [Goldsmith, Salmon 1987], looked for on the way down to the leaf that grows least.
// 3. Going down from the root, subtrees whose cost has drifted from what they had when they were built
//    are built anew by Cells, the smallest that explain the drift.
//
// Answers do not depend on the tree; cost does: see octree_bench --moves and tests/octree/update_test.cpp.
#pragma once
#include <core/octree/octree.hpp>
#include <core/octree/tree.hpp>

#include <span>

namespace rt::octree {

/// What stays between two updates of a tree.
struct UpdateState {
    std::array<std::vector<std::uint32_t>, kParts> free; // places that nothing uses
    std::uint64_t garbage = 0;                           // bytes that cannot be used again
    std::uint64_t singles = 0;   // primitives that left their place since the whole was built
    std::uint32_t nodesThen = 0; // of the whole when built
};

/// False: the tree has to be built anew; it is in no state to be used.
bool update(Tree& tree, UpdateState& state, const double center[3], double scale,
            const geometry::Primitives& primitives, const BuildOptions& options,
            std::span<const geometry::PrimitiveId> moved, UpdateReport& report);

} // namespace rt::octree
