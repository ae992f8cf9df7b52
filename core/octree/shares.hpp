// What parts of a tree that is updated cost, and would cost if they were new.
#pragma once
#include <core/octree/box.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/tree.hpp>

#include <algorithm>

namespace rt::octree {

/// What a part of the tree adds to the numbers of a node above it.
struct Share {
    float cost = 0;
    std::uint32_t count = 0;

    Share& operator+=(const Share& s) {
        cost += s.cost;
        count += s.count;
        return *this;
    }
    Share& operator-=(const Share& s) {
        cost -= s.cost;
        count -= s.count;
        return *this;
    }
};

inline Share shareOf(const Tree& tree, std::uint32_t reference, const Box& box) {
    if (reference == kEmptyChild) return {};
    if (reference & kLeaf)
        return {costOfLeaf(tree, reference) * box.area(), sizeOfLeaf(tree, reference)};
    const Node::Links& links = tree.nodes[reference].links;
    return {links.cost, links.count};
}

/// Of a node's child, without a look at its block where the node knows enough.
inline Share shareOf(const Tree& tree, const Node& node, int slot) {
    const std::uint32_t child = node.child[slot];
    const Box box = boxOf(node, slot);
    if (child == kEmptyChild || !(child & kLeaf) || kindOfLeaf(child) == kMixedLeaf)
        return shareOf(tree, child, box);
    return {kBlockCost * box.area(), node.links.leafSize[slot]};
}

inline std::uint32_t heightOf(const Tree& tree, std::uint32_t reference) {
    return reference & kLeaf ? 0 : tree.nodes[reference].links.height;
}

/// Of a node that got something below it. Levels that it loses are not noticed.
inline void raise(Node::Links& links, std::uint32_t height) {
    links.height = static_cast<std::uint16_t>(std::max<std::uint32_t>(links.height, height));
}

/// What the subtree would cost if it were new, as far as we know.
inline float freshCost(const Tree& tree, std::uint32_t index) {
    const Node::Links& links = tree.nodes[index].links;
    return links.costThen * static_cast<float>(links.count) /
           static_cast<float>(std::max(1u, links.countThen));
}

inline float excessOf(const Tree& tree, std::uint32_t index) {
    return tree.nodes[index].links.cost - freshCost(tree, index);
}

} // namespace rt::octree
