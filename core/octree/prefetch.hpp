// Asks memory for parts of a tree before they are looked at.
#pragma once
#include <core/octree/tree.hpp>

#include <immintrin.h>

namespace rt::octree {

/// All lines of an item: two even of a small one, if it lies across their border.
template <class T> void prefetchLines(const T& item) {
    const char* const bytes = reinterpret_cast<const char*>(&item);
    for (std::size_t i = 0; i < sizeof item; i += 64) _mm_prefetch(bytes + i, _MM_HINT_T0);
    if constexpr (alignof(T) < 64 && sizeof item > alignof(T))
        _mm_prefetch(bytes + sizeof item - 1, _MM_HINT_T0);
}

inline void prefetch(const Tree& tree, std::uint32_t reference) {
    const std::uint32_t index = reference & kLeafIndex;
    if (!(reference & kLeaf)) return prefetchLines(tree.nodes[reference]);
    switch (kindOfLeaf(reference)) {
    case kSharedLeaf:
        return prefetchLines(tree.shared[index]);
    case kTriangleLeaf:
        return prefetchLines(tree.triangles[index]);
    case kNarrowSharedLeaf:
        return prefetchLines(tree.narrowShared[index]);
    case kNarrowTriangleLeaf:
        return prefetchLines(tree.narrowTriangles[index]);
    default:
        return;
    }
}

} // namespace rt::octree
