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

} // namespace

void measureLeaks(std::uint64_t rays) {
    constexpr std::size_t kBatch = 4096;
    std::printf("%-10s %-9s %12s %10s %10s %14s %15s\n", "mesh", "aim", "rays", "octree",
                "octree 16", "Embree robust", "Embree default");
    for (const Closed& closed : closedMeshes())
        for (const bool atEdges : {false, true}) {
            Mesh mesh;
            mesh.positions = closed.mesh.positions;
            mesh.indices = closed.mesh.indices;
            const Subject subject = subjectOf(mesh);
            const Octree tree = Octree::build(subject.primitives);
            std::uint64_t alone = 0, together = 0;
            [[maybe_unused]] std::uint64_t robust = 0, plain = 0;
#ifdef RT_BENCH_EMBREE
            const EmbreeScene robustScene(mesh, true), plainScene(mesh, false);
            std::vector<EmbreeRay> narrow(kBatch);
            std::vector<EmbreeHit> found(kBatch);
#endif
            Random random(atEdges);
            std::vector<Ray> batch(kBatch);
            std::vector<Hit> hits(kBatch);
            std::uint64_t asked = 0;
            for (; asked < rays; asked += kBatch) {
                for (Ray& ray : batch) {
                    const auto& face =
                        mesh.indices[random.below(static_cast<std::uint32_t>(mesh.indices.size()))];
                    const std::size_t corner = random.below(3);
                    const Vec3 a = mesh.positions[face[corner]],
                               b = mesh.positions[face[(corner + 1) % 3]];
                    ray.origin = inF32(random.inBox(closed.reach));
                    ray.direction = inF32(a + (atEdges ? random.unit() : 0) * (b - a) - ray.origin);
                }
                for (const Ray& ray : batch) alone += !tree.closest(ray);
                tree.closest(batch, hits, Coherence::coherent);
                for (const Hit& hit : hits) together += !hit;
#ifdef RT_BENCH_EMBREE
                for (std::size_t i = 0; i < kBatch; ++i) narrow[i] = embreeRay(batch[i]);
                const auto leaks = [&](const EmbreeScene& scene) {
                    scene.closest(narrow.data(), kBatch, found.data());
                    std::uint64_t n = 0;
                    for (const EmbreeHit& hit : found) n += hit.id == 0xFFFFFFFF;
                    return n;
                };
                robust += leaks(robustScene);
                plain += leaks(plainScene);
#endif
            }
            std::printf("%-10s %-9s %12llu %10llu %10llu", closed.name,
                        atEdges ? "edges" : "vertices", static_cast<unsigned long long>(asked),
                        static_cast<unsigned long long>(alone),
                        static_cast<unsigned long long>(together));
#ifdef RT_BENCH_EMBREE
            std::printf(" %14llu %15llu", static_cast<unsigned long long>(robust),
                        static_cast<unsigned long long>(plain));
#endif
            std::printf("\n");
            std::fflush(stdout);
        }
}

} // namespace rt::bench
