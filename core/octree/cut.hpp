// Where a cell of the octree is cut.
#pragma once
#include <core/octree/bins.hpp>
#include <core/octree/box.hpp>
#include <core/octree/cells.hpp>
#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace rt::octree {

inline constexpr std::uint32_t kChunk = 16384; // of references, for parallel passes over one cell

inline __m128 lowerOf(const Reference& r) { return _mm_load_ps(r.lower); }
inline __m128 upperOf(const Reference& r) { return _mm_load_ps(r.upper); }
inline Box boxOf(const Reference& r) { return {lowerOf(r), upperOf(r)}; }
inline __m128 twiceCenter(const Reference& r) { return _mm_add_ps(lowerOf(r), upperOf(r)); }
inline float twiceCenter(const Reference& r, int axis) { return r.lower[axis] + r.upper[axis]; }

/// A cell on its way.
struct Range {
    Box box, centers; // `centers`: around doubled centres
    std::uint32_t begin, end;
    unsigned open; // bit per axis that this level of the octree has still to cut

    std::uint32_t size() const { return end - begin; }
};

/// A reference with doubled centre c is below if (c − lower) · factor < limit.
struct Cut {
    int axis = -1;
    float lower, factor, limit;
    std::uint32_t below = 0;                 // how many
    std::vector<std::uint32_t> belowOfChunk; // of those; may be empty where one chunk is all
    Box belowBox, aboveBox;

    explicit operator bool() const { return axis >= 0; }
    bool isBelow(const Reference& r) const {
        return (twiceCenter(r, axis) - lower) * factor < limit;
    }
};

/// Where it costs least by the surface area heuristic, on an axis that this level has left, or, where all
/// centres agree on those, on one of the next level; none when all centres coincide. `balanced`: through the
/// middle reference instead.
Cut chooseCut(Range range, const Reference* from, int bins, FillBins& fill, bool balanced);

/// Runs body(first, last, chunk) over the range in chunks whose bounds depend on the range alone.
template <class Body> void overChunks(std::uint32_t begin, std::uint32_t end, const Body& body) {
    const std::uint32_t chunks = (end - begin + kChunk - 1) / kChunk;
    const auto one = [&](std::size_t i) {
        const auto first = begin + static_cast<std::uint32_t>(i) * kChunk;
        body(first, std::min(first + kChunk, end), i);
    };
    if (chunks == 1)
        one(0);
    else
        parallel::forEach(chunks, 0, one);
}

} // namespace rt::octree
