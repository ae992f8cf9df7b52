#include <core/geometry/surface.hpp>
#include <core/numeric/elementary.hpp>
#include <core/octree/octree.hpp>
#include <core/trace/direction.hpp>
#include <core/trace/wave.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

namespace rt::trace {
namespace {

using geometry::Surface;
using numeric::LinearRgb;
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
        for (std::size_t i = 0; i < kCount; ++i) mets.emplace_back(random);
        const auto wave = std::make_unique<Wave>();
        material::Material glass;
        glass.ior = kIndex;
        glass.transmission = {0.5, 0.6, 0.7};
        glass.color = {0.25, 0.5, 0.75};
        std::fill_n(wave->material, kColumn, &glass);
        std::fill_n(wave->sphere, kColumn, &kNoSphere);
        std::vector<geometry::Ray> rays(kCount);
        std::vector<geometry::Hit> hits(kCount);
        std::vector<Work> works(kCount);
        for (std::size_t i = 0; i < kCount; ++i) {
            const Met& met = mets[i];
            const std::size_t ray = kCount - 1 - i;
            wave->ray[i] = static_cast<std::uint32_t>(ray);
            rays[ray] = met.ray;
            hits[ray] = met.hit;
            works[ray].weight = {0.1 + i, 0.2 + i, 0.3 + i};
            wave->sphere[i] = &met.primitives.spheres[0];
            if (i % 16 < 3) { // known without the kernel
                wave->sphere[i] = &kNoSphere;
                put(wave->position, i, met.surface.position);
                put(wave->geometric, i, met.surface.geometricNormal);
                put(wave->normal, i, met.surface.geometricNormal);
                wave->error.at[i] = wave->errorBeside.at[i] = met.surface.error / 2;
            }
            wave->bends.at[i] = -1;
            wave->exclude.at[i] = static_cast<std::uint32_t>(i % 2 ? geometry::kNoPrimitive
                                                                   : geometry::PrimitiveId(i));
        }
        ASSERT_FALSE(level.kernel.gather(*wave, kCount, rays.data(), hits.data(), works.data()));
        level.kernel.face(*wave, kCount);
        level.kernel.aim(*wave, kCount, &light.x);
        level.kernel.bend(*wave, 0, kCount);
        level.kernel.leave(*wave, 0, 0, kCount);

        std::size_t total = 0, behind = 0;
        for (std::size_t i = 0; i < kCount; ++i) {
            const Met& met = mets[i];
            ASSERT_EQ(at(wave->direction, i), met.ray.direction);
            ASSERT_EQ(at(wave->weight, i), Vec3(0.1 + i, 0.2 + i, 0.3 + i));
            ASSERT_EQ(at(wave->color, i), Vec3(0.25, 0.5, 0.75));
            ASSERT_EQ(at(wave->position, i), met.surface.position);
            ASSERT_EQ(at(wave->geometric, i), met.normal());
            ASSERT_EQ(at(wave->normal, i), met.normal());
            ASSERT_EQ(wave->error.at[i], met.surface.error);
            ASSERT_EQ(wave->leaving.at[i] != 0, met.leaving);
            ASSERT_EQ(wave->ratio.at[i], met.leaving ? kIndex : 1 / kIndex);

            const geometry::Ray toLight = geometry::spawnRayTo(met.surface, light);
            const geometry::Ray& shadow = wave->shadow.ray[i];
            ASSERT_EQ(shadow.origin, toLight.origin);
            ASSERT_EQ(shadow.direction, toLight.direction);
            ASSERT_EQ(shadow.tMax, 1);
            ASSERT_EQ(static_cast<std::int64_t>(shadow.exclude), wave->exclude.at[i]);
            const Vec3 apart = light - met.surface.position;
            const Vec3 direction = apart / std::sqrt(dot(apart, apart));
            const double cosine = dot(direction, met.normal());
            ASSERT_EQ(wave->cosine.at[i], cosine > 0 ? cosine : 0);
            behind += !(cosine > 0);
            const Vec3 halfway = direction - met.ray.direction;
            ASSERT_EQ(wave->halfway.at[i],
                      dot(halfway, met.normal()) / std::sqrt(dot(halfway, halfway)));

            const auto bent = refracted(met.ray.direction, met.normal(), wave->ratio.at[i]);
            ASSERT_EQ(wave->sends.at[i],
                      bent ? Sends::kRefracts | Sends::kReflectedBlack : Sends::kReflects);
            total += !bent;
            if (bent) {
                const Vec3 out = -intoHemisphere(-*bent, met.normal());
                ASSERT_EQ(wave->refracted.ray[i].direction, out);
                ASSERT_EQ(wave->refracted.ray[i].origin,
                          geometry::spawnRay(met.surface, out).origin);
            }
            const Vec3 mirrored =
                intoHemisphere(reflected(met.ray.direction, met.normal()), met.normal());
            ASSERT_EQ(wave->mirrored.ray[i].direction, mirrored);
            ASSERT_EQ(wave->mirrored.ray[i].origin,
                      geometry::spawnRay(met.surface, mirrored).origin);
        }
        EXPECT_GT(total, 0u);
        EXPECT_GT(behind, 0u);
    }
}

TEST(Wave, tellsWhereSpheresAreTooSmallOrTooLargeForIt) {
    for (const Level& level : kLevels) {
        if (!Octree::supports(level.simd)) continue;
        SCOPED_TRACE(level.name);
        for (const double size : {0x1p-1001, 0x1p-999, 1.0, 0x1p999, 0x1p1001}) {
            const geometry::Sphere sphere{Vec3(0.0), size};
            const geometry::Ray ray{{0, 0, 3 * size}, numeric::kInfinity, {0, 0, -1}};
            const geometry::Hit hit{2 * size};
            const Work work;
            const material::Material material;
            const auto wave = std::make_unique<Wave>();
            std::fill_n(wave->material, kColumn, &material);
            std::fill_n(wave->sphere, kColumn, &sphere);
            EXPECT_EQ(level.kernel.gather(*wave, 1, &ray, &hit, &work),
                      size < 0x1p-1000 || size > 0x1p1000)
                << size;
            EXPECT_EQ(wave->geometric.z.at[0], size);
        }
    }
}

/// What is added for a light, the highlight's power included.
TEST(Wave, addsLightAsTheScalarCodeAtEverySimdLevel) {
    constexpr std::size_t kCount = 253;
    for (const Level& level : kLevels) {
        if (!Octree::supports(level.simd)) continue;
        SCOPED_TRACE(level.name);
        std::mt19937_64 random(11);
        std::uniform_real_distribution<double> share(0, 1);
        const auto vector = [&] { return Vec3{share(random), share(random), share(random)}; };
        const auto color = [&] { return LinearRgb{share(random), share(random), share(random)}; };
        std::vector<material::Material> materials(kColumn);
        const auto wave = std::make_unique<Wave>();
        for (std::size_t i = 0; i < kColumn; ++i) {
            material::Material& m = materials[i];
            for (LinearRgb* c : {&m.diffuse, &m.environment, &m.specular, &m.transmission})
                *c = color();
            if (i % 5 == 0) m.specular = {};
            m.shininess = i % 13 ? std::exp(12 * share(random)) : i % 2 ? 0 : 1e300;
            // Some neighbours have one material, others have not.
            wave->material[i] = &materials[i / 32 % 2 ? i : i / 32 * 32 + 1];
        }
        for (std::size_t i = 0; i < kCount; ++i) {
            for (Columns* c : {&wave->color, &wave->visible, &wave->light}) put(*c, i, vector());
            if (i % 7 == 0) put(wave->visible, i, Vec3(0.0));
            wave->cosine.at[i] = i % 3 ? share(random) : 0;
            // Powers from 1 to 0, by way of subnormal ones, and of subnormal numbers.
            wave->halfway.at[i] = i % 11 ? share(random) : i % 2 ? 1 : 1e-310;
        }
        const auto before = std::make_unique<Wave>(*wave);
        level.kernel.add(*wave, kCount, true);
        std::size_t shining = 0, vanishing = 0;
        for (std::size_t i = 0; i < kCount; ++i) {
            const double cosine = before->cosine.at[i];
            const material::Material& m = *wave->material[i];
            const auto vec = [](const LinearRgb& c) { return Vec3{c.r, c.g, c.b}; };
            Vec3 visible = at(before->visible, i);
            if (cosine == 0) visible *= vec(m.transmission);
            double power = 0;
            if (cosine > 0 && m.isMirror() && visible != Vec3(0.0)) {
                power = numeric::pow(before->halfway.at[i], m.shininess);
                ++shining;
                vanishing += power < 1e-300;
            }
            const Vec3 added = (vec(m.environment) * visible +
                                at(before->color, i) * vec(m.diffuse) * cosine * visible) +
                               vec(m.specular) * power * visible;
            ASSERT_EQ(at(wave->visible, i), visible);
            ASSERT_EQ(at(wave->added, i), added) << i;
            ASSERT_EQ(at(wave->light, i), at(before->light, i) + added);
        }
        EXPECT_GT(shining, vanishing + 50);
        EXPECT_GT(vanishing, 20u);
    }
}

} // namespace
} // namespace rt::trace
