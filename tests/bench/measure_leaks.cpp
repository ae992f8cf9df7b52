// Rays from inside of closed meshes, at corners and edges: whatever meets nothing has leaked.
#include "measure.hpp"

#ifdef RT_BENCH_EMBREE
#include "embree_scene.hpp"
#endif

#include <tests/octree/scenes.hpp>

#include <cstdio>

namespace rt::bench {
namespace {

using geometry::Hit;
using geometry::Ray;
using octree::Coherence;
using octree::Octree;
using test::Random;

double inF32(double x) { return static_cast<float>(x); }
Vec3 inF32(const Vec3& v) { return {inF32(v.x), inF32(v.y), inF32(v.z)}; }

struct Closed {
    const char* name;
    test::Mesh mesh;
    double reach; // rays start as near as this to 0 in each coordinate, which is inside
};

/// Those of the stability suite, of values that f32 can hold.
std::vector<Closed> closedMeshes() {
    std::vector<Closed> all = {
        {"icosphere", test::icosphere(5, 1, Vec3(0.0)), 0.4},
        {"torus", test::torus(90, 30, 1, 0.4, Vec3(-1, 0, 0)), 0.1},
        {"box", test::box(12, {1, 0.5, 0.25}, Vec3(0.0)), 0.2},
        {"needles", test::needles(2000, 8, Vec3(1.0), Vec3(0.0)), 0.3},
    };
    for (Closed& closed : all)
        for (Vec3& p : closed.mesh.positions) p = inF32(p);
    return all;
}

/// From inside to a corner, or to a point of an edge, of a face; of values that f32 can hold.
Ray aimedRay(const Mesh& mesh, double reach, bool atEdge, Random& random) {
    const auto& face = mesh.indices[random.below(static_cast<std::uint32_t>(mesh.indices.size()))];
    const std::size_t corner = random.below(3);
    const Vec3 a = mesh.positions[face[corner]], b = mesh.positions[face[(corner + 1) % 3]];
    Ray ray;
    ray.origin = inF32(random.inBox(reach));
    ray.direction = inF32(a + (atEdge ? random.unit() : 0) * (b - a) - ray.origin);
    return ray;
}

/// Everything that is asked about one closed mesh.
class Contest {
public:
    explicit Contest(const Mesh& mesh)
        : subject_(subjectOf(mesh)), tree_(Octree::build(subject_.primitives)) {}

    /// One line.
    void run(const Closed& closed, bool atEdges, std::uint64_t rays) {
        Random random(atEdges);
        std::uint64_t asked = 0, alone = 0, together = 0;
        [[maybe_unused]] std::uint64_t robust = 0, plain = 0;
        for (; asked < rays; asked += kBatch) {
            for (Ray& ray : batch_) ray = aimedRay(subject_.mesh, closed.reach, atEdges, random);
            for (const Ray& ray : batch_) alone += !tree_.closest(ray);
            tree_.closest(batch_, hits_, Coherence::coherent);
            for (const Hit& hit : hits_) together += !hit;
#ifdef RT_BENCH_EMBREE
            robust += leaks(robust_);
            plain += leaks(plain_);
#endif
        }
        const auto number = [](int width, std::uint64_t n) {
            std::printf(" %*llu", width, static_cast<unsigned long long>(n));
        };
        std::printf("%-10s %-9s", closed.name, atEdges ? "edges" : "vertices");
        number(12, asked);
        number(10, alone);
        number(10, together);
#ifdef RT_BENCH_EMBREE
        number(14, robust);
        number(15, plain);
#endif
        std::printf("\n");
        std::fflush(stdout);
    }

private:
    static constexpr std::size_t kBatch = 4096;
    Subject subject_;
    Octree tree_;
    std::vector<Ray> batch_ = std::vector<Ray>(kBatch);
    std::vector<Hit> hits_ = std::vector<Hit>(kBatch);
#ifdef RT_BENCH_EMBREE
    std::uint64_t leaks(const EmbreeScene& scene) {
        for (std::size_t i = 0; i < kBatch; ++i) narrow_[i] = embreeRay(batch_[i]);
        scene.closest(narrow_.data(), kBatch, found_.data());
        std::uint64_t n = 0;
        for (const EmbreeHit& hit : found_) n += hit.id == 0xFFFFFFFF;
        return n;
    }
    EmbreeScene robust_{subject_.mesh, true}, plain_{subject_.mesh, false};
    std::vector<EmbreeRay> narrow_ = std::vector<EmbreeRay>(kBatch);
    std::vector<EmbreeHit> found_ = std::vector<EmbreeHit>(kBatch);
#endif
};

} // namespace

void measureLeaks(std::uint64_t rays) {
    std::printf("%-10s %-9s %12s %10s %10s %14s %15s\n", "mesh", "aim", "rays", "octree",
                "octree 16", "Embree robust", "Embree default");
    for (const Closed& closed : closedMeshes()) {
        Mesh mesh;
        mesh.positions = closed.mesh.positions;
        mesh.indices = closed.mesh.indices;
        Contest contest(mesh);
        for (const bool atEdges : {false, true}) contest.run(closed, atEdges, rays);
    }
}

} // namespace rt::bench
