// How the references of a cell spread along its axes: what the builder chooses a cut by.
#pragma once
#include <core/octree/cells.hpp>

#include <immintrin.h>

namespace rt::octree {

inline constexpr int kMostBins = 32;

/// A place along an axis, (doubled centre − lower) · factor: from 0 at the least centre to just under the number of
/// bins at the greatest.
struct Scale {
    alignas(16) float lower[4], factor[4];
    unsigned axes; // bit per axis on which centres differ
};

/// The references whose centres lie in one part of an axis.
struct Bin {
    __m128 lower, upper; // of the box around them; the fourth components mean nothing
    std::uint32_t count;
};

struct Bins {
    Bin of[3][kMostBins]; // [axis]
};

/// Sets the first `count` bins of each axis in `axes`, a bit per axis, at least one. Both give the same bits.
using FillBins = void(const Reference* first, const Reference* last, const Scale& scale,
                      unsigned axes, int count, Bins& bins);
namespace baseline {
FillBins fillBins;
}
namespace avx2 {
FillBins fillBins;
}

} // namespace rt::octree
