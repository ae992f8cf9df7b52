#include <core/octree/update.hpp>

#include <core/octree/cut.hpp>
#include <core/octree/entrance.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/prefetch.hpp>
#include <core/octree/references.hpp>
#include <core/octree/shares.hpp>
#include <core/octree/upkeep.hpp>

#include <algorithm>
#include <bit>

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
          options_(options), writer_(primitives, {options.storage}), places_(tree, state),
          upkeep_(tree, state, center, scale, primitives, options, places_, report),
          report_(report), isMoved_((primitives.count() + 63) / 64) {}

    bool run(std::span<const PrimitiveId> moved) {
        if (tree_.nodes.size() == 0) return moved.empty();
        for (std::size_t i = 0; i < moved.size(); ++i) {
            prefetchAhead(moved, i);
            if (!mark(static_cast<std::uint32_t>(moved[i]))) return false;
        }
        if (!tree_.nodes[0].links.marks) return true;
        listEdits(0, 0);
        // By turns over as many leaves as the cache holds: short loops, each with little code (octree_bench --moves:
        // a leaf at a time takes 20 % longer, all at once 5 %).
        constexpr std::uint32_t kTogether = 64;
        for (std::size_t i = 0, leaf = 0; i < edits_.size();) {
            const std::size_t last = std::min<std::size_t>(i + kTogether, edits_.size());
            for (; leaf < edits_[last - 1].endOfLeaves; ++leaf) lookInto(leaf);
            for (; i < last; ++i)
                if (!editLeaves(i)) return false;
        }
        for (std::size_t i = edits_.size(); i-- > 0;) finish(i);
        const std::uint32_t count = primitives_.count();
        if (items_.size() > count / kWorthBuilding) return false;
        state_.singles += singles_;
        root_ = boxOf(tree_.nodes[0]);
        enterAll();
        if (!upkeep_.followDrift(moved.size(), singles_)) return false;
        return tree_.nodes[0].links.height <= kMaxDepth && !upkeep_.hasTooManyNodes() &&
               state_.singles <= kManySingles * count && state_.garbage <= tree_.bytes() / 2;
    }

private:
    /// A node below which something has moved.
    struct Edit {
        std::uint32_t node, above; // above: its parent's, in edits_
        std::uint32_t endOfLeaves; // its last one's in leaves_, and one
        unsigned marks;            // bit per slot
        unsigned movedSlots = 0;   // whose primitives have all moved
        bool allMoved = true;      // every primitive below
        Share change{};            // of what it has below
        Box before{};
    };
    /// One of its leaves.
    struct MovedLeaf {
        std::uint32_t reference;
        int slot;
        unsigned moved = 0;                    // which of its triangles, bit per position
        std::uint32_t count = 0, triangle = 0; // how many it has; one that moved
    };

    bool moved(std::uint32_t id) const { return isMoved_[id / 64] >> id % 64 & 1; }

    /// Node::Links::marks: bit per slot below which something has moved.
    bool mark(std::uint32_t id) {
        std::uint32_t at = tree_.leafOf[id];
        if (at == Tree::kNoLeaf) return false;
        isMoved_[id / 64] |= std::uint64_t{1} << id % 64;
        for (;;) {
            Node::Links& links = tree_.nodes[at / kLanes].links;
            const bool isKnown = links.marks != 0;
            links.marks |= static_cast<std::uint8_t>(1u << at % kLanes);
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

    /// Parents before their children.
    void listEdits(std::uint32_t index, std::uint32_t above) {
        const Node& node = tree_.nodes[index];
        const unsigned marks = node.links.marks;
        for (unsigned m = marks; m; m &= m - 1) {
            const int slot = std::countr_zero(m);
            if (node.child[slot] & kLeaf) leaves_.push_back({node.child[slot], slot});
        }
        const auto at = static_cast<std::uint32_t>(edits_.size());
        edits_.push_back({index, above, static_cast<std::uint32_t>(leaves_.size()), marks});
        for (unsigned m = marks; m; m &= m - 1) {
            const std::uint32_t child = node.child[std::countr_zero(m)];
            if (!(child & kLeaf)) listEdits(child, at);
        }
    }

    // Each pass over the leaves or nodes asks memory for what it will look at a few further on.

    void lookInto(std::size_t at) {
        constexpr std::size_t kStep = 8;
        if (at + 2 * kStep < leaves_.size()) prefetch(tree_, leaves_[at + 2 * kStep].reference);
        MovedLeaf& leaf = leaves_[at];
        if (!isTriangles(leaf.reference)) return;
        const auto ids = idsOfTriangles(tree_, leaf.reference);
        leaf.count = static_cast<std::uint32_t>(ids.size());
        for (std::size_t i = 0; i < ids.size(); ++i)
            leaf.moved |= static_cast<unsigned>(moved(ids[i])) << i;
        leaf.triangle = indexInKind(primitives_, ids[std::countr_zero(leaf.moved)]);
        prefetchLines(primitives_.triangles.indices[leaf.triangle]);
    }

    // ---- 1. what moved stays or leaves ---------------------------------------------------------------

    struct Edited {
        bool stands = true;   // false: the tree cannot follow
        bool allMoved = true; // every primitive below has moved
        std::uint32_t reference = kEmptyChild;
        Box box;
    };

    bool editLeaves(std::size_t at) {
        constexpr std::size_t kStep = 4;
        if (at + kStep < edits_.size()) prefetchLines(tree_.nodes[edits_[at + kStep].node]);
        Edit& edit = edits_[at];
        Node& node = tree_.nodes[edit.node];
        edit.before = boxOf(node);
        for (int slot = 0; slot < kLanes; ++slot)
            edit.allMoved &= node.child[slot] == kEmptyChild || (edit.marks >> slot & 1);
        node.links.marks = 0;
        for (; nextLeaf_ < edit.endOfLeaves; ++nextLeaf_) {
            const MovedLeaf& leaf = leaves_[nextLeaf_];
            if (nextLeaf_ + 2 * kStep < leaves_.size()) {
                const MovedLeaf& next = leaves_[nextLeaf_ + 2 * kStep];
                prefetch(tree_, next.reference);
                if (next.moved)
                    for (const std::uint32_t c : primitives_.triangles.indices[next.triangle])
                        prefetchLines(primitives_.triangles.positions[c]);
            }
            const Box before = boxOf(node, leaf.slot);
            edit.change -= shareOf(tree_, node, leaf.slot);
            const Edited edited = editLeaf(leaf, before);
            if (!edited.stands) return false;
            setLeaf(node, leaf.slot, edited.reference);
            settle(edit, leaf.slot, edited);
        }
        return true;
    }

    /// What has become of a child whose place is set.
    void settle(Edit& edit, int slot, const Edited& child) {
        Node& node = tree_.nodes[edit.node];
        setBox(node, slot, child.box);
        edit.change += shareOf(tree_, node, slot);
        if (child.reference == kEmptyChild) return;
        if (child.allMoved)
            edit.movedSlots |= 1u << slot;
        else
            edit.allMoved = false;
    }

    /// A node whose children are all edited.
    void finish(std::size_t at) {
        constexpr std::size_t kStep = 4;
        if (at >= kStep) prefetchLines(tree_.nodes[edits_[at - kStep].node]);
        Edit& edit = edits_[at];
        const std::uint32_t index = edit.node;
        if (!edit.allMoved && edit.movedSlots)
            leaveFrom(index, edit.movedSlots, edit.before, edit.change);
        mergeLeaves(index, edit.marks, edit.change);
        absorb(index, edit.change);
        Node& node = tree_.nodes[index];
        Edited result;
        result.allMoved = edit.allMoved;
        int count = 0;
        for (const std::uint32_t child : node.child)
            if (child != kEmptyChild) {
                ++count;
                result.reference = child;
            }
        result.box = boxOf(node);
        const Share before{node.links.cost, node.links.count};
        node.links.count += edit.change.count;
        node.links.cost += edit.change.cost + kNodeCost * (result.box.area() - edit.before.area());
        if (index == 0) return;
        Edit& above = edits_[edit.above];
        const auto slot = static_cast<int>(node.links.slot);
        if (count > 1) {
            result.reference = index;
        } else {
            places_.freeNode(index);
            attach(result.reference, above.node, slot);
        }
        above.change -= before;
        settle(above, slot, result);
    }

    /// A leaf that has lost some of its primitives takes those of another, where that costs less.
    void mergeLeaves(std::uint32_t index, std::uint32_t marks, Share& change) {
        for (; marks; marks &= marks - 1) {
            const int slot = __builtin_ctz(marks);
            const Node& node = tree_.nodes[index];
            const std::uint32_t leaf = node.child[slot];
            const int room = kLanes - node.links.leafSize[slot];
            if (leaf == kEmptyChild || !(leaf & kLeaf) || !isTriangles(leaf) || room <= 0) continue;
            const Box box = boxOf(node, slot);
            const Joined joined(node, box);
            const int best = leastOf(joined.growth, joined.leaves & ~(1u << slot));
            if (best < 0 || node.links.leafSize[best] > room || !isTriangles(node.child[best]) ||
                !(joined.growth[best] < kMerged * box.area()))
                continue;
            merge(index, best, slot, change);
        }
    }

    void merge(std::uint32_t index, int into, int from, Share& change) {
        Box box = boxOf(tree_.nodes[index], into);
        const Box lost = boxOf(tree_.nodes[index], from);
        const std::uint32_t source = tree_.nodes[index].child[from];
        std::uint32_t target = tree_.nodes[index].child[into];
        change -= shareOf(tree_, tree_.nodes[index], from);
        change -= shareOf(tree_, tree_.nodes[index], into);
        for (int i = 0; i < tree_.nodes[index].links.leafSize[from]; ++i) {
            const LooseTriangle triangle = triangleAt(tree_, source, i);
            target = joined(target, triangle);
            tree_.leafOf[triangle.id] = kLanes * index + static_cast<std::uint32_t>(into);
        }
        places_.freeLeaf(source);
        box.add(lost);
        tree_.nodes[index].child[from] = kEmptyChild;
        setBox(tree_.nodes[index], from, Box());
        setLeaf(tree_.nodes[index], into, target);
        setBox(tree_.nodes[index], into, box);
        change += shareOf(tree_, tree_.nodes[index], into);
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
            const Share share = shareOf(tree_, node, slot);
            change -= share;
            report_.entered += share.count;
            node.child[slot] = kEmptyChild;
            setBox(node, slot, Box());
        }
    }

    /// A shared block whose triangles have all moved, and share the same corners: only those change.
    bool moveCorners(SharedBlock& block, const Box& before, Box& box) const {
        const geometry::Vec3* const positions = primitives_.triangles.positions.data();
        const auto* const indices = primitives_.triangles.indices.data();
        std::uint32_t corner[kSharedLanes] = {};
        unsigned used = 0;
        const int count = __builtin_popcount(block.valid);
        for (int lane = 0; lane < count; ++lane) {
            const auto& triangle = indices[indexInKind(primitives_, block.id[lane])];
            for (std::size_t c = 0; c < 3; ++c) {
                corner[block.index[c][lane]] = triangle[c];
                used |= 1u << block.index[c][lane];
            }
        }
        bool isSame = true; // corner of all that share its place
        for (int lane = 0; lane < count; ++lane) {
            const auto& triangle = indices[indexInKind(primitives_, block.id[lane])];
            for (std::size_t c = 0; c < 3; ++c)
                isSame &= corner[block.index[c][lane]] == triangle[c];
        }
        if (!isSame) return false;
        numeric::Box3d bounds;
        for (unsigned m = used; m; m &= m - 1) {
            const geometry::Vec3& p = positions[corner[__builtin_ctz(m)]];
            if (!numeric::isFinite(p)) return false;
            bounds.add(p);
        }
        if (!isBoxed(bounds, box) || !(box.area() <= kTurned * before.area())) return false;
        const int first = __builtin_ctz(used);
        for (int i = 0; i < kSharedLanes; ++i)
            for (int a = 0; a < 3; ++a)
                block.corner[a][i] = positions[corner[used >> i & 1 ? i : first]][a];
        return true;
    }

    /// inOctreeSpace(), into a box.
    bool isBoxed(const numeric::Box3d& bounds, Box& box) const {
        alignas(16) float lower[4] = {}, upper[4] = {};
        const bool isInside = inOctreeSpace(bounds, center_, scale_, lower, upper);
        box = {_mm_load_ps(lower), _mm_load_ps(upper)};
        return isInside;
    }

    Edited editLeaf(const MovedLeaf& known, const Box& before) {
        const std::uint32_t leaf = known.reference;
        Edited result;
        if (isTriangles(leaf)) {
            if (known.moved + 1 != 1u << known.count) {
                singles_ += static_cast<unsigned>(std::popcount(known.moved));
                return editTriangles(leaf, known.moved, before);
            }
            if (kindOfLeaf(leaf) == kSharedLeaf &&
                moveCorners(tree_.shared[leaf & kLeafIndex], before, result.box)) {
                result.reference = leaf;
                return result;
            }
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
                if (r.kind == static_cast<std::uint32_t>(geometry::Kind::triangle)) {
                    leave(single, looseOf(r.id));
                } else {
                    items_.push_back({single, kEmptyChild, r, {}});
                    ++report_.entered;
                }
            }
        }
        if (!result.allMoved) singles_ += movedCount;
        places_.freeLeaf(leaf);
        if (staying) result.reference = writeLeaf(references_.data(), staying);
        result.box = rest;
        return result;
    }

    /// Of a leaf with triangles, of which not all have moved: the others stay as they are.
    Edited editTriangles(std::uint32_t leaf, unsigned moved, const Box& before) {
        Edited result;
        result.allMoved = false;
        result.reference = leaf;
        if (kindOfLeaf(leaf) == kNarrowSharedLeaf)
            state_.garbage += 4 * static_cast<unsigned>(std::popcount(moved));
        LooseTriangle loose[kSharedLanes];
        int count = 0;
        const auto ids = idsOfTriangles(tree_, leaf);
        for (unsigned m = moved; m; m &= m - 1) loose[count++] = looseOf(ids[std::countr_zero(m)]);
        result.stands = isBoxed(dropTriangles(tree_, leaf, moved), result.box);
        const float limit = kGrowth * before.area();
        for (int i = 0; i < count; ++i) {
            const LooseTriangle& triangle = loose[i];
            Box single;
            if (!isBoxed(triangle, single)) {
                result.stands = false;
                return result;
            }
            Box with = result.box;
            with.add(single);
            if (with.area() <= limit && hasRoom(tree_, result.reference, triangle)) {
                result.box = with;
                result.reference = joined(result.reference, triangle);
            } else {
                leave(single, triangle);
            }
        }
        return result;
    }

    void leave(const Box& box, const LooseTriangle& triangle) {
        items_.push_back({box, kEmptyChild, {}, triangle});
        Reference& r = items_.back().primitive;
        r.id = triangle.id;
        r.kind = static_cast<std::uint32_t>(geometry::Kind::triangle);
        ++report_.entered;
    }

    bool isBoxed(const LooseTriangle& triangle, Box& box) const {
        numeric::Box3d bounds;
        for (const geometry::Vec3& p : triangle.corner) {
            if (!numeric::isFinite(p)) return false;
            bounds.add(p);
        }
        return isBoxed(bounds, box);
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
        return writer_.write(tree_, places_, first, n, sharesBlock(primitives_, first, first + n),
                             scratch_);
    }

    void setLeaf(Node& node, int slot, std::uint32_t leaf) const {
        node.child[slot] = leaf;
        node.links.leafSize[slot] =
            leaf == kEmptyChild ? std::uint8_t{0} : leafSizeOf(sizeOfLeaf(tree_, leaf));
    }

    /// Puts a child into a slot; its box is set by the caller.
    void attach(std::uint32_t reference, std::uint32_t index, int slot) {
        const auto at = static_cast<std::uint32_t>(slot);
        tree_.nodes[index].child[slot] = reference;
        if (reference == kEmptyChild) return;
        if (!(reference & kLeaf)) {
            tree_.nodes[reference].links.parent = index;
            tree_.nodes[reference].links.slot = static_cast<std::uint8_t>(slot);
            return;
        }
        members_.clear();
        idsOfLeaf(tree_, reference, members_);
        tree_.nodes[index].links.leafSize[slot] = leafSizeOf(members_.size());
        for (const std::uint32_t id : members_) tree_.leafOf[id] = kLanes * index + at;
    }

    // ---- 2. what left enters --------------------------------------------------------------------------

    /// Some at a time look for their places in turns, so that each waits for memory while the others go on. Who finds
    /// that another has changed the node meanwhile looks again.
    void enterAll() {
        constexpr std::size_t kTogether = 8;
        std::vector<Search> searches;
        std::vector<std::uint32_t> changed;
        for (std::size_t first = 0; first < items_.size(); first += kTogether) {
            const std::size_t last = std::min(first + kTogether, items_.size());
            searches.clear();
            changed.clear();
            for (std::size_t i = first; i < last; ++i) searches.emplace_back(items_[i]);
            for (bool isLooking = true; isLooking;) {
                isLooking = false;
                for (Search& search : searches)
                    isLooking |= search.step(tree_, options_.maxObjects);
            }
            for (const Search& search : searches) {
                const Place& place = search.found();
                if (place.kind == Place::join)
                    prefetch(tree_, tree_.nodes[place.node].child[place.at]);
            }
            for (std::size_t i = first; i < last; ++i) {
                Place place = searches[i - first].found();
                if (std::find(changed.begin(), changed.end(), place.node) != changed.end()) {
                    Search again(items_[i]);
                    while (again.step(tree_, options_.maxObjects)) {
                    }
                    place = again.found();
                }
                changed.push_back(place.node);
                enter(items_[i], place);
            }
        }
    }

    void enter(const Item& item, const Place& place) {
        const std::uint32_t node = place.node;
        const int slot = place.at;
        const Box beside = boxOf(tree_.nodes[node], slot);
        Box box = beside;
        box.add(item.box);
        const std::uint32_t sibling = tree_.nodes[node].child[slot];
        Share change;
        const Share shareBeside = shareOf(tree_, tree_.nodes[node], slot);
        change -= shareBeside;
        std::uint32_t entered;
        if (place.kind == Place::slot) {
            entered = asChild(item);
        } else if (place.kind == Place::join) {
            entered = join(sibling, item);
            setLeaf(tree_.nodes[node], slot, entered);
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
            share += shareBeside;
            share += shareOf(tree_, child, item.box);
            const auto height = std::max(heightOf(tree_, sibling), heightOf(tree_, child)) + 1;
            const float drift = sibling & kLeaf ? 0 : excessOf(tree_, sibling);
            pair.links.parent = node;
            pair.links.count = pair.links.countThen = share.count;
            pair.links.cost = share.cost;
            pair.links.costThen = share.cost - drift;
            pair.links.height = static_cast<std::uint16_t>(height);
            pair.links.marks = 0;
        }
        if (place.kind != Place::join) attach(entered, node, slot);
        setBox(tree_.nodes[node], slot, box);
        change += shareOf(tree_, tree_.nodes[node], slot);
        for (std::uint32_t index = node;;) {
            Node::Links& links = tree_.nodes[index].links;
            links.count += change.count;
            if (index == 0) {
                Box all = root_;
                all.add(item.box);
                links.cost += change.cost + kNodeCost * (all.area() - root_.area());
                root_ = all;
                raise(links, heightOf(tree_, entered) + 1);
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
            raise(links, heightOf(tree_, entered) + 1);
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
        if (item.child != kEmptyChild) return item.child;
        return item.primitive.kind == static_cast<std::uint32_t>(geometry::Kind::triangle)
                   ? leafOf(tree_, places_, options_.storage, item.triangle)
                   : writeLeaf(&item.primitive, 1);
    }

    Tree& tree_;
    UpdateState& state_;
    const double* const center_;
    const double scale_;
    const Primitives& primitives_;
    const BuildOptions& options_;
    const LeafWriter writer_;
    FreePlaces places_;
    Upkeep upkeep_;
    UpdateReport& report_;
    std::vector<std::uint64_t> isMoved_; // bit per id
    std::vector<Edit> edits_;
    std::vector<MovedLeaf> leaves_; // of those, in their order
    std::size_t nextLeaf_ = 0;
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
