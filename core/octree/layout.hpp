// The bytes of the octree.
//
// Node, 256 bytes, 4 cache lines: the tight boxes of up to 8 children as 6 rows of 8 f32, their 8
// references, 32 bytes for updates. The slot of a child is the octant of the node that it is nearest to, so
// visiting slots in the order of the ray's signs goes from near to far.
// Shared block, 512 bytes: up to 16 triangles that share up to 16 corners; corners as 3 rows of 16 f64,
// triangles as 3 rows of 16 bytes that index them, and ids. Most meshes live in these.
// Triangle block, 640 bytes: the corners of up to 8 triangles as 9 rows of 8 f64, and their ids; for
// triangles that share too few corners.
// Narrow shared block and narrow triangle block, 320 bytes: the same with corners in f32, for leaves whose corners f32 holds exactly. Kernels widen them first, so
// answers are the same bits.
// Sphere block, 320 bytes; parallelogram block, 832 bytes: likewise.
// In a tree of Precision::f32 leaves hold narrow shared blocks, with corners in octree space, and narrow
// triangle blocks for all else: of triangles and parallelograms a corner and the edges from it, of spheres
// centre and radius in the first rows.
// Unused lanes hold NaN, which no test accepts; unused children hold a box that no ray meets.
//
// Node planes are in octree space: (world − centre) · scale, in [−1, 1], rounded outward; scale is a
// power of two. So f32 boxes are as tight far from the origin, or at any size, as near it.
#pragma once
#include <core/geometry/ray.hpp>

#include <cstdint>

namespace rt::octree {

inline constexpr int kLanes = 8;

struct alignas(64) Node {
    float planes[6][kLanes]; // [2 · axis + (0 lower, 1 upper)][child]
    std::uint32_t child[kLanes];
    struct Links {               // for updates; queries read none of it
        std::uint32_t parent;    // of the root: kEmptyChild
        std::uint32_t count;     // primitives below
        float cost;              // of the subtree, by surface area in octree space
        std::uint32_t countThen; // when the subtree was built
        float costThen;
        std::uint8_t slot;             // in the parent; of the root: 0
        std::uint8_t marks;            // of the update under way
        std::uint16_t height;          // levels of nodes, itself included
        std::uint8_t leafSize[kLanes]; // primitives in each child that is a leaf, at most 255
    } links;
};
static_assert(sizeof(Node) == 256);

inline constexpr int kSharedLanes = 16;

struct alignas(64) SharedBlock {
    double corner[3][kSharedLanes];      // [axis][corner]
    std::uint8_t index[3][kSharedLanes]; // [corner of the triangle][lane]
    std::uint32_t id[kSharedLanes];
    std::uint32_t valid; // bit per lane
    std::uint32_t spare[3];
};
static_assert(sizeof(SharedBlock) == 512);

struct alignas(64) TriangleBlock {
    double corner[3][3][kLanes]; // [corner][axis][lane]
    std::uint32_t id[kLanes];
    std::uint32_t spare[kLanes];
};
static_assert(sizeof(TriangleBlock) == 640);

struct alignas(64) NarrowSharedBlock {
    float corner[3][kSharedLanes];
    std::uint8_t index[3][kSharedLanes];
    std::uint32_t valid;
    std::uint32_t spare[3];
    std::uint32_t id[kSharedLanes];
};
static_assert(sizeof(NarrowSharedBlock) == 320);

struct alignas(64) NarrowTriangleBlock {
    float corner[3][3][kLanes];
    std::uint32_t id[kLanes];
};
static_assert(sizeof(NarrowTriangleBlock) == 320);

struct alignas(64) SphereBlock {
    double center[3][kLanes], radius[kLanes];
    std::uint32_t id[kLanes];
    std::uint32_t spare[kLanes];
};
static_assert(sizeof(SphereBlock) == 320);

struct alignas(64) ParallelogramBlock {
    double corner[4][3][kLanes]; // geometry::cornersOf
    std::uint32_t id[kLanes];
    std::uint32_t spare[kLanes];
};
static_assert(sizeof(ParallelogramBlock) == 832);

/// Custom primitives of one shape in one leaf: one indirect call.
struct CustomRun {
    std::uint32_t shape;        // index into Customs::shapes
    std::uint32_t first, count; // into TreeView::customPrimitives and customIds
};

/// A leaf that is more than one block.
struct LeafRecord {
    std::uint32_t triangles, triangleBlocks;
    std::uint32_t spheres, sphereBlocks;
    std::uint32_t parallelograms, parallelogramBlocks;
    std::uint32_t runs, runCount;
};

// A reference to a child: the index of a node, or kLeaf, a LeafKind and the index of a block or record.
inline constexpr std::uint32_t kLeaf = 1u << 31;
inline constexpr int kLeafKindShift = 28;
inline constexpr std::uint32_t kLeafIndex = (1u << kLeafKindShift) - 1;
inline constexpr std::uint32_t kEmptyChild = 0xFFFFFFFFu;
enum LeafKind : std::uint32_t {
    kTriangleLeaf = 0,
    kSphereLeaf = 1,
    kParallelogramLeaf = 2,
    kMixedLeaf = 3,
    kSharedLeaf = 4,
    kNarrowSharedLeaf = 5,
    kNarrowTriangleLeaf = 6
};

/// Entries of a traversal stack: 7 a level, and one more of the last above one that marks the end; the builder cuts no
/// deeper than this allows.
inline constexpr int kStackSize = 1024;
inline constexpr int kMaxDepth = (kStackSize - 8) / 7;

/// What the kernels see of a tree.
struct TreeView {
    const Node* nodes; // node 0 is the root; null when the tree has none
    const SharedBlock* shared;
    const TriangleBlock* triangles;
    const NarrowSharedBlock* narrowShared;
    const NarrowTriangleBlock* narrowTriangles;
    const SphereBlock* spheres;
    const ParallelogramBlock* parallelograms;
    const LeafRecord* records;
    const CustomRun* runs;
    const std::uint32_t* customPrimitives;
    const std::uint32_t* customIds;
    const geometry::Primitives* primitives;
    struct Place {
        const void* first;
        std::size_t size; // of one
    };
    Place places[16]; // where a reference leads, by its upper four bits; for prefetching
    double center[4]; // [3]: 0
    double scale, inverseScale;
    bool hasTriangles, hasSpheres, hasUnbounded;
    LeafRecord unbounded; // primitives without finite bounds: every ray tests them
};

} // namespace rt::octree
