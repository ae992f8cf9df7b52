// What a hit stands for, and where rays to a point end. (Self hits, gaps and slivers: tests/stability.)
#include "scenes.hpp"

#include <core/geometry/intersect.hpp>
#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>

#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rt::test {
namespace {

using geometry::Hit;
using geometry::Surface;
using octree::Octree;

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

} // namespace
} // namespace rt::test
