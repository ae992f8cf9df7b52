// What plugins of ABI 1.0 are in this rt, and must be in every rt that speaks 1.x.
#include <core/plugin_host/module.hpp>
#include <tests/plugin_host/describe.hpp>
#include <tests/plugin_host/temporary_folder.hpp>

#include <gtest/gtest.h>

namespace rt::plugin_host {
namespace {

const std::filesystem::path kFossils = std::filesystem::path(RT_TEST_MODULES) / "fossil";

TEST(Fossil, ShapeIsWhatItWas) {
    test::Scene scene({kFossils});
    scene.add("fossil_shape");
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    EXPECT_EQ(scene.said(), "scene.yaml:10: note: shape 'fossil_shape': a fossil\n");
    const auto& p = world->primitives;
    ASSERT_EQ(p.count(), 4u);
    EXPECT_EQ(p.triangles.sourceFaces, (std::vector<std::uint32_t>{41}));
    EXPECT_EQ(p.triangles.normalIndices[0], (std::array<std::uint32_t, 3>{0, 0, RT_NO_INDEX}));
    EXPECT_EQ(world->materialNames[static_cast<std::uint32_t>(p.triangles.materials[0])], "clay");
    EXPECT_EQ(p.spheres[0].center, geometry::Vec3(1, 2, 3));
    EXPECT_EQ(p.spheres[0].radius, 2);
    EXPECT_EQ(p.parallelograms[0].origin, geometry::Vec3(0, 0, 1));
    const rt_custom& custom = p.customs.shapes[0]->shape;
    const rt_ray ray{{0.5, 0.25, 9}, 0, {0, 0, -2}, 100};
    const std::uint32_t id = 0;
    rt_hit hit;
    ASSERT_EQ(custom.intersect(custom.data, &id, 1, &ray, &hit), 1);
    EXPECT_EQ(hit.t, 2);
    EXPECT_EQ(hit.uv[1], 0.25);
    double t;
    ASSERT_EQ(custom.crossings(custom.data, 0, &ray, &t, 1), 1u);
    EXPECT_EQ(t, 2);
}

TEST(Fossil, TextureIsWhatItWas) {
    test::Scene scene({kFossils});
    scene.addTexture("t", "fossil_texture");
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    const auto& [type, state] = *world->textures[0];
    const rt_surface_point points[2] = {{{1, 2}, {3, 4, 5}, {6, 7, 8}},
                                        {{9, 0}, {0, 9, 0}, {0, 0, 9}}};
    double rgb[6];
    type->evaluate(state, points, 2, rgb);
    EXPECT_EQ((std::vector<double>(rgb, rgb + 6)), (std::vector<double>{1, 4, 8, 9, 9, 9}));
    std::uint32_t size[2];
    type->resolution(state, size);
    EXPECT_EQ(size[0], 7u);
    EXPECT_EQ(size[1], 5u);
}

TEST(Fossil, LoaderIsWhatItWas) {
    const test::TemporaryFolder folder;
    test::Scene scene({kFossils, std::filesystem::path(RT_TEST_MODULES) / "loading"});
    scene::Object& object = scene.add("loading", {{"file", folder.write("a.fossil", "").string()}});
    object.loader = test::instance(scene.catalog, scene::TypeKind::loader, "fossil_loader");
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    EXPECT_EQ(world->primitives.count(), 1u);
    EXPECT_TRUE(world->primitives.segments[0].solid);
}

} // namespace
} // namespace rt::plugin_host
