#include <core/octree/cells.hpp>

#include <core/octree/box.hpp>
#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>
#include <vector>

namespace rt::octree {
namespace {

constexpr int kMostBins = 32;
constexpr int kLeastBins = 16, kBinShare = 1;
constexpr std::uint32_t kTaskSize = 2048;       // smaller cells are built by one thread
constexpr std::uint32_t kHandful = 256;         // cells that a task takes at a time
constexpr std::uint32_t kChunk = 16384;         // of references, for parallel passes over one cell
constexpr std::uint32_t kLeastCutOfSpheres = 2; // octree_bench --spheres, random: 4 is 8 % slower
constexpr int kBalancedDepth = 64;              // from here on cells are cut at the median
constexpr float kInfinityF32 = std::numeric_limits<float>::infinity();

__m128 lowerOf(const Reference& r) { return _mm_load_ps(r.lower); }
__m128 upperOf(const Reference& r) { return _mm_load_ps(r.upper); }
float twiceCenter(const Reference& r, int axis) { return r.lower[axis] + r.upper[axis]; }

/// The references whose centres lie in one part of an axis. Not cleared by itself: most are never used.
struct Bin {
    __m128 lower, upper;
    std::uint32_t count;

    void add(__m128 l, __m128 u, std::uint32_t n) {
        lower = _mm_min_ps(lower, l);
        upper = _mm_max_ps(upper, u);
        count += n;
    }
};

struct Bins {
    Bin of[3][kMostBins];

    void clear(unsigned axes, int count) {
        const Box empty;
        for (int a = 0; a < 3; ++a)
            if (axes >> a & 1)
                for (int i = 0; i < count; ++i) of[a][i] = {empty.lower, empty.upper, 0};
    }
    void add(const Bins& other, unsigned axes, int count) {
        for (int a = 0; a < 3; ++a)
            if (axes >> a & 1)
                for (int i = 0; i < count; ++i) {
                    const Bin& bin = other.of[a][i];
                    of[a][i].add(bin.lower, bin.upper, bin.count);
                }
    }
};

/// A cell on its way: its primitives' bounds and those of their (doubled) centres.
struct Range {
    Box box, centers;
    std::uint32_t begin, end;
    std::uint8_t open; // axes that this level of the octree has still to cut

    std::uint32_t size() const { return end - begin; }
};

struct Cut {
    int axis = -1;
    float plane = 0; // on doubled centres
    explicit operator bool() const { return axis >= 0; }
};

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

} // namespace

bool sharesBlock(const geometry::Primitives& primitives, const Reference* first,
                 const Reference* last) {
    if (last - first > kSharedLanes) return false;
    for (const Reference* r = first; r != last; ++r)
        if (r->kind != static_cast<std::uint32_t>(geometry::Kind::triangle)) return false;
    if (last - first <= kSharedLanes / 3) return true;
    CornerSet corners;
    for (const Reference* r = first; r != last; ++r)
        for (const std::uint32_t c : primitives.triangles.indices[indexInKind(primitives, r->id)])
            if (corners.add(c) < 0) return false;
    return true;
}

class Cells::Builder {
public:
    Builder(Cells& cells, const geometry::Primitives& primitives, std::uint32_t count, double scale,
            const BuildOptions& options)
        : cells_(cells), primitives_(primitives), references_(cells.references_.get()),
          leastCut_(
              std::min(std::max(1u, options.tuning.leastCut), std::max(1u, options.maxObjects))),
          bins_(std::clamp(options.tuning.bins, 2, kMostBins)),
          blockCost_(options.tuning.blockCost), maxObjects_(std::max(1u, options.maxObjects)),
          minSize_(static_cast<float>(options.minSize * scale)) {
        if (count > kChunk) other_.reset(new Reference[count]);
    }

    std::uint32_t root(std::uint32_t count) {
        std::vector<Range> parts((count + kChunk - 1) / kChunk);
        overChunks(0, count, [&](std::uint32_t first, std::uint32_t last, std::size_t i) {
            parts[i] = bounds(references_, first, last);
        });
        Range all = parts[0];
        for (const Range& part : parts) {
            all.box.add(part.box);
            all.centers.add(part.centers);
        }
        all.begin = 0;
        all.end = count;
        all.open = 7;
        Handful handful;
        return build(all, references_, 0, handful);
    }

private:
    static Range bounds(const Reference* references, std::uint32_t first, std::uint32_t last) {
        Range r;
        r.begin = first;
        r.end = last;
        for (std::uint32_t i = first; i < last; ++i) {
            const __m128 l = lowerOf(references[i]), u = upperOf(references[i]);
            const __m128 c = _mm_add_ps(l, u);
            r.box.add(l, u);
            r.centers.add(c, c);
        }
        return r;
    }

    /// Indices of cells for one task; which cell gets which index is seen by nobody.
    struct Handful {
        std::uint32_t next = 0, last = 0;
    };

    std::uint32_t newCell(Handful& handful) {
        if (handful.next == handful.last) {
            handful.next = cellCount_.fetch_add(kHandful, std::memory_order_relaxed);
            handful.last = handful.next + kHandful;
        }
        return handful.next++;
    }

    /// The cheapest plane on the axes in `range.open`.
    Cut cheapestCut(const Range& range, const Reference* from) const {
        alignas(16) float lower[4], upper[4], scale[4] = {};
        _mm_store_ps(lower, range.centers.lower);
        _mm_store_ps(upper, range.centers.upper);
        // Few primitives have few places worth a plane.
        const int count = std::min(bins_, kLeastBins + static_cast<int>(range.size() / kBinShare));
        unsigned axes = 0;
        for (int a = 0; a < 3; ++a) {
            // Just under `count`, so that the last centre falls into the last bin.
            const float s = static_cast<float>(count) *
                            (1 - static_cast<float>(numeric::powerOfTwo(-20))) /
                            (upper[a] - lower[a]);
            scale[a] = upper[a] > lower[a] && s < kInfinityF32 ? s : 0;
            axes |= static_cast<unsigned>(scale[a] != 0) << a;
        }
        axes &= range.open;
        if (!axes) return {};
        const auto fill = [&](std::uint32_t first, std::uint32_t last, Bins& into) {
            into.clear(axes, count);
            const __m128 low = _mm_load_ps(lower), factor = _mm_load_ps(scale);
            for (std::uint32_t i = first; i < last; ++i) {
                const __m128 l = lowerOf(from[i]), u = upperOf(from[i]);
                alignas(16) std::int32_t bin[4];
                _mm_store_si128(
                    reinterpret_cast<__m128i*>(bin),
                    _mm_cvttps_epi32(_mm_mul_ps(_mm_sub_ps(_mm_add_ps(l, u), low), factor)));
                for (int a = 0; a < 3; ++a) {
                    if (!(axes >> a & 1)) continue;
                    into.of[a][bin[a]].add(l, u, 1);
                }
            }
        };
        Bins bins;
        if (range.size() <= kChunk) {
            fill(range.begin, range.end, bins);
        } else {
            std::vector<Bins> parts((range.size() + kChunk - 1) / kChunk);
            overChunks(range.begin, range.end,
                       [&](std::uint32_t first, std::uint32_t last, std::size_t i) {
                           fill(first, last, parts[i]);
                       });
            bins.clear(axes, count);
            for (const Bins& part : parts) bins.add(part, axes, count);
        }
        Cut best;
        float bestCost = kInfinityF32;
        for (int a = 0; a < 3; ++a) {
            if (!(axes >> a & 1)) continue;
            float aboveArea[kMostBins];
            std::uint32_t aboveCount[kMostBins];
            Box box;
            std::uint32_t inBox = 0;
            for (int i = count - 1; i > 0; --i) {
                const Bin& bin = bins.of[a][i];
                box.add(bin.lower, bin.upper);
                inBox += bin.count;
                aboveArea[i] = box.area();
                aboveCount[i] = inBox;
            }
            box = Box();
            inBox = 0;
            for (int i = 1; i < count; ++i) {
                const Bin& bin = bins.of[a][i - 1];
                box.add(bin.lower, bin.upper);
                inBox += bin.count;
                if (inBox == 0 || aboveCount[i] == 0) continue;
                // Work comes in blocks; fours, since blocks are rarely full.
                const float cost = box.area() * static_cast<float>((inBox + 3) / 4) +
                                   aboveArea[i] * static_cast<float>((aboveCount[i] + 3) / 4);
                if (cost < bestCost) {
                    bestCost = cost;
                    best = {a, lower[a] + static_cast<float>(i) / scale[a]};
                }
            }
        }
        return best;
    }

    /// The plane through the middle primitive, on the open axis where the centres spread most.
    static Cut medianCut(const Range& range, const Reference* from) {
        alignas(16) float lower[4], upper[4];
        _mm_store_ps(lower, range.centers.lower);
        _mm_store_ps(upper, range.centers.upper);
        Cut cut;
        float widest = 0;
        for (int a = 0; a < 3; ++a)
            if ((range.open >> a & 1) && upper[a] - lower[a] > widest) {
                widest = upper[a] - lower[a];
                cut.axis = a;
            }
        if (!cut) return cut;
        std::vector<float> centers(range.size());
        for (std::uint32_t i = 0; i < range.size(); ++i)
            centers[i] = twiceCenter(from[range.begin + i], cut.axis);
        const auto middle = centers.begin() + static_cast<std::ptrdiff_t>(centers.size() / 2);
        std::nth_element(centers.begin(), middle, centers.end());
        cut.plane = *middle;
        if (cut.plane == lower[cut.axis]) { // nothing is below the least
            cut.plane = upper[cut.axis];
            for (const float c : centers)
                if (c > lower[cut.axis]) cut.plane = std::min(cut.plane, c);
        }
        return cut;
    }

    /// Sorts the range by the plane: in place, or from one array to the other.
    static void partitionInPlace(Reference* at, const Range& range, const Cut& cut, Range& below,
                                 Range& above) {
        std::uint32_t i = range.begin, j = range.end;
        while (i < j) {
            Reference& r = at[i];
            const __m128 l = lowerOf(r), u = upperOf(r), c = _mm_add_ps(l, u);
            if (twiceCenter(r, cut.axis) < cut.plane) {
                below.box.add(l, u);
                below.centers.add(c, c);
                ++i;
            } else {
                above.box.add(l, u);
                above.centers.add(c, c);
                if (--j > i) {
                    const __m128 ol = lowerOf(at[j]), ou = upperOf(at[j]);
                    _mm_store_ps(at[j].lower, l);
                    _mm_store_ps(at[j].upper, u);
                    _mm_store_ps(r.lower, ol);
                    _mm_store_ps(r.upper, ou);
                }
            }
        }
        below.begin = range.begin;
        below.end = above.begin = i;
        above.end = range.end;
    }

    static void partitionAcross(const Reference* from, Reference* to, const Range& range,
                                const Cut& cut, Range& below, Range& above) {
        const std::size_t chunks = (range.size() + kChunk - 1) / kChunk;
        std::vector<Range> belows(chunks), aboves(chunks);
        overChunks(range.begin, range.end,
                   [&](std::uint32_t first, std::uint32_t last, std::size_t i) {
                       std::uint32_t count = 0;
                       for (std::uint32_t k = first; k < last; ++k)
                           count += twiceCenter(from[k], cut.axis) < cut.plane;
                       belows[i].end = count;
                       aboves[i].end = last - first - count;
                   });
        std::uint32_t at = range.begin;
        for (auto* parts : {&belows, &aboves}) {
            for (Range& part : *parts) {
                part.begin = at;
                at += part.end;
            }
            if (parts == &belows) above.begin = below.end = at;
        }
        below.begin = range.begin;
        above.end = range.end;
        overChunks(range.begin, range.end,
                   [&](std::uint32_t first, std::uint32_t last, std::size_t i) {
                       Range &b = belows[i], &a = aboves[i];
                       std::uint32_t nextBelow = b.begin, nextAbove = a.begin;
                       for (std::uint32_t k = first; k < last; ++k) {
                           const __m128 l = lowerOf(from[k]), u = upperOf(from[k]);
                           const __m128 c = _mm_add_ps(l, u);
                           const bool isBelow = twiceCenter(from[k], cut.axis) < cut.plane;
                           Range& side = isBelow ? b : a;
                           side.box.add(l, u);
                           side.centers.add(c, c);
                           Reference& r = to[isBelow ? nextBelow++ : nextAbove++];
                           _mm_store_ps(r.lower, l);
                           _mm_store_ps(r.upper, u);
                       }
                   });
        for (std::size_t i = 0; i < chunks; ++i) {
            below.box.add(belows[i].box);
            below.centers.add(belows[i].centers);
            above.box.add(aboves[i].box);
            above.centers.add(aboves[i].centers);
        }
    }

    /// More spheres than it is worth to leave together: the box of several is mostly empty.
    static bool areLooseSpheres(const Range& range, const Reference* from) {
        if (range.size() <= kLeastCutOfSpheres) return false;
        for (std::uint32_t i = range.begin; i < range.end; ++i)
            if (from[i].kind != static_cast<std::uint32_t>(geometry::Kind::sphere)) return false;
        return true;
    }

    bool mayCut(const Range& range, const Reference* from, int depth) const {
        if (depth >= kMaxDepth || (range.size() <= leastCut_ && !areLooseSpheres(range, from)))
            return false;
        alignas(16) float side[4];
        _mm_store_ps(side, _mm_sub_ps(range.box.upper, range.box.lower));
        return side[0] > minSize_ || side[1] > minSize_ || side[2] > minSize_;
    }

    /// `from`: where the range's references are now, one of the two arrays.
    std::uint32_t build(const Range& range, Reference* from, int depth, Handful& handful) {
        const std::uint32_t index = newCell(handful);
        Cell& cell = cells_.cells_[index];
        alignas(16) float lower[4], upper[4];
        _mm_store_ps(lower, range.box.lower);
        _mm_store_ps(upper, range.box.upper);
        for (int a = 0; a < 3; ++a) {
            cell.lower[a] = lower[a];
            cell.upper[a] = upper[a];
        }
        cell.begin = range.begin;
        cell.end = range.end;
        cell.below = cell.above = kNoCell;
        cell.open = range.open;

        Range below, above;
        Reference* sorted = from;
        Cut cut;
        if (mayCut(range, from, depth)) cut = separate(range, from, sorted, depth, below, above);
        if (cut) {
            cell.axis = static_cast<std::uint8_t>(cut.axis);
            cell.plane = cut.plane / 2;
            const auto left =
                static_cast<std::uint8_t>(range.open >> cut.axis & 1 ? range.open : 7);
            const auto open = static_cast<std::uint8_t>(left & ~(1 << cut.axis));
            below.open = above.open = open ? open : 7;
            std::uint32_t b, a;
            if (std::min(below.size(), above.size()) > kTaskSize) {
                parallel::invoke([&] { b = build(below, sorted, depth + 1, handful); },
                                 [&] {
                                     Handful own;
                                     a = build(above, sorted, depth + 1, own);
                                 });
            } else {
                b = build(below, sorted, depth + 1, handful);
                a = build(above, sorted, depth + 1, handful);
            }
            cell.below = b;
            cell.above = a;
        } else if (from != references_) {
            std::copy(from + range.begin, from + range.end, references_ + range.begin);
        }
        merge(cell, range.box.area());
        return index;
    }

    /// Cuts the range once: on an axis that this level has left, or, where all centres agree on those,
    /// on one of the next level. No cut when all centres coincide.
    Cut separate(Range range, Reference* from, Reference*& sorted, int depth, Range& below,
                 Range& above) {
        Cut cut = chooseCut(range, from, depth);
        if (!cut) {
            range.open = 7;
            cut = chooseCut(range, from, depth);
        }
        if (!cut) return cut;
        partition(range, from, cut, sorted, below, above);
        if (below.size() == 0 ||
            above.size() == 0) { // rounding put the plane on the outermost centre
            range.open = static_cast<std::uint8_t>(1 << cut.axis);
            cut = medianCut(range, from);
            partition(range, from, cut, sorted, below, above);
        }
        return cut;
    }

    Cut chooseCut(const Range& range, const Reference* from, int depth) const {
        const Cut cut = depth < kBalancedDepth ? cheapestCut(range, from) : Cut();
        return cut ? cut : medianCut(range, from);
    }

    void partition(const Range& range, Reference* from, const Cut& cut, Reference*& sorted,
                   Range& below, Range& above) {
        below = above = Range();
        if (range.size() > kChunk) {
            sorted = from == references_ ? other_.get() : references_;
            partitionAcross(from, sorted, range, cut, below, above);
        } else {
            sorted = from;
            partitionInPlace(from, range, cut, below, above);
        }
    }

    /// Cost of a cell as a leaf, per unit of area: blocks and custom calls, in node visits.
    float leafCost(const Cell& cell) const {
        if (cell.sharesBlock) return blockCost_;
        std::uint32_t count[4] = {};
        for (std::uint32_t i = cell.begin; i < cell.end; ++i) ++count[references_[i].kind];
        float cost = kCustomCost * static_cast<float>(count[3]);
        for (int kind = 0; kind < 3; ++kind)
            cost += blockCost_ * static_cast<float>((count[kind] + kLanes - 1) / kLanes);
        return cost;
    }

    /// Cheapest way to put the cell's subtree into n slots of a node, for every n [Ylitie, Karras,
    /// Laine 2017], under the surface area heuristic with one node visit as the unit.
    void merge(Cell& cell, float area) const {
        const std::uint32_t size = cell.end - cell.begin;
        const bool leafAllowed = size <= maxObjects_ || !cell.isCut();
        // What does not fit from one side does not fit with the other.
        const bool mayShare = !cell.isCut() || (cells_.cells_[cell.below].sharesBlock &&
                                                cells_.cells_[cell.above].sharesBlock);
        cell.sharesBlock =
            leafAllowed && mayShare &&
            sharesBlock(primitives_, references_ + cell.begin, references_ + cell.end);
        const float leaf = leafAllowed ? area * leafCost(cell) : kInfinityF32;
        if (!cell.isCut()) {
            for (int n = 0; n < kNodeChildren; ++n) {
                cell.cost[n] = leaf;
                cell.split[n] = 0;
            }
            return;
        }
        const Cell& b = cells_.cells_[cell.below];
        const Cell& a = cells_.cells_[cell.above];
        float spread[kNodeChildren];
        std::uint8_t toBelow[kNodeChildren];
        for (int n = 1; n < kNodeChildren; ++n) {
            spread[n] = kInfinityF32;
            toBelow[n] = 1;
            for (int k = 0; k < n; ++k) {
                const float cost = b.cost[k] + a.cost[n - 1 - k];
                if (cost < spread[n]) {
                    spread[n] = cost;
                    toBelow[n] = static_cast<std::uint8_t>(k + 1);
                }
            }
        }
        const float node = spread[kNodeChildren - 1] + area * kNodeCost;
        cell.cost[0] = std::min(leaf, node);
        cell.split[0] = leaf <= node ? 0 : toBelow[kNodeChildren - 1];
        for (int n = 1; n < kNodeChildren; ++n) {
            const bool better = spread[n] < cell.cost[n - 1];
            cell.cost[n] = better ? spread[n] : cell.cost[n - 1];
            cell.split[n] = better ? toBelow[n] : 0;
        }
    }

    Cells& cells_;
    const geometry::Primitives& primitives_;
    Reference* const references_;
    std::unique_ptr<Reference[]> other_;
    const std::uint32_t leastCut_;
    const int bins_;
    const float blockCost_;
    const std::uint32_t maxObjects_;
    const float minSize_;
    std::atomic<std::uint32_t> cellCount_{0};
};

Cells::Cells(const geometry::Primitives& primitives, std::unique_ptr<Reference[]> references,
             std::uint32_t count, double scale, const BuildOptions& options)
    : references_(std::move(references)) {
    if (count == 0) return;
    // At most 2n − 1 cells, and what tasks take too many: there are fewer than n / kTaskSize of them.
    // The pages of unused ones are never touched.
    const std::size_t capacity =
        2 * static_cast<std::size_t>(count) + kHandful * (count / kTaskSize + 1);
    cells_ = static_cast<Cell*>(std::malloc(capacity * sizeof(Cell)));
    if (!cells_) throw std::bad_alloc();
    Builder builder(*this, primitives, count, scale, options);
    root_ = builder.root(count);
}

Cells::~Cells() { std::free(cells_); }

void Cells::gather(std::uint32_t index, int slots, std::uint32_t* children, int& count) const {
    const Cell& cell = cells_[index];
    // Fewer slots do as well where the cost is the same.
    while (slots > 1 && cell.split[slots - 1] == 0) --slots;
    if (slots == 1) {
        children[count++] = index;
        return;
    }
    gather(cell.below, cell.split[slots - 1], children, count);
    gather(cell.above, slots - cell.split[slots - 1], children, count);
}

int Cells::childrenOf(std::uint32_t index, std::uint32_t children[kNodeChildren]) const {
    const Cell& cell = cells_[index];
    int count = 0;
    if (isLeaf(index)) { // a root that is a leaf
        children[count++] = index;
        return count;
    }
    gather(cell.below, cell.split[0], children, count);
    gather(cell.above, kNodeChildren - cell.split[0], children, count);
    return count;
}

} // namespace rt::octree
