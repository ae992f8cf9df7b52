// The octree: octants whose planes slide to where they cost least, cut once in x, y and z, children merged by cost.
#pragma once
#include <core/geometry/ray.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

namespace rt::octree {

using geometry::Crossing;
using geometry::Hit;
using geometry::Primitives;
using geometry::Ray;

/// Which compiled copy of the queries runs. All give the same bits.
enum class Simd : std::uint8_t { best, baseline, avx2, avx512 };

/// How leaves hold the corners of triangles; gives the same bits in any case.
enum class Storage : std::uint8_t {
    narrowest, // in f32 where that is exact for the whole leaf, else f64
    f64
};

/// How rays meet primitives.
enum class Precision : std::uint8_t {
    exact, // as closestBruteForce() does, bit for bit
    /// Approximately, for comparison: planes, edges, t, u and v are f32, relative to the size of the whole. Rays may slip
    /// through edges; hits nearer than 2^-18 of half that size are missed, and all by rays from farther than 2^36
    /// times as far; of hits at nearly one distance any may win, and a batch may choose another than a ray alone.
    /// Shapes of plugins answer as ever. A ray alone gets the same bits at every SIMD level. Updates build anew.
    f32
};

/// What measurement chose: octree_bench --sweep.
struct Tuning {
    int bins = 16;              // places for a plane along an axis, at most 32
    std::uint32_t leastCut = 4; // cells of as many primitives or fewer are not cut
    float blockCost = 1;        // of testing one block, in visits of a node
};

struct BuildOptions {
    std::uint32_t maxObjects = 16; // largest number of primitives in a cell that is not cut further
    double minSize = 0; // cells with all sides <= this are not cut, world units; 0: no limit
    Storage storage = Storage::narrowest;
    Precision precision = Precision::exact;
    int threads = 0;      // 0: all that the process may use
    bool movable = false; // keeps what update() needs, 4 bytes a primitive; else it builds anew
    Tuning tuning = {};
    Simd simd = Simd::best; // best: what RT_SIMD asks for, or else the widest that this CPU has
};

struct Statistics {
    std::uint64_t nodes = 0, leaves = 0, blocks = 0, bytes = 0;
    double cost =
        0; // node visits and blocks tested per line through the root's box, by surface area
    std::uint32_t depth = 0;
    std::vector<std::uint64_t> leafHistogram; // [n]: leaves with n primitives
};

/// What the caller knows of a batch of rays; it decides the speed, never the answers.
enum class Coherence : std::uint8_t {
    /// Neighbours in the span start and point alike: camera rays of a tile in small blocks (best 4x4),
    /// shadow rays from there to one light. They are traced together, 16 at a time.
    coherent,
    /// Neighbours have nothing in common: each is traced by itself, but several take turns, so that they neither
    /// wait for memory nor make the CPU guess where a ray goes next.
    incoherent
};

/// Counters of one traversal thread; filled only by the counting twin of each query.
struct Visits {
    std::uint64_t nodes = 0, triangles = 0, spheres = 0, parallelograms = 0, customs = 0;
};

/// What an update did; in primitives.
struct UpdateReport {
    std::uint64_t moved = 0; // that were named
    std::uint64_t entered =
        0; // that left their place in the tree for another, subtrees with all they hold
    std::uint64_t rebuilt = 0; // in parts of the tree, or the whole, that were built anew
    bool whole = false;        // everything was built anew
};

/// One crossing of ray number `ray` of a batch.
struct Found {
    double t;
    std::uint32_t id, ray;
};

/// What the rays of a batch cross.
class CrossingLists {
public:
    /// Did the ray meet something opaque? Then it has no list.
    bool isEnded(std::size_t ray) const { return ended_.data()[ray]; }
    /// By rising t then id.
    std::span<const Crossing> of(std::size_t ray) const {
        const std::uint32_t* const end = end_.data() + ray;
        const std::uint32_t first = ray ? end[-1] : 0;
        return {all_.data() + first, *end - first};
    }

private:
    friend class Octree;
    std::vector<Crossing> all_;
    std::vector<std::uint32_t> end_; // by ray, in all_
    std::vector<std::uint8_t> ended_;
    std::vector<Found> found_; // room for what the kernel finds
};

/// Immutable after build but for update(); queries are const and thread-safe. Results depend on the primitives alone: smallest t,
/// equal t by lowest id, whatever the tree looks like; but see Precision::f32.
class Octree {
public:
    Octree();
    ~Octree();
    Octree(Octree&&) noexcept;
    Octree& operator=(Octree&&) noexcept;

    /// Keeps a reference to `primitives`, which must outlive the tree.
    static Octree build(const Primitives& primitives, const BuildOptions& options = {});

    /// Makes this the tree of `primitives`, to which a reference is kept instead, as build() does; answers
    /// are those of a fresh build, bit for bit. `moved`: every id whose geometry is not what it was, in
    /// any order; more of them do no harm. Segments must be the same as before; other ids are
    /// std::invalid_argument.
    ///
    /// For frames of a film or a viewer: build once with `movable`, then update between frames; no query
    /// may run meanwhile. Primitives that moved together keep their common subtree, others leave and enter;
    /// parts whose cost has drifted are built anew, and everything when most primitives have moved apart or
    /// one is outside of the tree's space. After an exception the tree is empty.
    UpdateReport update(const Primitives& primitives, std::span<const geometry::PrimitiveId> moved);

    /// Nearest hit in (0, ray.tMax).
    Hit closest(const Ray& ray, Visits* visits = nullptr) const;
    /// Is there any hit in (0, ray.tMax)?
    bool occluded(const Ray& ray, Visits* visits = nullptr) const;
    /// Every crossing in (0, ray.tMax), both sides of a sphere, by rising t then id, appended to `out`;
    /// stops early and returns false as soon as `opaque[material]` is met, and then appends nothing.
    /// A ray through an edge or a corner of a mesh crosses one of the triangles around it.
    bool crossings(const Ray& ray, const std::vector<bool>& opaqueMaterials,
                   std::vector<Crossing>& out, Visits* visits = nullptr) const;

    /// lists.of(i) = crossings(rays[i]), isEnded(i) where that is false; rays and visits as below.
    void crossings(std::span<const Ray> rays, const std::vector<bool>& opaqueMaterials,
                   CrossingLists& lists, Visits* visits = nullptr) const;

    /// hits[i] = closest(rays[i]), with the same bits, for any number of rays. `coherence` is of neighbours
    /// in the span. Rays and hits are read and written only during the call; each hit is written once.
    /// Visits count what was really done: a node or a triangle that 16 rays meet together counts once.
    /// Throws std::invalid_argument unless the spans are of equal size.
    void closest(std::span<const Ray> rays, std::span<Hit> hits, Coherence coherence,
                 Visits* visits = nullptr) const;
    /// answers[i] = occluded(rays[i]), 0 or 1; otherwise as above.
    void occluded(std::span<const Ray> rays, std::span<std::uint8_t> answers, Coherence coherence,
                  Visits* visits = nullptr) const;

    /// As closest, but every block of every leaf is tested, without the nodes: for tests. Not of Precision::f32:
    /// std::logic_error.
    Hit closestWithoutTree(const Ray& ray) const;

    /// Visits the whole tree. std::logic_error if a node says that it is lower than it is.
    Statistics statistics() const;
    /// "avx512", "avx2" or "baseline": what this process runs.
    /// Throws std::invalid_argument if RT_SIMD names another, or one that this CPU does not have.
    static std::string_view simdLevel();
    /// Does this CPU have it?
    static bool supports(Simd simd);

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// The definition of every query: scalar, without a tree. Bit-equal to the octree's answers.
Hit closestBruteForce(const Primitives& primitives, const Ray& ray);
bool occludedBruteForce(const Primitives& primitives, const Ray& ray);
/// Every crossing, also of opaque materials, by rising t then id.
std::vector<Crossing> crossingsBruteForce(const Primitives& primitives, const Ray& ray);

} // namespace rt::octree
