#include <core/octree/cut.hpp>

#include <core/numeric/rounding.hpp>

#include <limits>
#include <vector>

namespace rt::octree {
namespace {

constexpr std::uint32_t kFew = 16; // references of a cell that are sorted, not binned
constexpr float kInfinityF32 = std::numeric_limits<float>::infinity();

/// Bounds of doubled centres.
struct Centers {
    alignas(16) float lower[4], upper[4];
};

Scale scaleOf(const Centers& centers, float count) {
    Scale scale;
    scale.axes = 0;
    for (int a = 0; a < 3; ++a) {
        scale.lower[a] = centers.lower[a];
        const float f = count * (1 - static_cast<float>(numeric::powerOfTwo(-20))) /
                        (centers.upper[a] - centers.lower[a]);
        const bool differ = centers.upper[a] > centers.lower[a] && f < kInfinityF32;
        scale.factor[a] = differ ? f : 0;
        scale.axes |= static_cast<unsigned>(differ) << a;
    }
    scale.lower[3] = scale.factor[3] = 0;
    return scale;
}

__m128i placesOf(const Scale& scale, const Reference& r) {
    return _mm_cvttps_epi32(_mm_mul_ps(_mm_sub_ps(twiceCenter(r), _mm_load_ps(scale.lower)),
                                       _mm_load_ps(scale.factor)));
}

/// A box that starts uninitialised.
struct RawBox {
    __m128 lower, upper;
};

/// Half of the surface of four boxes, none empty.
__m128 areasOf(const RawBox* box) {
    __m128 x = _mm_sub_ps(box[0].upper, box[0].lower), y = _mm_sub_ps(box[1].upper, box[1].lower),
           z = _mm_sub_ps(box[2].upper, box[2].lower), w = _mm_sub_ps(box[3].upper, box[3].lower);
    _MM_TRANSPOSE4_PS(x, y, z, w);
    return _mm_add_ps(_mm_add_ps(_mm_mul_ps(x, y), _mm_mul_ps(y, z)), _mm_mul_ps(z, x));
}

/// The cheapest place to cut a row of boxes in two, over several rows.
class Sweep {
public:
    /// box(i): the i-th of `length`, of which the first `count`, 2 to kMostBins, matter; the first and the
    /// last of those are not empty.
    /// sizes(i): how many primitives are in those before each of the i-th to the (i + 3)-th.
    /// invalid(i): all ones where the row may not be cut before those.
    template <class BoxAt, class Sizes, class Invalid>
    void add(int axis, int length, int count, int primitives, const BoxAt& box, const Sizes& sizes,
             const Invalid& invalid) {
        Row& row = rows_[axis];
        Box b = box(0);
        for (int i = 1; i < length; ++i) {
            row.below[i] = {b.lower, b.upper};
            b.add(box(i));
        }
        b = box(length - 1);
        for (int i = length; i < length + 3; ++i) row.below[i] = row.above[i] = {b.lower, b.upper};
        for (int i = length - 1; i > 0; --i) {
            b.add(box(i));
            row.above[i] = {b.lower, b.upper};
        }
        // Work comes in blocks; fours, since blocks are rarely full.
        const auto blocks = [](__m128i n) {
            return _mm_cvtepi32_ps(_mm_srli_epi32(_mm_add_epi32(n, _mm_set1_epi32(3)), 2));
        };
        const __m128i all = _mm_set1_epi32(primitives), end = _mm_set1_epi32(count);
        for (int i = 1; i < length; i += 4) {
            const __m128i n = sizes(i),
                          index = _mm_add_epi32(_mm_set1_epi32(i), _mm_setr_epi32(0, 1, 2, 3));
            __m128 cost =
                _mm_add_ps(_mm_mul_ps(areasOf(row.below + i), blocks(n)),
                           _mm_mul_ps(areasOf(row.above + i), blocks(_mm_sub_epi32(all, n))));
            // NaN is cheaper than nothing.
            const __m128i isValid = _mm_andnot_si128(invalid(i), _mm_cmplt_epi32(index, end));
            const __m128i better =
                _mm_and_si128(isValid, _mm_castps_si128(_mm_cmplt_ps(cost, cost_)));
            const __m128 betterPs = _mm_castsi128_ps(better);
            cost_ = _mm_or_ps(_mm_and_ps(betterPs, cost), _mm_andnot_ps(betterPs, cost_));
            place_ = _mm_or_si128(
                _mm_and_si128(better, _mm_add_epi32(index, _mm_set1_epi32(axis * kRow))),
                _mm_andnot_si128(better, place_));
        }
    }
    /// Of equal ones the first on the lowest axis. There is one.
    void cheapest(int& axis, int& at, Box& below, Box& above) const {
        alignas(16) float cost[4];
        alignas(16) std::int32_t place[4];
        _mm_store_ps(cost, cost_);
        _mm_store_si128(reinterpret_cast<__m128i*>(place), place_);
        int best = 0;
        for (int i = 1; i < 4; ++i)
            if (cost[i] < cost[best] || (cost[i] == cost[best] && place[i] < place[best])) best = i;
        axis = place[best] / kRow;
        at = place[best] % kRow;
        const RawBox &b = rows_[axis].below[at], &a = rows_[axis].above[at];
        below = {b.lower, b.upper};
        above = {a.lower, a.upper};
    }

private:
    static constexpr int kRow = 64;
    struct Row {
        RawBox below[kMostBins + 4],
            above[kMostBins + 4]; // [i]: of those before the i-th; of it and the rest
    };
    Row rows_[3];
    __m128 cost_ = _mm_set1_ps(kInfinityF32);
    __m128i place_ = _mm_set1_epi32(INT32_MAX);
};

void merge(const Bins& from, unsigned axes, int count, Bins& to) {
    for (int a = 0; a < 3; ++a)
        if (axes >> a & 1)
            for (int i = 0; i < count; ++i) {
                const Bin& bin = from.of[a][i];
                Bin& sum = to.of[a][i];
                sum.lower = _mm_min_ps(sum.lower, bin.lower);
                sum.upper = _mm_max_ps(sum.upper, bin.upper);
                sum.count += bin.count;
            }
}

/// The cheapest plane on the open axes, between bins.
Cut cheapestCut(const Range& range, const Centers& centers, const Reference* from, int count,
                FillBins& fill) {
    const Scale scale = scaleOf(centers, static_cast<float>(count));
    const unsigned axes = scale.axes & range.open;
    if (!axes) return {};
    Bins bins;
    std::vector<Bins> parts; // by chunk, where there are several
    if (range.size() <= kChunk) {
        fill(from + range.begin, from + range.end, scale, axes, count, bins);
    } else {
        parts.resize((range.size() + kChunk - 1) / kChunk);
        overChunks(range.begin, range.end,
                   [&](std::uint32_t first, std::uint32_t last, std::size_t i) {
                       fill(from + first, from + last, scale, axes, count, parts[i]);
                   });
        bins = parts[0];
        for (std::size_t i = 1; i < parts.size(); ++i) merge(parts[i], axes, count, bins);
    }
    Sweep sweep;
    alignas(16) std::int32_t below[3][kMostBins + 4] = {}; // primitives
    for (int a = 0; a < 3; ++a) {
        if (!(axes >> a & 1)) continue;
        const Bin* const row = bins.of[a];
        for (int i = 0; i < count; ++i)
            below[a][i + 1] = below[a][i] + static_cast<std::int32_t>(row[i].count);
        sweep.add(
            a, count, count, static_cast<int>(range.size()),
            [&](int i) {
                return Box{row[i].lower, row[i].upper};
            },
            [&](int i) { return _mm_loadu_si128(reinterpret_cast<const __m128i*>(below[a] + i)); },
            [](int) { return _mm_setzero_si128(); });
    }
    Cut best;
    int at;
    sweep.cheapest(best.axis, at, best.belowBox, best.aboveBox);
    best.below = static_cast<std::uint32_t>(below[best.axis][at]);
    best.lower = scale.lower[best.axis];
    best.factor = scale.factor[best.axis];
    best.limit = static_cast<float>(at);
    for (const Bins& part : parts) {
        std::uint32_t n = 0;
        for (int i = 0; i < at; ++i) n += part.of[best.axis][i].count;
        best.belowOfChunk.push_back(n);
    }
    return best;
}

/// The cheapest of all planes on the open axes, for at most kMost references. No loop's length depends
/// on their number, which nobody can foretell.
template <int kMost>
Cut cheapestCutOfFew(const Range& range, const Centers& centers, const Reference* from) {
    const Scale scale = scaleOf(centers, 0x1p20f);
    const unsigned axes = scale.axes & range.open;
    if (!axes) return {};
    const Reference* const first = from + range.begin;
    const int count = static_cast<int>(range.size());
    __m128i place[3][kMost / 4]; // of axis a from the g-th four on
    for (int g = 0; g < kMost / 4; ++g) {
        __m128 of[4];
        for (int i = 0; i < 4; ++i)
            of[i] = _mm_castsi128_ps(placesOf(scale, first[std::min(4 * g + i, count - 1)]));
        _MM_TRANSPOSE4_PS(of[0], of[1], of[2], of[3]);
        for (int a = 0; a < 3; ++a) place[a][g] = _mm_castps_si128(of[a]);
    }
    alignas(16) std::int32_t sorted[3][kMost + 4]; // place · 16 + which
    Sweep sweep;
    for (int a = 0; a < 3; ++a) {
        if (!(axes >> a & 1)) continue;
        alignas(16) std::int32_t key[kMost], rank[kMost];
        for (int g = 0; g < kMost / 4; ++g) {
            const __m128i which = _mm_add_epi32(_mm_set1_epi32(4 * g), _mm_setr_epi32(0, 1, 2, 3));
            const __m128i unused = _mm_cmpgt_epi32(which, _mm_set1_epi32(count - 1));
            const __m128i k = _mm_or_si128(_mm_slli_epi32(place[a][g], 4), which);
            _mm_store_si128(
                reinterpret_cast<__m128i*>(key) + g,
                _mm_or_si128(k, _mm_and_si128(unused, _mm_set1_epi32(INT32_MAX & ~15))));
        }
        // Each one's rank is the number of those that come before it.
        for (int g = 0; g < kMost / 4; ++g) {
            const __m128i these = _mm_load_si128(reinterpret_cast<const __m128i*>(key) + g);
            __m128i before = _mm_setzero_si128();
            for (const std::int32_t k : key)
                before = _mm_sub_epi32(before, _mm_cmpgt_epi32(these, _mm_set1_epi32(k)));
            _mm_store_si128(reinterpret_cast<__m128i*>(rank) + g, before);
        }
        for (int i = 0; i < kMost; ++i) sorted[a][rank[i]] = key[i];
        for (int i = kMost; i < kMost + 4; ++i) sorted[a][i] = 0;
        sweep.add(
            a, kMost, count, count,
            [&](int i) { // unused ones repeat the last
                const Reference& r = first[sorted[a][std::min(i, count - 1)] & 15];
                return boxOf(r);
            },
            [](int i) { return _mm_add_epi32(_mm_set1_epi32(i), _mm_setr_epi32(0, 1, 2, 3)); },
            [&](int i) {
                const auto load = [&](int k) {
                    return _mm_srai_epi32(
                        _mm_loadu_si128(reinterpret_cast<const __m128i*>(sorted[a] + k)), 4);
                };
                return _mm_cmpeq_epi32(load(i - 1), load(i));
            });
    }
    Cut best;
    int at;
    sweep.cheapest(best.axis, at, best.belowBox, best.aboveBox);
    best.lower = scale.lower[best.axis];
    best.factor = scale.factor[best.axis];
    best.below = static_cast<std::uint32_t>(at);
    best.limit = static_cast<float>(sorted[best.axis][at] >> 4);
    return best;
}

/// The plane through the middle primitive, on the open axis where the centres spread most.
Cut medianCut(const Range& range, const Centers& all, const Reference* from) {
    Cut cut;
    float widest = 0;
    for (int a = 0; a < 3; ++a)
        if ((range.open >> a & 1) && all.upper[a] - all.lower[a] > widest) {
            widest = all.upper[a] - all.lower[a];
            cut.axis = a;
        }
    if (!cut) return cut;
    std::vector<float> centers(range.size());
    for (std::uint32_t i = 0; i < range.size(); ++i)
        centers[i] = twiceCenter(from[range.begin + i], cut.axis);
    const auto middle = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() / 2);
    std::nth_element(centers.begin(), middle, centers.end());
    cut.lower = 0;
    cut.factor = 1;
    cut.limit = *middle;
    if (cut.limit == all.lower[cut.axis]) { // nothing is below the least
        cut.limit = all.upper[cut.axis];
        for (const float c : centers)
            if (c > all.lower[cut.axis]) cut.limit = std::min(cut.limit, c);
    }
    cut.belowOfChunk.resize((range.size() + kChunk - 1) / kChunk);
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
        const bool isBelow = cut.isBelow(from[i]);
        cut.below += isBelow;
        cut.belowOfChunk[(i - range.begin) / kChunk] += isBelow;
        (isBelow ? cut.belowBox : cut.aboveBox).add(boxOf(from[i]));
    }
    return cut;
}

} // namespace

Cut chooseCut(Range range, const Reference* from, int bins, FillBins& fill, bool balanced) {
    Centers centers;
    _mm_store_ps(centers.lower, range.centers.lower);
    _mm_store_ps(centers.upper, range.centers.upper);
    for (;;) {
        Cut cut;
        if (!balanced)
            cut = range.size() <= kFew / 2 ? cheapestCutOfFew<kFew / 2>(range, centers, from)
                  : range.size() <= kFew   ? cheapestCutOfFew<kFew>(range, centers, from)
                                           : cheapestCut(range, centers, from, bins, fill);
        if (!cut) cut = medianCut(range, centers, from);
        if (cut || range.open == 7) return cut;
        range.open = 7;
    }
}

} // namespace rt::octree
