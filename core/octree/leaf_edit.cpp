#include <core/octree/leaf_edit.hpp>

#include <algorithm>
#include <bit>
#include <limits>
#include <type_traits>

#include <emmintrin.h>

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

/// The lanes of a row in registers; moved without branches, which nobody could foresee.
template <class T, std::size_t kCount> class Row {
public:
    explicit Row(T (&row)[kCount]) : row_(row) {
        for (int i = 0; i < kRegisters; ++i) old_[i] = _mm_loadu_si128(at(i));
    }
    /// Those after one move into it. `unused`: what the last one holds then.
    void close(int lane, T unused) const {
        T last[kCount] = {unused};
        for (int i = 0; i < kRegisters; ++i) {
            const __m128i next = i + 1 < kRegisters
                                     ? old_[i + 1]
                                     : _mm_loadu_si128(reinterpret_cast<const __m128i*>(last));
            store(i, lane, _mm_srli_si128(old_[i], sizeof(T)),
                  _mm_slli_si128(next, 16 - sizeof(T)));
        }
    }
    /// One and those after it move away; the last is lost.
    void open(int lane) const {
        for (int i = 0; i < kRegisters; ++i) {
            const __m128i before = i ? old_[i - 1] : _mm_setzero_si128();
            store(i, lane, _mm_slli_si128(old_[i], sizeof(T)),
                  _mm_srli_si128(before, 16 - sizeof(T)));
        }
    }

private:
    static constexpr int kRegisters = sizeof(T) * kCount / 16;

    __m128i* at(int i) const { return reinterpret_cast<__m128i*>(row_) + i; }
    /// From a lane on, what has moved there, in two parts.
    void store(int i, int lane, __m128i a, __m128i b) const {
        const int bytes = lane * static_cast<int>(sizeof(T)) - 16 * i;
        const __m128i stays =
            _mm_cmpgt_epi8(_mm_set1_epi8(static_cast<char>(bytes)),
                           _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
        _mm_storeu_si128(at(i), _mm_or_si128(_mm_and_si128(stays, old_[i]),
                                             _mm_andnot_si128(stays, _mm_or_si128(a, b))));
    }

    T* const row_;
    __m128i old_[kRegisters];
};

/// Calls visit(row) with each row of what a triangle's lane holds, but for its id.
template <class Block, class Visit> void overRows(Block& block, const Visit& visit) {
    if constexpr (kShares<Block>) {
        for (auto& row : block.index) visit(row);
    } else {
        for (auto& corner : block.corner)
            for (auto& row : corner) visit(row);
    }
}

/// Takes a lane away and closes the gap.
template <class Block> void dropLane(Block& block, std::uint32_t* id, int count, int lane) {
    overRows(block, [&](auto& row) {
        using Value = std::remove_reference_t<decltype(row[0])>;
        Row(row).close(lane, kShares<Block> ? Value{} : std::numeric_limits<Value>::quiet_NaN());
    });
    if constexpr (kShares<Block>) block.valid >>= 1;
    if constexpr (std::is_same_v<Block, NarrowSharedBlock>) {
        std::copy(id + lane + 1, id + count, id + lane);
        id[count - 1] = kEmptyChild;
    } else {
        Row(block.id).close(lane, kEmptyChild);
    }
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
        using Float = std::remove_cvref_t<decltype(block.corner[0][0][0])>;
        Float least[3], most[3];
        for (int a = 0; a < 3; ++a) {
            least[a] = std::numeric_limits<Float>::infinity();
            most[a] = -least[a];
            for (const auto& corner : block.corner)
                for (const Float x : corner[a]) { // NaN, of unused ones, is neither
                    least[a] = x < least[a] ? x : least[a];
                    most[a] = x > most[a] ? x : most[a];
                }
        }
        box = {{least[0], least[1], least[2]}, {most[0], most[1], most[2]}};
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
    int lane = 0;
    for (const std::uint32_t id : block.id) lane += id < newId; // unused ones are larger
    overRows(block, [&](auto& row) { Row(row).open(lane); });
    Row(block.id).open(lane);
    block.id[lane] = newId;
    return lane;
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
        for (int count = countOf(block); positions; --count) {
            const int lane = static_cast<int>(std::bit_width(positions)) - 1;
            dropLane(block, id, count, lane);
            positions &= ~(1u << lane);
        }
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
