// The queries as one SIMD level compiles them: kernel.inl, bundle.inl and queries.inl, three times, with the flags of the level.
#pragma once
#include <core/octree/layout.hpp>

#include <cstddef>

namespace rt::octree {

struct Visits;
struct Found;

/// Where crossing queries put what they find; rays are numbers in the batch.
struct CrossingSink {
    Found* found;
    std::size_t count, room;
    void (*grow)(CrossingSink&); // makes room for one more at least
    /// Ends the ray.
    bool (*isOpaque)(const CrossingSink&, std::uint32_t id);
    /// Of a ray whose line touches an edge: decides exactly.
    void (*touch)(CrossingSink&, std::uint32_t ray, std::uint32_t id);
    /// Returns false to end the ray.
    bool (*custom)(CrossingSink&, std::uint32_t ray, const CustomRun& run);
};

/// How many of each a tree has.
struct BlockCounts {
    std::uint32_t shared, triangles, narrowShared, narrowTriangles, spheres, parallelograms, runs;
};

/// Plain data only crosses between levels: code compiled for AVX may share no inline function with the
/// rest, or the linker could keep the wrong copy.
struct Kernel {
    const char* name;
    void (*closest)(const TreeView&, const geometry::Ray&, geometry::Hit*, Visits*);
    bool (*occluded)(const TreeView&, const geometry::Ray&, Visits*);
    /// ended[i]: 1 where ray i met something opaque. What the others crossed comes in any order.
    void (*crossings)(const TreeView&, const geometry::Ray*, std::size_t count, CrossingSink&,
                      std::uint8_t* ended, Visits*);
    void (*closestBatch)(const TreeView&, const geometry::Ray*, std::size_t count, bool coherent,
                         geometry::Hit*, Visits*);
    void (*occludedBatch)(const TreeView&, const geometry::Ray*, std::size_t count, bool coherent,
                          std::uint8_t* answers, Visits*);
    /// closest without the tree: every block of every leaf. Null where leaves are Precision::f32.
    void (*scan)(const TreeView&, const BlockCounts&, const geometry::Ray&, geometry::Hit*);
};

/// kernelF32: for trees of Precision::f32.
namespace avx512 {
extern const Kernel kernel, kernelF32;
}
namespace avx2 {
extern const Kernel kernel, kernelF32;
}
namespace baseline {
extern const Kernel kernel, kernelF32;
}

/// One indirect call: the closest of a run before `limit` (equal t by lowest id); where its id is in
/// TreeView::customIds, or null.
const std::uint32_t* closestOfRun(const TreeView& tree, const CustomRun& run,
                                  const geometry::Ray& ray, double limit, double& t);

} // namespace rt::octree
