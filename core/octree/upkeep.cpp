#include <core/octree/upkeep.hpp>

#include <core/octree/emit.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/prefetch.hpp>
#include <core/octree/references.hpp>
#include <core/octree/shares.hpp>

#include <algorithm>

namespace rt::octree {
namespace {

// Chosen by octree_bench --moves; see A3 of tests/stability for what they keep.
// Subtrees built anew by themselves: when so much of their cost is drift, and so much of the tree's.
constexpr float kDrift = 0.1f, kFelt = 0.03f;
// Upkeep: subtrees of 1/32 of all primitives, 256 to 4096; one built anew for each that moved alone where the
// tree costs 0.1 more than a new one, by the square of that elsewhere.
constexpr std::uint32_t kFewShare = 32, kLeastFew = 256, kMostFew = 4096;
constexpr float kAllowed = 0.1f, kLeastUpkeep = 0.25f, kMostUpkeep = 2;
constexpr float kMemory = 0.9f; // from one update to the next, of what upkeep gained
// Nodes: too many when there are 1 + 1/4 times as many as when the whole was built, and 1.4 times as many as new
// subtrees have.
constexpr std::uint32_t kNodesPart = 4;
constexpr float kMostNodes = 1.4f, kTrusted = 256; // nodes of new subtrees that say anything

} // namespace

void Upkeep::findDrifted(std::uint32_t index, Drifted& found) const {
    const Node::Links& links = tree_.nodes[index].links;
    const float excess = excessOf(tree_, index);
    const std::uint32_t few = std::clamp(primitives_.count() / kFewShare, kLeastFew, kMostFew);
    if (links.count <= few && index != 0) {
        if (excess > 0) found.few.push_back(index);
        return;
    }
    float explained = 0;
    for (const std::uint32_t child : tree_.nodes[index].child)
        if (!(child & kLeaf)) explained += std::max(0.0f, excessOf(tree_, child));
    if (excess > kDrift * freshCost(tree_, index) && excess > kFelt * tree_.nodes[0].links.cost &&
        !(explained >= excess / 2))
        return found.whole.push_back(index);
    for (const std::uint32_t child : tree_.nodes[index].child)
        if (!(child & kLeaf)) findDrifted(child, found);
}

bool Upkeep::followDrift(std::uint64_t moved, std::uint64_t singles) {
    Drifted drifted;
    findDrifted(0, drifted);
    for (const std::uint32_t node : drifted.whole)
        if (!rebuild(node)) return false;
    const auto perPrimitive = [&](std::uint32_t node) {
        return excessOf(tree_, node) / static_cast<float>(tree_.nodes[node].links.count);
    };
    std::sort(drifted.few.begin(), drifted.few.end(),
              [&](std::uint32_t a, std::uint32_t b) { return perPrimitive(a) > perPrimitive(b); });
    const float excess = state_.costAfter > 0 ? state_.costBefore / state_.costAfter - 1 : 0;
    const float worn = excess / kAllowed;
    const float upkeep = std::clamp(worn * worn, kLeastUpkeep, kMostUpkeep);
    const bool isFelt = excessOf(tree_, 0) > kFelt * tree_.nodes[0].links.cost;
    std::uint64_t built = 0;
    for (const std::uint32_t node : drifted.few) {
        const float drift = excessOf(tree_, node) / freshCost(tree_, node);
        if (!(static_cast<float>(built) <
              static_cast<float>(singles) * upkeep +
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

bool Upkeep::hasTooManyNodes() const {
    return liveNodes() > state_.nodesThen + state_.nodesThen / kNodesPart + kLanes &&
           !(state_.nodesAfter > kTrusted && state_.nodesBefore < kMostNodes * state_.nodesAfter);
}

void Upkeep::release(std::uint32_t reference) {
    if (reference == kEmptyChild) return;
    if (reference & kLeaf) {
        idsOfLeaf(tree_, reference, members_);
        return places_.freeLeaf(reference);
    }
    for (const std::uint32_t child : tree_.nodes[reference].child)
        if (child != kEmptyChild) prefetch(tree_, child);
    for (const std::uint32_t child : tree_.nodes[reference].child) release(child);
    places_.freeNode(reference);
}

/// What rebuild() will look at after the i-th of its members.
void Upkeep::prefetchAhead(std::size_t i) const {
    constexpr std::size_t kStep = 8;
    const auto& triangles = primitives_.triangles;
    const auto indicesOf = [&](std::size_t at) -> const std::array<std::uint32_t, 3>* {
        if (at >= members_.size()) return nullptr;
        const auto& segment = primitives_.segmentOf(geometry::PrimitiveId{members_[at]});
        return segment.kind == geometry::Kind::triangle
                   ? &triangles.indices[indexInKind(primitives_, members_[at])]
                   : nullptr;
    };
    if (const auto* indices = indicesOf(i + 2 * kStep)) prefetchLines(*indices);
    if (const auto* indices = indicesOf(i + kStep))
        for (const std::uint32_t c : *indices) prefetchLines(triangles.positions[c]);
}

bool Upkeep::rebuild(std::uint32_t index) {
    const Node::Links links = tree_.nodes[index].links;
    if (links.parent == kEmptyChild) return false;
    const float fresh = freshCost(tree_, index);
    members_.clear();
    const std::size_t all = liveNodes();
    release(index);
    const std::size_t others = liveNodes();
    const auto count = static_cast<std::uint32_t>(members_.size());
    report_.rebuilt += count;
    Array<Reference> references(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        prefetchAhead(i);
        if (!referenceOf(primitives_, members_[i], center_, scale_, references[i])) return false;
    }
    const Cells cells(primitives_, std::move(references), count, scale_, options_);
    const std::uint32_t child = emitSubtree(cells, primitives_, {options_.storage}, links.parent,
                                            links.slot, tree_, places_);
    Node& parent = tree_.nodes[links.parent];
    parent.child[links.slot] = child;
    if (child & kLeaf) parent.links.leafSize[links.slot] = leafSizeOf(count);
    const float cost = shareOf(tree_, child, boxOf(parent, static_cast<int>(links.slot))).cost;
    state_.costBefore += links.cost;
    state_.costAfter += cost;
    state_.nodesBefore += static_cast<float>(all - others);
    state_.nodesAfter += static_cast<float>(liveNodes() - others);
    std::uint32_t height = heightOf(tree_, child);
    for (std::uint32_t above = links.parent; above != kEmptyChild;) {
        Node::Links& changed = tree_.nodes[above].links;
        raise(changed, ++height);
        changed.costThen = freshCost(tree_, above) + cost - fresh;
        changed.countThen = changed.count;
        changed.cost += cost - links.cost;
        above = changed.parent;
    }
    return true;
}

} // namespace rt::octree
