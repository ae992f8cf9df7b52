// The arrays of a tree.
#pragma once
#include <core/octree/layout.hpp>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <new>
#include <vector>

#include <sys/mman.h>

namespace rt::octree {

inline LeafKind kindOfLeaf(std::uint32_t reference) {
    return static_cast<LeafKind>(reference >> kLeafKindShift & 7);
}
inline std::uint32_t leafReference(LeafKind kind, std::uint32_t index) {
    return kLeaf | static_cast<std::uint32_t>(kind) << kLeafKindShift | index;
}

/// A 64-byte aligned array of plain data whose elements start uninitialised.
template <class T> class Array {
public:
    Array() = default;
    explicit Array(std::size_t size) { resize(size); }
    T& operator[](std::size_t i) { return items_.get()[i]; }
    const T& operator[](std::size_t i) const { return items_.get()[i]; }
    T* data() { return items_.get(); }
    const T* data() const { return items_.get(); }
    std::size_t size() const { return size_; }
    std::size_t bytes() const { return size_ * sizeof(T); }

    /// Keeps what fits. Grows by half, but to no more than asked for at first, with room for `more`.
    void resize(std::size_t size, std::size_t more = 0) {
        if (size > capacity_) {
            const std::size_t capacity =
                capacity_ ? std::max(size, capacity_ + capacity_ / 2) : size + more;
            const std::size_t wanted = capacity * sizeof(T);
            const std::size_t alignment = wanted < kHugePage ? kAlignment : kHugePage;
            const std::size_t bytes = (wanted + alignment - 1) / alignment * alignment;
            std::unique_ptr<T, Free> grown(static_cast<T*>(std::aligned_alloc(alignment, bytes)));
            if (!grown) throw std::bad_alloc();
            // Only advice: without it random rays of a large tree miss the TLB (octree_bench, ico: 20 %;
            // scan70k in f32, 4 MB: all rays 4 %).
            if (alignment == kHugePage)
                madvise(grown.get(), wanted / kHugePage * kHugePage, MADV_HUGEPAGE);
            if (size_) std::memcpy(grown.get(), items_.get(), size_ * sizeof(T));
            items_ = std::move(grown);
            capacity_ = capacity;
        }
        size_ = size;
    }

private:
    static constexpr std::size_t kAlignment = 64, kHugePage = 2u << 20;
    struct Free {
        void operator()(T* p) const { std::free(p); }
    };
    std::unique_ptr<T, Free> items_;
    std::size_t size_ = 0, capacity_ = 0;
};

enum Part : std::uint8_t {
    kNodes,
    kShared,
    kTriangles,
    kNarrowShared,
    kNarrowTriangles,
    kSpheres,
    kParallelograms,
    kRecords,
    kRuns,
    kCustoms,
    kParts
};

/// Gives out places in the arrays of a tree.
class Places {
public:
    /// The first of `count` in a row.
    virtual std::uint32_t take(Part part, std::uint32_t count = 1) = 0;

protected:
    ~Places() = default;
};

/// How many of each array something takes, or where it starts in each.
struct Extent final : Places {
    std::array<std::uint32_t, kParts> of{};

    std::uint32_t take(Part part, std::uint32_t count = 1) override {
        const std::uint32_t first = of[part];
        of[part] += count;
        return first;
    }
    Extent& operator+=(const Extent& other) {
        for (std::size_t i = 0; i < kParts; ++i) of[i] += other.of[i];
        return *this;
    }
};

struct Tree {
    Array<Node> nodes;
    Array<SharedBlock> shared;
    Array<TriangleBlock> triangles;
    Array<NarrowSharedBlock> narrowShared;
    Array<NarrowTriangleBlock> narrowTriangles;
    Array<SphereBlock> spheres;
    Array<ParallelogramBlock> parallelograms;
    Array<LeafRecord> records;
    Array<CustomRun> runs;
    Array<std::uint32_t> customPrimitives, customIds;
    bool isF32 = false; // Precision::f32: all blocks but shared ones are narrow triangle blocks
    LeafRecord unbounded{};
    /// By id: kLanes · node + slot of the leaf that holds it, kNoLeaf of unbounded ones. Empty in a tree
    /// that is not to be updated.
    Array<std::uint32_t> leafOf;

    static constexpr std::uint32_t kNoLeaf = 0xFFFFFFFFu;

    Extent extent() const {
        Extent e;
        e.of = {size(nodes),          size(shared),          size(triangles),
                size(narrowShared),   size(narrowTriangles), size(spheres),
                size(parallelograms), size(records),         size(runs),
                size(customIds)};
        return e;
    }
    void resize(const Extent& e) {
        // What moves ends up in new nodes and f64 blocks; pages that nothing uses cost nothing.
        const auto half = [&](std::uint32_t count) { return leafOf.size() > 0 ? count / 2 : 0; };
        nodes.resize(e.of[kNodes], half(e.of[kNodes]));
        shared.resize(e.of[kShared], half(e.of[kShared] + e.of[kNarrowShared]));
        triangles.resize(e.of[kTriangles], half(e.of[kTriangles] + e.of[kNarrowTriangles]));
        narrowShared.resize(e.of[kNarrowShared]);
        narrowTriangles.resize(e.of[kNarrowTriangles]);
        spheres.resize(e.of[kSpheres]);
        parallelograms.resize(e.of[kParallelograms]);
        records.resize(e.of[kRecords]);
        runs.resize(e.of[kRuns]);
        customPrimitives.resize(e.of[kCustoms]);
        customIds.resize(e.of[kCustoms]);
    }
    std::size_t bytes() const {
        return nodes.bytes() + shared.bytes() + triangles.bytes() + narrowShared.bytes() +
               narrowTriangles.bytes() + spheres.bytes() + parallelograms.bytes() +
               records.bytes() + runs.bytes() + customPrimitives.bytes() + customIds.bytes() +
               leafOf.bytes();
    }

private:
    template <class T> static std::uint32_t size(const Array<T>& array) {
        return static_cast<std::uint32_t>(array.size());
    }
};

} // namespace rt::octree
