#include <core/octree/octree.hpp>

#include <core/geometry/intersect.hpp>
#include <core/geometry/surface.hpp>
#include <core/octree/cells.hpp>
#include <core/octree/emit.hpp>
#include <core/octree/kernel.hpp>
#include <core/octree/references.hpp>
#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace rt::octree {
namespace {

using geometry::Kind;
using geometry::PrimitiveId;

const Kernel& kernelOf(Simd simd) {
    switch (simd) {
    case Simd::avx512:
        return avx512::kernel;
    case Simd::avx2:
        return avx2::kernel;
    default:
        return baseline::kernel;
    }
}

constexpr Simd kWidestFirst[] = {Simd::avx512, Simd::avx2, Simd::baseline};

Simd levelOfProcess() {
    const char* const wanted = std::getenv("RT_SIMD");
    if (!wanted || !*wanted) {
        for (const Simd simd : kWidestFirst)
            if (Octree::supports(simd)) return simd;
    }
    for (const Simd simd : kWidestFirst) {
        if (std::string_view(wanted) != kernelOf(simd).name) continue;
        if (Octree::supports(simd)) return simd;
        throw std::invalid_argument("RT_SIMD=" + std::string(wanted) +
                                    ": this CPU does not have it");
    }
    throw std::invalid_argument("RT_SIMD=" + std::string(wanted) +
                                ": must be avx512, avx2 or baseline");
}

Simd chosenLevel() {
    static const Simd level = levelOfProcess();
    return level;
}

void requireEqualSizes(std::size_t rays, std::size_t answers) {
    if (rays != answers)
        throw std::invalid_argument("a batch of " + std::to_string(rays) +
                                    " rays needs as many answers, not " + std::to_string(answers));
}

bool byTThenId(const Crossing& a, const Crossing& b) {
    return a.t != b.t ? a.t < b.t : a.id < b.id;
}

/// Index into the array of its kind.
std::uint32_t indexOf(const geometry::Segment& segment, std::uint32_t id) {
    return segment.index + id - static_cast<std::uint32_t>(segment.first);
}

/// One crossing query under way.
struct CrossingQuery {
    const Primitives& primitives;
    const TreeView& tree;
    const Ray& ray;
    const std::vector<bool>& opaque;
    std::vector<Crossing>& out;

    bool isOpaque(std::uint32_t id) const {
        const auto material =
            static_cast<std::size_t>(geometry::materialOf(primitives, PrimitiveId{id}));
        return material < opaque.size() && opaque[material];
    }
    bool add(double t, std::uint32_t id) {
        if (isOpaque(id)) return false;
        out.push_back({t, PrimitiveId{id}});
        return true;
    }
    bool touch(std::uint32_t id) {
        if (isOpaque(id)) return false;
        const geometry::Segment& segment = primitives.segmentOf(PrimitiveId{id});
        const std::uint32_t index = indexOf(segment, id);
        const geometry::RayFrame frame = geometry::frameOf(ray);
        double t;
        bool crosses;
        if (segment.kind == Kind::triangle) {
            const auto& triangles = primitives.triangles;
            const auto& corner = triangles.indices[index];
            crosses = geometry::crossTriangle(frame, triangles.positions[corner[0]],
                                              triangles.positions[corner[1]],
                                              triangles.positions[corner[2]], ray.tMax, t);
        } else {
            crosses = geometry::crossParallelogram(
                frame, geometry::cornersOf(primitives.parallelograms[index]), ray.tMax, t);
        }
        if (crosses) out.push_back({t, PrimitiveId{id}});
        return true;
    }
    bool custom(const CustomRun& run) {
        const geometry::CustomShape& shape = *primitives.customs.shapes[run.shape];
        for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
            const std::size_t before = out.size();
            geometry::crossCustom(shape, tree.customPrimitives[i], PrimitiveId{tree.customIds[i]},
                                  ray, out);
            if (out.size() > before && isOpaque(tree.customIds[i])) return false;
        }
        return true;
    }
};

CrossingSink sinkOf(CrossingQuery& query) {
    return {
        &query,
        [](void* q, double t, std::uint32_t id) {
            return static_cast<CrossingQuery*>(q)->add(t, id);
        },
        [](void* q, std::uint32_t id) { return static_cast<CrossingQuery*>(q)->touch(id); },
        [](void* q, const CustomRun& run) { return static_cast<CrossingQuery*>(q)->custom(run); }};
}

} // namespace

bool closestOfRun(const TreeView& tree, const CustomRun& run, const Ray& ray, double limit,
                  double& t, std::uint32_t& id) {
    // A hit at the limit itself still wins by a lower id; tMax stays exclusive.
    const double tMax = std::min(numeric::nextUp(limit), ray.tMax);
    const std::uint32_t* const primitives = tree.customPrimitives + run.first;
    std::uint32_t primitive;
    if (!geometry::intersectCustom(*tree.primitives->customs.shapes[run.shape], primitives,
                                   run.count, ray, tMax, t, primitive))
        return false;
    id = tree.customIds[run.first +
                        (std::find(primitives, primitives + run.count, primitive) - primitives)];
    return true;
}

struct Octree::Impl {
    const Primitives* primitives = nullptr;
    const Kernel* kernel = nullptr;
    Tree tree;
    TreeView view{};
};

Octree::Octree() = default;
Octree::~Octree() = default;
Octree::Octree(Octree&&) noexcept = default;
Octree& Octree::operator=(Octree&&) noexcept = default;

Octree Octree::build(const Primitives& primitives, const BuildOptions& options) {
    Octree octree;
    octree.impl_ = std::make_unique<Impl>();
    Impl& impl = *octree.impl_;
    impl.primitives = &primitives;
    impl.kernel = &kernelOf(options.simd == Simd::best ? chosenLevel() : options.simd);
    TreeView& view = impl.view;
    const auto run = [&] {
        References references = referencesOf(primitives);
        for (int i = 0; i < 3; ++i) view.center[i] = references.center[i];
        view.scale = references.scale;
        const Cells cells(primitives, std::move(references.bounded), references.boundedCount,
                          references.scale, options);
        impl.tree = emit(cells, references.unbounded, primitives, options.storage);
    };
    // Starting threads costs more than a small tree.
    constexpr std::uint32_t kWorthThreads = 4096;
    parallel::withThreads(primitives.count() < kWorthThreads ? 1 : options.threads, run);
    const Tree& tree = impl.tree;
    view.nodes = tree.nodes.data();
    view.hasSpheres = tree.spheres.size() > 0;
    view.shared = tree.shared.data();
    view.triangles = tree.triangles.data();
    view.narrowShared = tree.narrowShared.data();
    view.narrowTriangles = tree.narrowTriangles.data();
    view.narrowIds = tree.narrowIds.data();
    view.spheres = tree.spheres.data();
    view.parallelograms = tree.parallelograms.data();
    view.records = tree.records.data();
    view.runs = tree.runs.data();
    view.customPrimitives = tree.customPrimitives.data();
    view.customIds = tree.customIds.data();
    view.primitives = &primitives;
    view.unbounded = tree.unbounded;
    view.hasUnbounded = tree.unbounded.triangleBlocks + tree.unbounded.sphereBlocks +
                            tree.unbounded.parallelogramBlocks + tree.unbounded.runCount >
                        0;
    return octree;
}

Hit Octree::closest(const Ray& ray, Visits* visits) const {
    Hit hit;
    if (impl_) impl_->kernel->closest(impl_->view, ray, &hit, visits);
    return hit;
}

bool Octree::occluded(const Ray& ray, Visits* visits) const {
    return impl_ && impl_->kernel->occluded(impl_->view, ray, visits);
}

bool Octree::crossings(const Ray& ray, const std::vector<bool>& opaqueMaterials,
                       std::vector<Crossing>& out, Visits* visits) const {
    if (!impl_) return true;
    const std::size_t before = out.size();
    CrossingQuery query{*impl_->primitives, impl_->view, ray, opaqueMaterials, out};
    if (!impl_->kernel->crossings(impl_->view, ray, sinkOf(query), visits)) {
        out.resize(before);
        return false;
    }
    std::sort(out.begin() + static_cast<std::ptrdiff_t>(before), out.end(), byTThenId);
    return true;
}

void Octree::closest(std::span<const Ray> rays, std::span<Hit> hits, Coherence coherence,
                     Visits* visits) const {
    requireEqualSizes(rays.size(), hits.size());
    if (impl_)
        impl_->kernel->closestBatch(impl_->view, rays.data(), rays.size(),
                                    coherence == Coherence::coherent, hits.data(), visits);
    else
        std::fill(hits.begin(), hits.end(), Hit());
}

void Octree::occluded(std::span<const Ray> rays, std::span<std::uint8_t> answers,
                      Coherence coherence, Visits* visits) const {
    requireEqualSizes(rays.size(), answers.size());
    if (impl_)
        impl_->kernel->occludedBatch(impl_->view, rays.data(), rays.size(),
                                     coherence == Coherence::coherent, answers.data(), visits);
    else
        std::fill(answers.begin(), answers.end(), std::uint8_t{0});
}

Hit Octree::closestWithoutTree(const Ray& ray) const {
    Hit hit;
    if (!impl_) return hit;
    const Tree& tree = impl_->tree;
    const auto count = [](const auto& array) { return static_cast<std::uint32_t>(array.size()); };
    impl_->kernel->scan(impl_->view,
                        {count(tree.shared), count(tree.triangles), count(tree.narrowShared),
                         count(tree.narrowTriangles), count(tree.spheres),
                         count(tree.parallelograms), count(tree.runs)},
                        ray, &hit);
    return hit;
}

Statistics Octree::statistics() const {
    Statistics s;
    if (!impl_) return s;
    const Tree& tree = impl_->tree;
    s.nodes = tree.nodes.size();
    s.blocks = tree.shared.size() + tree.triangles.size() + tree.narrowShared.size() +
               tree.narrowTriangles.size() + tree.spheres.size() + tree.parallelograms.size();
    s.bytes = tree.nodes.bytes() + tree.shared.bytes() + tree.triangles.bytes() +
              tree.narrowShared.bytes() + tree.narrowTriangles.bytes() + tree.narrowIds.bytes() +
              tree.spheres.bytes() + tree.parallelograms.bytes() + tree.records.bytes() +
              tree.runs.bytes() + tree.customPrimitives.bytes() + tree.customIds.bytes();
    const auto inUse = [](const std::uint32_t* id) {
        std::size_t n = 0;
        while (n < kLanes && id[n] != kEmptyChild) ++n;
        return n;
    };
    struct Visit {
        std::uint32_t reference, depth;
    };
    std::vector<Visit> stack;
    if (tree.nodes.size() > 0) stack.push_back({0, 1});
    while (!stack.empty()) {
        const auto [reference, depth] = stack.back();
        stack.pop_back();
        if (!(reference & kLeaf)) {
            s.depth = std::max(s.depth, depth);
            for (const std::uint32_t child : tree.nodes[reference].child)
                if (child != kEmptyChild) stack.push_back({child, depth + 1});
            continue;
        }
        const std::uint32_t index = reference & kLeafIndex;
        std::size_t count = 0;
        switch (reference >> kLeafKindShift & 7) {
        case kSharedLeaf:
            count = static_cast<std::size_t>(__builtin_popcount(tree.shared[index].valid));
            break;
        case kNarrowSharedLeaf:
            count = static_cast<std::size_t>(__builtin_popcount(tree.narrowShared[index].valid));
            break;
        case kNarrowTriangleLeaf:
            count = inUse(tree.narrowTriangles[index].id);
            break;
        case kTriangleLeaf:
            count = inUse(tree.triangles[index].id);
            break;
        case kSphereLeaf:
            count = inUse(tree.spheres[index].id);
            break;
        case kParallelogramLeaf:
            count = inUse(tree.parallelograms[index].id);
            break;
        default: {
            const LeafRecord& leaf = tree.records[index];
            for (std::uint32_t i = 0; i < leaf.triangleBlocks; ++i)
                count += inUse(tree.triangles[leaf.triangles + i].id);
            for (std::uint32_t i = 0; i < leaf.sphereBlocks; ++i)
                count += inUse(tree.spheres[leaf.spheres + i].id);
            for (std::uint32_t i = 0; i < leaf.parallelogramBlocks; ++i)
                count += inUse(tree.parallelograms[leaf.parallelograms + i].id);
            for (std::uint32_t i = 0; i < leaf.runCount; ++i)
                count += tree.runs[leaf.runs + i].count;
        }
        }
        ++s.leaves;
        if (s.leafHistogram.size() <= count) s.leafHistogram.resize(count + 1);
        ++s.leafHistogram[count];
    }
    return s;
}

std::string_view Octree::simdLevel() { return kernelOf(chosenLevel()).name; }

bool Octree::supports(Simd simd) {
    switch (simd) {
    case Simd::avx512:
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
               __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw") &&
               __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma");
    case Simd::avx2:
        return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") &&
               __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2");
    default:
        return true;
    }
}

} // namespace rt::octree
