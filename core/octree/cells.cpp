#include <core/octree/cells.hpp>

#include <core/octree/cut.hpp>
#include <core/octree/prefetch.hpp>

#include <algorithm>
#include <atomic>
#include <limits>
#include <numeric>
#include <vector>

namespace rt::octree {
namespace {

constexpr std::uint32_t kTaskSize = 2048; // smaller cells are built by one thread
constexpr std::uint32_t kHandful = 256;   // cells that a task takes at a time
// octree_bench: with 4, random spheres are 8 % slower, and the soup a fifth, with a fifth fewer bytes.
constexpr std::uint32_t kLeastCutOfLoose = 2;
constexpr int kBalancedDepth = 64; // from here on cells are cut at the median
constexpr float kInfinityF32 = std::numeric_limits<float>::infinity();

/// Two cells in n + 2 slots: what that costs at least, and how many of the slots the first one gets then.
struct Spread {
    alignas(16) float cost[kNodeChildren];
    alignas(16) std::int32_t toBelow[kNodeChildren];

    Spread(const float (&below)[kNodeChildren - 1], const float (&above)[kNodeChildren - 1]) {
        // after[kNodeChildren − 1 + k]: of the second one in k + 1 slots
        float after[3 * kNodeChildren];
        for (float& x : after) x = kInfinityF32;
        std::ranges::copy(above, after + kNodeChildren - 1);
        for (int half = 0; half < kNodeChildren; half += 4) {
            __m128 least = _mm_set1_ps(kInfinityF32);
            __m128i first = _mm_set1_epi32(1);
            for (int k = 0; k < kNodeChildren - 1; ++k) {
                const __m128 sum = _mm_add_ps(_mm_set1_ps(below[k]),
                                              _mm_loadu_ps(after + kNodeChildren - 1 + half - k));
                const __m128i better = _mm_castps_si128(_mm_cmplt_ps(sum, least));
                least = _mm_min_ps(sum, least);
                first = _mm_or_si128(_mm_and_si128(better, _mm_set1_epi32(k + 1)),
                                     _mm_andnot_si128(better, first));
            }
            _mm_store_ps(cost + half, least);
            _mm_store_si128(reinterpret_cast<__m128i*>(toBelow + half), first);
        }
    }
};

} // namespace

bool sharesBlock(const geometry::Primitives& primitives, const Reference* first,
                 const Reference* last) {
    if (last - first > kSharedLanes) return false;
    for (const Reference* r = first; r != last; ++r)
        if (r->kind != static_cast<std::uint32_t>(geometry::Kind::triangle)) return false;
    if (last - first <= kSharedLanes / 3) return true;
    for (const Reference* r = first; r != last; ++r)
        prefetchLines(primitives.triangles.indices[indexInKind(primitives, r->id)]);
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
        : cells_(cells), primitives_(primitives), references_(cells.references_.data()),
          leastCut_(
              std::min(std::max(1u, options.tuning.leastCut), std::max(1u, options.maxObjects))),
          bins_(std::clamp(options.tuning.bins, 2, kMostBins)),
          fill_(options.simd == Simd::baseline ? baseline::fillBins : avx2::fillBins),
          blockCost_(options.tuning.blockCost), maxObjects_(std::max(1u, options.maxObjects)),
          minSize_(static_cast<float>(options.minSize * scale)) {
        other_.resize(count);
    }

    std::uint32_t root(std::uint32_t count) {
        struct Bounds {
            Box box, centers;
        };
        std::vector<Bounds> parts((count + kChunk - 1) / kChunk);
        overChunks(0, count, [&](std::uint32_t first, std::uint32_t last, std::size_t i) {
            for (std::uint32_t k = first; k < last; ++k) {
                const __m128 center = twiceCenter(references_[k]);
                parts[i].box.add(boxOf(references_[k]));
                parts[i].centers.add(center, center);
            }
        });
        Range all{{}, {}, 0, count, 7};
        for (const Bounds& part : parts) {
            all.box.add(part.box);
            all.centers.add(part.centers);
        }
        Handful handful;
        return build(all, references_, false, 0, handful);
    }

private:
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

    /// Around the doubled centres on both sides of a cut.
    struct Sides {
        Box below, above;
    };

    /// Both sides keep their order.
    static Sides partition(const Range& range, const Cut& cut, const Reference* from,
                           Reference* to) {
        const auto move = [&](std::uint32_t first, std::uint32_t last, std::uint32_t below,
                              std::uint32_t above) {
            Sides sides;
            for (std::uint32_t k = first; k < last; ++k) {
                const __m128 l = lowerOf(from[k]), u = upperOf(from[k]), center = _mm_add_ps(l, u);
                // Which side it is nobody can foretell: no branch may depend on it.
                const std::uint32_t isBelow = cut.isBelow(from[k]), side = 0 - isBelow;
                Reference& r = to[(below & side) | (above & ~side)];
                below += isBelow;
                above += 1 - isBelow;
                _mm_store_ps(r.lower, l);
                _mm_store_ps(r.upper, u);
                // NaN on the other side, which these leave out.
                const auto add = [&](Box& box, std::uint32_t isOther) {
                    const __m128 c = _mm_or_ps(
                        center, _mm_castsi128_ps(_mm_set1_epi32(static_cast<int>(isOther))));
                    box.lower = _mm_min_ps(c, box.lower);
                    box.upper = _mm_max_ps(c, box.upper);
                };
                add(sides.below, ~side);
                add(sides.above, side);
            }
            return sides;
        };
        if (range.size() <= kChunk)
            return move(range.begin, range.end, range.begin, range.begin + cut.below);
        std::vector<std::uint32_t> belows(cut.belowOfChunk.size()); // where each chunk's go
        std::exclusive_scan(cut.belowOfChunk.begin(), cut.belowOfChunk.end(), belows.begin(),
                            range.begin);
        std::vector<Sides> parts(belows.size());
        overChunks(range.begin, range.end,
                   [&](std::uint32_t first, std::uint32_t last, std::size_t i) {
                       parts[i] = move(first, last, belows[i],
                                       range.begin + cut.below + (first - range.begin) -
                                           (belows[i] - range.begin));
                   });
        Sides all;
        for (const Sides& part : parts) {
            all.below.add(part.below);
            all.above.add(part.above);
        }
        return all;
    }

    /// More than it is worth to leave together: spheres, or triangles of which no two share a corner. The box
    /// of several is mostly empty. `shared`: they lie in a cell that is one shared block.
    bool areLoose(const Range& range, const Reference* from, bool shared) const {
        if (range.size() <= kLeastCutOfLoose || shared) return false;
        const std::uint32_t kind = from[range.begin].kind;
        for (std::uint32_t i = range.begin; i < range.end; ++i)
            if (from[i].kind != kind) return false;
        if (kind == static_cast<std::uint32_t>(geometry::Kind::sphere)) return true;
        if (kind != static_cast<std::uint32_t>(geometry::Kind::triangle)) return false;
        CornerSet corners;
        for (std::uint32_t i = range.begin; i < range.end; ++i)
            for (const std::uint32_t c :
                 primitives_.triangles.indices[indexInKind(primitives_, from[i].id)])
                corners.add(c);
        return corners.size() == 3 * static_cast<int>(range.size());
    }

    bool mayCut(const Range& range, const Reference* from, int depth, bool shared) const {
        if (depth >= kMaxDepth || (range.size() <= leastCut_ && !areLoose(range, from, shared)))
            return false;
        alignas(16) float side[4];
        _mm_store_ps(side, _mm_sub_ps(range.box.upper, range.box.lower));
        return side[0] > minSize_ || side[1] > minSize_ || side[2] > minSize_;
    }

    /// `from`: where the range's references are now, one of the two arrays. `shares`: a cell around it is
    /// one shared block.
    std::uint32_t build(const Range& range, Reference* from, bool shares, int depth,
                        Handful& handful) {
        const std::uint32_t index = newCell(handful);
        const Handful mark = handful;
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
        const Reference *const first = from + range.begin, *const last = from + range.end;
        cell.sharesBlock = shares || octree::sharesBlock(primitives_, first, last);
        const float leaf =
            range.size() <= maxObjects_ ? leafCost(first, last, cell.sharesBlock) : kInfinityF32;
        Cut cut;
        // A leaf of one block of shared corners is not cut. When it was where that left less than 0.7 of its surface,
        // builds took 4 to 17 % longer, at equal speed (octree_bench: meshes, Zen 3).
        const bool isBlock = leaf <= blockCost_;
        const bool mayBeLoose = !cell.sharesBlock || range.size() <= kSharedLanes / 3;
        if ((mayBeLoose || !isBlock) && mayCut(range, from, depth, shares)) {
            cut = chooseCut(range, from, bins_, fill_, depth >= kBalancedDepth);
            if (isBlock && cut.belowBox.area() + cut.aboveBox.area() >= range.box.area())
                cut.axis = -1;
        }
        if (cut) {
            Reference* const to = from == references_ ? other_.data() : references_;
            const Sides centers = partition(range, cut, from, to);
            cell.axis = static_cast<std::uint8_t>(cut.axis);
            const unsigned left = (range.open >> cut.axis & 1 ? range.open : 7) & ~(1u << cut.axis);
            const unsigned open = left ? left : 7;
            const std::uint32_t middle = range.begin + cut.below;
            const Range below{cut.belowBox, centers.below, range.begin, middle, open},
                above{cut.aboveBox, centers.above, middle, range.end, open};
            std::uint32_t b, a;
            if (std::min(below.size(), above.size()) > kTaskSize) {
                parallel::invoke([&] { b = build(below, to, false, depth + 1, handful); },
                                 [&] {
                                     Handful own;
                                     a = build(above, to, false, depth + 1, own);
                                 });
            } else {
                b = build(below, to, cell.sharesBlock, depth + 1, handful);
                a = build(above, to, cell.sharesBlock, depth + 1, handful);
            }
            cell.below = b;
            cell.above = a;
            merge(cell, leaf, range.box.area());
            // Of what stays whole nobody needs the parts.
            if (!cell.isCut() && handful.last == mark.last) handful = mark;
        } else {
            makeWhole(cell,
                      range.box.area() *
                          (leaf < kInfinityF32 ? leaf : leafCost(first, last, cell.sharesBlock)));
            if (from != references_) std::copy(first, last, references_ + range.begin);
        }
        return index;
    }

    /// Cost of a leaf, per unit of area: blocks and custom calls, in node visits.
    float leafCost(const Reference* first, const Reference* last, bool shares) const {
        if (shares) return blockCost_;
        std::uint32_t count[4] = {};
        for (; first != last; ++first) ++count[first->kind];
        float cost = kCustomCost * static_cast<float>(count[3]);
        for (int kind = 0; kind < 3; ++kind)
            cost += blockCost_ * static_cast<float>((count[kind] + kLanes - 1) / kLanes);
        return cost;
    }

    static void makeWhole(Cell& cell, float cost) {
        cell.below = cell.above = kNoCell;
        for (float& c : cell.cost) c = cost;
        for (std::uint8_t& split : cell.split) split = 0;
    }

    /// Cheapest way to put the subtree of a cell that is cut into n slots of a node, for every n [Ylitie,
    /// Karras, Laine 2017], under the surface area heuristic with one node visit as the unit. Whole where
    /// that is cheapest in any number of slots.
    void merge(Cell& cell, float leafCost, float area) const {
        const Spread spread(cells_.cells_[cell.below].cost, cells_.cells_[cell.above].cost);
        // The area of what is 2^-75 of the scene is 0, and 0 · infinity no cost.
        const float leaf = leafCost < kInfinityF32 ? area * leafCost : kInfinityF32,
                    node = spread.cost[kNodeChildren - 2] + area * kNodeCost;
        cell.cost[0] = std::min(leaf, node);
        cell.split[0] =
            static_cast<std::uint8_t>(leaf <= node ? 0 : spread.toBelow[kNodeChildren - 2]);
        unsigned anySplit = cell.split[0];
        for (int n = 1; n < kNodeChildren - 1; ++n) {
            const bool better = spread.cost[n - 1] < cell.cost[n - 1];
            cell.cost[n] = better ? spread.cost[n - 1] : cell.cost[n - 1];
            cell.split[n] = static_cast<std::uint8_t>(better ? spread.toBelow[n - 1] : 0);
            anySplit |= cell.split[n];
        }
        if (!anySplit) makeWhole(cell, leaf);
    }

    Cells& cells_;
    const geometry::Primitives& primitives_;
    Reference* const references_;
    Array<Reference> other_;
    const std::uint32_t leastCut_;
    const int bins_;
    FillBins& fill_;
    const float blockCost_;
    const std::uint32_t maxObjects_;
    const float minSize_;
    std::atomic<std::uint32_t> cellCount_{0};
};

Cells::Cells(const geometry::Primitives& primitives, Array<Reference> references,
             std::uint32_t count, double scale, const BuildOptions& options)
    : references_(std::move(references)) {
    if (count == 0) return;
    // At most 2n − 1 cells, and what tasks take too many: there are fewer than n / kTaskSize of them.
    // The pages of unused ones are never touched.
    const std::size_t capacity =
        2 * static_cast<std::size_t>(count) + kHandful * (count / kTaskSize + 1);
    cells_.resize(capacity);
    Builder builder(*this, primitives, count, scale, options);
    root_ = builder.root(count);
}

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
