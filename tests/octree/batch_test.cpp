// Batches of rays against one ray at a time, bit for bit, at every SIMD level that this CPU has.
// RT_OCTREE_RAYS=1000000 runs more rays than CI can afford.
#include "scenes.hpp"

#include <core/octree/octree.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cstdlib>
#include <stdexcept>

namespace rt::test {
namespace {

using octree::Coherence;
using octree::Hit;
using octree::Octree;
using octree::Simd;

constexpr Simd kLevels[] = {Simd::baseline, Simd::avx2, Simd::avx512};
constexpr Coherence kCoherences[] = {Coherence::coherent, Coherence::incoherent};

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

/// Holds batches of many lengths against single rays; how many rays hit.
std::size_t expectSameBits(const Octree& tree, const std::vector<Ray>& rays,
                           const std::string& what) {
    // Shorter than a bundle, a bundle, between and far beyond.
    constexpr std::size_t kLengths[] = {1, 16, 2, 15, 37, 256, 1000};
    std::size_t differing = 0, hits = 0, length = 0;
    std::vector<Hit> closest;
    std::vector<std::uint8_t> occluded;
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

class Batch : public testing::TestWithParam<int> {
protected:
    static const std::vector<Scene>& scenes() {
        static const std::vector<Scene> all = mixedScenes();
        return all;
    }
    const Scene& scene() const { return scenes()[static_cast<std::size_t>(GetParam())]; }

    void expectSameBitsAtEveryLevel(const std::vector<Ray>& rays) {
        for (const Simd simd : kLevels) {
            if (!Octree::supports(simd)) continue;
            const Octree tree = Octree::build(*scene().primitives, {.simd = simd});
            EXPECT_GT(expectSameBits(tree, rays,
                                     scene().name + ", SIMD level " +
                                         std::to_string(static_cast<int>(simd))),
                      rays.size() / 10)
                << "most rays miss: the test is weak";
        }
    }
};

TEST_P(Batch, CameraRaysEqualSingleRays) {
    expectSameBitsAtEveryLevel(cameraRays(scene(), rayCount(3000)));
}

TEST_P(Batch, AnyRaysEqualSingleRays) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < rayCount(2000); ++i) rays.push_back(rayFor(scene(), i));
    expectSameBitsAtEveryLevel(rays);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Batch, testing::Range(0, 6));

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
