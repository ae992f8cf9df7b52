// Precision::f32: near the exact answers on ordinary rays, and one answer at every SIMD level.
#include "on_mixed_scenes.hpp"

#include <core/geometry/bounds.hpp>
#include <core/octree/octree.hpp>

#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace rt::test {
namespace {

using octree::Crossing;
using octree::Hit;
using octree::Octree;
using octree::Precision;
using octree::Simd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool same(const Hit& a, const Hit& b) {
    return a.id == b.id && a.t == b.t && a.u == b.u && a.v == b.v;
}

class F32 : public OnMixedScenes {
protected:
    Octree build(Simd simd = Simd::best) const {
        return Octree::build(*scene().primitives, {.precision = Precision::f32, .simd = simd});
    }
    /// From anywhere near to anywhere.
    Ray ordinaryRay(Random& random) const {
        Ray ray;
        ray.origin = scene().center + random.inBox(2 * scene().size);
        ray.direction = random.direction();
        return ray;
    }
};

TEST_P(F32, IsNearTheExactAnswers) {
    const Octree exact = Octree::build(*scene().primitives), fast = build();
    const double off = tolerance::kF32Distance *
                       numeric::maxComponent(geometry::boundsOf(*scene().primitives).diagonal());
    constexpr int kRays = 20'000;
    Random random(7);
    int hits = 0, others = 0;
    for (int i = 0; i < kRays; ++i) {
        const Ray ray = ordinaryRay(random);
        const Hit a = exact.closest(ray), b = fast.closest(ray);
        hits += static_cast<bool>(a);
        const bool agree = a.id == b.id && (!a || std::abs(a.t - b.t) < off);
        const bool isOccluded = fast.occluded(ray);
        std::vector<Crossing> all, allFast;
        exact.crossings(ray, {}, all);
        fast.crossings(ray, {}, allFast);
        others += !agree || isOccluded != static_cast<bool>(a) || all.size() != allFast.size();
    }
    EXPECT_GT(hits, kRays / 20);
    EXPECT_LT(others, hits / 20); // most where the whole is 20 000 times a teapot
}

TEST_P(F32, IsTheSameAtEverySimdLevel) {
    const Octree baseline = build(Simd::baseline);
    for (const Simd simd : {Simd::avx2, Simd::avx512}) {
        if (!Octree::supports(simd)) continue;
        const Octree other = build(simd);
        for (std::uint64_t i = 0; i < 10'000; ++i) {
            const Ray ray = rayFor(scene(), i);
            ASSERT_TRUE(same(baseline.closest(ray), other.closest(ray))) << i;
            ASSERT_EQ(baseline.occluded(ray), other.occluded(ray)) << i;
            std::vector<Crossing> a, b;
            baseline.crossings(ray, {}, a);
            other.crossings(ray, {}, b);
            ASSERT_TRUE(std::ranges::equal(a, b, [](const Crossing& p, const Crossing& q) {
                return p.id == q.id && p.t == q.t;
            })) << i;
        }
    }
}

TEST_P(F32, BatchesAreNearSingleRays) {
    const Octree tree = build();
    Random random(5);
    constexpr std::size_t kRays = 160;
    std::vector<Ray> rays(kRays);
    std::vector<Hit> hits(kRays);
    std::vector<std::uint8_t> occluded(kRays);
    octree::CrossingLists lists;
    std::size_t met = 0, others = 0;
    for (int round = 0; round < 200; ++round) {
        const Ray middle = ordinaryRay(random);
        for (Ray& ray : rays) {
            ray = middle;
            ray.direction += random.inBox(0.02);
            if (round % 4 == 0) ray.tMax = scene().size;
        }
        tree.closest(rays, hits, octree::Coherence::coherent);
        tree.occluded(rays, occluded, octree::Coherence::coherent);
        tree.crossings(rays, {}, lists);
        for (std::size_t i = 0; i < kRays; ++i) {
            const Hit alone = tree.closest(rays[i]);
            std::vector<Crossing> all;
            tree.crossings(rays[i], {}, all);
            met += static_cast<bool>(alone);
            others += hits[i].id != alone.id || (occluded[i] != 0) != static_cast<bool>(alone) ||
                      lists.of(i).size() != all.size();
        }
    }
    EXPECT_GT(met, 1000u);
    EXPECT_LT(others, met / 20);
}

TEST_P(F32, RaysInTurnsAreSingleRays) {
    const Octree tree = build();
    Random random(6);
    std::vector<Ray> rays;
    for (int i = 0; i < 3000; ++i) {
        rays.push_back(ordinaryRay(random));
        if (i % 4 == 0) rays.back().tMax = scene().size;
        if (i % 100 == 0) rays.back().tMax = -scene().size;
    }
    std::vector<Hit> hits(rays.size());
    std::vector<std::uint8_t> occluded(rays.size());
    tree.closest(rays, hits, octree::Coherence::incoherent);
    tree.occluded(rays, occluded, octree::Coherence::incoherent);
    std::size_t met = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(same(tree.closest(rays[i]), hits[i])) << i;
        ASSERT_EQ(tree.occluded(rays[i]), occluded[i] != 0) << i;
        met += static_cast<bool>(hits[i]);
    }
    EXPECT_GT(met, 100u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, F32, testing::Range(0, 6));

TEST(F32Rays, WithoutSenseMissEverything) {
    Primitives p;
    addSpheres(p, {{{0, 0, 0}, 1}, {{3, 0, 0}, 1}});
    const Octree tree = Octree::build(p, {.precision = Precision::f32});
    for (const double x : {kInfinity, -kInfinity, std::nan(""), 1e300, 1e50}) {
        for (int axis = 0; axis < 3; ++axis) {
            Ray ray;
            ray.direction = {0, 0, 1};
            ray.origin = {0, 0, -5};
            ray.origin[axis] = x;
            EXPECT_FALSE(tree.closest(ray));
            ray.origin = {0, 0, -5};
            ray.direction[axis] = x;
            EXPECT_FALSE(tree.occluded(ray));
        }
    }
}

TEST(F32Updates, BuildAnew) {
    Primitives p;
    const Mesh mesh = icosphere(3, 1, {0, 0, 0});
    addMesh(p, mesh.positions, mesh.indices);
    Octree tree = Octree::build(p, {.precision = Precision::f32, .movable = true});
    std::vector<geometry::PrimitiveId> all;
    for (std::uint32_t i = 0; i < p.count(); ++i) all.push_back(geometry::PrimitiveId{i});
    for (Vec3& v : p.triangles.positions) v.x += 10;
    EXPECT_TRUE(tree.update(p, all).whole);
    EXPECT_TRUE(tree.closest({.origin = {10, 0, -5}, .direction = {0, 0, 1}}));
}

} // namespace
} // namespace rt::test
