#include <core/octree/emit.hpp>

#include <core/geometry/intersect.hpp>
#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <limits>
#include <type_traits>

namespace rt::octree {
namespace {

using geometry::Kind;
using geometry::PrimitiveId;
using geometry::Primitives;
using geometry::Vec3;

constexpr std::uint32_t kJobSize = 8192; // cells of fewer primitives are emitted by one thread
constexpr float kInfinityF32 = std::numeric_limits<float>::infinity();
constexpr double kUnused = std::numeric_limits<double>::quiet_NaN();

/// How many of each array something takes, or where it starts in each.
struct Extent {
    std::uint32_t nodes = 0, shared = 0, triangles = 0, narrowShared = 0, narrowTriangles = 0,
                  narrowIds = 0, spheres = 0, parallelograms = 0, records = 0, runs = 0,
                  customs = 0;

    Extent& operator+=(const Extent& o) {
        nodes += o.nodes;
        shared += o.shared;
        triangles += o.triangles;
        narrowShared += o.narrowShared;
        narrowTriangles += o.narrowTriangles;
        narrowIds += o.narrowIds;
        spheres += o.spheres;
        parallelograms += o.parallelograms;
        records += o.records;
        runs += o.runs;
        customs += o.customs;
        return *this;
    }
};

std::uint32_t blocksFor(std::uint32_t count) { return (count + kLanes - 1) / kLanes; }

/// A leaf's primitives, by kind and within a kind by id; customs by shape.
struct LeafContents {
    std::vector<std::uint32_t> ids[3];
    struct Custom {
        std::uint32_t shape, primitive, id;
    };
    std::vector<Custom> customs;

    void fill(const Reference* first, const Reference* last, const Primitives& primitives) {
        for (auto& list : ids) list.clear();
        customs.clear();
        for (const Reference* r = first; r != last; ++r) {
            if (r->kind != static_cast<std::uint32_t>(Kind::custom)) {
                ids[r->kind].push_back(r->id);
                continue;
            }
            const auto& segment = primitives.segmentOf(PrimitiveId{r->id});
            const auto& custom =
                primitives.customs
                    .primitives[segment.index + r->id - static_cast<std::uint32_t>(segment.first)];
            customs.push_back({custom.shape, custom.primitive, r->id});
        }
        for (auto& list : ids) std::sort(list.begin(), list.end());
        std::sort(customs.begin(), customs.end(), [](const Custom& a, const Custom& b) {
            return a.shape != b.shape ? a.shape < b.shape : a.id < b.id;
        });
    }

    Extent extent() const {
        Extent e;
        e.triangles = blocksFor(static_cast<std::uint32_t>(ids[0].size()));
        e.spheres = blocksFor(static_cast<std::uint32_t>(ids[1].size()));
        e.parallelograms = blocksFor(static_cast<std::uint32_t>(ids[2].size()));
        e.customs = static_cast<std::uint32_t>(customs.size());
        for (std::size_t i = 0; i < customs.size(); ++i)
            e.runs += i == 0 || customs[i].shape != customs[i - 1].shape;
        e.records = e.triangles + e.spheres + e.parallelograms != 1 || e.runs != 0;
        return e;
    }
};

class Emitter {
public:
    Emitter(const Cells& cells, const Primitives& primitives, Storage storage, Tree& tree)
        : cells_(cells), primitives_(primitives), storage_(storage), tree_(tree) {}

    void run(const std::vector<Reference>& unbounded) {
        LeafContents rest;
        rest.fill(unbounded.data(), unbounded.data() + unbounded.size(), primitives_);
        Extent total = rest.extent();
        total.records = 0;
        Extent top; // the nodes above the jobs come first
        if (cells_.root() != kNoCell) {
            collectJobs(cells_.root(), top);
            parallel::forEach(jobs_.size(), 0, [&](std::size_t i) {
                LeafContents contents;
                jobs_[i].extent = measure(jobs_[i].cell, contents);
            });
        }
        Extent at = total;
        at += top;
        for (Job& job : jobs_) {
            const Extent own = job.extent;
            job.extent = at;
            at += own;
        }
        tree_.nodes = Array<Node>(at.nodes);
        tree_.shared = Array<SharedBlock>(at.shared);
        tree_.triangles = Array<TriangleBlock>(at.triangles);
        tree_.narrowShared = Array<NarrowSharedBlock>(at.narrowShared);
        tree_.narrowTriangles = Array<NarrowTriangleBlock>(at.narrowTriangles);
        tree_.narrowIds = Array<std::uint32_t>(at.narrowIds);
        tree_.spheres = Array<SphereBlock>(at.spheres);
        tree_.parallelograms = Array<ParallelogramBlock>(at.parallelograms);
        tree_.records = Array<LeafRecord>(at.records);
        tree_.runs = Array<CustomRun>(at.runs);
        tree_.customPrimitives = Array<std::uint32_t>(at.customs);
        tree_.customIds = Array<std::uint32_t>(at.customs);
        Extent start;
        tree_.unbounded = emitRecord(rest, start);
        if (cells_.root() == kNoCell) return;
        start.nodes = 0;
        LeafContents contents;
        std::size_t nextJob = 0;
        emitTop(cells_.root(), start, contents, nextJob);
        parallel::forEach(jobs_.size(), 0, [&](std::size_t i) {
            LeafContents own;
            Extent from = jobs_[i].extent;
            emitNode(jobs_[i].cell, from, own);
        });
    }

private:
    struct Job {
        std::uint32_t cell;
        Extent extent;
    };

    bool isJob(std::uint32_t cell) const {
        return !cells_.isLeaf(cell) && cells_[cell].end - cells_[cell].begin <= kJobSize;
    }

    void collectJobs(std::uint32_t cell, Extent& top) {
        LeafContents contents;
        ++top.nodes;
        std::uint32_t children[kNodeChildren];
        const int count = cells_.childrenOf(cell, children);
        for (int i = 0; i < count; ++i) {
            if (cells_.isLeaf(children[i]))
                top += measureLeaf(children[i], contents);
            else if (isJob(children[i]))
                jobs_.push_back({children[i], {}});
            else
                collectJobs(children[i], top);
        }
    }

    Extent measureLeaf(std::uint32_t cell, LeafContents& contents) const {
        const Reference* const first = cells_.references() + cells_[cell].begin;
        const std::uint32_t count = cells_[cell].end - cells_[cell].begin;
        if (cells_[cell].sharesBlock) {
            Extent e;
            if (isNarrow(first, count)) {
                e.narrowShared = 1;
                e.narrowIds = count;
            } else {
                e.shared = 1;
            }
            return e;
        }
        if (count <= kLanes && sameKind(first, count)) {
            Extent e;
            switch (static_cast<Kind>(first->kind)) {
            case Kind::triangle:
                (isNarrow(first, count) ? e.narrowTriangles : e.triangles) = 1;
                break;
            case Kind::sphere:
                e.spheres = 1;
                break;
            default:
                e.parallelograms = 1;
            }
            return e;
        }
        contents.fill(first, first + count, primitives_);
        return contents.extent();
    }

    static bool sameKind(const Reference* first, std::uint32_t count) {
        if (first->kind == static_cast<std::uint32_t>(Kind::custom)) return false;
        for (std::uint32_t i = 1; i < count; ++i)
            if (first[i].kind != first->kind) return false;
        return true;
    }

    /// Does f32 hold all corners of these triangles exactly?
    bool isNarrow(const Reference* first, std::uint32_t count) const {
        if (storage_ == Storage::f64) return false;
        const auto& triangles = primitives_.triangles;
        for (std::uint32_t i = 0; i < count; ++i)
            for (const std::uint32_t corner : triangles.indices[indexOf(first[i].id)])
                if (!numeric::fitsF32(triangles.positions[corner])) return false;
        return true;
    }

    Extent measure(std::uint32_t cell, LeafContents& contents) const {
        Extent extent;
        extent.nodes = 1;
        std::uint32_t children[kNodeChildren];
        const int count = cells_.childrenOf(cell, children);
        for (int i = 0; i < count; ++i)
            extent += cells_.isLeaf(children[i]) ? measureLeaf(children[i], contents)
                                                 : measure(children[i], contents);
        return extent;
    }

    /// Each child's octant of the node, as nearly as all can have their own: greedily, then by swaps.
    void assignSlots(const Cell& node, const std::uint32_t* children, int count, int* slot) const {
        float weight[kNodeChildren]
                    [kNodeChildren]; // [child][slot]: how far toward the slot's corner
        for (int i = 0; i < count; ++i) {
            const Cell& child = cells_[children[i]];
            float c[3];
            for (int a = 0; a < 3; ++a)
                c[a] = (child.lower[a] + child.upper[a]) - (node.lower[a] + node.upper[a]);
            for (int s = 0; s < kNodeChildren; ++s)
                weight[i][s] =
                    (s & 1 ? c[0] : -c[0]) + (s & 2 ? c[1] : -c[1]) + (s & 4 ? c[2] : -c[2]);
        }
        unsigned freeChildren = (1u << count) - 1, freeSlots = 255;
        while (freeChildren) {
            float best = -kInfinityF32;
            int child = __builtin_ctz(freeChildren), at = __builtin_ctz(freeSlots);
            for (unsigned m = freeChildren; m; m &= m - 1)
                for (unsigned n = freeSlots; n; n &= n - 1) {
                    const int i = __builtin_ctz(m), s = __builtin_ctz(n);
                    if (weight[i][s] > best) {
                        best = weight[i][s];
                        child = i;
                        at = s;
                    }
                }
            slot[child] = at;
            freeChildren &= ~(1u << child);
            freeSlots &= ~(1u << at);
        }
        for (int round = 0; round < 4; ++round) {
            bool changed = false;
            for (int i = 0; i < count; ++i)
                for (int j = 0; j < i; ++j)
                    if (weight[i][slot[j]] + weight[j][slot[i]] >
                        weight[i][slot[i]] + weight[j][slot[j]]) {
                        std::swap(slot[i], slot[j]);
                        changed = true;
                    }
            if (!changed) break;
        }
    }

    static void clear(Node& node) {
        for (int row = 0; row < 6; ++row)
            for (int i = 0; i < kLanes; ++i)
                node.planes[row][i] = row & 1 ? -kInfinityF32 : kInfinityF32;
        for (int i = 0; i < kLanes; ++i) {
            node.child[i] = kEmptyChild;
            node.spare[i] = 0;
        }
    }

    void setBox(Node& node, int slot, const Cell& cell) const {
        for (int a = 0; a < 3; ++a) {
            node.planes[2 * a][slot] = cell.lower[a];
            node.planes[2 * a + 1][slot] = cell.upper[a];
        }
    }

    /// As emitNode for the nodes above the jobs.
    std::uint32_t emitTop(std::uint32_t cell, Extent& at, LeafContents& contents,
                          std::size_t& nextJob) {
        const std::uint32_t index = at.nodes++;
        Node& node = tree_.nodes[index];
        clear(node);
        std::uint32_t children[kNodeChildren];
        int slot[kNodeChildren];
        const int count = cells_.childrenOf(cell, children);
        assignSlots(cells_[cell], children, count, slot);
        for (int i = 0; i < count; ++i) {
            setBox(node, slot[i], cells_[children[i]]);
            node.child[slot[i]] = cells_.isLeaf(children[i]) ? emitLeaf(children[i], at, contents)
                                  : isJob(children[i])
                                      ? jobs_[nextJob++].extent.nodes
                                      : emitTop(children[i], at, contents, nextJob);
        }
        return index;
    }

    std::uint32_t emitNode(std::uint32_t cell, Extent& at, LeafContents& contents) {
        const std::uint32_t index = at.nodes++;
        Node& node = tree_.nodes[index];
        clear(node);
        std::uint32_t children[kNodeChildren];
        int slot[kNodeChildren];
        const int count = cells_.childrenOf(cell, children);
        assignSlots(cells_[cell], children, count, slot);
        for (int i = 0; i < count; ++i) {
            setBox(node, slot[i], cells_[children[i]]);
            node.child[slot[i]] = cells_.isLeaf(children[i]) ? emitLeaf(children[i], at, contents)
                                                             : emitNode(children[i], at, contents);
        }
        return index;
    }

    static std::uint32_t leafReference(LeafKind kind, std::uint32_t index) {
        return kLeaf | static_cast<std::uint32_t>(kind) << kLeafKindShift | index;
    }

    std::uint32_t emitLeaf(std::uint32_t cell, Extent& at, LeafContents& contents) {
        const Reference* const first = cells_.references() + cells_[cell].begin;
        const std::uint32_t count = cells_[cell].end - cells_[cell].begin;
        if (cells_[cell].sharesBlock) {
            if (isNarrow(first, count)) {
                NarrowSharedBlock& block = tree_.narrowShared[at.narrowShared];
                fillShared(block, tree_.narrowIds.data() + at.narrowIds, count, first, count);
                block.ids = at.narrowIds;
                at.narrowIds += count;
                return leafReference(kNarrowSharedLeaf, at.narrowShared++);
            }
            SharedBlock& block = tree_.shared[at.shared];
            fillShared(block, block.id, kSharedLanes, first, count);
            return leafReference(kSharedLeaf, at.shared++);
        }
        if (count <= kLanes && sameKind(first, count)) {
            std::uint32_t ids[kLanes];
            for (std::uint32_t i = 0; i < count; ++i) ids[i] = first[i].id;
            std::sort(ids, ids + count);
            switch (static_cast<Kind>(first->kind)) {
            case Kind::triangle:
                if (isNarrow(first, count)) {
                    fillTriangles(tree_.narrowTriangles[at.narrowTriangles], ids, count);
                    return leafReference(kNarrowTriangleLeaf, at.narrowTriangles++);
                }
                fillTriangles(tree_.triangles[at.triangles], ids, count);
                return leafReference(kTriangleLeaf, at.triangles++);
            case Kind::sphere:
                fillSpheres(tree_.spheres[at.spheres], ids, count);
                return leafReference(kSphereLeaf, at.spheres++);
            default:
                fillParallelograms(tree_.parallelograms[at.parallelograms], ids, count);
                return leafReference(kParallelogramLeaf, at.parallelograms++);
            }
        }
        contents.fill(first, first + count, primitives_);
        const std::uint32_t record = at.records++;
        tree_.records[record] = emitRecord(contents, at);
        return leafReference(kMixedLeaf, record);
    }

    LeafRecord emitRecord(const LeafContents& contents, Extent& at) {
        const Extent extent = contents.extent();
        const LeafRecord record{at.triangles,   extent.triangles,  at.spheres,
                                extent.spheres, at.parallelograms, extent.parallelograms,
                                at.runs,        extent.runs};
        eachBlock(contents.ids[0], [&](const std::uint32_t* ids, std::uint32_t n) {
            fillTriangles(tree_.triangles[at.triangles++], ids, n);
        });
        eachBlock(contents.ids[1], [&](const std::uint32_t* ids, std::uint32_t n) {
            fillSpheres(tree_.spheres[at.spheres++], ids, n);
        });
        eachBlock(contents.ids[2], [&](const std::uint32_t* ids, std::uint32_t n) {
            fillParallelograms(tree_.parallelograms[at.parallelograms++], ids, n);
        });
        for (std::size_t i = 0; i < contents.customs.size(); ++i) {
            const auto& custom = contents.customs[i];
            if (i == 0 || custom.shape != contents.customs[i - 1].shape)
                tree_.runs[at.runs++] = {custom.shape, at.customs, 0};
            ++tree_.runs[at.runs - 1].count;
            tree_.customPrimitives[at.customs] = custom.primitive;
            tree_.customIds[at.customs++] = custom.id;
        }
        return record;
    }

    template <class Fill>
    static void eachBlock(const std::vector<std::uint32_t>& ids, const Fill& fill) {
        for (std::size_t i = 0; i < ids.size(); i += kLanes)
            fill(ids.data() + i,
                 static_cast<std::uint32_t>(std::min<std::size_t>(kLanes, ids.size() - i)));
    }

    std::uint32_t indexOf(std::uint32_t id) const { return indexInKind(primitives_, id); }

    /// `id`: room for `idLanes` ids; those beyond `count` are marked as unused.
    template <class Block>
    void fillShared(Block& block, std::uint32_t* id, std::uint32_t idLanes, const Reference* first,
                    std::uint32_t count) const {
        using Float = std::remove_reference_t<decltype(block.corner[0][0])>;
        std::uint32_t ids[kSharedLanes];
        for (std::uint32_t i = 0; i < count; ++i) ids[i] = first[i].id;
        std::sort(ids, ids + count);
        for (std::uint32_t i = 0; i < idLanes; ++i) id[i] = i < count ? ids[i] : kEmptyChild;
        CornerSet corners;
        block.valid = (1u << count) - 1;
        for (auto& word : block.spare) word = 0;
        for (std::uint32_t lane = 0; lane < kSharedLanes; ++lane)
            for (std::size_t c = 0; c < 3; ++c)
                block.index[c][lane] =
                    lane < count ? static_cast<std::uint8_t>(corners.add(
                                       primitives_.triangles.indices[indexOf(ids[lane])][c]))
                                 : std::uint8_t{0};
        for (int i = 0; i < kSharedLanes; ++i) {
            // Unused corners repeat the first: lanes must not meet NaN where none is needed.
            const Vec3& p = primitives_.triangles.positions[corners.at(i < corners.size() ? i : 0)];
            for (int a = 0; a < 3; ++a) block.corner[a][i] = static_cast<Float>(p[a]);
        }
    }

    static void clearSpare(TriangleBlock& block) {
        for (auto& word : block.spare) word = 0;
    }
    static void clearSpare(NarrowTriangleBlock&) {}

    template <class Block>
    void fillTriangles(Block& block, const std::uint32_t* ids, std::uint32_t count) const {
        using Float = std::remove_reference_t<decltype(block.corner[0][0][0])>;
        const auto& triangles = primitives_.triangles;
        clearSpare(block);
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
            block.id[lane] = lane < count ? ids[lane] : kEmptyChild;
            if (lane < count) {
                const auto& corners = triangles.indices[indexOf(ids[lane])];
                for (std::size_t c = 0; c < 3; ++c)
                    for (int a = 0; a < 3; ++a)
                        block.corner[c][a][lane] =
                            static_cast<Float>(triangles.positions[corners[c]][a]);
            } else {
                for (auto& corner : block.corner)
                    for (auto& row : corner) row[lane] = std::numeric_limits<Float>::quiet_NaN();
            }
        }
    }

    void fillSpheres(SphereBlock& block, const std::uint32_t* ids, std::uint32_t count) const {
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
            block.id[lane] = lane < count ? ids[lane] : kEmptyChild;
            block.spare[lane] = 0;
            const geometry::Sphere sphere = lane < count ? primitives_.spheres[indexOf(ids[lane])]
                                                         : geometry::Sphere{Vec3(kUnused), kUnused};
            block.center[0][lane] = sphere.center.x;
            block.center[1][lane] = sphere.center.y;
            block.center[2][lane] = sphere.center.z;
            block.radius[lane] = sphere.radius;
        }
    }

    void fillParallelograms(ParallelogramBlock& block, const std::uint32_t* ids,
                            std::uint32_t count) const {
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
            block.id[lane] = lane < count ? ids[lane] : kEmptyChild;
            block.spare[lane] = 0;
            std::array<Vec3, 4> corners;
            corners.fill(Vec3(kUnused));
            if (lane < count)
                corners = geometry::cornersOf(primitives_.parallelograms[indexOf(ids[lane])]);
            for (std::size_t c = 0; c < 4; ++c) {
                block.corner[c][0][lane] = corners[c].x;
                block.corner[c][1][lane] = corners[c].y;
                block.corner[c][2][lane] = corners[c].z;
            }
        }
    }

    const Cells& cells_;
    const Primitives& primitives_;
    const Storage storage_;
    Tree& tree_;
    std::vector<Job> jobs_;
};

} // namespace

Tree emit(const Cells& cells, const std::vector<Reference>& unbounded, const Primitives& primitives,
          Storage storage) {
    Tree tree;
    Emitter(cells, primitives, storage, tree).run(unbounded);
    return tree;
}

} // namespace rt::octree
