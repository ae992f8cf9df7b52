#include <core/octree/free_places.hpp>

#include <cstring>

namespace rt::octree {

std::uint32_t FreePlaces::take(Part part, std::uint32_t count) {
    auto& free = state_.free[part];
    if (count == 1 && !free.empty()) {
        const std::uint32_t place = free.back();
        free.pop_back();
        return place;
    }
    Extent extent = tree_.extent();
    const std::uint32_t first = extent.take(part, count);
    if (count) tree_.resize(extent);
    return first;
}

template <class Block>
void FreePlaces::freeBlock(Array<Block>& blocks, Part part, std::uint32_t index) {
    std::memset(static_cast<void*>(&blocks[index]), 0xFF, sizeof(Block)); // NaN, and no ids
    state_.free[part].push_back(index);
}

void FreePlaces::freeLeaf(std::uint32_t reference) {
    const std::uint32_t index = reference & kLeafIndex;
    switch (kindOfLeaf(reference)) {
    case kSharedLeaf:
        tree_.shared[index].valid = 0;
        return state_.free[kShared].push_back(index);
    case kNarrowSharedLeaf:
        tree_.narrowShared[index].valid = 0;
        return state_.free[kNarrowShared].push_back(index);
    case kTriangleLeaf:
        return freeBlock(tree_.triangles, kTriangles, index);
    case kNarrowTriangleLeaf:
        return freeBlock(tree_.narrowTriangles, kNarrowTriangles, index);
    case kSphereLeaf:
        return freeBlock(tree_.spheres, kSpheres, index);
    case kParallelogramLeaf:
        return freeBlock(tree_.parallelograms, kParallelograms, index);
    default: {
        const LeafRecord leaf = tree_.records[index];
        for (std::uint32_t i = 0; i < leaf.triangleBlocks; ++i)
            freeBlock(tree_.triangles, kTriangles, leaf.triangles + i);
        for (std::uint32_t i = 0; i < leaf.sphereBlocks; ++i)
            freeBlock(tree_.spheres, kSpheres, leaf.spheres + i);
        for (std::uint32_t i = 0; i < leaf.parallelogramBlocks; ++i)
            freeBlock(tree_.parallelograms, kParallelograms, leaf.parallelograms + i);
        for (std::uint32_t i = 0; i < leaf.runCount; ++i) {
            auto& count = tree_.runs[leaf.runs + i].count;
            state_.garbage += sizeof(CustomRun) + 8 * std::uint64_t{count};
            count = 0;
        }
        state_.free[kRecords].push_back(index);
    }
    }
}

} // namespace rt::octree
