// Interpolated normals: STABILITY.md N1 and N2.
#include <core/trace/direction.hpp>
#include <core/trace/ray_tree.hpp>
#include <core/trace/shadow_terminator.hpp>
#include <tests/trace/scene_maker.hpp>

#include <gtest/gtest.h>

namespace rt::trace {
namespace {

/// Every ray of the tree of every pixel of a smooth ball.
template <class Check> void forEachNode(const Material& material, Check&& check) {
    SceneMaker scene;
    scene.description.image.width = 80, scene.description.image.height = 60;
    scene.icosphere({0, 3, 0}, 1, 1, true, scene.add(material));
    scene.light({2, 0, 3});
    for (std::uint32_t y = 0; y < 60; ++y)
        for (std::uint32_t x = 0; x < 80; ++x) {
            const RayTree tree = tracePixel(scene.octree(), scene.world, scene.description, x, y);
            for (const auto& node : tree.nodes) check(scene, tree, node);
        }
}

Vec3 facetNormal(const SceneMaker& scene, geometry::PrimitiveId id) {
    const auto& t = scene.world.primitives.triangles;
    const auto& f = t.indices[static_cast<std::uint32_t>(id)];
    return unit(
        cross(t.positions[f[1]] - t.positions[f[0]], t.positions[f[2]] - t.positions[f[0]]));
}

TEST(InterpolatedNormals, neverReflectBelowTheFacet) {
    std::size_t reflections = 0, clamped = 0;
    forEachNode(mirror(), [&](const SceneMaker& scene, const RayTree& tree, const auto& node) {
        if (node.kind != RayTree::Kind::reflected || node.fate != RayTree::Fate::traced) return;
        const auto& from = tree.nodes[node.parent];
        const Vec3 facet = facetNormal(scene, from.primitive);
        ++reflections;
        clamped += dot(reflected(from.direction, from.normal), facet) < 0;
        EXPECT_GT(dot(node.direction, facet), 0);
        EXPECT_FALSE(node.hit); // a convex body never sees itself
    });
    EXPECT_GT(reflections, 500u);
    EXPECT_GT(clamped, 5u); // else nothing was tested
}

TEST(InterpolatedNormals, neverRefractToTheSameSide) {
    std::size_t refractions = 0;
    forEachNode(clear(1.5), [&](const SceneMaker& scene, const RayTree& tree, const auto& node) {
        if (node.kind != RayTree::Kind::refracted || node.fate != RayTree::Fate::traced) return;
        const auto& from = tree.nodes[node.parent];
        const Vec3 facet = facetNormal(scene, from.primitive) * (from.leaving ? -1.0 : 1.0);
        ++refractions;
        EXPECT_LT(dot(node.direction, facet), 0);
        EXPECT_EQ(node.media.size(), from.leaving ? 0u : 1u);
    });
    EXPECT_GT(refractions, 500u);
}

TEST(ShadowTerminator, leavesNoBlackFacets) {
    std::size_t lit = 0, facingAway = 0;
    forEachNode(matte({1, 1, 1}), [&](const SceneMaker& scene, const RayTree&, const auto& node) {
        if (!node.hit) return;
        const Vec3 toLight = unit(Vec3{2, 0, 3} - node.position);
        if (!(dot(toLight, node.normal) > 0)) return;
        ++lit;
        facingAway += dot(toLight, facetNormal(scene, node.primitive)) < 0;
        ASSERT_EQ(node.lights.size(), 1u);
        EXPECT_FALSE(node.lights[0].visible.isBlack()) << "black facet";
    });
    EXPECT_GT(lit, 500u);
    EXPECT_GT(facingAway, 5u);
}

TEST(ShadowTerminator, movesNothingOnFlatSurfaces) {
    SceneMaker scene;
    scene.icosphere({0, 0, 0}, 1, 0, false, scene.add(matte({1, 1, 1})));
    geometry::Ray ray;
    ray.origin = {0.1, 0.2, 5}, ray.direction = {0, 0, -1};
    const auto hit = scene.octree().closest(ray);
    ASSERT_TRUE(hit);
    const auto surface = geometry::surfaceAt(scene.world.primitives, ray, hit);
    EXPECT_EQ(smoothPosition(scene.world.primitives, surface, hit, 1), surface.position);
}

TEST(ShadowTerminator, liftsAFacetOntoTheBall) {
    SceneMaker scene;
    scene.icosphere({0, 0, 0}, 1, 1, true, scene.add(matte({1, 1, 1})));
    for (double x = -0.5; x < 0.5; x += 0.0625) {
        geometry::Ray ray;
        ray.origin = {x, 0.13, 5}, ray.direction = {0, 0, -1};
        const auto hit = scene.octree().closest(ray);
        const auto surface = geometry::surfaceAt(scene.world.primitives, ray, hit);
        const double flat = 1 - length(surface.position);
        const double lifted = 1 - length(smoothPosition(scene.world.primitives, surface, hit, 1));
        EXPECT_LT(std::fabs(lifted), flat); // tangent planes lie outside, by about as much
        // Seen from inside the ball is hollow, and the facet hides nothing.
        EXPECT_EQ(smoothPosition(scene.world.primitives, surface, hit, -1), surface.position);
    }
}

} // namespace
} // namespace rt::trace
