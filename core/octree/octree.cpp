#include <core/octree/octree.hpp>

#include <core/geometry/intersect.hpp>
#include <core/geometry/surface.hpp>
#include <core/octree/box.hpp>
#include <core/octree/by_origin.hpp>
#include <core/octree/cells.hpp>
#include <core/octree/emit.hpp>
#include <core/octree/kernel.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/references.hpp>
#include <core/octree/shares.hpp>
#include <core/octree/update.hpp>
#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <utility>

namespace rt::octree {
namespace {

using geometry::Kind;
using geometry::PrimitiveId;

const Kernel& kernelOf(Simd simd, Precision precision = Precision::exact) {
    const bool exact = precision == Precision::exact;
    switch (simd) {
    case Simd::avx512:
        return exact ? avx512::kernel : avx512::kernelF32;
    case Simd::avx2:
        return exact ? avx2::kernel : avx2::kernelF32;
    default:
        return exact ? baseline::kernel : baseline::kernelF32;
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

/// With fewer primitives a block, most lie apart: a soup and spheres have 4.2 to 4.7; meshes, whose blocks of 512 bytes
/// come to 53 a triangle or fewer, at least 9.
constexpr std::size_t kLooseInBlock = 6;

bool byTThenId(const Crossing& a, const Crossing& b) {
    return a.t != b.t ? a.t < b.t : a.id < b.id;
}

/// Index into the array of its kind.
std::uint32_t indexOf(const geometry::Segment& segment, std::uint32_t id) {
    return segment.index + id - static_cast<std::uint32_t>(segment.first);
}

/// A batch of crossing queries under way.
struct CrossingQuery final : CrossingSink {
    const Primitives& primitives;
    const TreeView& tree;
    std::span<const Ray> rays;
    const std::vector<bool>& opaque;
    std::vector<Found>& more; // where `few` are not enough
    std::vector<Crossing> ofCustom;

    CrossingQuery(const Primitives& p, const TreeView& view, std::span<const Ray> of,
                  const std::vector<bool>& opaqueMaterials, std::span<Found> few,
                  std::vector<Found>& memory)
        : CrossingSink{few.data(), 0, few.size(), growing, testing, touching, crossing},
          primitives(p), tree(view), rays(of), opaque(opaqueMaterials), more(memory) {}

    std::span<const Found> all() const { return {found, count}; }

private:
    static CrossingQuery& of(CrossingSink& sink) { return static_cast<CrossingQuery&>(sink); }

    static void growing(CrossingSink& sink) {
        std::vector<Found>& more = of(sink).more;
        if (sink.found != more.data()) more.assign(sink.found, sink.found + sink.count);
        more.resize(std::max<std::size_t>(256, 2 * sink.count));
        sink.found = more.data();
        sink.room = more.size();
    }
    static bool testing(const CrossingSink& sink, std::uint32_t id) {
        const auto& query = static_cast<const CrossingQuery&>(sink);
        const auto material =
            static_cast<std::size_t>(geometry::materialOf(query.primitives, PrimitiveId{id}));
        return material < query.opaque.size() && query.opaque[material];
    }
    void add(std::uint32_t ray, double t, std::uint32_t id) {
        if (count == room) growing(*this);
        found[count++] = {t, id, ray};
    }
    static void touching(CrossingSink& sink, std::uint32_t ray, std::uint32_t id) {
        CrossingQuery& query = of(sink);
        const Primitives& primitives = query.primitives;
        const geometry::Segment& segment = primitives.segmentOf(PrimitiveId{id});
        const std::uint32_t index = indexOf(segment, id);
        const double tMax = query.rays[ray].tMax;
        const geometry::RayFrame frame = geometry::frameOf(query.rays[ray]);
        double t;
        bool crosses;
        if (segment.kind == Kind::triangle) {
            const auto& triangles = primitives.triangles;
            const auto& corner = triangles.indices[index];
            crosses = geometry::crossTriangle(frame, triangles.positions[corner[0]],
                                              triangles.positions[corner[1]],
                                              triangles.positions[corner[2]], tMax, t);
        } else {
            crosses = geometry::crossParallelogram(
                frame, geometry::cornersOf(primitives.parallelograms[index]), tMax, t);
        }
        if (crosses) query.add(ray, t, id);
    }
    static bool crossing(CrossingSink& sink, std::uint32_t ray, const CustomRun& run) {
        CrossingQuery& query = of(sink);
        const geometry::CustomShape& shape = *query.primitives.customs.shapes[run.shape];
        for (std::uint32_t i = run.first; i < run.first + run.count; ++i) {
            const std::uint32_t id = query.tree.customIds[i];
            query.ofCustom.clear();
            geometry::crossCustom(shape, query.tree.customPrimitives[i], PrimitiveId{id},
                                  query.rays[ray], query.ofCustom);
            if (!query.ofCustom.empty() && testing(sink, id)) return false;
            for (const Crossing& c : query.ofCustom) query.add(ray, c.t, id);
        }
        return true;
    }
};

} // namespace

const std::uint32_t* closestOfRun(const TreeView& tree, const CustomRun& run, const Ray& ray,
                                  double limit, double& t) {
    // A hit at the limit itself still wins by a lower id; tMax stays exclusive.
    const double tMax = std::min(numeric::nextUp(limit), ray.tMax);
    const std::uint32_t* const primitives = tree.customPrimitives + run.first;
    std::uint32_t primitive;
    if (!geometry::intersectCustom(*tree.primitives->customs.shapes[run.shape], primitives,
                                   run.count, ray, tMax, t, primitive))
        return nullptr;
    return tree.customIds + run.first +
           (std::find(primitives, primitives + run.count, primitive) - primitives);
}

struct Octree::Impl {
    const Primitives* primitives = nullptr;
    BuildOptions options;
    std::vector<geometry::Segment> segments; // of *primitives, which may be gone at an update
    const Kernel* kernel = nullptr;
    Tree tree;
    UpdateState state;
    TreeView view{};
    bool isLoose = false; // primitives lie apart, see areLoose() in cells.cpp

    void bind(const Primitives& to);
};

void Octree::Impl::bind(const Primitives& to) {
    primitives = &to;
    view.nodes = tree.nodes.data();
    view.hasTriangles = tree.shared.size() + tree.triangles.size() + tree.narrowShared.size() +
                            tree.narrowTriangles.size() >
                        0;
    view.hasSpheres = tree.spheres.size() > 0;
    const std::size_t blocks = tree.shared.size() + tree.triangles.size() +
                               tree.narrowShared.size() + tree.narrowTriangles.size() +
                               tree.spheres.size();
    isLoose = to.count() < kLooseInBlock * blocks;
    view.shared = tree.shared.data();
    view.triangles = tree.triangles.data();
    view.narrowShared = tree.narrowShared.data();
    view.narrowTriangles = tree.narrowTriangles.data();
    view.spheres = tree.spheres.data();
    view.parallelograms = tree.parallelograms.data();
    view.records = tree.records.data();
    view.runs = tree.runs.data();
    view.customPrimitives = tree.customPrimitives.data();
    view.customIds = tree.customIds.data();
    view.primitives = &to;
    const auto place = [](const auto& array) {
        return TreeView::Place{array.data(), sizeof array[0]};
    };
    for (int i = 0; i < 8; ++i) view.places[i] = place(tree.nodes);
    view.places[8 + kSharedLeaf] = place(tree.shared);
    view.places[8 + kTriangleLeaf] = place(tree.triangles);
    view.places[8 + kNarrowSharedLeaf] = place(tree.narrowShared);
    view.places[8 + kNarrowTriangleLeaf] = place(tree.narrowTriangles);
    view.places[8 + kSphereLeaf] = place(tree.spheres);
    view.places[8 + kParallelogramLeaf] = place(tree.parallelograms);
    if (tree.isF32)
        view.places[8 + kSphereLeaf] = view.places[8 + kParallelogramLeaf] =
            place(tree.narrowTriangles);
    view.places[8 + kMixedLeaf] = place(tree.records);
    view.places[kEmptyChild >> kLeafKindShift] = {tree.nodes.data(), 0}; // the root is at hand
    view.unbounded = tree.unbounded;
    view.hasUnbounded = tree.unbounded.triangleBlocks + tree.unbounded.sphereBlocks +
                            tree.unbounded.parallelogramBlocks + tree.unbounded.runCount >
                        0;
}

Octree::Octree() = default;
Octree::~Octree() = default;
Octree::Octree(Octree&&) noexcept = default;
Octree& Octree::operator=(Octree&&) noexcept = default;

Octree Octree::build(const Primitives& primitives, const BuildOptions& options) {
    Octree octree;
    octree.impl_ = std::make_unique<Impl>();
    Impl& impl = *octree.impl_;
    impl.options = options;
    impl.segments = primitives.segments;
    impl.options.movable = options.movable && options.precision == Precision::exact;
    if (options.simd == Simd::best) impl.options.simd = chosenLevel();
    impl.kernel = &kernelOf(impl.options.simd, options.precision);
    TreeView& view = impl.view;
    const auto run = [&] {
        const bool movable = impl.options.movable;
        References references = referencesOf(primitives, movable);
        for (int i = 0; i < 3; ++i) view.center[i] = references.center[i];
        view.scale = references.scale;
        view.inverseScale = 1 / references.scale;
        const Cells cells(primitives, std::move(references.bounded), references.boundedCount,
                          references.scale, impl.options);
        LeafFormat format{options.storage, options.precision};
        std::ranges::copy(references.center, format.center);
        format.scale = references.scale;
        impl.tree = emit(cells, references.unbounded, primitives, format, movable);
    };
    // Starting threads costs more than a small tree.
    constexpr std::uint32_t kWorthThreads = 4096;
    parallel::withThreads(primitives.count() < kWorthThreads ? 1 : options.threads, run);
    impl.state.nodesThen = static_cast<std::uint32_t>(impl.tree.nodes.size());
    impl.bind(primitives);
    return octree;
}

UpdateReport Octree::update(const Primitives& primitives,
                            std::span<const geometry::PrimitiveId> moved) {
    if (!impl_) throw std::invalid_argument("an octree that was not built has nothing to update");
    const auto sameRun = [](const geometry::Segment& a, const geometry::Segment& b) {
        return a.first == b.first && a.count == b.count && a.kind == b.kind;
    };
    if (!std::equal(impl_->segments.begin(), impl_->segments.end(), primitives.segments.begin(),
                    primitives.segments.end(), sameRun))
        throw std::invalid_argument("an update may move primitives, not add or remove any");
    for (const PrimitiveId id : moved)
        if (static_cast<std::uint32_t>(id) >= primitives.count())
            throw std::invalid_argument("an update names primitive " +
                                        std::to_string(static_cast<std::uint32_t>(id)) + " of " +
                                        std::to_string(primitives.count()));
    std::unique_ptr<Impl> impl = std::move(impl_);
    UpdateReport report;
    report.moved = moved.size();
    bool followed = false;
    if (impl->options.movable)
        parallel::withThreads(impl->options.threads, [&] {
            followed = octree::update(impl->tree, impl->state, impl->view.center, impl->view.scale,
                                      primitives, impl->options, moved, report);
        });
    if (followed) {
        impl->bind(primitives);
        impl_ = std::move(impl);
    } else {
        const BuildOptions options = impl->options;
        impl.reset();
        *this = build(primitives, options);
        report.entered = 0;
        report.rebuilt = primitives.count();
        report.whole = true;
    }
    return report;
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
    std::array<Found, 16> few;
    std::vector<Found> more;
    CrossingQuery query(*impl_->primitives, impl_->view, {&ray, 1}, opaqueMaterials, few, more);
    std::uint8_t ended = 0;
    impl_->kernel->crossings(impl_->view, &ray, 1, query, &ended, visits);
    if (ended) return false;
    const auto before = static_cast<std::ptrdiff_t>(out.size());
    for (const Found& f : query.all()) out.push_back({f.t, PrimitiveId{f.id}});
    std::sort(out.begin() + before, out.end(), byTThenId);
    return true;
}

void Octree::crossings(std::span<const Ray> rays, const std::vector<bool>& opaqueMaterials,
                       CrossingLists& lists, Visits* visits) const {
    auto& ended = lists.ended_;
    auto& end = lists.end_;
    ended.assign(rays.size(), 0);
    end.assign(rays.size(), 0);
    if (!impl_) return;
    CrossingQuery query(*impl_->primitives, impl_->view, rays, opaqueMaterials, lists.found_,
                        lists.found_);
    impl_->kernel->crossings(impl_->view, rays.data(), rays.size(), query, ended.data(), visits);
    std::uint32_t* const ends = end.data();
    const std::uint8_t* const isEnded = ended.data();
    for (const Found& f : query.all()) ends[f.ray] += !isEnded[f.ray];
    std::uint32_t sum = 0;
    for (std::uint32_t& n : end) sum += std::exchange(n, sum);
    lists.all_.resize(sum);
    Crossing* const all = lists.all_.data();
    for (const Found& f : query.all())
        if (!isEnded[f.ray]) all[ends[f.ray]++] = {f.t, PrimitiveId{f.id}};
    Crossing* first = lists.all_.data();
    for (const std::uint32_t e : end) {
        Crossing* const last = lists.all_.data() + e;
        if (last - first > 1) std::sort(first, last, byTThenId);
        first = last;
    }
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
    if (impl_ && coherence == Coherence::coherent && impl_->isLoose)
        occludedByOrigin(*impl_->kernel, impl_->view, rays, answers, visits);
    else if (impl_)
        impl_->kernel->occludedBatch(impl_->view, rays.data(), rays.size(),
                                     coherence == Coherence::coherent, answers.data(), visits);
    else
        std::fill(answers.begin(), answers.end(), std::uint8_t{0});
}

Hit Octree::closestWithoutTree(const Ray& ray) const {
    Hit hit;
    if (!impl_) return hit;
    const Tree& tree = impl_->tree;
    if (tree.isF32) throw std::logic_error("leaves in f32 are not tested without the tree");
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
    s.nodes = tree.nodes.size() - impl_->state.free[kNodes].size();
    for (const Part part :
         {kShared, kTriangles, kNarrowShared, kNarrowTriangles, kSpheres, kParallelograms})
        s.blocks += tree.extent().of[part] - impl_->state.free[part].size();
    s.bytes = tree.bytes();
    struct Visit {
        std::uint32_t reference, depth;
    };
    std::vector<Visit> stack;
    std::vector<std::uint32_t> ids;
    double rootArea = 0;
    if (tree.nodes.size() > 0) {
        stack.push_back({0, 1});
        rootArea = boxOf(tree.nodes[0]).area();
        s.cost = kNodeCost;
    }
    while (!stack.empty()) {
        const auto [reference, depth] = stack.back();
        stack.pop_back();
        if (!(reference & kLeaf)) {
            s.depth = std::max(s.depth, depth);
            const Node& node = tree.nodes[reference];
            for (int slot = 0; slot < kLanes; ++slot) {
                const std::uint32_t child = node.child[slot];
                if (child == kEmptyChild) continue;
                if (heightOf(tree, child) >= node.links.height)
                    throw std::logic_error("a node of the octree is higher than it says");
                stack.push_back({child, depth + 1});
                const float visit = child & kLeaf ? costOfLeaf(tree, child) : kNodeCost;
                if (rootArea > 0) s.cost += visit * boxOf(node, slot).area() / rootArea;
            }
            continue;
        }
        ids.clear();
        idsOfLeaf(tree, reference, ids);
        ++s.leaves;
        if (s.leafHistogram.size() <= ids.size()) s.leafHistogram.resize(ids.size() + 1);
        ++s.leafHistogram[ids.size()];
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
