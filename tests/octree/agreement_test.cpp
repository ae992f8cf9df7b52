// The octree against its definition, bit for bit, at every SIMD level that this CPU has.
// RT_OCTREE_RAYS=1000000 runs the acceptance figure; the default is what CI can afford.
#include "on_mixed_scenes.hpp"

#include <core/octree/octree.hpp>
#include <core/parallel/parallel.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <mutex>
#include <numeric>

namespace rt::test {
namespace {

using octree::BuildOptions;
using octree::Crossing;
using octree::Hit;
using octree::Octree;
using octree::Simd;

constexpr Simd kLevels[] = {Simd::baseline, Simd::avx2, Simd::avx512};

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
bool same(const std::vector<Crossing>& a, const std::vector<Crossing>& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i].id != b[i].id || !sameBits(a[i].t, b[i].t)) return false;
    return true;
}

/// Rays of a scene for which `differs` is true; the first is named.
template <class Differs> std::size_t countDiffering(std::size_t rays, const Differs& differs) {
    constexpr std::size_t kBatch = 256;
    const std::size_t batches = (rays + kBatch - 1) / kBatch;
    std::vector<std::size_t> count(batches), first(batches, rays);
    parallel::forEach(batches, 0, [&](std::size_t b) {
        for (std::size_t i = b * kBatch; i < std::min(rays, (b + 1) * kBatch); ++i)
            if (differs(i) && count[b]++ == 0) first[b] = i;
    });
    for (const std::size_t i : first)
        if (i != rays) {
            ADD_FAILURE() << "ray " << i << " differs";
            break;
        }
    return std::accumulate(count.begin(), count.end(), std::size_t{0});
}

using Agreement = OnMixedScenes;

TEST_P(Agreement, SceneIsBigEnough) { EXPECT_GE(scene().primitives->count(), 10000u); }

TEST_P(Agreement, ClosestEqualsBruteForce) {
    for (const Simd simd : kLevels) {
        if (!Octree::supports(simd)) continue;
        const Octree tree = Octree::build(*scene().primitives, {.simd = simd});
        std::atomic<std::size_t> hits{0};
        EXPECT_EQ(0u, countDiffering(rayCount(1500),
                                     [&](std::size_t i) {
                                         const Ray ray = rayFor(scene(), i);
                                         const Hit hit = tree.closest(ray);
                                         hits += static_cast<bool>(hit);
                                         return !same(hit, octree::closestBruteForce(
                                                               *scene().primitives, ray));
                                     }))
            << "SIMD level " << static_cast<int>(simd);
        EXPECT_GT(hits, rayCount(1500) / 5) << "most rays miss: the test is weak";
    }
}

TEST_P(Agreement, LanesEqualScalar) {
    for (const Simd simd : kLevels) {
        if (!Octree::supports(simd)) continue;
        const Octree tree = Octree::build(*scene().primitives, {.simd = simd});
        EXPECT_EQ(0u, countDiffering(std::min<std::size_t>(rayCount(500), 20000),
                                     [&](std::size_t i) {
                                         const Ray ray = rayFor(scene(), 7919 * i);
                                         return !same(
                                             tree.closestWithoutTree(ray),
                                             octree::closestBruteForce(*scene().primitives, ray));
                                     }))
            << "SIMD level " << static_cast<int>(simd);
    }
}

TEST_P(Agreement, TreeEqualsScanOfItsBlocks) {
    const Octree tree = Octree::build(*scene().primitives);
    EXPECT_EQ(0u, countDiffering(rayCount(10000), [&](std::size_t i) {
                  const Ray ray = rayFor(scene(), i);
                  return !same(tree.closest(ray), tree.closestWithoutTree(ray));
              }));
}

TEST_P(Agreement, OccludedEqualsBruteForce) {
    for (const Simd simd : kLevels) {
        if (!Octree::supports(simd)) continue;
        const Octree tree = Octree::build(*scene().primitives, {.simd = simd});
        EXPECT_EQ(0u, countDiffering(std::min<std::size_t>(rayCount(1500), 100000),
                                     [&](std::size_t i) {
                                         const Ray ray = rayFor(scene(), i);
                                         return tree.occluded(ray) != octree::occludedBruteForce(
                                                                          *scene().primitives, ray);
                                     }))
            << "SIMD level " << static_cast<int>(simd);
    }
}

TEST_P(Agreement, CrossingsEqualBruteForce) {
    for (const Simd simd : kLevels) {
        if (!Octree::supports(simd)) continue;
        const Octree tree = Octree::build(*scene().primitives, {.simd = simd});
        EXPECT_EQ(0u, countDiffering(std::min<std::size_t>(rayCount(1500), 100000),
                                     [&](std::size_t i) {
                                         const Ray ray = rayFor(scene(), i);
                                         std::vector<Crossing> out;
                                         return !tree.crossings(ray, {}, out) ||
                                                !same(out, octree::crossingsBruteForce(
                                                               *scene().primitives, ray));
                                     }))
            << "SIMD level " << static_cast<int>(simd);
    }
}

TEST_P(Agreement, OptionsAndThreadsChangeNoAnswer) {
    const BuildOptions variants[] = {{.maxObjects = 1},
                                     {.maxObjects = 40},
                                     {.minSize = 0.1 * scene().size},
                                     {.threads = 1},
                                     {.threads = 7}};
    const Octree reference = Octree::build(*scene().primitives);
    for (const BuildOptions& options : variants) {
        const Octree tree = Octree::build(*scene().primitives, options);
        EXPECT_EQ(0u, countDiffering(5000, [&](std::size_t i) {
                      const Ray ray = rayFor(scene(), i);
                      return !same(tree.closest(ray), reference.closest(ray)) ||
                             tree.occluded(ray) != reference.occluded(ray);
                  }));
    }
}

/// Also the definition itself, so that no two storages agree on something else.
TEST_P(Agreement, StorageChangesNoBit) {
    Primitives rounded = *scene().primitives;
    for (Vec3& p : rounded.triangles.positions) p = numeric::roundedToF32(p);
    for (const Simd simd : kLevels) {
        if (!Octree::supports(simd)) continue;
        const Octree narrow = Octree::build(rounded, {.simd = simd}),
                     wide = Octree::build(rounded, {.storage = octree::Storage::f64, .simd = simd});
        if (!rounded.triangles.indices.empty()) {
            EXPECT_LT(narrow.statistics().bytes, wide.statistics().bytes);
        }
        EXPECT_EQ(0u,
                  countDiffering(5000,
                                 [&](std::size_t i) {
                                     const Ray ray = rayFor(scene(), i);
                                     const Hit hit = narrow.closest(ray);
                                     std::vector<Crossing> a, b;
                                     narrow.crossings(ray, {}, a);
                                     wide.crossings(ray, {}, b);
                                     return !same(hit, wide.closest(ray)) ||
                                            !same(hit, narrow.closestWithoutTree(ray)) ||
                                            !same(a, b) ||
                                            narrow.occluded(ray) != wide.occluded(ray) ||
                                            (i % 16 == 0 &&
                                             !same(hit, octree::closestBruteForce(rounded, ray)));
                                 }))
            << "SIMD level " << static_cast<int>(simd);
    }
}

TEST_P(Agreement, VisitsDependOnNoThread) {
    const Octree one = Octree::build(*scene().primitives, {.threads = 1}),
                 seven = Octree::build(*scene().primitives, {.threads = 7});
    octree::Visits a, b;
    for (std::size_t i = 0; i < 2000; ++i) {
        const Ray ray = rayFor(scene(), i);
        const Hit counted = one.closest(ray, &a);
        seven.closest(ray, &b);
        EXPECT_TRUE(same(counted, one.closest(ray)));
    }
    EXPECT_GT(a.nodes, 0u);
    EXPECT_EQ(a.nodes, b.nodes);
    EXPECT_EQ(a.triangles, b.triangles);
    EXPECT_EQ(a.spheres, b.spheres);
    EXPECT_EQ(a.parallelograms, b.parallelograms);
    EXPECT_EQ(a.customs, b.customs);
    EXPECT_EQ(one.statistics().bytes, seven.statistics().bytes);
    EXPECT_EQ(one.statistics().leafHistogram, seven.statistics().leafHistogram);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Agreement, testing::Range(0, 6));

} // namespace
} // namespace rt::test
