// A tree after some of its primitives have moved: only what is around them changes.
//
// 1. Leaves that hold a moved primitive are edited in place. A primitive that would make its leaf much larger
//    leaves it; primitives of a leaf, and leaves of a node, that all moved stay together, so a rigid object
//    keeps its subtree, and leaves its node with all below when it has gone elsewhere. Empty leaves go, a
//    leaf that has lost some takes in another, nodes whose children their parent has room for go.
// 2. What left enters again where it costs least: into a leaf, an empty slot, or a new node above a
//    child: entrance.hpp.
// 3. Going down from the root, subtrees whose cost has drifted by itself are built anew: upkeep.hpp. Where primitives
//    move alone, the tree wears out everywhere: some subtrees of a few thousand are built anew in each
//    update, those first that have drifted most. What that gains in cost and nodes says how good the tree
//    still is, and so how many more are due, or the whole.
//
// Answers do not depend on the tree; cost does: see octree_bench --moves and A3 of tests/stability.
#pragma once
#include <core/octree/octree.hpp>
#include <core/octree/tree.hpp>

#include <span>

namespace rt::octree {

/// What stays between two updates of a tree.
struct UpdateState {
    std::array<std::vector<std::uint32_t>, kParts> free; // places that nothing uses
    std::uint64_t garbage = 0;                           // bytes that cannot be used again
    std::uint64_t singles =
        0; // primitives that moved without their neighbours, since the whole was built
    std::uint32_t nodesThen = 0; // of the whole when built
    float costBefore = 0, costAfter = 0, nodesBefore = 0,
          nodesAfter = 0; // of parts built anew lately
};

/// False: the tree has to be built anew; it is in no state to be used.
bool update(Tree& tree, UpdateState& state, const double center[3], double scale,
            const geometry::Primitives& primitives, const BuildOptions& options,
            std::span<const geometry::PrimitiveId> moved, UpdateReport& report);

} // namespace rt::octree
