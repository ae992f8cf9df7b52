// Where a primitive or subtree that has left its place enters at the least cost: into a leaf, an empty slot, or a new node
// above a child [Goldsmith, Salmon 1987], looked for on the way down to the leaf that grows least.
#pragma once
#include <core/octree/box.hpp>
#include <core/octree/cells.hpp>
#include <core/octree/leaf_edit.hpp>
#include <core/octree/tree.hpp>

#include <limits>

namespace rt::octree {

/// A primitive or a subtree that has left its place.
struct Item {
    Box box;
    std::uint32_t child; // its reference; kEmptyChild for a primitive
    Reference primitive;
    LooseTriangle triangle; // if it is one
};

/// Where an item may go, and what the tree's cost grows by.
struct Place {
    enum Kind : std::uint8_t { join, slot, pair } kind = slot;
    std::uint32_t node = 0;
    int at = 0;
    float cost = std::numeric_limits<float>::infinity();

    void offer(Kind k, std::uint32_t n, int s, float c) {
        if (!(c <= cost)) return;
        kind = k;
        node = n;
        at = s;
        cost = c;
    }
};

/// Looks for an item's place in steps, which ask memory for what the next one will read. The tree may not change
/// between them.
class Search {
public:
    explicit Search(const Item& item)
        : item_(&item), isSingle_(item.child == kEmptyChild),
          // A subtree costs the same wherever it hangs.
          own_(isSingle_ ? kBlockCost * item.box.area() : 0) {}

    /// One node further down; false: found. `maxObjects`: of a leaf that the item may join.
    bool step(const Tree& tree, std::uint32_t maxObjects);
    const Place& found() const { return best_; }

private:
    const Item* item_;
    bool isSingle_;
    float own_, inherited_ = 0, leafCost_ = 0; // inherited: what the nodes on the way grow by
    std::uint32_t next_ = 0, node_ = 0, leaf_ = kEmptyChild; // leaf: of node_, that it may join
    std::uint32_t leafSize_ = 0;
    int leafSlot_ = 0;
    Place best_;
};

/// The octant of `a` in a cell that it shares with `b`; b's is the opposite one.
int slotFor(const Box& a, const Box& b);

/// The free slot that is nearest to the octant of a box; there must be one.
int freeSlotFor(const Node& node, const Box& box);

/// A node's children if something joined them.
struct Joined {
    alignas(16) float area[kLanes], growth[kLanes];
    unsigned empty, leaves, nodes; // bit per slot

    Joined(const Node& node, const Box& box);
};

/// The first of the slots where the value is least; -1 if there are none.
int leastOf(const float (&value)[kLanes], unsigned slots);

} // namespace rt::octree
