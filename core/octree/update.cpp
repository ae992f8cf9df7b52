#include <core/octree/update.hpp>

#include <core/octree/cut.hpp>
#include <core/octree/entrance.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/prefetch.hpp>
#include <core/octree/references.hpp>
#include <core/octree/shares.hpp>
#include <core/octree/upkeep.hpp>

#include <algorithm>
#include <cstring>

namespace rt::octree {
namespace {

using geometry::PrimitiveId;
using geometry::Primitives;

// Chosen by octree_bench --moves; see A3 of tests/stability for what they keep.
constexpr float kGrowth = 1.2f; // of a box's area, by what stays in it although it moved
constexpr float kTurned = 2; // of the box of a leaf that moves as a whole, if nothing more is asked
constexpr float kScatter = 2; // area of a box, over those of the primitives in it
constexpr float kMerged = 2;  // what a leaf may grow by, over the area of the one that it takes in
// The whole is built anew when 1/8 of all leave at once, or twice as many moved alone since it was.
constexpr std::uint32_t kWorthBuilding = 8;
constexpr std::uint64_t kManySingles = 2;

class Updater {
public:
    Updater(Tree& tree, UpdateState& state, const double center[3], double scale,
            const Primitives& primitives, const BuildOptions& options, UpdateReport& report)
        : tree_(tree), state_(state), center_(center), scale_(scale), primitives_(primitives),
          options_(options), leaves_(primitives, options.storage), places_(tree, state),
          upkeep_(tree, state, center, scale, primitives, options, places_, report),
          report_(report), isMoved_((primitives.count() + 63) / 64) {}

    bool run(std::span<const PrimitiveId> moved) {
        if (tree_.nodes.size() == 0) return moved.empty();
        for (std::size_t i = 0; i < moved.size(); ++i) {
            prefetchAhead(moved, i);
            if (!mark(static_cast<std::uint32_t>(moved[i]))) return false;
        }
        if (!tree_.nodes[0].links.marks) return true;
        listLeaves(0);
        if (!edit(0).stands) return false;
        const std::uint32_t count = primitives_.count();
        if (items_.size() > count / kWorthBuilding) return false;
        state_.singles += singles_;
        root_ = boxOf(tree_.nodes[0]);
        for (const Item& item : items_) enter(item);
        if (!upkeep_.followDrift(moved.size(), singles_)) return false;
        return tree_.nodes[0].links.height <= kMaxDepth && !upkeep_.hasTooManyNodes() &&
               state_.singles <= kManySingles * count && state_.garbage <= tree_.bytes() / 2;
    }

private:
    bool moved(std::uint32_t id) const { return isMoved_[id / 64] >> id % 64 & 1; }

    /// Node::Links::marks: bit per slot below which something has moved.
    bool mark(std::uint32_t id) {
        std::uint32_t at = tree_.leafOf[id];
        if (at == Tree::kNoLeaf) return false;
        isMoved_[id / 64] |= std::uint64_t{1} << id % 64;
        for (;;) {
            Node::Links& links = tree_.nodes[at / kLanes].links;
            const bool isKnown = links.marks != 0;
            links.marks |= 1u << at % kLanes;
            if (isKnown || links.parent == kEmptyChild) return true;
            at = kLanes * links.parent + links.slot;
        }
    }

    /// What mark() will look at: each waits for memory only once the next ones have asked.
    void prefetchAhead(std::span<const PrimitiveId> moved, std::size_t i) const {
        constexpr std::size_t kStep = 12;
        const auto placeOf = [&](std::size_t at) -> const std::uint32_t& {
            return tree_.leafOf[static_cast<std::uint32_t>(moved[at])];
        };
        if (i + 2 * kStep < moved.size()) prefetchLines(placeOf(i + 2 * kStep));
        if (i + kStep < moved.size() && placeOf(i + kStep) != Tree::kNoLeaf)
            prefetchLines(tree_.nodes[placeOf(i + kStep) / kLanes].links);
    }

    /// The leaves that edit() will come to, in its order.
    void listLeaves(std::uint32_t index) {
        const Node& node = tree_.nodes[index];
        for (unsigned m = node.links.marks; m; m &= m - 1) {
            const std::uint32_t child = node.child[__builtin_ctz(m)];
            if (child & kLeaf)
                ahead_.push_back({index, child, kEmptyChild});
            else
                listLeaves(child);
        }
    }

    /// Asks memory for what edit() will look at: first the node, then the leaf, then what moved in it.
    void lookAhead() {
        constexpr std::size_t kStep = 2;
        const std::size_t at = next_++;
        const auto& triangles = primitives_.triangles;
        if (at + 4 * kStep < ahead_.size()) prefetchLines(tree_.nodes[ahead_[at + 4 * kStep].node]);
        if (at + 3 * kStep < ahead_.size()) prefetch(tree_, ahead_[at + 3 * kStep].leaf);
        if (at + 2 * kStep < ahead_.size()) {
            Ahead& leaf = ahead_[at + 2 * kStep];
            members_.clear();
            if (isTriangles(leaf.leaf)) idsOfLeaf(tree_, leaf.leaf, members_);
            for (const std::uint32_t id : members_)
                if (moved(id)) leaf.moved = indexInKind(primitives_, id);
            if (leaf.moved != kEmptyChild) prefetchLines(triangles.indices[leaf.moved]);
        }
        if (at + kStep < ahead_.size() && ahead_[at + kStep].moved != kEmptyChild)
            for (const std::uint32_t c : triangles.indices[ahead_[at + kStep].moved])
                prefetchLines(triangles.positions[c]);
    }

    // ---- 1. what moved stays or leaves ---------------------------------------------------------------

    struct Edited {
        bool stands = true;   // false: the tree cannot follow
        bool allMoved = true; // every primitive below has moved
        std::uint32_t reference = kEmptyChild;
        Box box;
    };

    Edited edit(std::uint32_t index) {
        const Box before = boxOf(tree_.nodes[index]);
        const std::uint32_t marks = tree_.nodes[index].links.marks;
        tree_.nodes[index].links.marks = 0;
        unsigned movedSlots = 0;
        Edited result;
        Share change;
        for (int slot = 0; slot < kLanes; ++slot) {
            const std::uint32_t child = tree_.nodes[index].child[slot];
            if (child == kEmptyChild) continue;
            if (!(marks >> slot & 1)) {
                result.allMoved = false;
                continue;
            }
            const Box boxBefore = boxOf(tree_.nodes[index], slot);
            change -= shareOf(tree_, child, boxBefore);
            const Edited edited = child & kLeaf ? editLeaf(child, boxBefore) : edit(child);
            if (!edited.stands) return edited;
            if (child & kLeaf)
                tree_.nodes[index].child[slot] = edited.reference;
            else if (edited.reference != child)
                attach(edited.reference, index, slot);
            setBox(tree_.nodes[index], slot, edited.box);
            change += shareOf(tree_, edited.reference, edited.box);
            if (edited.reference == kEmptyChild) continue;
            if (edited.allMoved)
                movedSlots |= 1u << slot;
            else
                result.allMoved = false;
        }
        if (!result.allMoved && movedSlots) leaveFrom(index, movedSlots, before, change);
        mergeLeaves(index, marks, change);
        absorb(index, change);
        Node& node = tree_.nodes[index];
        int count = 0;
        for (const std::uint32_t child : node.child)
            if (child != kEmptyChild) {
                ++count;
                result.reference = child;
            }
        result.box = boxOf(node);
        node.links.count += change.count;
        node.links.cost += change.cost + kNodeCost * (result.box.area() - before.area());
        if (count > 1 || index == 0)
            result.reference = index;
        else
            places_.freeNode(index);
        return result;
    }

    /// A leaf that has lost some of its primitives takes those of another, where that costs less.
    void mergeLeaves(std::uint32_t index, std::uint32_t marks, Share& change) {
        for (; marks; marks &= marks - 1) {
            const int slot = __builtin_ctz(marks);
            const Node& node = tree_.nodes[index];
            const std::uint32_t leaf = node.child[slot];
            if (leaf == kEmptyChild || !(leaf & kLeaf) || !isTriangles(leaf)) continue;
            const Box box = boxOf(node, slot);
            const Joined joined(node, box);
            const int best = leastOf(joined.growth, joined.leaves & ~(1u << slot));
            if (best < 0 || !isTriangles(node.child[best]) ||
                !(joined.growth[best] < kMerged * box.area()))
                continue;
            const std::uint32_t other = node.child[best];
            if (sizeOfLeaf(tree_, leaf) + sizeOfLeaf(tree_, other) > kLanes) continue;
            merge(index, best, slot, change);
        }
    }

    void merge(std::uint32_t index, int into, int from, Share& change) {
        Box box = boxOf(tree_.nodes[index], into);
        const Box lost = boxOf(tree_.nodes[index], from);
        const std::uint32_t source = tree_.nodes[index].child[from];
        std::uint32_t target = tree_.nodes[index].child[into];
        change -= shareOf(tree_, source, lost);
        change -= shareOf(tree_, target, box);
        members_.clear();
        idsOfLeaf(tree_, source, members_);
        for (const std::uint32_t id : members_) {
            target = joined(target, looseOf(id));
            tree_.leafOf[id] = kLanes * index + static_cast<std::uint32_t>(into);
        }
        places_.freeLeaf(source);
        box.add(lost);
        change += shareOf(tree_, target, box);
        tree_.nodes[index].child[from] = kEmptyChild;
        setBox(tree_.nodes[index], from, Box());
        tree_.nodes[index].child[into] = target;
        setBox(tree_.nodes[index], into, box);
    }

    /// Children of a child whose children all find room here: one node less to visit.
    void absorb(std::uint32_t index, Share& change) {
        const auto childrenOf = [&](std::uint32_t node) {
            int count = 0;
            for (const std::uint32_t child : tree_.nodes[node].child) count += child != kEmptyChild;
            return count;
        };
        int room = kLanes - childrenOf(index);
        for (int slot = 0; room > 0 && slot < kLanes; ++slot) {
            const std::uint32_t child = tree_.nodes[index].child[slot];
            if (child & kLeaf) continue;
            const int more = childrenOf(child) - 1;
            if (more > room) continue;
            room -= more;
            change.cost -= kNodeCost * boxOf(tree_.nodes[index], slot).area();
            tree_.nodes[index].child[slot] = kEmptyChild;
            setBox(tree_.nodes[index], slot, Box());
            for (int from = 0; from < kLanes; ++from) {
                const std::uint32_t grandchild = tree_.nodes[child].child[from];
                if (grandchild == kEmptyChild) continue;
                const Box box = boxOf(tree_.nodes[child], from);
                const int to = freeSlotFor(tree_.nodes[index], box);
                attach(grandchild, index, to);
                setBox(tree_.nodes[index], to, box);
            }
            places_.freeNode(child);
            slot = -1;
        }
    }

    /// Children that moved as a whole leave a node that they would make much larger.
    void leaveFrom(std::uint32_t index, unsigned movedSlots, const Box& before, Share& change) {
        Node& node = tree_.nodes[index];
        Box rest;
        for (int slot = 0; slot < kLanes; ++slot)
            if (!(movedSlots >> slot & 1) && node.child[slot] != kEmptyChild)
                rest.add(boxOf(node, slot));
        const float limit = kGrowth * before.area();
        for (; movedSlots; movedSlots &= movedSlots - 1) {
            const int slot = __builtin_ctz(movedSlots);
            const Box box = boxOf(node, slot);
            Box with = rest;
            with.add(box);
            if (with.area() <= limit) {
                rest = with;
                continue;
            }
            items_.push_back({box, node.child[slot], {}, {}});
            const Share share = shareOf(tree_, node.child[slot], box);
            change -= share;
            report_.entered += share.count;
            node.child[slot] = kEmptyChild;
            setBox(node, slot, Box());
        }
    }

    /// A shared block whose triangles have all moved, and share the same corners: only those change.
    bool moveCorners(SharedBlock& block, const Box& before, Box& box) const {
        const auto& triangles = primitives_.triangles;
        double corner[3][kSharedLanes];
        unsigned known = 0;
        numeric::Box3d bounds;
        for (unsigned lanes = block.valid; lanes; lanes &= lanes - 1) {
            const int lane = __builtin_ctz(lanes);
            if (!moved(block.id[lane])) return false;
            const auto& indices = triangles.indices[indexInKind(primitives_, block.id[lane])];
            for (std::size_t c = 0; c < 3; ++c) {
                const unsigned at = block.index[c][lane];
                const geometry::Vec3& p = triangles.positions[indices[c]];
                const geometry::Vec3 q(corner[0][at], corner[1][at], corner[2][at]);
                if (!(known >> at & 1)) {
                    for (int a = 0; a < 3; ++a) corner[a][at] = p[a];
                    known |= 1u << at;
                    bounds.add(p);
                    if (!numeric::isFinite(p)) return false;
                } else if (std::memcmp(&p, &q, sizeof p) != 0) {
                    return false;
                }
            }
        }
        if (!isBoxed(bounds, box) || !(box.area() <= kTurned * before.area())) return false;
        const int first = __builtin_ctz(known);
        for (int a = 0; a < 3; ++a)
            for (int i = 0; i < kSharedLanes; ++i)
                block.corner[a][i] = corner[a][known >> i & 1 ? i : first];
        return true;
    }

    /// inOctreeSpace(), into a box.
    bool isBoxed(const numeric::Box3d& bounds, Box& box) const {
        alignas(16) float lower[4] = {}, upper[4] = {};
        const bool isInside = inOctreeSpace(bounds, center_, scale_, lower, upper);
        box = {_mm_load_ps(lower), _mm_load_ps(upper)};
        return isInside;
    }

    Edited editLeaf(std::uint32_t leaf, const Box& before) {
        lookAhead();
        Edited result;
        if (kindOfLeaf(leaf) == kSharedLeaf &&
            moveCorners(tree_.shared[leaf & kLeafIndex], before, result.box)) {
            result.reference = leaf;
            return result;
        }
        members_.clear();
        idsOfLeaf(tree_, leaf, members_);
        if (isTriangles(leaf)) {
            unsigned unmoved = 0;
            for (std::size_t i = 0; i < members_.size(); ++i)
                unmoved |= static_cast<unsigned>(!moved(members_[i])) << i;
            if (unmoved) {
                singles_ += members_.size() - static_cast<std::size_t>(__builtin_popcount(unmoved));
                return editTriangles(leaf, unmoved, before);
            }
        }
        references_.resize(members_.size());
        std::size_t staying = 0; // the first of references_
        Box rest;
        for (std::size_t i = 0; i < members_.size(); ++i) {
            Reference& r = references_[i];
            if (!referenceOf(primitives_, members_[i], center_, scale_, r)) {
                result.stands = false;
                return result;
            }
            if (moved(members_[i])) continue;
            result.allMoved = false;
            rest.add(boxOf(r));
            std::swap(r, references_[staying++]);
        }
        // What turns as a whole may have a larger box, but not one that its own boxes leave mostly empty.
        float limit = kGrowth * before.area(), own = 0;
        if (result.allMoved) {
            for (const Reference& r : references_) own += boxOf(r).area();
            limit = std::max(limit, kScatter * own);
        }
        const std::size_t movedCount = members_.size() - staying;
        for (std::size_t i = staying; i < members_.size(); ++i) {
            Reference& r = references_[i];
            const Box single = boxOf(r);
            Box with = rest;
            with.add(single);
            if (staying == 0 || with.area() <= limit) {
                rest = with;
                std::swap(r, references_[staying++]);
            } else {
                const bool isTriangle =
                    r.kind == static_cast<std::uint32_t>(geometry::Kind::triangle);
                items_.push_back(
                    {single, kEmptyChild, r, isTriangle ? looseOf(r.id) : LooseTriangle{}});
                ++report_.entered;
            }
        }
        if (!result.allMoved) singles_ += movedCount;
        places_.freeLeaf(leaf);
        if (staying) result.reference = writeLeaf(references_.data(), staying);
        result.box = rest;
        return result;
    }

    /// Of a leaf with triangles, members_, some of which have not moved: they stay as they are.
    Edited editTriangles(std::uint32_t leaf, unsigned unmoved, const Box& before) {
        Edited result;
        result.allMoved = false;
        result.reference = leaf;
        if (kindOfLeaf(leaf) == kNarrowSharedLeaf)
            state_.garbage +=
                4 * (members_.size() - static_cast<std::size_t>(__builtin_popcount(unmoved)));
        result.stands = isBoxed(keepTriangles(tree_, leaf, unmoved), result.box);
        const float limit = kGrowth * before.area();
        for (std::size_t i = 0; i < members_.size(); ++i) {
            if (unmoved >> i & 1) continue;
            Reference r;
            if (!referenceOf(primitives_, members_[i], center_, scale_, r)) {
                result.stands = false;
                return result;
            }
            const Box single = boxOf(r);
            Box with = result.box;
            with.add(single);
            const LooseTriangle triangle = looseOf(r.id);
            if (with.area() <= limit && hasRoom(tree_, result.reference, triangle)) {
                result.box = with;
                result.reference = joined(result.reference, triangle);
            } else {
                items_.push_back({single, kEmptyChild, r, triangle});
                ++report_.entered;
            }
        }
        return result;
    }

    LooseTriangle looseOf(std::uint32_t id) const {
        const auto& triangles = primitives_.triangles;
        const auto& corners = triangles.indices[indexInKind(primitives_, id)];
        return {id,
                {triangles.positions[corners[0]], triangles.positions[corners[1]],
                 triangles.positions[corners[2]]}};
    }

    /// The leaf with one more triangle, for which it has room.
    std::uint32_t joined(std::uint32_t leaf, const LooseTriangle& triangle) {
        const std::uint32_t result = addTriangle(tree_, places_, leaf, triangle);
        if (result != leaf) places_.freeLeaf(leaf);
        return result;
    }

    std::uint32_t writeLeaf(const Reference* first, std::size_t count) {
        const auto n = static_cast<std::uint32_t>(count);
        return leaves_.write(tree_, places_, first, n, sharesBlock(primitives_, first, first + n),
                             scratch_);
    }

    /// Puts a child into a slot; its box is set by the caller.
    void attach(std::uint32_t reference, std::uint32_t index, int slot) {
        const auto at = static_cast<std::uint32_t>(slot);
        tree_.nodes[index].child[slot] = reference;
        if (reference == kEmptyChild) return;
        if (!(reference & kLeaf)) {
            tree_.nodes[reference].links.parent = index;
            tree_.nodes[reference].links.slot = at;
            return;
        }
        members_.clear();
        idsOfLeaf(tree_, reference, members_);
        for (const std::uint32_t id : members_) tree_.leafOf[id] = kLanes * index + at;
    }

    // ---- 2. what left enters --------------------------------------------------------------------------

    void enter(const Item& item) {
        const Place place = placeFor(tree_, item, options_.maxObjects);
        const std::uint32_t node = place.node;
        const int slot = place.at;
        const Box beside = boxOf(tree_.nodes[node], slot);
        Box box = beside;
        box.add(item.box);
        const std::uint32_t sibling = tree_.nodes[node].child[slot];
        Share change;
        change -= shareOf(tree_, sibling, beside);
        std::uint32_t entered;
        if (place.kind == Place::slot) {
            entered = asChild(item);
        } else if (place.kind == Place::join) {
            entered = join(sibling, item);
            tree_.nodes[node].child[slot] = entered;
            tree_.leafOf[item.primitive.id] = kLanes * node + static_cast<std::uint32_t>(slot);
        } else {
            const std::uint32_t child = asChild(item);
            entered = places_.take(kNodes);
            Node& pair = tree_.nodes[entered];
            for (int i = 0; i < kLanes; ++i) {
                pair.child[i] = kEmptyChild;
                setBox(pair, i, Box());
            }
            const int first = slotFor(beside, item.box);
            attach(sibling, entered, first);
            setBox(pair, first, beside);
            attach(child, entered, first ^ 7);
            setBox(pair, first ^ 7, item.box);
            Share share{kNodeCost * box.area(), 0};
            share += shareOf(tree_, sibling, beside);
            share += shareOf(tree_, child, item.box);
            const auto height = std::max(heightOf(tree_, sibling), heightOf(tree_, child)) + 1;
            const float drift = sibling & kLeaf ? 0 : excessOf(tree_, sibling);
            pair.links = {node,   0, share.count, share.cost, share.count, share.cost - drift,
                          height, 0};
        }
        if (place.kind != Place::join) attach(entered, node, slot);
        setBox(tree_.nodes[node], slot, box);
        change += shareOf(tree_, entered, box);
        for (std::uint32_t index = node;;) {
            Node::Links& links = tree_.nodes[index].links;
            links.count += change.count;
            if (index == 0) {
                Box all = root_;
                all.add(item.box);
                links.cost += change.cost + kNodeCost * (all.area() - root_.area());
                root_ = all;
                links.height = std::max(links.height, heightOf(tree_, entered) + 1);
                return;
            }
            Node& above = tree_.nodes[links.parent];
            const auto at = static_cast<int>(links.slot);
            const Box old = boxOf(above, at);
            if (!old.holds(item.box)) {
                Box grown = old;
                grown.add(item.box);
                change.cost += kNodeCost * (grown.area() - old.area());
                setBox(above, at, grown);
            }
            links.cost += change.cost;
            links.height = std::max(links.height, heightOf(tree_, entered) + 1);
            entered = index;
            index = links.parent;
        }
    }

    /// The leaf with one more primitive, for which it has room.
    std::uint32_t join(std::uint32_t leaf, const Item& item) {
        if (isTriangles(leaf)) return joined(leaf, item.triangle);
        const Reference& primitive = item.primitive;
        members_.clear();
        idsOfLeaf(tree_, leaf, members_);
        references_.resize(members_.size() + 1);
        for (std::size_t i = 0; i < members_.size(); ++i) {
            references_[i].id = members_[i];
            references_[i].kind = primitive.kind;
        }
        references_.back() = primitive;
        places_.freeLeaf(leaf);
        return writeLeaf(references_.data(), references_.size());
    }

    std::uint32_t asChild(const Item& item) {
        return item.child == kEmptyChild ? writeLeaf(&item.primitive, 1) : item.child;
    }

    Tree& tree_;
    UpdateState& state_;
    const double* const center_;
    const double scale_;
    const Primitives& primitives_;
    const BuildOptions& options_;
    const LeafWriter leaves_;
    FreePlaces places_;
    Upkeep upkeep_;
    UpdateReport& report_;
    std::vector<std::uint64_t> isMoved_; // bit per id
    struct Ahead {
        std::uint32_t node, leaf, moved; // a triangle
    };
    std::vector<Ahead> ahead_;
    std::size_t next_ = 0; // of ahead_
    std::vector<Item> items_;
    std::uint64_t singles_ = 0;
    std::vector<std::uint32_t> members_; // scratch
    std::vector<Reference> references_;  // scratch
    LeafContents scratch_;
    Box root_; // of node 0
};

} // namespace

bool update(Tree& tree, UpdateState& state, const double center[3], double scale,
            const Primitives& primitives, const BuildOptions& options,
            std::span<const PrimitiveId> moved, UpdateReport& report) {
    return Updater(tree, state, center, scale, primitives, options, report).run(moved);
}

} // namespace rt::octree
