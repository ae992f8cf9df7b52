// Nodes, blocks and leaf records from cells.
#pragma once
#include <core/octree/cells.hpp>
#include <core/octree/layout.hpp>
#include <core/octree/octree.hpp>

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <vector>

namespace rt::octree {

/// A 64-byte aligned array whose elements start uninitialised.
template <class T> class Array {
public:
    Array() = default;
    explicit Array(std::size_t size) : size_(size) {
        if (size == 0) return;
        const std::size_t bytes = (size * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
        items_.reset(static_cast<T*>(std::aligned_alloc(kAlignment, bytes)));
        if (!items_) throw std::bad_alloc();
    }
    T& operator[](std::size_t i) { return items_.get()[i]; }
    const T& operator[](std::size_t i) const { return items_.get()[i]; }
    T* data() { return items_.get(); }
    const T* data() const { return items_.get(); }
    std::size_t size() const { return size_; }
    std::size_t bytes() const { return size_ * sizeof(T); }

private:
    static constexpr std::size_t kAlignment = 64;
    struct Free {
        void operator()(T* p) const { std::free(p); }
    };
    std::unique_ptr<T, Free> items_;
    std::size_t size_ = 0;
};

struct Tree {
    Array<Node> nodes;
    Array<SharedBlock> shared;
    Array<TriangleBlock> triangles;
    Array<NarrowSharedBlock> narrowShared;
    Array<NarrowTriangleBlock> narrowTriangles;
    Array<std::uint32_t> narrowIds;
    Array<SphereBlock> spheres;
    Array<ParallelogramBlock> parallelograms;
    Array<LeafRecord> records;
    Array<CustomRun> runs;
    Array<std::uint32_t> customPrimitives, customIds;
    LeafRecord unbounded{};
};

/// The same bytes for any number of threads. `unbounded`: primitives that are in no cell.
Tree emit(const Cells& cells, const std::vector<Reference>& unbounded,
          const geometry::Primitives& primitives, Storage storage = Storage::narrowest);

} // namespace rt::octree
