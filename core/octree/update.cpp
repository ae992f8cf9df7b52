#include <core/octree/update.hpp>

#include <core/octree/box.hpp>
#include <core/octree/emit.hpp>
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
constexpr float kTurned =
    2; // of the box of a leaf that moves as a whole, when nothing more is asked
constexpr float kScatter = 2; // area of a box, over those of the primitives in it
constexpr float kDrift = 0.1f, kDriftOfFew = 0.3f; // of a subtree's cost, before it is built anew
constexpr std::uint32_t kFew = 4096; // primitives of a subtree whose drift the whole hardly feels
constexpr std::uint32_t kNodesPart = 4;     // whole: when nodes have become 1 + 1/4 times as many
constexpr std::uint64_t kManySingles = 4;   // whole: primitives entered again, times all there are
constexpr std::uint32_t kWorthBuilding = 8; // whole: when more than 1/8 of all leave in one update
constexpr float kInfinityF32 = std::numeric_limits<float>::infinity();

// Node::Links::marks: bits 0-7, leaves to be written anew.
constexpr std::uint32_t kChanged = 256; // something below is

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

/// A primitive or a subtree that has left its place.
struct Item {
    Box box;
    std::uint32_t child; // its reference; kEmptyChild for a primitive
    Reference primitive;
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
        for (const PrimitiveId id : moved)
            if (!mark(static_cast<std::uint32_t>(id))) return false;
        if (!(tree_.nodes[0].links.marks)) return true;
        if (!edit(0).stands) return false;
        const std::uint32_t count = primitives_.count();
        for (const Item& item : items_) singles_ += item.child == kEmptyChild;
        if (singles_ > count / kWorthBuilding) return false;
        state_.singles += singles_;
        for (const Item& item : items_) enter(item);
        refresh(0);
        float fresh = 0;
        if (!inspect(0, fresh)) return false;
        const auto live =
            static_cast<std::uint32_t>(tree_.nodes.size() - state_.free[kNodes].size());
        return tree_.nodes[0].links.height <= kMaxDepth &&
               live <= state_.nodesThen + state_.nodesThen / kNodesPart + kLanes &&
               state_.singles <= kManySingles * count && state_.garbage <= tree_.bytes() / 2;
    }

private:
    bool moved(std::uint32_t id) const { return isMoved_[id / 64] >> id % 64 & 1; }

    bool mark(std::uint32_t id) {
        const std::uint32_t leaf = tree_.leafOf[id];
        if (leaf == Tree::kNoLeaf) return false;
        isMoved_[id / 64] |= std::uint64_t{1} << id % 64;
        std::uint32_t node = leaf / kLanes;
        tree_.nodes[node].links.marks |= 1u << leaf % kLanes;
        markPath(node);
        return true;
    }

    void markPath(std::uint32_t node) {
        while (node != kEmptyChild && !(tree_.nodes[node].links.marks & kChanged)) {
            tree_.nodes[node].links.marks |= kChanged;
            node = tree_.nodes[node].links.parent;
        }
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
        unsigned movedSlots = 0;
        Edited result;
        for (int slot = 0; slot < kLanes; ++slot) {
            const std::uint32_t child = tree_.nodes[index].child[slot];
            if (child == kEmptyChild) continue;
            Edited edited;
            if (child & kLeaf) {
                if (!(marks >> slot & 1)) {
                    result.allMoved = false;
                    continue;
                }
                edited = editLeaf(child, boxOf(tree_.nodes[index], slot));
            } else {
                if (!(tree_.nodes[child].links.marks & kChanged)) {
                    result.allMoved = false;
                    continue;
                }
                edited = edit(child);
            }
            if (!edited.stands) return edited;
            if (edited.reference != child) attach(edited.reference, index, slot);
            setBox(tree_.nodes[index], slot, edited.box);
            if (edited.reference == kEmptyChild) continue;
            if (edited.allMoved)
                movedSlots |= 1u << slot;
            else
                result.allMoved = false;
        }
        if (!result.allMoved && movedSlots) leaveFrom(index, movedSlots, before);
        const Node& node = tree_.nodes[index];
        int count = 0;
        for (const std::uint32_t child : node.child)
            if (child != kEmptyChild) {
                ++count;
                result.reference = child;
            }
        result.box = boxOf(node);
        if (count > 1 || index == 0)
            result.reference = index;
        else
            freeNode(index);
        return result;
    }

    /// Children that moved as a whole leave a node that they would make much larger.
    void leaveFrom(std::uint32_t index, unsigned movedSlots, const Box& before) {
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
            items_.push_back({box, node.child[slot], {}});
            report_.entered += countOf(node.child[slot]);
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
        alignas(16) float lower[4] = {}, upper[4] = {};
        if (!inOctreeSpace(bounds, center_, scale_, lower, upper)) return false;
        box = Box();
        box.add(_mm_load_ps(lower), _mm_load_ps(upper));
        if (!(box.area() <= kTurned * before.area())) return false;
        for (int a = 0; a < 3; ++a)
            for (int i = 0; i < kSharedLanes; ++i)
                block.corner[a][i] = corner[a][known >> i & 1 ? i : 0];
        return true;
    }

    Edited editLeaf(std::uint32_t leaf, const Box& before) {
        Edited result;
        if ((leaf >> kLeafKindShift & 7) == kSharedLeaf &&
            moveCorners(tree_.shared[leaf & kLeafIndex], before, result.box)) {
            result.reference = leaf;
            return result;
        }
        members_.clear();
        idsOfLeaf(tree_, leaf, members_);
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
            rest.add(_mm_load_ps(r.lower), _mm_load_ps(r.upper));
            std::swap(r, references_[staying++]);
        }
        // What turns as a whole may have a larger box, but not one that its own boxes leave mostly empty.
        float limit = kGrowth * before.area(), own = 0;
        if (result.allMoved) {
            for (const Reference& r : references_) {
                Box box;
                box.add(_mm_load_ps(r.lower), _mm_load_ps(r.upper));
                own += box.area();
            }
            limit = std::max(limit, kScatter * own);
        }
        for (std::size_t i = staying; i < members_.size(); ++i) {
            Reference& r = references_[i];
            Box single, with = rest;
            single.add(_mm_load_ps(r.lower), _mm_load_ps(r.upper));
            with.add(single);
            if (staying == 0 || with.area() <= limit) {
                rest = with;
                std::swap(r, references_[staying++]);
            } else {
                items_.push_back({single, kEmptyChild, r});
                ++report_.entered;
            }
        }
        freeLeaf(leaf);
        if (staying) result.reference = writeLeaf(references_.data(), staying);
        result.box = rest;
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
        switch (reference >> kLeafKindShift & 7) {
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
        markPath(node);
        Box box = boxOf(tree_.nodes[node], slot);
        box.add(item.box);
        if (place.kind == Place::slot) {
            attach(asChild(item), node, slot);
        } else if (place.kind == Place::join) {
            const std::uint32_t leaf = tree_.nodes[node].child[slot];
            members_.clear();
            idsOfLeaf(tree_, leaf, members_);
            references_.resize(members_.size() + 1);
            for (std::size_t i = 0; i < members_.size(); ++i) {
                references_[i].id = members_[i];
                references_[i].kind = static_cast<std::uint32_t>(
                    primitives_.segmentOf(PrimitiveId{members_[i]}).kind);
            }
            references_.back() = item.primitive;
            freeLeaf(leaf);
            attach(writeLeaf(references_.data(), references_.size()), node, slot);
        } else {
            const std::uint32_t added = places_.take(kNodes), child = asChild(item);
            const std::uint32_t sibling = tree_.nodes[node].child[slot];
            Node& pair = tree_.nodes[added];
            for (int i = 0; i < kLanes; ++i) {
                pair.child[i] = kEmptyChild;
                setBox(pair, i, Box());
            }
            pair.links = {node, static_cast<std::uint32_t>(slot), 0, 0, 0, 0, 1, 0};
            const Box beside = boxOf(tree_.nodes[node], slot);
            const int first = slotFor(beside, item.box);
            attach(sibling, added, first);
            setBox(pair, first, beside);
            attach(child, added, first ^ 7);
            setBox(pair, first ^ 7, item.box);
            attach(added, node, slot);
            markPath(added);
            tree_.nodes[added].links.costThen = kInfinityF32; // taken from the cost by refresh()
        }
        setBox(tree_.nodes[node], slot, box);
        for (std::uint32_t below = node; below != 0;) {
            const auto& links = tree_.nodes[below].links;
            Node& above = tree_.nodes[links.parent];
            const auto at = static_cast<int>(links.slot);
            Box grown = boxOf(above, at);
            grown.add(item.box);
            setBox(above, at, grown);
            below = links.parent;
        }
    }

    /// The octant of `a` in a cell that it shares with `b`; b's is the opposite one.
    static int slotFor(const Box& a, const Box& b) {
        return _mm_movemask_ps(
                   _mm_cmpgt_ps(_mm_add_ps(a.lower, a.upper), _mm_add_ps(b.lower, b.upper))) &
               7;
    }

    std::uint32_t asChild(const Item& item) {
        return item.child == kEmptyChild ? writeLeaf(&item.primitive, 1) : item.child;
    }

    Place placeFor(const Item& item) {
        const bool single = item.child == kEmptyChild;
        // A subtree costs the same wherever it hangs.
        const float own = single ? kBlockCost * item.box.area() : 0;
        alignas(16) float lower[4], upper[4];
        _mm_store_ps(lower, item.box.lower);
        _mm_store_ps(upper, item.box.upper);
        Place best;
        float inherited = 0; // what the nodes on the way grow by
        for (std::uint32_t index = 0;;) {
            const Node& node = tree_.nodes[index];
            float area[kLanes], joined[kLanes];
            for (int s = 0; s < kLanes; ++s) {
                float d[3], e[3];
                for (int a = 0; a < 3; ++a) {
                    const float low = node.planes[2 * a][s], high = node.planes[2 * a + 1][s];
                    d[a] = high - low;
                    e[a] = (high > upper[a] ? high : upper[a]) - (low < lower[a] ? low : lower[a]);
                }
                area[s] = d[0] * d[1] + d[1] * d[2] + d[2] * d[0];
                joined[s] = e[0] * e[1] + e[1] * e[2] + e[2] * e[0];
            }
            int down = -1, leaf = -1;
            for (int s = 0; s < kLanes; ++s) {
                const std::uint32_t child = node.child[s];
                if (child == kEmptyChild) {
                    best.offer(Place::slot, index, s, inherited + own);
                    continue;
                }
                best.offer(Place::pair, index, s, inherited + own + kNodeCost * joined[s]);
                int& least = child & kLeaf ? leaf : down;
                if (least < 0 || joined[s] - area[s] < joined[least] - area[least]) least = s;
            }
            if (single && leaf >= 0) {
                const float cost = inherited + kBlockCost * (joined[leaf] - area[leaf]);
                if (cost <= best.cost && fits(node.child[leaf], item.primitive))
                    best.offer(Place::join, index, leaf, cost);
            }
            if (down < 0) return best;
            inherited += kNodeCost * (joined[down] - area[down]);
            if (inherited > best.cost) return best;
            index = node.child[down];
        }
    }

    /// Does the leaf stay one block with this primitive in it?
    bool fits(std::uint32_t leaf, const Reference& primitive) {
        members_.clear();
        idsOfLeaf(tree_, leaf, members_);
        if (members_.size() >= options_.maxObjects) return false;
        const auto kind = leaf >> kLeafKindShift & 7;
        switch (static_cast<geometry::Kind>(primitive.kind)) {
        case geometry::Kind::triangle: {
            if (kind == kTriangleLeaf || kind == kNarrowTriangleLeaf)
                return members_.size() < kLanes;
            if ((kind != kSharedLeaf && kind != kNarrowSharedLeaf) ||
                members_.size() >= kSharedLanes)
                return false;
            members_.push_back(primitive.id);
            CornerSet corners;
            for (const std::uint32_t id : members_)
                for (const std::uint32_t c :
                     primitives_.triangles.indices[indexInKind(primitives_, id)])
                    if (corners.add(c) < 0) return members_.size() <= kLanes;
            return true;
        }
        case geometry::Kind::sphere:
            return kind == kSphereLeaf && members_.size() < kLanes;
        case geometry::Kind::parallelogram:
            return kind == kParallelogramLeaf && members_.size() < kLanes;
        case geometry::Kind::custom:
            return false;
        }
        return false;
    }

    // ---- counts, boxes and costs of what changed ------------------------------------------------------

    std::uint32_t countOf(std::uint32_t reference) {
        return reference & kLeaf ? sizeOfLeaf(tree_, reference)
                                 : tree_.nodes[reference].links.count;
    }

    void refresh(std::uint32_t index) {
        for (int slot = 0; slot < kLanes; ++slot) {
            const std::uint32_t child = tree_.nodes[index].child[slot];
            if (!(child & kLeaf) && (tree_.nodes[child].links.marks & kChanged)) {
                refresh(child);
                setBox(tree_.nodes[index], slot, boxOf(tree_.nodes[child]));
            }
        }
        sum(index);
        Node::Links& links = tree_.nodes[index].links;
        links.marks = 0;
        if (links.costThen == kInfinityF32) {
            links.costThen = links.cost;
            links.countThen = links.count;
        }
    }

    void sum(std::uint32_t index) {
        Node& node = tree_.nodes[index];
        Node::Links& links = node.links;
        links.count = links.height = 0;
        links.cost = kNodeCost * boxOf(node).area();
        for (int slot = 0; slot < kLanes; ++slot) {
            const std::uint32_t child = node.child[slot];
            if (child == kEmptyChild) continue;
            links.count += countOf(child);
            if (child & kLeaf) {
                links.cost += costOfLeaf(tree_, child) * boxOf(node, slot).area();
            } else {
                links.cost += tree_.nodes[child].links.cost;
                links.height = std::max(links.height, tree_.nodes[child].links.height);
            }
        }
        ++links.height;
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

    /// Adds to `fresher` what the cost of the subtree if it were new has changed by. False: it is the whole
    /// tree that has drifted.
    bool inspect(std::uint32_t index, float& fresher) {
        const float fresh = freshCost(index), excess = excessOf(index);
        const bool few = tree_.nodes[index].links.count <= kFew;
        if (!(excess > (few ? kDriftOfFew : kDrift) * fresh)) return true;
        float explained = 0;
        for (const std::uint32_t child : tree_.nodes[index].child)
            if (!(child & kLeaf)) explained += std::max(0.0f, excessOf(child));
        if (!(explained >= excess / 2)) return rebuild(index, fresher);
        float below = 0;
        for (int slot = 0; slot < kLanes; ++slot) {
            const std::uint32_t child = tree_.nodes[index].child[slot];
            if (!(child & kLeaf) && !inspect(child, below)) return false;
        }
        sum(index);
        Node::Links& links = tree_.nodes[index].links;
        links.costThen = fresh + below;
        links.countThen = links.count;
        fresher += below;
        return true;
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

    bool rebuild(std::uint32_t index, float& fresher) {
        const Node::Links links = tree_.nodes[index].links;
        if (links.parent == kEmptyChild) return false;
        const float fresh = freshCost(index);
        members_.clear();
        release(index);
        const auto count = static_cast<std::uint32_t>(members_.size());
        report_.rebuilt += count;
        std::unique_ptr<Reference[]> references(new Reference[count]);
        for (std::uint32_t i = 0; i < count; ++i)
            if (!referenceOf(primitives_, members_[i], center_, scale_, references[i]))
                return false;
        const Cells cells(primitives_, std::move(references), count, scale_, options_);
        const std::uint32_t child = emitSubtree(cells, primitives_, options_.storage, links.parent,
                                                links.slot, tree_, places_);
        tree_.nodes[links.parent].child[links.slot] = child;
        fresher += cells[cells.root()].cost[0] - fresh;
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
    std::vector<Item> items_;
    std::uint64_t singles_ = 0;
    std::vector<std::uint32_t> members_; // scratch
    std::vector<Reference> references_;  // scratch
    LeafContents scratch_;
};

} // namespace

bool update(Tree& tree, UpdateState& state, const double center[3], double scale,
            const Primitives& primitives, const BuildOptions& options,
            std::span<const PrimitiveId> moved, UpdateReport& report) {
    return Updater(tree, state, center, scale, primitives, options, report).run(moved);
}

} // namespace rt::octree
