#include <core/octree/update.hpp>

#include <core/octree/box.hpp>
#include <core/octree/cut.hpp>
#include <core/octree/emit.hpp>
#include <core/octree/leaf_edit.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/references.hpp>

#include <algorithm>
#include <cstring>
#include <limits>

namespace rt::octree {
namespace {

using geometry::PrimitiveId;
using geometry::Primitives;

// Chosen by octree_bench --moves; see tests/octree/update_test.cpp for what they keep.
constexpr float kGrowth = 1.2f; // of a box's area, by what stays in it although it moved
constexpr float kTurned = 2; // of the box of a leaf that moves as a whole, if nothing more is asked
constexpr float kScatter = 2; // area of a box, over those of the primitives in it
constexpr float kMerged = 2;  // what a leaf may grow by, over the area of the one that it takes in
// Subtrees built anew by themselves: when so much of their cost is drift, and so much of the tree's.
constexpr float kDrift = 0.1f, kFelt = 0.03f;
// Upkeep: subtrees of 1/32 of all primitives, 256 to 4096; one built anew for each that moved alone where the
// tree costs 0.1 more than a new one, by the square of that elsewhere.
constexpr std::uint32_t kFewShare = 32, kLeastFew = 256, kMostFew = 4096;
constexpr float kAllowed = 0.1f, kLeastUpkeep = 0.25f, kMostUpkeep = 2;
constexpr float kMemory = 0.9f; // from one update to the next, of what upkeep gained
// The whole: nodes, when there are 1 + 1/4 times as many as when it was built, and 1.4 times as many as new
// subtrees have; primitives that moved alone since, times all there are; 1/8 of all leave at once.
constexpr std::uint32_t kNodesPart = 4, kWorthBuilding = 8;
constexpr float kMostNodes = 1.4f, kTrusted = 256; // nodes of new subtrees that say anything
constexpr std::uint64_t kManySingles = 2;
constexpr float kInfinityF32 = std::numeric_limits<float>::infinity();

/// Takes places that are free, and new ones where there are none.
class FreePlaces final : public Places {
public:
    FreePlaces(Tree& tree, UpdateState& state) : tree_(tree), state_(state) {}

    std::uint32_t take(Part part, std::uint32_t count = 1) override {
        auto& free = state_.free[part];
        if (count == 1 && !free.empty()) {
            const std::uint32_t place = free.back();
            free.pop_back();
            return place;
        }
        Extent extent = tree_.extent();
        const std::uint32_t first = extent.take(part, count);
        if (count) tree_.resize(extent);
        return first;
    }

private:
    Tree& tree_;
    UpdateState& state_;
};

/// What a part of the tree adds to the numbers of a node above it.
struct Share {
    float cost = 0;
    std::uint32_t count = 0;

    Share& operator+=(const Share& s) {
        cost += s.cost;
        count += s.count;
        return *this;
    }
    Share& operator-=(const Share& s) {
        cost -= s.cost;
        count -= s.count;
        return *this;
    }
};

/// A primitive or a subtree that has left its place.
struct Item {
    Box box;
    std::uint32_t child; // its reference; kEmptyChild for a primitive
    Reference primitive;
    LooseTriangle triangle; // if it is one
};

class Updater {
public:
    Updater(Tree& tree, UpdateState& state, const double center[3], double scale,
            const Primitives& primitives, const BuildOptions& options, UpdateReport& report)
        : tree_(tree), state_(state), center_(center), scale_(scale), primitives_(primitives),
          options_(options), leaves_(primitives, options.storage), places_(tree, state),
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
        if (!followDrift(moved.size())) return false;
        return tree_.nodes[0].links.height <= kMaxDepth && !hasTooManyNodes() &&
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

    template <class T> static void lines(const T& item) { // into the cache
        const char* const bytes = reinterpret_cast<const char*>(&item);
        for (std::size_t i = 0; i < sizeof item; i += 64) _mm_prefetch(bytes + i, _MM_HINT_T0);
    }

    /// What mark() will look at: each waits for memory only once the next ones have asked.
    void prefetchAhead(std::span<const PrimitiveId> moved, std::size_t i) const {
        constexpr std::size_t kStep = 12;
        const auto placeOf = [&](std::size_t at) -> const std::uint32_t& {
            return tree_.leafOf[static_cast<std::uint32_t>(moved[at])];
        };
        if (i + 2 * kStep < moved.size()) lines(placeOf(i + 2 * kStep));
        if (i + kStep < moved.size() && placeOf(i + kStep) != Tree::kNoLeaf)
            lines(tree_.nodes[placeOf(i + kStep) / kLanes].links);
    }

    void prefetch(std::uint32_t reference) const {
        const std::uint32_t index = reference & kLeafIndex;
        if (!(reference & kLeaf)) return lines(tree_.nodes[reference]);
        switch (kindOfLeaf(reference)) {
        case kSharedLeaf:
            return lines(tree_.shared[index]);
        case kTriangleLeaf:
            return lines(tree_.triangles[index]);
        case kNarrowSharedLeaf:
            return lines(tree_.narrowShared[index]);
        case kNarrowTriangleLeaf:
            return lines(tree_.narrowTriangles[index]);
        default:
            return;
        }
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
        if (at + 4 * kStep < ahead_.size()) lines(tree_.nodes[ahead_[at + 4 * kStep].node]);
        if (at + 3 * kStep < ahead_.size()) prefetch(ahead_[at + 3 * kStep].leaf);
        if (at + 2 * kStep < ahead_.size()) {
            Ahead& leaf = ahead_[at + 2 * kStep];
            members_.clear();
            if (isTriangles(leaf.leaf)) idsOfLeaf(tree_, leaf.leaf, members_);
            for (const std::uint32_t id : members_)
                if (moved(id)) leaf.moved = indexInKind(primitives_, id);
            if (leaf.moved != kEmptyChild) lines(triangles.indices[leaf.moved]);
        }
        if (at + kStep < ahead_.size() && ahead_[at + kStep].moved != kEmptyChild)
            for (const std::uint32_t c : triangles.indices[ahead_[at + kStep].moved])
                lines(triangles.positions[c]);
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
            change -= shareOf(child, boxBefore);
            const Edited edited = child & kLeaf ? editLeaf(child, boxBefore) : edit(child);
            if (!edited.stands) return edited;
            if (child & kLeaf)
                tree_.nodes[index].child[slot] = edited.reference;
            else if (edited.reference != child)
                attach(edited.reference, index, slot);
            setBox(tree_.nodes[index], slot, edited.box);
            change += shareOf(edited.reference, edited.box);
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
            freeNode(index);
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
        change -= shareOf(source, lost);
        change -= shareOf(target, box);
        members_.clear();
        idsOfLeaf(tree_, source, members_);
        for (const std::uint32_t id : members_) {
            target = joined(target, looseOf(id));
            tree_.leafOf[id] = kLanes * index + static_cast<std::uint32_t>(into);
        }
        freeLeaf(source);
        box.add(lost);
        change += shareOf(target, box);
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
            freeNode(child);
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
            const Share share = shareOf(node.child[slot], box);
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
        freeLeaf(leaf);
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
        if (result != leaf) freeLeaf(leaf);
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

    // ---- places that nothing uses any more; blocks hold nothing that a ray could hit ------------------

    void freeNode(std::uint32_t index) { state_.free[kNodes].push_back(index); }

    template <class Block> void freeBlock(Array<Block>& blocks, Part part, std::uint32_t index) {
        std::memset(static_cast<void*>(&blocks[index]), 0xFF, sizeof(Block)); // NaN, and no ids
        state_.free[part].push_back(index);
    }

    void freeLeaf(std::uint32_t reference) {
        const std::uint32_t index = reference & kLeafIndex;
        switch (kindOfLeaf(reference)) {
        case kSharedLeaf:
            tree_.shared[index].valid = 0;
            return state_.free[kShared].push_back(index);
        case kNarrowSharedLeaf: {
            auto& valid = tree_.narrowShared[index].valid;
            state_.garbage += static_cast<std::uint64_t>(__builtin_popcount(valid)) * 4;
            valid = 0;
            return state_.free[kNarrowShared].push_back(index);
        }
        case kTriangleLeaf:
            return freeBlock(tree_.triangles, kTriangles, index);
        case kNarrowTriangleLeaf:
            return freeBlock(tree_.narrowTriangles, kNarrowTriangles, index);
        case kSphereLeaf:
            return freeBlock(tree_.spheres, kSpheres, index);
        case kParallelogramLeaf:
            return freeBlock(tree_.parallelograms, kParallelograms, index);
        default: {
            const LeafRecord leaf = tree_.records[index];
            for (std::uint32_t i = 0; i < leaf.triangleBlocks; ++i)
                freeBlock(tree_.triangles, kTriangles, leaf.triangles + i);
            for (std::uint32_t i = 0; i < leaf.sphereBlocks; ++i)
                freeBlock(tree_.spheres, kSpheres, leaf.spheres + i);
            for (std::uint32_t i = 0; i < leaf.parallelogramBlocks; ++i)
                freeBlock(tree_.parallelograms, kParallelograms, leaf.parallelograms + i);
            for (std::uint32_t i = 0; i < leaf.runCount; ++i) {
                auto& count = tree_.runs[leaf.runs + i].count;
                state_.garbage += sizeof(CustomRun) + 8 * std::uint64_t{count};
                count = 0;
            }
            state_.free[kRecords].push_back(index);
        }
        }
    }

    // ---- 2. what left enters --------------------------------------------------------------------------

    /// Where an item may go, and what the tree's cost grows by.
    struct Place {
        enum Kind : std::uint8_t { join, slot, pair } kind = slot;
        std::uint32_t node = 0;
        int at = 0;
        float cost = kInfinityF32;

        void offer(Kind k, std::uint32_t n, int s, float c) {
            if (!(c <= cost)) return;
            kind = k;
            node = n;
            at = s;
            cost = c;
        }
    };

    void enter(const Item& item) {
        const Place place = placeFor(item);
        const std::uint32_t node = place.node;
        const int slot = place.at;
        const Box beside = boxOf(tree_.nodes[node], slot);
        Box box = beside;
        box.add(item.box);
        const std::uint32_t sibling = tree_.nodes[node].child[slot];
        Share change;
        change -= shareOf(sibling, beside);
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
            share += shareOf(sibling, beside);
            share += shareOf(child, item.box);
            const auto height = std::max(heightOf(sibling), heightOf(child)) + 1;
            const float drift = sibling & kLeaf ? 0 : excessOf(sibling);
            pair.links = {node,   0, share.count, share.cost, share.count, share.cost - drift,
                          height, 0};
        }
        if (place.kind != Place::join) attach(entered, node, slot);
        setBox(tree_.nodes[node], slot, box);
        change += shareOf(entered, box);
        for (std::uint32_t index = node;;) {
            Node::Links& links = tree_.nodes[index].links;
            links.count += change.count;
            if (index == 0) {
                Box all = root_;
                all.add(item.box);
                links.cost += change.cost + kNodeCost * (all.area() - root_.area());
                root_ = all;
                links.height = std::max(links.height, heightOf(entered) + 1);
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
            links.height = std::max(links.height, heightOf(entered) + 1);
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
        freeLeaf(leaf);
        return writeLeaf(references_.data(), references_.size());
    }

    /// The octant of `a` in a cell that it shares with `b`; b's is the opposite one.
    static int slotFor(const Box& a, const Box& b) {
        return _mm_movemask_ps(
                   _mm_cmpgt_ps(_mm_add_ps(a.lower, a.upper), _mm_add_ps(b.lower, b.upper))) &
               7;
    }

    /// The free slot that is nearest to the octant of a box; there must be one.
    static int freeSlotFor(const Node& node, const Box& box) {
        const int octant = slotFor(box, boxOf(node));
        for (const int flips : {0, 1, 2, 4, 3, 5, 6, 7})
            if (node.child[octant ^ flips] == kEmptyChild) return octant ^ flips;
        return -1;
    }

    std::uint32_t asChild(const Item& item) {
        return item.child == kEmptyChild ? writeLeaf(&item.primitive, 1) : item.child;
    }

    /// A node's children if something joined them.
    struct Joined {
        alignas(16) float area[kLanes], growth[kLanes];
        unsigned empty, leaves, nodes; // bit per slot

        Joined(const Node& node, const Box& box) {
            const auto half = [](const __m128(&d)[3]) {
                return _mm_add_ps(_mm_mul_ps(d[0], _mm_add_ps(d[1], d[2])), _mm_mul_ps(d[1], d[2]));
            };
            const __m128 lower[3] = {_mm_shuffle_ps(box.lower, box.lower, 0x00),
                                     _mm_shuffle_ps(box.lower, box.lower, 0x55),
                                     _mm_shuffle_ps(box.lower, box.lower, 0xAA)};
            const __m128 upper[3] = {_mm_shuffle_ps(box.upper, box.upper, 0x00),
                                     _mm_shuffle_ps(box.upper, box.upper, 0x55),
                                     _mm_shuffle_ps(box.upper, box.upper, 0xAA)};
            empty = nodes = 0;
            for (int s = 0; s < kLanes; s += 4) {
                __m128 own[3], both[3];
                for (int a = 0; a < 3; ++a) {
                    const __m128 low = _mm_load_ps(node.planes[2 * a] + s),
                                 high = _mm_load_ps(node.planes[2 * a + 1] + s);
                    own[a] = _mm_sub_ps(high, low);
                    both[a] = _mm_sub_ps(_mm_max_ps(high, upper[a]), _mm_min_ps(low, lower[a]));
                }
                const __m128 joined = half(both);
                _mm_store_ps(area + s, joined);
                _mm_store_ps(growth + s, _mm_sub_ps(joined, half(own)));
                const __m128i child =
                    _mm_load_si128(reinterpret_cast<const __m128i*>(node.child + s));
                const auto bits = [s](__m128i v) {
                    return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(v))) << s;
                };
                empty |= bits(_mm_cmpeq_epi32(child, _mm_set1_epi32(-1)));
                nodes |= bits(child); // where the top bit is set, for now
            }
            leaves = nodes & ~empty;
            nodes = ~nodes & 0xFF;
        }
    };

    /// The first of the slots where the value is least; -1 if there are none. Without branches, which
    /// nobody could foresee.
    static int leastOf(const float (&value)[kLanes], unsigned slots) {
        if (!slots) return -1;
        const __m128i bit = _mm_setr_epi32(1, 2, 4, 8), high = _mm_slli_epi32(bit, 4);
        const __m128i all = _mm_set1_epi32(static_cast<int>(slots));
        const __m128 infinity = _mm_set1_ps(kInfinityF32);
        const auto chosen = [&](const float* from, __m128i of) {
            const __m128 in = _mm_castsi128_ps(_mm_cmpeq_epi32(_mm_and_si128(all, of), of));
            return _mm_or_ps(_mm_and_ps(in, _mm_load_ps(from)), _mm_andnot_ps(in, infinity));
        };
        const __m128 a = chosen(value, bit), b = chosen(value + 4, high);
        __m128 least = _mm_min_ps(a, b);
        least = _mm_min_ps(least, _mm_shuffle_ps(least, least, _MM_SHUFFLE(1, 0, 3, 2)));
        least = _mm_min_ps(least, _mm_shuffle_ps(least, least, _MM_SHUFFLE(2, 3, 0, 1)));
        const int found =
            _mm_movemask_ps(_mm_cmpeq_ps(a, least)) | _mm_movemask_ps(_mm_cmpeq_ps(b, least)) << 4;
        return __builtin_ctz(static_cast<unsigned>(found) & slots);
    }

    Place placeFor(const Item& item) {
        const bool single = item.child == kEmptyChild;
        // A subtree costs the same wherever it hangs.
        const float own = single ? kBlockCost * item.box.area() : 0;
        Place best;
        float inherited = 0; // what the nodes on the way grow by
        for (std::uint32_t index = 0;;) {
            const Node& node = tree_.nodes[index];
            const Joined joined(node, item.box);
            const int down = leastOf(joined.growth, joined.nodes),
                      leaf = leastOf(joined.growth, joined.leaves);
            if (down >= 0) prefetch(node.child[down]);
            const int beside = leastOf(joined.area, joined.nodes | joined.leaves);
            if (joined.empty)
                best.offer(Place::slot, index, freeSlotFor(node, item.box), inherited + own);
            else
                best.offer(Place::pair, index, beside,
                           inherited + own + kNodeCost * joined.area[beside]);
            if (single && leaf >= 0) {
                const float cost = inherited + kBlockCost * joined.growth[leaf];
                if (cost <= best.cost && fits(node.child[leaf], item))
                    best.offer(Place::join, index, leaf, cost);
            }
            if (down < 0) return best;
            inherited += kNodeCost * joined.growth[down];
            if (inherited > best.cost) return best;
            index = node.child[down];
        }
    }

    /// Does the leaf stay one block with this primitive in it?
    bool fits(std::uint32_t leaf, const Item& item) const {
        const std::uint32_t size = sizeOfLeaf(tree_, leaf);
        if (size >= options_.maxObjects) return false;
        switch (static_cast<geometry::Kind>(item.primitive.kind)) {
        case geometry::Kind::triangle:
            return isTriangles(leaf) && hasRoom(tree_, leaf, item.triangle);
        case geometry::Kind::sphere:
            return kindOfLeaf(leaf) == kSphereLeaf && size < kLanes;
        case geometry::Kind::parallelogram:
            return kindOfLeaf(leaf) == kParallelogramLeaf && size < kLanes;
        case geometry::Kind::custom:
            return false;
        }
        return false;
    }

    // ---- counts and costs --------------------------------------------------------------------------------

    Share shareOf(std::uint32_t reference, const Box& box) const {
        if (reference == kEmptyChild) return {};
        if (reference & kLeaf)
            return {costOfLeaf(tree_, reference) * box.area(), sizeOfLeaf(tree_, reference)};
        const Node::Links& links = tree_.nodes[reference].links;
        return {links.cost, links.count};
    }

    std::uint32_t heightOf(std::uint32_t reference) const {
        return reference & kLeaf ? 0 : tree_.nodes[reference].links.height;
    }

    // ---- 3. what has drifted is built anew ------------------------------------------------------------

    /// What the subtree would cost if it were new, as far as we know.
    float freshCost(std::uint32_t index) const {
        const Node::Links& links = tree_.nodes[index].links;
        return links.costThen * static_cast<float>(links.count) /
               static_cast<float>(std::max(1u, links.countThen));
    }

    float excessOf(std::uint32_t index) const {
        return tree_.nodes[index].links.cost - freshCost(index);
    }

    /// Subtrees to build anew: what has drifted by itself as a whole, and candidates, a few primitives each.
    struct Drifted {
        std::vector<std::uint32_t> whole, few;
    };

    void findDrifted(std::uint32_t index, Drifted& found) const {
        const Node::Links& links = tree_.nodes[index].links;
        const float excess = excessOf(index);
        const std::uint32_t few = std::clamp(primitives_.count() / kFewShare, kLeastFew, kMostFew);
        if (links.count <= few && index != 0) {
            if (excess > 0) found.few.push_back(index);
            return;
        }
        float explained = 0;
        for (const std::uint32_t child : tree_.nodes[index].child)
            if (!(child & kLeaf)) explained += std::max(0.0f, excessOf(child));
        if (excess > kDrift * freshCost(index) && excess > kFelt * tree_.nodes[0].links.cost &&
            !(explained >= excess / 2))
            return found.whole.push_back(index);
        for (const std::uint32_t child : tree_.nodes[index].child)
            if (!(child & kLeaf)) findDrifted(child, found);
    }

    /// Boxes that have grown cost more than new ones would, by how much is not known: so as many
    /// primitives are built anew as keeps any motion in bounds, those first that cost most.
    bool followDrift(std::uint64_t moved) {
        Drifted drifted;
        findDrifted(0, drifted);
        for (const std::uint32_t node : drifted.whole)
            if (!rebuild(node)) return false;
        const auto perPrimitive = [&](std::uint32_t node) {
            return excessOf(node) / static_cast<float>(tree_.nodes[node].links.count);
        };
        std::sort(drifted.few.begin(), drifted.few.end(), [&](std::uint32_t a, std::uint32_t b) {
            return perPrimitive(a) > perPrimitive(b);
        });
        const float excess = state_.costAfter > 0 ? state_.costBefore / state_.costAfter - 1 : 0;
        const float worn = excess / kAllowed;
        const float upkeep = std::clamp(worn * worn, kLeastUpkeep, kMostUpkeep);
        const bool isFelt = excessOf(0) > kFelt * tree_.nodes[0].links.cost;
        std::uint64_t built = 0;
        for (const std::uint32_t node : drifted.few) {
            const float drift = excessOf(node) / freshCost(node);
            if (!(static_cast<float>(built) <
                  static_cast<float>(singles_) * upkeep +
                      (isFelt ? static_cast<float>(moved) * drift * drift : 0)))
                break;
            built += tree_.nodes[node].links.count;
            if (!rebuild(node)) return false;
        }
        for (float* sum :
             {&state_.costBefore, &state_.costAfter, &state_.nodesBefore, &state_.nodesAfter})
            *sum *= kMemory;
        return true;
    }

    std::size_t liveNodes() const { return tree_.nodes.size() - state_.free[kNodes].size(); }

    /// A new tree would have more nodes than when this was new, too: what was built anew lately tells how many.
    bool hasTooManyNodes() const {
        return liveNodes() > state_.nodesThen + state_.nodesThen / kNodesPart + kLanes &&
               !(state_.nodesAfter > kTrusted &&
                 state_.nodesBefore < kMostNodes * state_.nodesAfter);
    }

    void release(std::uint32_t reference) {
        if (reference == kEmptyChild) return;
        if (reference & kLeaf) {
            idsOfLeaf(tree_, reference, members_);
            return freeLeaf(reference);
        }
        for (const std::uint32_t child : tree_.nodes[reference].child) release(child);
        freeNode(reference);
    }

    bool rebuild(std::uint32_t index) {
        const Node::Links links = tree_.nodes[index].links;
        if (links.parent == kEmptyChild) return false;
        const float fresh = freshCost(index);
        members_.clear();
        const std::size_t all = liveNodes();
        release(index);
        const std::size_t others = liveNodes();
        const auto count = static_cast<std::uint32_t>(members_.size());
        report_.rebuilt += count;
        Array<Reference> references(count);
        for (std::uint32_t i = 0; i < count; ++i)
            if (!referenceOf(primitives_, members_[i], center_, scale_, references[i]))
                return false;
        const Cells cells(primitives_, std::move(references), count, scale_, options_);
        const std::uint32_t child = emitSubtree(cells, primitives_, options_.storage, links.parent,
                                                links.slot, tree_, places_);
        tree_.nodes[links.parent].child[links.slot] = child;
        const float cost =
            shareOf(child, boxOf(tree_.nodes[links.parent], static_cast<int>(links.slot))).cost;
        state_.costBefore += links.cost;
        state_.costAfter += cost;
        state_.nodesBefore += static_cast<float>(all - others);
        state_.nodesAfter += static_cast<float>(liveNodes() - others);
        for (std::uint32_t above = links.parent; above != kEmptyChild;) {
            Node::Links& changed = tree_.nodes[above].links;
            changed.costThen = freshCost(above) + cost - fresh;
            changed.countThen = changed.count;
            changed.cost += cost - links.cost;
            above = changed.parent;
        }
        return true;
    }

    Tree& tree_;
    UpdateState& state_;
    const double* const center_;
    const double scale_;
    const Primitives& primitives_;
    const BuildOptions& options_;
    const LeafWriter leaves_;
    FreePlaces places_;
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
