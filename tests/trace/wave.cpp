#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>
#include <core/trace/direction.hpp>
#include <core/trace/wave.hpp>

#include <gtest/gtest.h>

#include <memory>
#include <random>

namespace rt::trace {
namespace {

using geometry::Surface;
using octree::Octree;
using octree::Simd;

Vec3 at(const Columns& c, std::size_t i) { return {c.x.at[i], c.y.at[i], c.z.at[i]}; }
void put(Columns& c, std::size_t i, const Vec3& v) {
    c.x.at[i] = v.x, c.y.at[i] = v.y, c.z.at[i] = v.z;
}

struct Level {
    const char* name;
    Simd simd;
    const WaveKernel& kernel;
};
const Level kLevels[] = {{"avx512", Simd::avx512, avx512::waveKernel},
                         {"avx2", Simd::avx2, avx2::waveKernel},
                         {"baseline", Simd::baseline, baseline::waveKernel}};

/// A sphere that a ray meets from outside or within, as the scalar code has it.
struct Met {
    geometry::Primitives primitives;
    geometry::Ray ray;
    geometry::Hit hit;
    Surface surface;
    bool leaving;

    explicit Met(std::mt19937_64& random) {
        std::uniform_real_distribution<double> unitary(-1, 1);
        const auto vector = [&] { return Vec3{unitary(random), unitary(random), unitary(random)}; };
        primitives.spheres.push_back({vector() * 10.0, 0.5 + 0.4 * unitary(random)});
        primitives.segments.push_back({geometry::PrimitiveId{0}, 1, geometry::Kind::sphere, true, 0,
                                       geometry::ObjectId{0}, geometry::MaterialId{0}});
        const geometry::Sphere& sphere = primitives.spheres[0];
        const Vec3 on = sphere.center + sphere.radius * unit(vector());
        ray.origin = on + 3.0 * vector();
        ray.direction = unit(on - ray.origin);
        hit.t = length(on - ray.origin);
        hit.id = geometry::PrimitiveId{0};
        surface = geometry::surfaceAt(primitives, ray, hit);
        surface.error += surface.error;
        leaving = dot(ray.direction, surface.geometricNormal) > 0;
    }
    Vec3 normal() const { return leaving ? -surface.geometricNormal : surface.geometricNormal; }
};

TEST(Wave, hasTheBitsOfTheScalarCodeAtEverySimdLevel) {
    constexpr std::size_t kCount = 253; // the last lanes are not full
    constexpr double kIndex = 1.5;
    const Vec3 light{3, -4, 20};
    for (const Level& level : kLevels) {
        if (!Octree::supports(level.simd)) continue;
        SCOPED_TRACE(level.name);
        std::mt19937_64 random(7);
        std::vector<Met> mets;
        const auto wave = std::make_unique<Wave>();
        for (std::size_t i = 0; i < kCount; ++i) {
            const Met& met = mets.emplace_back(random);
            const geometry::Sphere& sphere = met.primitives.spheres[0];
            put(wave->direction, i, met.ray.direction);
            put(wave->geometric, i,
                (met.ray.origin - sphere.center) + met.hit.t * met.ray.direction);
            put(wave->center, i, sphere.center);
            wave->radius.at[i] = sphere.radius;
            wave->isSphere.at[i] = -1;
        }
        level.kernel.face(*wave, kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            wave->ratio.at[i] = mets[i].leaving ? kIndex : 1 / kIndex;
            wave->refractedError.at[i] = wave->error.at[i];
        }
        level.kernel.aim(*wave, kCount, &light.x);
        level.kernel.refract(*wave, kCount);
        level.kernel.mirror(*wave, kCount, true);

        std::size_t total = 0, behind = 0;
        for (std::size_t i = 0; i < kCount; ++i) {
            const Met& met = mets[i];
            ASSERT_EQ(at(wave->position, i), met.surface.position);
            ASSERT_EQ(at(wave->geometric, i), met.normal());
            ASSERT_EQ(at(wave->normal, i), met.normal());
            ASSERT_EQ(wave->error.at[i], met.surface.error);
            ASSERT_EQ(wave->leaving.at[i] != 0, met.leaving);

            const geometry::Ray toLight = geometry::spawnRayTo(met.surface, light);
            ASSERT_EQ(at(wave->shadowOrigin, i), toLight.origin);
            ASSERT_EQ(at(wave->shadowDirection, i), toLight.direction);
            const Vec3 apart = light - met.surface.position;
            const Vec3 direction = apart / std::sqrt(dot(apart, apart));
            const double cosine = dot(direction, met.normal());
            ASSERT_EQ(wave->cosine.at[i], cosine > 0 ? cosine : 0);
            behind += !(cosine > 0);
            const Vec3 halfway = direction - met.ray.direction;
            ASSERT_EQ(wave->halfway.at[i],
                      dot(halfway, met.normal()) / std::sqrt(dot(halfway, halfway)));

            const auto bent = refracted(met.ray.direction, met.normal(), wave->ratio.at[i]);
            ASSERT_EQ(wave->passes.at[i] != 0, bent.has_value());
            total += !bent;
            if (bent) {
                const Vec3 out = -intoHemisphere(-*bent, met.normal());
                ASSERT_EQ(at(wave->refracted, i), out);
                ASSERT_EQ(at(wave->refractedOrigin, i),
                          geometry::spawnRay(met.surface, out).origin);
            }
            const Vec3 mirrored =
                intoHemisphere(reflected(met.ray.direction, met.normal()), met.normal());
            ASSERT_EQ(at(wave->mirrored, i), mirrored);
            ASSERT_EQ(at(wave->mirroredOrigin, i),
                      geometry::spawnRay(met.surface, mirrored).origin);
        }
        EXPECT_GT(total, 0u);
        EXPECT_GT(behind, 0u);
    }
}

} // namespace
} // namespace rt::trace
