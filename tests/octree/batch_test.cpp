// Batches of rays against one ray at a time, bit for bit, at every SIMD level that this CPU has.
// RT_OCTREE_RAYS=1000000 runs more rays than CI can afford.
#include "on_mixed_scenes.hpp"

#include <core/octree/octree.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <stdexcept>

namespace rt::test {
namespace {

using octree::Coherence;
using octree::Crossing;
using octree::Hit;
using octree::Octree;
using octree::Simd;

constexpr Simd kLevels[] = {Simd::baseline, Simd::avx2, Simd::avx512};
constexpr Coherence kCoherences[] = {Coherence::coherent, Coherence::incoherent};

/// Materials that are opaque.
const std::vector<bool> kEverySecond{false, true};

std::size_t rayCount(std::size_t inCi) {
    const char* const wanted = std::getenv("RT_OCTREE_RAYS");
    return wanted ? static_cast<std::size_t>(std::atoll(wanted)) : inCi;
}

bool sameBits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool same(const Hit& a, const Hit& b) {
    return a.id == b.id && sameBits(a.t, b.t) && sameBits(a.u, b.u) && sameBits(a.v, b.v);
}

/// Lists of crossings of a batch against those of single rays; how many are not as they should be.
std::size_t countDiffering(const Octree& tree, std::span<const Ray> batch,
                           const std::vector<bool>& opaque, octree::CrossingLists& lists) {
    std::size_t differing = 0;
    tree.crossings(batch, opaque, lists);
    for (std::size_t i = 0; i < batch.size(); ++i) {
        std::vector<Crossing> one;
        const bool ended = !tree.crossings(batch[i], opaque, one);
        const auto list = lists.of(i);
        differing += lists.isEnded(i) != ended ||
                     !std::equal(list.begin(), list.end(), one.begin(), one.end(),
                                 [](const Crossing& a, const Crossing& b) {
                                     return a.id == b.id && sameBits(a.t, b.t);
                                 });
    }
    return differing;
}

/// Holds batches of many lengths against single rays; how many rays hit.
std::size_t expectSameBits(const Octree& tree, const std::vector<Ray>& rays,
                           const std::string& what) {
    // Shorter than a bundle, a bundle, between and far beyond.
    constexpr std::size_t kLengths[] = {1, 16, 2, 15, 37, 256, 1000};
    std::size_t differing = 0, hits = 0, length = 0;
    std::vector<Hit> closest;
    std::vector<std::uint8_t> occluded;
    octree::CrossingLists lists;
    for (const Coherence coherence : kCoherences)
        for (std::size_t first = 0; first < rays.size();) {
            const std::size_t count =
                std::min(kLengths[length++ % std::size(kLengths)], rays.size() - first);
            const std::span<const Ray> batch(rays.data() + first, count);
            closest.assign(count, {7, 7, 7, geometry::PrimitiveId{7}});
            occluded.assign(count, 7);
            tree.closest(batch, closest, coherence);
            tree.occluded(batch, occluded, coherence);
            for (std::size_t i = 0; i < count; ++i) {
                const Hit hit = tree.closest(batch[i]);
                hits += static_cast<bool>(hit);
                if (same(closest[i], hit) && occluded[i] == tree.occluded(batch[i])) continue;
                if (differing++ == 0)
                    ADD_FAILURE() << what << ": ray " << first + i << " of a batch of " << count
                                  << ", coherence " << static_cast<int>(coherence);
            }
            EXPECT_EQ(0u, countDiffering(tree, batch, {}, lists)) << what;
            EXPECT_EQ(0u, countDiffering(tree, batch, kEverySecond, lists)) << what;
            first += count;
        }
    EXPECT_EQ(0u, differing) << what;
    return hits;
}

/// Camera rays in 4x4 blocks, each followed by its neighbours; every 7th block ends early.
std::vector<Ray> cameraRays(const Scene& scene, std::size_t count) {
    Random random(count);
    std::vector<Ray> rays;
    while (rays.size() < count) {
        const Vec3 eye = scene.center + random.direction() * (scene.size * random.in(0, 3));
        const Vec3 target = scene.center + random.inBox(scene.size);
        const double step = scene.size / random.in(1, 200);
        const Vec3 right = random.direction() * step, up = random.direction() * step;
        const bool ends = random.below(7) == 0;
        for (int i = 0; i < 16; ++i) {
            Ray ray;
            ray.origin = eye;
            ray.direction = target + right * double(i & 3) + up * double(i >> 2) - eye;
            if (ends) ray.tMax = random.in(0, 2);
            rays.push_back(ray);
        }
    }
    rays.resize(count);
    return rays;
}

class Batch : public OnMixedScenes {
protected:
    void expectSameBitsAtEveryLevel(const std::vector<Ray>& rays) {
        Primitives primitives = *scene().primitives;
        std::uint32_t material = 0;
        for (geometry::Segment& s : primitives.segments)
            s.material = geometry::MaterialId{material++ % 2};
        expectSameBitsAtEveryLevel(primitives, rays);
        Primitives rounded = primitives; // whose leaves hold f32
        for (Vec3& p : rounded.triangles.positions) p = numeric::roundedToF32(p);
        expectSameBitsAtEveryLevel(rounded, rays);
    }

private:
    void expectSameBitsAtEveryLevel(const Primitives& primitives, const std::vector<Ray>& rays) {
        for (const Simd simd : kLevels) {
            if (!Octree::supports(simd)) continue;
            const Octree tree = Octree::build(primitives, {.simd = simd});
            EXPECT_GT(expectSameBits(tree, rays,
                                     scene().name + ", SIMD level " +
                                         std::to_string(static_cast<int>(simd))),
                      rays.size() / 10)
                << "most rays miss: the test is weak";
        }
    }
};

TEST_P(Batch, CameraRaysEqualSingleRays) {
    expectSameBitsAtEveryLevel(cameraRays(scene(), rayCount(1500)));
}

TEST_P(Batch, AnyRaysEqualSingleRays) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < rayCount(1000); ++i) rays.push_back(rayFor(scene(), i));
    expectSameBitsAtEveryLevel(rays);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Batch, testing::Range(0, 6));

/// Bundles that try to break the bounds on the way to the f64 tests: what a box, an interval of boxes or
/// the f32 filter leaves out is held against every block without them.
class HardBundle : public testing::TestWithParam<double> {
protected:
    static Primitives primitives(double size, const Vec3& center) {
        Primitives p;
        const Mesh ball = icosphere(4, size, center, 0.3),
                   slab = box(6, {size, size, 0.01 * size}, center + Vec3(0, 0, 1.2 * size));
        addMesh(p, ball.positions, ball.indices);
        addMesh(p, slab.positions, slab.indices);
        std::vector<geometry::Sphere> spheres;
        std::vector<geometry::Parallelogram> tiles;
        Random random(5);
        for (int i = 0; i < 200; ++i) {
            spheres.push_back({center + random.inBox(1.5 * size), 0.03 * size});
            tiles.push_back({center + random.inBox(1.5 * size), random.inBox(0.1 * size),
                             random.inBox(0.1 * size)});
        }
        addSpheres(p, spheres);
        addParallelograms(p, tiles);
        return p;
    }

    /// 16 rays a bundle, all kinds of trouble.
    static std::vector<Ray> rays(const Primitives& p, double size, const Vec3& center,
                                 std::size_t bundles) {
        Random random(17);
        std::vector<Ray> rays;
        const auto& corners = p.triangles.positions;
        for (std::size_t n = 0; n < bundles; ++n) {
            const std::uint64_t kind = n % 8;
            const Vec3 corner = corners[random.below(static_cast<std::uint32_t>(corners.size()))];
            Vec3 from = center + random.direction() * (size * random.in(1.5, 4));
            if (kind == 1) from = center + random.direction() * (size * std::exp(random.in(2, 40)));
            if (kind == 2) from = corner; // on a surface
            const double spread = std::exp(random.in(-35, 0)) * size;
            const unsigned zero = random.below(3);
            const double length = kind == 6 ? std::exp(random.in(-600, 600)) : 1;
            for (int i = 0; i < 16; ++i) {
                Ray ray;
                ray.origin = from;
                Vec3 to = corner + random.inBox(spread);
                if (i % 4 == 0) to = corner; // through a corner, where boxes end
                if (kind == 3) {             // along a plane of a box
                    ray.origin = from = center + random.direction() * (3 * size);
                    (&ray.origin.x)[zero] = (&to.x)[zero] = (&corner.x)[zero];
                }
                if (kind == 7) ray.origin = from + random.inBox(spread);
                ray.direction = (to - ray.origin) * length;
                if (kind == 4) (&ray.direction.x)[zero] = n % 16 < 8 ? 0.0 : -0.0;
                if (kind == 5) // subnormal
                    (&ray.direction.x)[zero] =
                        std::copysign(5e-324 * (i + 1), n % 16 < 8 ? 1.0 : -1.0);
                if (i % 5 == 0) ray.exclude = geometry::PrimitiveId{random.below(p.count())};
                if (i % 7 == 0) ray.tMax = random.in(0, 2) / length;
                rays.push_back(ray);
            }
        }
        return rays;
    }
};

TEST_P(HardBundle, LosesNothing) {
    const double size = GetParam();
    for (const Vec3& center : {Vec3(0.0), Vec3(1000 * size, -3 * size, 1e6 * size)}) {
        const Primitives p = primitives(size, center);
        const std::vector<Ray> all = rays(p, size, center, rayCount(1600) / 16);
        for (const Simd simd : kLevels) {
            if (!Octree::supports(simd)) continue;
            const Octree tree = Octree::build(p, {.simd = simd});
            std::vector<Hit> hits(all.size());
            std::vector<std::uint8_t> occluded(all.size());
            tree.closest(all, hits, Coherence::coherent);
            tree.occluded(all, occluded, Coherence::coherent);
            std::size_t differing = 0, found = 0;
            for (std::size_t i = 0; i < all.size(); ++i) {
                const Hit hit = tree.closestWithoutTree(all[i]);
                found += static_cast<bool>(hit);
                if (same(hits[i], hit) && occluded[i] == static_cast<bool>(hit)) continue;
                if (differing++ == 0)
                    ADD_FAILURE() << "ray " << i << ", kind " << i / 16 % 8 << ", SIMD level "
                                  << static_cast<int>(simd);
            }
            EXPECT_EQ(0u, differing);
            EXPECT_GT(found, all.size() / 4) << "most rays miss: the test is weak";
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Sizes, HardBundle, testing::Values(1.0, 1e-30, 1e30, 1e-140, 1e140));

/// With leaves of every kind.
TEST(BatchOf, RandomRaysInALargeTreeEqualsSingleRays) {
    Scene scene;
    scene.name = "large";
    Random random(23);
    Primitives& p = *scene.primitives;
    const Mesh ball = icosphere(7, 0.8, Vec3(0.0), 0.2);
    addMesh(p, ball.positions, ball.indices);
    std::vector<geometry::Sphere> spheres, customs;
    std::vector<geometry::Parallelogram> tiles;
    for (int i = 0; i < 3000; ++i) {
        spheres.push_back({random.inBox(1), 0.01});
        customs.push_back({random.inBox(1), 0.01});
        tiles.push_back({random.inBox(1), random.inBox(0.05), random.inBox(0.05)});
    }
    addSpheres(p, spheres);
    addCustoms(p, customs, false);
    addParallelograms(p, tiles);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < rayCount(3000); ++i) rays.push_back(rayFor(scene, i));
    for (const Simd simd : kLevels) {
        if (!Octree::supports(simd)) continue;
        const Octree tree = Octree::build(p, {.storage = octree::Storage::f64, .simd = simd});
        ASSERT_GT(tree.statistics().bytes, 16u << 20) << "not large";
        EXPECT_GT(
            expectSameBits(tree, rays, "SIMD level " + std::to_string(static_cast<int>(simd))),
            rays.size() / 2);
    }
}

/// Stacks of rays in turns are as long as the tree is high, side by side.
TEST(BatchOf, RaysInADeepTreeEqualsSingleRays) {
    Scene scene;
    scene.name = "deep";
    std::vector<geometry::Sphere> spheres;
    for (int level = 0; level < 100; ++level)
        for (unsigned octant = 0; octant < 8; ++octant) {
            const double x = std::exp2(-level);
            spheres.push_back(
                {Vec3(octant & 1 ? x : -x, octant & 2 ? x : -x, octant & 4 ? x : -x), 0.3 * x});
        }
    addSpheres(*scene.primitives, spheres);
    Random random(37);
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < rayCount(2000); ++i) { // past the middle, ever nearer
        Ray ray;
        ray.origin = random.direction() * random.in(0, 4);
        ray.direction = random.inBox(std::exp2(-random.in(0, 90))) - ray.origin;
        rays.push_back(ray);
    }
    for (const Simd simd : kLevels) {
        if (!Octree::supports(simd)) continue;
        const Octree tree = Octree::build(
            *scene.primitives, {.maxObjects = 1, .tuning = {.leastCut = 1}, .simd = simd});
        EXPECT_GT(tree.statistics().depth, 25u);
        EXPECT_GT(
            expectSameBits(tree, rays, "SIMD level " + std::to_string(static_cast<int>(simd))),
            rays.size() / 2);
    }
}

/// Triangles that lie apart: shadow rays that start close together are traced together, wherever they are in the batch.
TEST(BatchOf, ShadowRaysFromStrewnTrianglesEqualsSingleRays) {
    Primitives p;
    Random random(31);
    std::vector<Vec3> positions;
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::uint32_t i = 0; i < 6000; ++i) {
        const Vec3 center = random.inBox(1);
        for (int c = 0; c < 3; ++c) positions.push_back(center + random.inBox(0.03));
        triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    addMesh(p, positions, triangles);
    const Vec3 light(3, 2, 4);
    std::vector<Ray> rays;
    for (int i = 0; i < 2500; ++i) {
        Ray ray;
        ray.origin = random.inBox(1);
        ray.direction = light - ray.origin;
        ray.tMax = 1;
        rays.push_back(ray);
    }
    rays[7].origin.x = std::nan("");
    rays[1100].origin.y = HUGE_VAL;
    for (const Simd simd : kLevels) {
        if (!Octree::supports(simd)) continue;
        const Octree tree = Octree::build(p, {.simd = simd});
        std::vector<std::uint8_t> answers(rays.size(), 2);
        octree::Visits together, inPieces;
        tree.occluded(rays, answers, Coherence::coherent, &together);
        std::size_t blocked = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(tree.occluded(rays[i]), answers[i]) << "ray " << i;
            blocked += answers[i];
        }
        EXPECT_GT(blocked, rays.size() / 10);
        EXPECT_LT(blocked, rays.size() - rays.size() / 10);
        constexpr std::size_t kPiece = 125; // too few to sort
        for (std::size_t i = 0; i < rays.size(); i += kPiece)
            tree.occluded(std::span(rays).subspan(i, kPiece), std::span(answers).subspan(i, kPiece),
                          Coherence::coherent, &inPieces);
        EXPECT_LT(together.nodes, inPieces.nodes * 9 / 10);
    }
}

/// Visits of a batch are of all its rays, and at most those of the rays alone.
TEST(BatchOf, VisitsAreCounted) {
    const Scene scene = std::move(mixedScenes()[0]);
    const Octree tree = Octree::build(*scene.primitives);
    const std::vector<Ray> rays = cameraRays(scene, 1600);
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    octree::Visits alone, together, inTurns, shadows;
    for (const Ray& ray : rays) tree.closest(ray, &alone);
    tree.closest(rays, hits, Coherence::coherent, &together);
    tree.closest(rays, hits, Coherence::incoherent, &inTurns);
    tree.occluded(rays, occluded, Coherence::coherent, &shadows);
    EXPECT_GT(together.nodes, rays.size() / 16);
    EXPECT_LT(together.nodes, alone.nodes / 2);
    EXPECT_EQ(inTurns.nodes, alone.nodes);
    EXPECT_EQ(inTurns.triangles, alone.triangles);
    EXPECT_GT(shadows.nodes, rays.size() / 16);
}

TEST(BatchOf, NothingAnswersNothing) {
    const Scene scene = std::move(mixedScenes()[0]);
    const Octree tree = Octree::build(*scene.primitives);
    for (const Coherence coherence : kCoherences) {
        tree.closest(std::span<const Ray>(), std::span<Hit>(), coherence);
        tree.occluded(std::span<const Ray>(), std::span<std::uint8_t>(), coherence);
    }
}

TEST(BatchOf, AnEmptyTreeMisses) {
    const Octree tree;
    const std::vector<Ray> rays(40);
    std::vector<Hit> hits(40, {7, 7, 7, geometry::PrimitiveId{7}});
    std::vector<std::uint8_t> occluded(40, 7);
    for (const Coherence coherence : kCoherences) {
        tree.closest(rays, hits, coherence);
        tree.occluded(rays, occluded, coherence);
        for (const Hit& hit : hits) EXPECT_TRUE(same(hit, Hit()));
        EXPECT_EQ(occluded, std::vector<std::uint8_t>(40, 0));
    }
}

TEST(BatchOf, UnequalSpansIsRefused) {
    const Octree tree;
    const std::vector<Ray> rays(3);
    std::vector<Hit> hits(2);
    std::vector<std::uint8_t> occluded(4);
    EXPECT_THROW(tree.closest(rays, hits, Coherence::coherent), std::invalid_argument);
    EXPECT_THROW(tree.occluded(rays, occluded, Coherence::coherent), std::invalid_argument);
}

} // namespace
} // namespace rt::test
