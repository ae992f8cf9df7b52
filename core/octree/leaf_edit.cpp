#include <core/octree/leaf_edit.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <type_traits>

namespace rt::octree {
namespace {

using geometry::Vec3;

template <class Block>
constexpr bool kShares =
    std::is_same_v<Block, SharedBlock> || std::is_same_v<Block, NarrowSharedBlock>;

/// Calls visit(block, ids) with the block of a leaf and the ids of its triangles.
template <class AnyTree, class Visit>
auto onBlock(AnyTree& tree, std::uint32_t leaf, const Visit& visit) {
    const std::uint32_t index = leaf & kLeafIndex;
    switch (kindOfLeaf(leaf)) {
    case kSharedLeaf:
        return visit(tree.shared[index], tree.shared[index].id);
    case kNarrowSharedLeaf:
        return visit(tree.narrowShared[index],
                     tree.narrowIds.data() + tree.narrowShared[index].ids);
    case kNarrowTriangleLeaf:
        return visit(tree.narrowTriangles[index], tree.narrowTriangles[index].id);
    default:
        return visit(tree.triangles[index], tree.triangles[index].id);
    }
}

template <class Block> int countOf(const Block& block) {
    if constexpr (kShares<Block>) {
        return __builtin_popcount(block.valid);
    } else {
        int count = 0;
        while (count < kLanes && block.id[count] != kEmptyChild) ++count;
        return count;
    }
}

/// Calls visit(row) with each row of what a triangle's lane holds, but for its id.
template <class Block, class Visit> void overRows(Block& block, const Visit& visit) {
    if constexpr (kShares<Block>) {
        for (auto& row : block.index) visit(row);
    } else {
        for (auto& corner : block.corner)
            for (auto& row : corner) visit(row);
    }
}

template <class Block> void setCount(Block& block, std::uint32_t* id, int count, int before) {
    if constexpr (kShares<Block>) block.valid = (1u << count) - 1;
    overRows(block, [&](auto& row) {
        using Value = std::remove_reference_t<decltype(row[0])>;
        for (int lane = count; lane < before; ++lane)
            row[lane] = kShares<Block> ? Value{} : std::numeric_limits<Value>::quiet_NaN();
    });
    for (int lane = count; lane < before; ++lane) id[lane] = kEmptyChild;
}

template <class Block> Vec3 cornerOf(const Block& block, std::size_t c, int lane) {
    if constexpr (kShares<Block>) {
        const std::uint8_t at = block.index[c][lane];
        return {block.corner[0][at], block.corner[1][at], block.corner[2][at]};
    } else {
        return {block.corner[c][0][lane], block.corner[c][1][lane], block.corner[c][2][lane]};
    }
}

/// Shifts lanes so that the triangle's is free, by rising id; returns it.
template <class Block>
int openLane(Block& block, std::uint32_t* id, int count, std::uint32_t newId) {
    const int at = static_cast<int>(std::upper_bound(id, id + count, newId) - id);
    const auto shift = [&](auto* row) {
        std::copy_backward(row + at, row + count, row + count + 1);
    };
    overRows(block, shift);
    shift(id);
    id[at] = newId;
    return at;
}

/// Where in a shared block the corners of another triangle are, or have room. False: they do not fit.
template <class Block>
bool placesOfCorners(const Block& block, const Vec3 (&corner)[3], std::uint8_t (&at)[3]) {
    const auto bits = [](double d) { return std::bit_cast<std::uint64_t>(d); };
    const int count = countOf(block);
    if (count == kSharedLanes) return false;
    unsigned used = 0;
    for (const auto& row : block.index)
        for (int lane = 0; lane < count; ++lane) used |= 1u << row[lane];
    unsigned unused = ~used & ((1u << kSharedLanes) - 1);
    for (std::size_t c = 0; c < 3; ++c) {
        unsigned equal = 0;
        for (int i = 0; i < kSharedLanes; ++i) {
            const bool same = bits(block.corner[0][i]) == bits(corner[c].x) &&
                              bits(block.corner[1][i]) == bits(corner[c].y) &&
                              bits(block.corner[2][i]) == bits(corner[c].z);
            equal |= static_cast<unsigned>(same) << i;
        }
        const unsigned known = equal & used;
        if (!known && !unused) return false;
        at[c] = static_cast<std::uint8_t>(__builtin_ctz(known ? known : unused));
        unused &= ~(1u << at[c]);
    }
    return true;
}

void put(SharedBlock& block, const LooseTriangle& triangle, const std::uint8_t (&at)[3]) {
    const int count = countOf(block);
    const int lane = openLane(block, block.id, count, triangle.id);
    block.valid = (1u << (count + 1)) - 1;
    for (std::size_t c = 0; c < 3; ++c) {
        block.index[c][lane] = at[c];
        for (int a = 0; a < 3; ++a) block.corner[a][at[c]] = triangle.corner[c][a];
    }
}

void put(TriangleBlock& block, const LooseTriangle& triangle) {
    const int lane = openLane(block, block.id, countOf(block), triangle.id);
    for (std::size_t c = 0; c < 3; ++c)
        for (int a = 0; a < 3; ++a) block.corner[c][a][lane] = triangle.corner[c][a];
}

SharedBlock widened(const NarrowSharedBlock& narrow, const std::uint32_t* id) {
    SharedBlock block{};
    for (int a = 0; a < 3; ++a)
        std::copy(std::begin(narrow.corner[a]), std::end(narrow.corner[a]), block.corner[a]);
    std::copy(&narrow.index[0][0], &narrow.index[0][0] + sizeof narrow.index, &block.index[0][0]);
    std::fill(std::begin(block.id), std::end(block.id), kEmptyChild);
    std::copy_n(id, countOf(narrow), block.id);
    block.valid = narrow.valid;
    return block;
}

template <class Block> TriangleBlock spread(const Block& from, const std::uint32_t* id) {
    TriangleBlock block{};
    const int count = countOf(from);
    for (int lane = 0; lane < kLanes; ++lane) {
        block.id[lane] = lane < count ? id[lane] : kEmptyChild;
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 p = lane < count ? cornerOf(from, c, lane)
                                        : Vec3(std::numeric_limits<double>::quiet_NaN());
            for (int a = 0; a < 3; ++a) block.corner[c][a][lane] = p[a];
        }
    }
    return block;
}

} // namespace

bool isTriangles(std::uint32_t leaf) {
    const LeafKind kind = kindOfLeaf(leaf);
    return kind == kSharedLeaf || kind == kNarrowSharedLeaf || kind == kTriangleLeaf ||
           kind == kNarrowTriangleLeaf;
}

numeric::Box3d keepTriangles(Tree& tree, std::uint32_t leaf, unsigned positions) {
    return onBlock(tree, leaf, [&](auto& block, std::uint32_t* id) {
        const int before = countOf(block);
        int count = 0;
        numeric::Box3d box;
        for (; positions; positions &= positions - 1) {
            const int lane = __builtin_ctz(positions);
            overRows(block, [&](auto& row) { row[count] = row[lane]; });
            id[count] = id[lane];
            for (std::size_t c = 0; c < 3; ++c) box.add(cornerOf(block, c, count));
            ++count;
        }
        setCount(block, id, count, before);
        return box;
    });
}

bool hasRoom(const Tree& tree, std::uint32_t leaf, const LooseTriangle& triangle) {
    return onBlock(tree, leaf, [&](const auto& block, const std::uint32_t*) {
        if (countOf(block) < kLanes) return true;
        if constexpr (kShares<std::remove_cvref_t<decltype(block)>>) {
            std::uint8_t at[3];
            return placesOfCorners(block, triangle.corner, at);
        } else {
            return false;
        }
    });
}

std::uint32_t addTriangle(Tree& tree, Places& places, std::uint32_t leaf,
                          const LooseTriangle& triangle) {
    if (kindOfLeaf(leaf) == kTriangleLeaf) {
        put(tree.triangles[leaf & kLeafIndex], triangle);
        return leaf;
    }
    std::uint8_t at[3];
    if (kindOfLeaf(leaf) == kSharedLeaf) {
        SharedBlock& block = tree.shared[leaf & kLeafIndex];
        if (placesOfCorners(block, triangle.corner, at)) {
            put(block, triangle, at);
            return leaf;
        }
    } else if (kindOfLeaf(leaf) == kNarrowSharedLeaf) {
        const NarrowSharedBlock& narrow = tree.narrowShared[leaf & kLeafIndex];
        if (placesOfCorners(narrow, triangle.corner, at)) {
            SharedBlock block = widened(narrow, tree.narrowIds.data() + narrow.ids);
            put(block, triangle, at);
            const std::uint32_t place = places.take(kShared);
            tree.shared[place] = block;
            return leafReference(kSharedLeaf, place);
        }
    }
    TriangleBlock block = onBlock(
        tree, leaf, [](const auto& from, const std::uint32_t* id) { return spread(from, id); });
    put(block, triangle);
    const std::uint32_t place = places.take(kTriangles);
    tree.triangles[place] = block;
    return leafReference(kTriangleLeaf, place);
}

} // namespace rt::octree
