// The queries as one SIMD level compiles them: kernel.inl, bundle.inl and queries.inl, three times, with the flags of the level.
#pragma once
#include <core/octree/layout.hpp>

#include <cstddef>

namespace rt::octree {

struct Visits;

/// Where a crossing query puts what it finds. Both return false to stop the query.
struct CrossingSink {
    void* context;
    bool (*add)(void* context, double t, std::uint32_t id);
    bool (*touch)(void* context, std::uint32_t id); // the line touches an edge: decide exactly
    bool (*custom)(void* context, const CustomRun& run);
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
    bool (*crossings)(const TreeView&, const geometry::Ray&, const CrossingSink&, Visits*);
    void (*closestBatch)(const TreeView&, const geometry::Ray*, std::size_t count, bool coherent,
                         geometry::Hit*, Visits*);
    void (*occludedBatch)(const TreeView&, const geometry::Ray*, std::size_t count, bool coherent,
                          std::uint8_t* answers, Visits*);
    /// closest without the tree: every block of every leaf.
    void (*scan)(const TreeView&, const BlockCounts&, const geometry::Ray&, geometry::Hit*);
};

namespace avx512 {
extern const Kernel kernel;
}
namespace avx2 {
extern const Kernel kernel;
}
namespace baseline {
extern const Kernel kernel;
}

/// One indirect call: the closest of a run before `limit` (equal t by lowest id); where its id is in
/// TreeView::customIds, or null.
const std::uint32_t* closestOfRun(const TreeView& tree, const CustomRun& run,
                                  const geometry::Ray& ray, double limit, double& t);

} // namespace rt::octree
