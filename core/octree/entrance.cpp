#include <core/octree/entrance.hpp>

#include <core/octree/cut.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/prefetch.hpp>

namespace rt::octree {
namespace {

constexpr float kInfinityF32 = std::numeric_limits<float>::infinity();

/// Does the leaf stay one block with this primitive in it?
bool fits(const Tree& tree, std::uint32_t leaf, std::uint32_t size, const Item& item,
          std::uint32_t maxObjects) {
    if (size >= maxObjects) return false;
    switch (static_cast<geometry::Kind>(item.primitive.kind)) {
    case geometry::Kind::triangle:
        return isTriangles(leaf) && (size < kLanes || hasRoom(tree, leaf, item.triangle));
    case geometry::Kind::sphere:
        return kindOfLeaf(leaf) == kSphereLeaf && size < kLanes;
    case geometry::Kind::parallelogram:
        return kindOfLeaf(leaf) == kParallelogramLeaf && size < kLanes;
    case geometry::Kind::custom:
        return false;
    }
    return false;
}

} // namespace

int slotFor(const Box& a, const Box& b) {
    return _mm_movemask_ps(
               _mm_cmpgt_ps(_mm_add_ps(a.lower, a.upper), _mm_add_ps(b.lower, b.upper))) &
           7;
}

int freeSlotFor(const Node& node, const Box& box) {
    const int octant = slotFor(box, boxOf(node));
    for (const int flips : {0, 1, 2, 4, 3, 5, 6, 7})
        if (node.child[octant ^ flips] == kEmptyChild) return octant ^ flips;
    return -1;
}

Joined::Joined(const Node& node, const Box& box) {
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
        const __m128i child = _mm_load_si128(reinterpret_cast<const __m128i*>(node.child + s));
        const auto bits = [s](__m128i v) {
            return static_cast<unsigned>(_mm_movemask_ps(_mm_castsi128_ps(v))) << s;
        };
        empty |= bits(_mm_cmpeq_epi32(child, _mm_set1_epi32(-1)));
        nodes |= bits(child); // where the top bit is set, for now
    }
    leaves = nodes & ~empty;
    nodes = ~nodes & 0xFF;
}

// Without branches, which nobody could foresee.
int leastOf(const float (&value)[kLanes], unsigned slots) {
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

bool Search::step(const Tree& tree, std::uint32_t maxObjects) {
    if (leaf_ != kEmptyChild && fits(tree, leaf_, leafSize_, *item_, maxObjects))
        best_.offer(Place::join, node_, leafSlot_, leafCost_);
    leaf_ = kEmptyChild;
    if (next_ == kEmptyChild || inherited_ > best_.cost) return false;
    node_ = next_;
    const Node& node = tree.nodes[node_];
    const Joined joined(node, item_->box);
    const int down = leastOf(joined.growth, joined.nodes),
              leaf = leastOf(joined.growth, joined.leaves),
              beside = leastOf(joined.area, joined.nodes | joined.leaves);
    next_ = down >= 0 ? node.child[down] : kEmptyChild;
    if (down >= 0) prefetch(tree, next_);
    if (joined.empty)
        best_.offer(Place::slot, node_, freeSlotFor(node, item_->box), inherited_ + own_);
    else
        best_.offer(Place::pair, node_, beside,
                    inherited_ + own_ + kNodeCost * joined.area[beside]);
    if (isSingle_ && leaf >= 0) {
        leafCost_ = inherited_ + kBlockCost * joined.growth[leaf];
        if (leafCost_ <= best_.cost) {
            leaf_ = node.child[leaf];
            leafSlot_ = leaf;
            leafSize_ = node.links.leafSize[leaf];
            if (leafSize_ >= kLanes) prefetch(tree, leaf_);
        }
    }
    if (down >= 0) inherited_ += kNodeCost * joined.growth[down];
    return true;
}

} // namespace rt::octree
