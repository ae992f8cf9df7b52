#include <core/octree/emit.hpp>

#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <limits>

namespace rt::octree {
namespace {

using geometry::Primitives;

/// Cells of at most so many primitives are emitted by one thread, after all larger ones, which are thus
/// close together: about 2000 nodes of a large tree, which any rays have in the cache.
std::uint32_t jobSizeOf(std::uint32_t primitives) {
    return std::clamp(primitives / 4096, 256u, 8192u);
}

constexpr std::uint32_t kWorthThreads = 16384; // primitives of a subtree
constexpr float kInfinityF32 = std::numeric_limits<float>::infinity();

class Emitter {
public:
    Emitter(const Cells& cells, const Primitives& primitives, const LeafFormat& format, Tree& tree)
        : cells_(cells), leaves_(primitives, format), tree_(tree) {}

    /// Appends the node made of `cell` and all below it; returns its index.
    std::uint32_t append(std::uint32_t cell, std::uint32_t parent, std::uint32_t slot) {
        jobSize_ = jobSizeOf(sizeOf(cell));
        Extent top; // the nodes above the jobs come first
        collectJobs(cell, top);
        parallel::forEach(jobs_.size(), 0, [&](std::size_t i) {
            LeafContents contents;
            jobs_[i].extent = measure(jobs_[i].cell, contents);
        });
        const Extent start = tree_.extent();
        Extent at = start;
        at += top;
        for (Job& job : jobs_) {
            const Extent own = job.extent;
            job.extent = at;
            at += own;
        }
        tree_.resize(at);
        at = start;
        LeafContents contents;
        nextJob_ = 0;
        const std::uint32_t root = emitNode<true>(cell, parent, slot, at, contents);
        parallel::forEach(jobs_.size(), 0, [&](std::size_t i) {
            LeafContents own;
            Job& job = jobs_[i];
            emitNode<false>(job.cell, job.parent, job.slot, job.extent, own);
        });
        for (std::uint32_t i = at.of[kNodes]; i-- > start.of[kNodes];) setHeight(i);
        return root;
    }

    std::uint32_t emit(std::uint32_t cell, std::uint32_t parent, std::uint32_t slot,
                       Places& places) {
        LeafContents contents;
        return cells_.isLeaf(cell) ? emitLeaf(cell, parent, slot, places, contents)
                                   : emitNode<false>(cell, parent, slot, places, contents);
    }

private:
    struct Job {
        std::uint32_t cell;
        std::uint32_t parent, slot;
        Extent extent;
    };

    std::uint32_t sizeOf(std::uint32_t cell) const { return cells_[cell].end - cells_[cell].begin; }

    bool isJob(std::uint32_t cell) const {
        return !cells_.isLeaf(cell) && sizeOf(cell) <= jobSize_;
    }

    void collectJobs(std::uint32_t cell, Extent& top) {
        LeafContents contents;
        top.take(kNodes);
        std::uint32_t children[kNodeChildren];
        const int count = cells_.childrenOf(cell, children);
        for (int i = 0; i < count; ++i) {
            if (cells_.isLeaf(children[i]))
                top += measureLeaf(children[i], contents);
            else if (isJob(children[i]))
                jobs_.push_back({children[i], 0, 0, {}});
            else
                collectJobs(children[i], top);
        }
    }

    Extent measureLeaf(std::uint32_t cell, LeafContents& contents) const {
        return leaves_.measure(cells_.references() + cells_[cell].begin, sizeOf(cell),
                               cells_[cell].sharesBlock, contents);
    }

    Extent measure(std::uint32_t cell, LeafContents& contents) const {
        Extent extent;
        extent.take(kNodes);
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
        for (std::uint32_t& child : node.child) child = kEmptyChild;
    }

    static void setBox(Node& node, int slot, const Cell& cell) {
        for (int a = 0; a < 3; ++a) {
            node.planes[2 * a][slot] = cell.lower[a];
            node.planes[2 * a + 1][slot] = cell.upper[a];
        }
    }

    /// kTop: leaves the jobs out.
    template <bool kTop>
    std::uint32_t emitNode(std::uint32_t cell, std::uint32_t parent, std::uint32_t slot,
                           Places& places, LeafContents& contents) {
        const std::uint32_t index = places.take(kNodes);
        std::uint32_t cells[kNodeChildren], reference[kNodeChildren];
        int slots[kNodeChildren];
        const int count = cells_.childrenOf(cell, cells);
        assignSlots(cells_[cell], cells, count, slots);
        for (int i = 0; i < count; ++i) {
            const auto at = static_cast<std::uint32_t>(slots[i]);
            if (cells_.isLeaf(cells[i])) {
                reference[i] = emitLeaf(cells[i], index, at, places, contents);
            } else if (kTop && isJob(cells[i])) {
                Job& job = jobs_[nextJob_++];
                job.parent = index;
                job.slot = at;
                reference[i] = job.extent.of[kNodes];
            } else {
                reference[i] = emitNode<kTop>(cells[i], index, at, places, contents);
            }
        }
        Node& node = tree_.nodes[index]; // only now: emission may move the array
        clear(node);
        for (int i = 0; i < count; ++i) {
            setBox(node, slots[i], cells_[cells[i]]);
            node.child[slots[i]] = reference[i];
        }
        const std::uint32_t size = sizeOf(cell);
        const float cost = cells_[cell].cost[0];
        node.links = {parent, size, cost, size, cost, static_cast<std::uint8_t>(slot), 0, 0, {}};
        for (int i = 0; i < count; ++i)
            if (reference[i] & kLeaf) node.links.leafSize[slots[i]] = leafSizeOf(sizeOf(cells[i]));
        if (!kTop) setHeight(index);
        return index;
    }

    void setHeight(std::uint32_t index) {
        Node& node = tree_.nodes[index];
        std::uint32_t below = 0;
        for (const std::uint32_t child : node.child)
            if (!(child & kLeaf))
                below = std::max<std::uint32_t>(below, tree_.nodes[child].links.height);
        node.links.height = static_cast<std::uint16_t>(below + 1);
    }

    std::uint32_t emitLeaf(std::uint32_t cell, std::uint32_t parent, std::uint32_t slot,
                           Places& places, LeafContents& contents) {
        const Reference* const first = cells_.references() + cells_[cell].begin;
        const std::uint32_t count = sizeOf(cell);
        if (tree_.leafOf.size() > 0)
            for (std::uint32_t i = 0; i < count; ++i)
                tree_.leafOf[first[i].id] = kLanes * parent + slot;
        return leaves_.write(tree_, places, first, count, cells_[cell].sharesBlock, contents);
    }

    const Cells& cells_;
    const LeafWriter leaves_;
    Tree& tree_;
    std::vector<Job> jobs_;
    std::size_t nextJob_ = 0;
    std::uint32_t jobSize_ = 0;
};

} // namespace

Tree emit(const Cells& cells, const std::vector<Reference>& unbounded, const Primitives& primitives,
          const LeafFormat& format, bool movable) {
    Tree tree;
    tree.isF32 = format.precision == Precision::f32;
    if (movable) {
        tree.leafOf.resize(primitives.count());
        for (const Reference& r : unbounded) tree.leafOf[r.id] = Tree::kNoLeaf;
    }
    LeafContents rest;
    rest.fill(unbounded.data(), static_cast<std::uint32_t>(unbounded.size()), primitives);
    const LeafWriter leaves(primitives, format);
    Extent extent = leaves.measure(rest), start;
    extent.of[kRecords] = 0;
    tree.resize(extent);
    tree.unbounded = leaves.writeRecord(tree, start, rest);
    if (cells.root() == kNoCell) return tree;
    Emitter emitter(cells, primitives, format, tree);
    emitter.append(cells.root(), kEmptyChild, 0);
    return tree;
}

std::uint32_t emitSubtree(const Cells& cells, const Primitives& primitives,
                          const LeafFormat& format, std::uint32_t parent, std::uint32_t slot,
                          Tree& tree, Places& places) {
    Emitter emitter(cells, primitives, format, tree);
    const std::uint32_t root = cells.root();
    return cells[root].end > kWorthThreads && !cells.isLeaf(root)
               ? emitter.append(root, parent, slot)
               : emitter.emit(root, parent, slot, places);
}

} // namespace rt::octree
