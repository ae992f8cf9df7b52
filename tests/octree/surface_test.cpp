// Leaving a surface: never onto itself, never past its neighbour; normals of the thinnest triangles.
#include "scenes.hpp"

#include <core/geometry/intersect.hpp>
#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>

#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rt::test {
namespace {

using geometry::Hit;
using geometry::Surface;
using numeric::dot;
using octree::Octree;

struct Setting {
    double size;
    Vec3 center;
};

std::vector<Setting> settings() {
    std::vector<Setting> all;
    for (const double size : {0.000001, 0.001, 1.0, 1e3, 1e6})
        for (const double away : {0.0, 1.0, 1e3})
            all.push_back({size, Vec3(0.7, -1, 0.4) * (away * size)});
    return all;
}

/// A ray from outside that hits the surface somewhere, also at its corners and under grazing angles.
Ray rayToward(const Vec3& point, double size, Random& random) {
    Ray ray;
    ray.origin = point + random.direction() * (size * std::pow(10.0, random.in(-3, 3)));
    ray.direction = (point - ray.origin) * std::pow(10.0, random.in(-2, 2));
    return ray;
}

/// A direction on the side of the normal, often nearly along the surface.
Vec3 leaving(const Vec3& normal, Random& random) {
    Vec3 d = random.direction();
    if (random.below(2)) d -= dot(d, normal) * normal * (1 - std::pow(10.0, random.in(-12, 0)));
    return dot(d, normal) >= 0 ? d : -d;
}

TEST(SpawnRay, NeverHitsTheSphereItLeaves) {
    for (const Setting& at : settings()) {
        Primitives p;
        addSpheres(p, {{at.center, at.size}});
        const Octree tree = Octree::build(p);
        Random random(1);
        std::size_t outward = 0, lost = 0, seen = 0;
        for (int i = 0; i < 4000; ++i) {
            const Ray ray = rayToward(at.center + at.size * random.direction(), at.size, random);
            const Hit hit = tree.closest(ray);
            if (!hit) continue;
            ++seen;
            const Surface s = geometry::surfaceAt(p, ray, hit);
            const Vec3 d = leaving(s.geometricNormal, random);
            outward += static_cast<bool>(tree.closest(geometry::spawnRay(s, d)));
            lost += !tree.closest(geometry::spawnRay(s, -d)); // into the ball: out again
        }
        EXPECT_GT(seen, 1500u);
        EXPECT_EQ(0u, outward) << "size " << at.size << " at " << at.center.x;
        EXPECT_EQ(0u, lost) << "size " << at.size << " at " << at.center.x;
    }
}

TEST(SpawnRay, NeverHitsTheConvexMeshItLeaves) {
    for (const Setting& at : settings()) {
        const Mesh ball = icosphere(3, at.size, at.center);
        const Mesh cube = box(8, Vec3(at.size), at.center); // coplanar neighbours
        for (const Mesh* mesh : {&ball, &cube}) {
            Primitives p;
            addMesh(p, mesh->positions, mesh->indices);
            const Octree tree = Octree::build(p);
            Random random(2);
            std::size_t self = 0, lost = 0, seen = 0;
            for (int i = 0; i < 4000; ++i) {
                const auto& t =
                    mesh->indices[random.below(static_cast<std::uint32_t>(mesh->indices.size()))];
                const double u = random.unit(), v = random.unit() * (1 - u);
                const Vec3 a = mesh->positions[t[0]];
                const bool corner = random.below(8) == 0;
                const Vec3 point =
                    corner ? a
                           : a + u * (mesh->positions[t[1]] - a) + v * (mesh->positions[t[2]] - a);
                Ray ray = rayToward(point, at.size, random);
                const Hit hit = tree.closest(ray);
                if (!hit) continue;
                ++seen;
                const Surface s = geometry::surfaceAt(p, ray, hit);
                const Vec3 d = leaving(s.geometricNormal, random);
                self += static_cast<bool>(tree.closest(geometry::spawnRay(s, d)));
                // Into the body; not from a corner, where the start is on other faces too, whose outside
                // it may round to.
                if (corner) continue;
                const Vec3 inward = -(s.geometricNormal + 0.3 * random.direction());
                lost += !tree.closest(geometry::spawnRay(s, inward));
            }
            EXPECT_GT(seen, 1500u);
            EXPECT_EQ(0u, self) << "size " << at.size << " at " << at.center.x
                                << (mesh == &ball ? " ball" : " cube");
            EXPECT_EQ(0u, lost) << "size " << at.size << " at " << at.center.x;
        }
    }
}

TEST(SpawnRay, MeetsAParallelNeighbourCloseBy) {
    for (const Setting& at : settings()) {
        const double largest =
            std::fmax(at.size, numeric::maxComponent(numeric::abs(at.center)) + at.size);
        const Vec3 u(at.size, 0, 0), v(0, at.size, 0);
        const Vec3 gap(0, 0, tolerance::kSmallestGap * largest);
        Primitives p;
        addParallelograms(p, {{at.center, u, v}, {at.center + gap, u, v}});
        addMesh(p, {at.center - gap, at.center - gap + u, at.center - gap + v}, {{0, 1, 2}}, false);
        const Octree tree = Octree::build(p);
        Random random(3);
        for (int i = 0; i < 2000; ++i) {
            // Between the first parallelogram and what lies above and below it.
            const Hit start{1, 0.1 + 0.3 * random.unit(), 0.1 + 0.3 * random.unit(),
                            geometry::PrimitiveId{0}};
            Ray ray;
            ray.direction = {0, 0, 1};
            const Surface s = geometry::surfaceAt(p, ray, start);
            Vec3 d = random.direction();
            d.z += d.z < 0 ? -0.1 : 0.1;
            const Hit hit = tree.closest(geometry::spawnRay(s, d));
            ASSERT_EQ(d.z > 0 ? 1u : 2u, static_cast<std::uint32_t>(hit.id))
                << "size " << at.size << " at " << at.center.x;
        }
    }
}

/// A triangle without uvs once had (0, 0) as soon as any other mesh of the scene had uvs.
TEST(Surface, UvOfAMeshDoesNotDependOnOtherMeshes) {
    Primitives p;
    p.triangles.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    p.triangles.indices = {{0, 1, 2}};
    p.segments = {{geometry::PrimitiveId{0}, 1, geometry::Kind::triangle, false, 0, {}, {}}};
    Ray ray;
    ray.origin = {0.25, 0.5, 1};
    ray.direction = {0, 0, -1};
    const Hit hit = Octree::build(p).closest(ray);
    ASSERT_TRUE(hit);
    const auto alone = geometry::surfaceAt(p, ray, hit).uv;
    p.triangles.uvs = {{0.5, 0.5}}; // of some other mesh
    p.triangles.uvIndices = {{geometry::kNoIndex, geometry::kNoIndex, geometry::kNoIndex}};
    EXPECT_EQ(geometry::surfaceAt(p, ray, hit).uv, alone);
    EXPECT_EQ(alone, (geometry::Vec2{0.25, 0.5}));
}

TEST(SpawnRay, ToAPointStopsBeforeIt) {
    Primitives p;
    addParallelograms(p,
                      {{{-1, -1, 0}, {2, 0, 0}, {0, 2, 0}}, {{-1, -1, 1}, {2, 0, 0}, {0, 2, 0}}});
    const Octree tree = Octree::build(p);
    Ray ray;
    ray.origin = {0.1, 0.2, 0.5};
    ray.direction = {0, 0, -1};
    const Surface s = geometry::surfaceAt(p, ray, tree.closest(ray));
    EXPECT_FALSE(tree.occluded(geometry::spawnRayTo(s, {0.3, 0.3, 0.999})));
    EXPECT_TRUE(tree.occluded(geometry::spawnRayTo(s, {0.3, 0.3, 1.001})));
    EXPECT_FALSE(tree.occluded(geometry::spawnRayTo(s, {0.3, 0.3, -5})));
}

TEST(SpawnRay, NeverHitsTheCustomShapeItLeaves) {
    for (const Setting& at : settings()) {
        Primitives p;
        addCustoms(p, {{at.center, at.size}}, true);
        const Octree tree = Octree::build(p);
        Random random(4);
        std::size_t self = 0, seen = 0;
        for (int i = 0; i < 2000; ++i) {
            const Ray ray = rayToward(at.center + at.size * random.direction(), at.size, random);
            const Hit hit = tree.closest(ray);
            if (!hit) continue;
            ++seen;
            const Surface s = geometry::surfaceAt(p, ray, hit);
            self += static_cast<bool>(
                tree.closest(geometry::spawnRay(s, leaving(s.geometricNormal, random))));
        }
        EXPECT_GT(seen, 500u);
        EXPECT_EQ(0u, self) << "size " << at.size << " at " << at.center.x;
    }
}

using Quad = __float128;

double degreesOff(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
    Quad e[3], f[3], n[3], m[3], off[3];
    for (int i = 0; i < 3; ++i) {
        e[i] = static_cast<Quad>(b[i]) - a[i];
        f[i] = static_cast<Quad>(c[i]) - a[i];
        m[i] = normal[i];
    }
    const auto cross = [](const Quad* x, const Quad* y, Quad* z) {
        for (int i = 0; i < 3; ++i)
            z[i] = x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3];
    };
    const auto dot3 = [](const Quad* x, const Quad* y) {
        return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    };
    cross(e, f, n);
    cross(n, m, off);
    const Quad squared = dot3(off, off) / (dot3(n, n) * dot3(m, m));
    if (dot3(n, m) < 0) return 180;
    return std::sqrt(static_cast<double>(squared)) * 180 / std::numbers::pi;
}

TEST(TriangleNormal, IsRightHoweverThinTheTriangle) {
    Random random(6);
    for (const double thin : {1.0, 0.01, 0.001, 0.0001, 0.00001, 0.000001})
        for (const double size : {0.000001, 1.0, 1e6})
            for (const double away : {0.0, 1.0, 100.0}) {
                double worst = 0;
                for (int i = 0; i < 300; ++i) {
                    const Vec3 a = (random.inBox(1) + Vec3(away)) * size,
                               b = a + random.direction() * size,
                               c = a + (b - a) * random.unit() + random.direction() * (thin * size);
                    const Vec3 n = geometry::triangleNormal(a, b, c);
                    if (n == Vec3(0.0)) continue;
                    worst = std::max(worst, degreesOff(a, b, c, n));
                    EXPECT_NEAR(1, numeric::length(n), numeric::gamma(6));
                }
                EXPECT_LE(worst, tolerance::kNormalDegrees)
                    << "thin " << thin << ", size " << size << ", away " << away;
            }
}

TEST(TriangleNormal, IsZeroOnlyWhenTheCornersAreInLine) {
    EXPECT_EQ(Vec3(0.0), geometry::triangleNormal({0, 0, 0}, {1, 1, 1}, {3, 3, 3}));
    EXPECT_EQ(Vec3(0.0), geometry::triangleNormal({1, 2, 3}, {1, 2, 3}, {4, 5, 6}));
    const Vec3 n = geometry::triangleNormal({0, 0, 0}, {1, 0, 0}, {0.5, std::ldexp(1.0, -60), 0});
    EXPECT_EQ(Vec3(0, 0, 1), n);
}

TEST(Surface, KnowsWhatWasHit) {
    Primitives p;
    addMesh(p, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 2}, {2, 1, 3}});
    addSpheres(p, {{{0, 0, 5}, 1}});
    p.triangles.normals = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}};
    p.triangles.normalIndices = {{0, 0, 0}, {1, 0, geometry::kNoIndex}};
    p.triangles.uvs = {{0.25, 0.5}, {0.75, 0.5}};
    p.triangles.uvIndices = {{0, 1, 0}, {0, 0, geometry::kNoIndex}};
    p.triangles.materials = {geometry::MaterialId{7}, geometry::MaterialId{8}};
    p.triangles.sourceFaces = {40, 41};
    Ray ray;
    ray.origin = {0.25, 0.25, 1};
    ray.direction = {0, 0, -2};
    const Octree tree = Octree::build(p);
    const Hit hit = tree.closest(ray);
    EXPECT_EQ(0.5, hit.t);
    const Surface s = geometry::surfaceAt(p, ray, hit);
    EXPECT_EQ(Vec3(0.25, 0.25, 0), s.position);
    EXPECT_EQ(Vec3(0, 0, 1), s.geometricNormal);
    EXPECT_EQ(Vec3(0, 0, 1), s.shadingNormal);
    EXPECT_EQ(0.375, s.uv.x);
    EXPECT_EQ(0.5, s.uv.y);
    EXPECT_EQ(geometry::MaterialId{7}, s.material);
    EXPECT_EQ(geometry::MaterialId{7}, geometry::materialOf(p, hit.id));
    EXPECT_EQ(40u, geometry::sourceFaceOf(p, s.id));
    EXPECT_TRUE(s.solid);
    ray.origin = {0.75, 0.75, 1};
    const Surface other = geometry::surfaceAt(p, ray, tree.closest(ray));
    EXPECT_EQ(41u, geometry::sourceFaceOf(p, other.id));
    EXPECT_GT(other.shadingNormal.x, 0.1);
    EXPECT_EQ(Vec3(0, 0, 1), other.geometricNormal);
    ray.origin = {0, 0, 5}; // inside the ball: the normal stays outward
    ray.direction = {3, 0, 0};
    const Surface ball = geometry::surfaceAt(p, ray, tree.closest(ray));
    EXPECT_EQ(Vec3(1, 0, 5), ball.position);
    EXPECT_EQ(Vec3(1, 0, 0), ball.geometricNormal);
    EXPECT_EQ(geometry::Vec2(0, 0.5), geometry::uvOf(ball));
    EXPECT_EQ(geometry::ObjectId{1}, ball.object);
}

TEST(Sphere, NoLineIsLostOrInventedFarAway) {
    // Impact parameter b against the radius, the origin up to a million radii away; the exact answer
    // is the sign of r − b.
    Random random(8);
    for (const double distance : {10.0, 1e3, 1e6})
        for (int i = 0; i < 20000; ++i) {
            const double margin = 16 * numeric::kUnitRoundoff * distance;
            const bool inside = random.below(2);
            const double off = margin * std::pow(10.0, random.in(0.01, 3)),
                         impact = inside ? 1 - off : 1 + off;
            Vec3 d = random.direction();
            const Vec3 side = numeric::normalize(numeric::cross(d, random.direction()));
            Ray ray;
            ray.origin = side * impact - d * distance;
            ray.direction = d;
            const __float128 ox = ray.origin.x, oy = ray.origin.y, oz = ray.origin.z, dx = d.x,
                             dy = d.y, dz = d.z;
            const __float128 b = ox * dx + oy * dy + oz * dz, a = dx * dx + dy * dy + dz * dz;
            const __float128 discriminant = b * b - a * (ox * ox + oy * oy + oz * oz - 1);
            double t[2];
            ASSERT_EQ(discriminant >= 0,
                      geometry::intersectSphereLine(geometry::frameOf(ray), {Vec3(0.0), 1}, t))
                << "distance " << distance << ", off by " << off;
        }
}

} // namespace
} // namespace rt::test
