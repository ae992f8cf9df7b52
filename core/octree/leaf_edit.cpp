#include <core/octree/leaf_edit.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <type_traits>

#include <emmintrin.h>

namespace rt::octree {
namespace {

using geometry::Vec3;

template <class Block>
constexpr bool kShares =
    std::is_same_v<Block, SharedBlock> || std::is_same_v<Block, NarrowSharedBlock>;

/// Calls visit(block) with the block of a leaf.
template <class AnyTree, class Visit>
auto onBlock(AnyTree& tree, std::uint32_t leaf, const Visit& visit) {
    const std::uint32_t index = leaf & kLeafIndex;
    switch (kindOfLeaf(leaf)) {
    case kSharedLeaf:
        return visit(tree.shared[index]);
    case kNarrowSharedLeaf:
        return visit(tree.narrowShared[index]);
    case kNarrowTriangleLeaf:
        return visit(tree.narrowTriangles[index]);
    default:
        return visit(tree.triangles[index]);
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

/// Which bytes of a row of lanes are of those before one of them.
template <class T, std::size_t kCount> struct Before {
    static constexpr int kRegisters = sizeof(T) * kCount / 16;
    __m128i of[kRegisters];

    Before(int lane) {
        for (int i = 0; i < kRegisters; ++i)
            of[i] = _mm_cmpgt_epi8(
                _mm_set1_epi8(static_cast<char>(lane * static_cast<int>(sizeof(T)) - 16 * i)),
                _mm_setr_epi8(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15));
    }
};

/// Those after a lane move into it, without branches, which nobody could foresee. `unused`: what the last holds then.
template <class T, std::size_t kCount>
void closeLane(T (&row)[kCount], const Before<T, kCount>& before, T unused) {
    auto* const at = reinterpret_cast<__m128i*>(row);
    T end[kCount] = {unused};
    for (int i = 0; i < before.kRegisters; ++i) {
        const __m128i old = _mm_loadu_si128(at + i);
        const __m128i next = _mm_loadu_si128(
            i + 1 < before.kRegisters ? at + i + 1 : reinterpret_cast<const __m128i*>(end));
        const __m128i moved =
            _mm_or_si128(_mm_srli_si128(old, sizeof(T)), _mm_slli_si128(next, 16 - sizeof(T)));
        _mm_storeu_si128(at + i, _mm_or_si128(_mm_and_si128(before.of[i], old),
                                              _mm_andnot_si128(before.of[i], moved)));
    }
}

/// A lane and those after it move away; the last is lost, and the one holds anything.
template <class T, std::size_t kCount>
void openLane(T (&row)[kCount], const Before<T, kCount>& before) {
    auto* const at = reinterpret_cast<__m128i*>(row);
    __m128i last = _mm_setzero_si128();
    for (int i = 0; i < before.kRegisters; ++i) {
        const __m128i old = _mm_loadu_si128(at + i);
        const __m128i moved =
            _mm_or_si128(_mm_slli_si128(old, sizeof(T)), _mm_srli_si128(last, 16 - sizeof(T)));
        _mm_storeu_si128(at + i, _mm_or_si128(_mm_and_si128(before.of[i], old),
                                              _mm_andnot_si128(before.of[i], moved)));
        last = old;
    }
}

/// Takes a lane away and closes the gap.
template <class Block> void dropLane(Block& block, int lane) {
    if constexpr (kShares<Block>) {
        const Before<std::uint8_t, kSharedLanes> before(lane);
        for (auto& row : block.index) closeLane(row, before, std::uint8_t{0});
        block.valid >>= 1;
    } else {
        using Float = std::remove_reference_t<decltype(block.corner[0][0][0])>;
        const Before<Float, kLanes> before(lane);
        for (auto& corner : block.corner)
            for (auto& row : corner)
                closeLane(row, before, std::numeric_limits<Float>::quiet_NaN());
    }
    closeLane(block.id, {lane}, kEmptyChild);
}

/// Bit per corner that a triangle of a shared block has.
template <class Block> unsigned usedCorners(const Block& block) {
    const int count = countOf(block);
    unsigned used = 0;
    for (int lane = 0; lane < count; ++lane)
        used |=
            1u << block.index[0][lane] | 1u << block.index[1][lane] | 1u << block.index[2][lane];
    return used;
}

__m128d twoOf(const double* from) { return _mm_loadu_pd(from); }
__m128d twoOf(const float* from) {
    return _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from))));
}

template <class Block> numeric::Box3d boundsOf(const Block& block) {
    numeric::Box3d box;
    if constexpr (kShares<Block>) {
        for (unsigned used = usedCorners(block); used; used &= used - 1) {
            const int i = __builtin_ctz(used);
            box.add(Vec3(block.corner[0][i], block.corner[1][i], block.corner[2][i]));
        }
    } else {
        double least[3], most[3];
        for (int a = 0; a < 3; ++a) {
            __m128d low = _mm_set1_pd(numeric::kInfinity), high = _mm_set1_pd(-numeric::kInfinity);
            for (const auto& corner : block.corner)
                for (int lane = 0; lane < kLanes; lane += 2) {
                    const __m128d x = twoOf(corner[a] + lane);
                    low = _mm_min_pd(x, low); // NaN, of unused ones, changes neither
                    high = _mm_max_pd(x, high);
                }
            least[a] = _mm_cvtsd_f64(_mm_min_sd(low, _mm_unpackhi_pd(low, low)));
            most[a] = _mm_cvtsd_f64(_mm_max_sd(high, _mm_unpackhi_pd(high, high)));
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

/// Puts an id among others, which rise; returns its lane.
template <std::size_t kCount> int putId(std::uint32_t (&id)[kCount], std::uint32_t newId) {
    int lane = 0;
    for (const std::uint32_t other : id) lane += other < newId; // unused ones are larger
    openLane(id, {lane});
    id[lane] = newId;
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
    const int lane = putId(block.id, triangle.id);
    const Before<std::uint8_t, kSharedLanes> before(lane);
    block.valid = 2 * block.valid + 1;
    for (std::size_t c = 0; c < 3; ++c) {
        openLane(block.index[c], before);
        block.index[c][lane] = at[c];
        for (int a = 0; a < 3; ++a) block.corner[a][at[c]] = triangle.corner[c][a];
    }
}

void put(TriangleBlock& block, const LooseTriangle& triangle) {
    const int lane = putId(block.id, triangle.id);
    const Before<double, kLanes> before(lane);
    for (std::size_t c = 0; c < 3; ++c)
        for (int a = 0; a < 3; ++a) {
            openLane(block.corner[c][a], before);
            block.corner[c][a][lane] = triangle.corner[c][a];
        }
}

void widen(const NarrowSharedBlock& narrow, SharedBlock& block) {
    for (int a = 0; a < 3; ++a)
        std::copy(std::begin(narrow.corner[a]), std::end(narrow.corner[a]), block.corner[a]);
    std::copy(&narrow.index[0][0], &narrow.index[0][0] + sizeof narrow.index, &block.index[0][0]);
    std::copy(std::begin(narrow.id), std::end(narrow.id), block.id);
    block.valid = narrow.valid;
    std::fill(std::begin(block.spare), std::end(block.spare), 0);
}

/// A block that holds nothing yet.
template <class Block> void spread(const Block& from, TriangleBlock& block) {
    const int count = countOf(from);
    for (std::uint32_t& word : block.spare) word = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
        block.id[lane] = lane < count ? from.id[lane] : kEmptyChild;
        for (std::size_t c = 0; c < 3; ++c) {
            const Vec3 p = lane < count ? cornerOf(from, c, lane)
                                        : Vec3(std::numeric_limits<double>::quiet_NaN());
            for (int a = 0; a < 3; ++a) block.corner[c][a][lane] = p[a];
        }
    }
}

} // namespace

bool isTriangles(std::uint32_t leaf) {
    const LeafKind kind = kindOfLeaf(leaf);
    return kind == kSharedLeaf || kind == kNarrowSharedLeaf || kind == kTriangleLeaf ||
           kind == kNarrowTriangleLeaf;
}

std::span<const std::uint32_t> idsOfTriangles(const Tree& tree, std::uint32_t leaf) {
    return onBlock(tree, leaf, [](const auto& block) {
        return std::span(block.id, static_cast<std::size_t>(countOf(block)));
    });
}

LooseTriangle triangleAt(const Tree& tree, std::uint32_t leaf, int position) {
    return onBlock(tree, leaf, [&](const auto& block) {
        return LooseTriangle{block.id[position],
                             {cornerOf(block, 0, position), cornerOf(block, 1, position),
                              cornerOf(block, 2, position)}};
    });
}

numeric::Box3d dropTriangles(Tree& tree, std::uint32_t leaf, unsigned positions) {
    return onBlock(tree, leaf, [&](auto& block) {
        while (positions) {
            const int lane = static_cast<int>(std::bit_width(positions)) - 1;
            dropLane(block, lane);
            positions &= ~(1u << lane);
        }
        return boundsOf(block);
    });
}

std::uint32_t leafOf(Tree& tree, Places& places, Storage storage, const LooseTriangle& triangle) {
    const auto fill = [&](auto& block) {
        using Float = std::remove_reference_t<decltype(block.corner[0][0])>;
        for (int a = 0; a < 3; ++a) {
            std::ranges::fill(block.corner[a], static_cast<Float>(triangle.corner[0][a]));
            for (int c = 1; c < 3; ++c)
                block.corner[a][c] = static_cast<Float>(triangle.corner[c][a]);
        }
        std::memset(block.index, 0, sizeof block.index);
        for (std::uint8_t c = 0; c < 3; ++c) block.index[c][0] = c;
        block.valid = 1;
        std::ranges::fill(block.spare, 0);
        std::ranges::fill(block.id, kEmptyChild);
        block.id[0] = triangle.id;
    };
    if (storage != Storage::f64 && std::ranges::all_of(triangle.corner, numeric::fitsF32)) {
        const std::uint32_t place = places.take(kNarrowShared);
        fill(tree.narrowShared[place]);
        return leafReference(kNarrowSharedLeaf, place);
    }
    const std::uint32_t place = places.take(kShared);
    fill(tree.shared[place]);
    return leafReference(kSharedLeaf, place);
}

bool hasRoom(const Tree& tree, std::uint32_t leaf, const LooseTriangle& triangle) {
    return onBlock(tree, leaf, [&](const auto& block) {
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
            const std::uint32_t place = places.take(kShared);
            SharedBlock& block = tree.shared[place];
            widen(narrow, block);
            put(block, triangle, at);
            return leafReference(kSharedLeaf, place);
        }
    }
    const std::uint32_t place = places.take(kTriangles);
    TriangleBlock& block = tree.triangles[place];
    onBlock(tree, leaf, [&](const auto& from) { spread(from, block); });
    put(block, triangle);
    return leafReference(kTriangleLeaf, place);
}

} // namespace rt::octree
