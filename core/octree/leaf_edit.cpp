#include <core/octree/leaf_edit.hpp>

#include <algorithm>
#include <array>
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
        for (const std::uint32_t id : block.id) count += id != kEmptyChild;
        return count;
    }
}

template <class Block> constexpr int kLanesOf = kShares<Block> ? kSharedLanes : kLanes;

/// For each lane the one that its triangle comes from; kLanesOf: none does.
template <class Block> using Order = std::array<std::uint8_t, kLanesOf<Block>>;

/// Of all that the lanes hold but the ids. Without branches, which nobody could foresee.
template <class Block> void rearrange(Block& block, const Order<Block>& from) {
    const auto row = [&](auto& lanes) {
        using Value = std::remove_reference_t<decltype(lanes[0])>;
        Value before[kLanesOf<Block> + 1];
        std::copy_n(lanes, kLanesOf<Block>, before);
        before[kLanesOf<Block>] =
            kShares<Block> ? Value{} : std::numeric_limits<Value>::quiet_NaN();
        for (int lane = 0; lane < kLanesOf<Block>; ++lane) lanes[lane] = before[from[lane]];
    };
    if constexpr (kShares<Block>) {
        for (auto& lanes : block.index) row(lanes);
    } else {
        for (auto& corner : block.corner)
            for (auto& lanes : corner) row(lanes);
    }
}

/// Takes lanes away and closes the gaps.
template <class Block> void dropLanes(Block& block, std::uint32_t* id, unsigned dropped) {
    const int before = countOf(block);
    Order<Block> from;
    int count = 0;
    for (int lane = 0; lane < kLanesOf<Block>; ++lane) {
        from[count] = static_cast<std::uint8_t>(lane);
        count += lane < before && !(dropped >> lane & 1);
    }
    for (int lane = count; lane < kLanesOf<Block>; ++lane) from[lane] = kLanesOf<Block>;
    rearrange(block, from);
    for (int lane = 0; lane < count; ++lane) id[lane] = id[from[lane]];
    for (int lane = count; lane < before; ++lane) id[lane] = kEmptyChild;
    if constexpr (kShares<Block>) block.valid = (1u << count) - 1;
}

/// Bit per corner that a triangle of a shared block has.
template <class Block> unsigned usedCorners(const Block& block) {
    const int count = countOf(block);
    unsigned used = 0;
    for (const auto& row : block.index)
        for (int lane = 0; lane < count; ++lane) used |= 1u << row[lane];
    return used;
}

template <class Block> numeric::Box3d boundsOf(const Block& block) {
    numeric::Box3d box;
    if constexpr (kShares<Block>) {
        for (unsigned used = usedCorners(block); used; used &= used - 1) {
            const int i = __builtin_ctz(used);
            box.add(Vec3(block.corner[0][i], block.corner[1][i], block.corner[2][i]));
        }
    } else {
        for (int a = 0; a < 3; ++a)
            for (const auto& corner : block.corner)
                for (const double x : corner[a]) { // NaN, of unused ones, is neither
                    box.min[a] = x < box.min[a] ? x : box.min[a];
                    box.max[a] = x > box.max[a] ? x : box.max[a];
                }
    }
    return box;
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
template <class Block> int openLane(Block& block, std::uint32_t newId) {
    const int count = countOf(block);
    int at = 0;
    for (int lane = 0; lane < count; ++lane) at += block.id[lane] < newId;
    Order<Block> from;
    for (int lane = 0; lane < kLanesOf<Block>; ++lane)
        from[lane] = static_cast<std::uint8_t>(lane - (lane > at));
    rearrange(block, from);
    for (int lane = count; lane > at; --lane) block.id[lane] = block.id[lane - 1];
    block.id[at] = newId;
    return at;
}

/// Where in a shared block the corners of another triangle are, or have room. False: they do not fit.
template <class Block>
bool placesOfCorners(const Block& block, const Vec3 (&corner)[3], std::uint8_t (&at)[3]) {
    const auto bits = [](double d) { return std::bit_cast<std::uint64_t>(d); };
    const int count = countOf(block);
    if (count == kSharedLanes) return false;
    const unsigned used = usedCorners(block);
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
    const int lane = openLane(block, triangle.id);
    block.valid = 2 * block.valid + 1;
    for (std::size_t c = 0; c < 3; ++c) {
        block.index[c][lane] = at[c];
        for (int a = 0; a < 3; ++a) block.corner[a][at[c]] = triangle.corner[c][a];
    }
}

void put(TriangleBlock& block, const LooseTriangle& triangle) {
    const int lane = openLane(block, triangle.id);
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

std::span<const std::uint32_t> idsOfTriangles(const Tree& tree, std::uint32_t leaf) {
    return onBlock(tree, leaf, [](const auto& block, const std::uint32_t* id) {
        return std::span(id, static_cast<std::size_t>(countOf(block)));
    });
}

LooseTriangle triangleAt(const Tree& tree, std::uint32_t leaf, int position) {
    return onBlock(tree, leaf, [&](const auto& block, const std::uint32_t* id) {
        return LooseTriangle{id[position],
                             {cornerOf(block, 0, position), cornerOf(block, 1, position),
                              cornerOf(block, 2, position)}};
    });
}

numeric::Box3d dropTriangles(Tree& tree, std::uint32_t leaf, unsigned positions) {
    return onBlock(tree, leaf, [&](auto& block, std::uint32_t* id) {
        dropLanes(block, id, positions);
        return boundsOf(block);
    });
}

std::uint32_t leafOf(Tree& tree, Places& places, Storage storage, const LooseTriangle& triangle) {
    const auto fill = [&](auto& block, std::uint32_t* id) {
        using Float = std::remove_reference_t<decltype(block.corner[0][0])>;
        for (int a = 0; a < 3; ++a)
            for (int i = 0; i < kSharedLanes; ++i)
                block.corner[a][i] = static_cast<Float>(triangle.corner[i < 3 ? i : 0][a]);
        for (std::size_t c = 0; c < 3; ++c) block.index[c][0] = static_cast<std::uint8_t>(c);
        block.valid = 1;
        *id = triangle.id;
    };
    if (storage != Storage::f64 && std::ranges::all_of(triangle.corner, numeric::fitsF32)) {
        NarrowSharedBlock block{};
        block.ids = places.take(kNarrowIds);
        fill(block, tree.narrowIds.data() + block.ids);
        const std::uint32_t place = places.take(kNarrowShared);
        tree.narrowShared[place] = block;
        return leafReference(kNarrowSharedLeaf, place);
    }
    SharedBlock block{};
    std::ranges::fill(block.id, kEmptyChild);
    fill(block, block.id);
    const std::uint32_t place = places.take(kShared);
    tree.shared[place] = block;
    return leafReference(kSharedLeaf, place);
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
