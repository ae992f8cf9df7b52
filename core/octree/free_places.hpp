// Places of a tree for what an update makes, and those that nothing uses any more: blocks there hold nothing that a ray
// could hit.
#pragma once
#include <core/octree/update.hpp>

namespace rt::octree {

/// Takes places that are free, and new ones where there are none.
class FreePlaces final : public Places {
public:
    FreePlaces(Tree& tree, UpdateState& state) : tree_(tree), state_(state) {}

    std::uint32_t take(Part part, std::uint32_t count = 1) override;
    void freeNode(std::uint32_t index) { state_.free[kNodes].push_back(index); }
    void freeLeaf(std::uint32_t reference);

private:
    template <class Block> void freeBlock(Array<Block>& blocks, Part part, std::uint32_t index);

    Tree& tree_;
    UpdateState& state_;
};

} // namespace rt::octree
