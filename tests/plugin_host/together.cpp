// Files that are loaded at the same time make the world that they make one after the other.
#include <core/world/append.hpp>
#include <tests/plugin_host/describe.hpp>
#include <tests/plugin_host/temporary_folder.hpp>

#include <gtest/gtest.h>

namespace rt::plugin_host {
namespace {

using numeric::Vec3;
using test::Scene;
using test::TemporaryFolder;

const std::filesystem::path kModules = RT_TEST_MODULES;
const std::filesystem::path kShipped = RT_SHIPPED_PLUGINS;

template <class Id> std::vector<std::uint32_t> numbers(const std::vector<Id>& ids) {
    std::vector<std::uint32_t> out;
    for (const Id id : ids) out.push_back(static_cast<std::uint32_t>(id));
    return out;
}

void expectSame(const world::World& a, const world::World& b) {
    const geometry::Triangles &s = a.primitives.triangles, &t = b.primitives.triangles;
    EXPECT_EQ(s.positions, t.positions);
    EXPECT_EQ(s.indices, t.indices);
    EXPECT_EQ(s.normals, t.normals);
    EXPECT_EQ(s.normalIndices, t.normalIndices);
    EXPECT_EQ(s.uvs, t.uvs);
    EXPECT_EQ(s.uvIndices, t.uvIndices);
    EXPECT_EQ(numbers(s.materials), numbers(t.materials));
    EXPECT_EQ(s.sourceFaces, t.sourceFaces);
    EXPECT_EQ(a.primitives.spheres.size(), b.primitives.spheres.size());
    EXPECT_EQ(a.primitives.customs.shapes.size(), b.primitives.customs.shapes.size());
    ASSERT_EQ(a.primitives.customs.primitives.size(), b.primitives.customs.primitives.size());
    for (std::size_t i = 0; i < a.primitives.customs.primitives.size(); ++i)
        EXPECT_EQ(a.primitives.customs.primitives[i].shape,
                  b.primitives.customs.primitives[i].shape);
    ASSERT_EQ(a.primitives.segments.size(), b.primitives.segments.size());
    for (std::size_t i = 0; i < a.primitives.segments.size(); ++i) {
        const geometry::Segment &x = a.primitives.segments[i], &y = b.primitives.segments[i];
        EXPECT_EQ(x.first, y.first);
        EXPECT_EQ(x.count, y.count);
        EXPECT_EQ(x.kind, y.kind);
        EXPECT_EQ(x.solid, y.solid);
        EXPECT_EQ(x.index, y.index);
        EXPECT_EQ(x.object, y.object);
        EXPECT_EQ(x.material, y.material);
    }
    EXPECT_EQ(a.materialNames, b.materialNames);
    EXPECT_EQ(a.objectNames, b.objectNames);
}

void addMesh(Scene& scene, const std::string& path, const std::string& kind = "surface",
             const test::Values& loaderValues = {}) {
    const std::int64_t solid = kind == "solid";
    scene::Object& object = scene.add("mesh", {{"file", path}, {"kind", solid}});
    object.loader =
        test::instance(scene.catalog, scene::TypeKind::loader, "openmesh", loaderValues);
}

/// Meshes with and without normals, uvs and materials, between shapes of every kind.
void fill(Scene& scene, const TemporaryFolder& folder) {
    folder.write("two.mtl", "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n");
    const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    const std::string plain = folder.write("plain.obj", corners + "f 1 2 3 4\n");
    const std::string coloured =
        folder.write("coloured.obj",
                     "mtllib two.mtl\n" + corners + "usemtl red\nf 1 2 3\nusemtl blue\nf 1 3 4\n");
    const std::string full = folder.write(
        "full.obj", corners + "vt 0 0\nvt 1 1\nvn 0 0 1\nf 1/1/1 2/2/1 3/1/1\nf 1 3 4\n");
    addMesh(scene, plain);
    scene.add("sphere");
    addMesh(scene, full);
    scene.add("torus");
    addMesh(scene, coloured);
    scene.add("parallelogram", {{"edge_u", Vec3(1, 0, 0)}, {"edge_v", Vec3(0, 1, 0)}});
    addMesh(scene, coloured, "solid");
    scene.add("torus");
    for (int i = 0; i < 20; ++i) addMesh(scene, i % 3 == 0 ? coloured : i % 3 == 1 ? full : plain);
}

TEST(LoadTogether, GivesTheSameWorldAsOneAfterTheOther) {
    const TemporaryFolder folder;
    Scene serial({kShipped}), together({kShipped});
    fill(serial, folder), fill(together, folder);
    const auto expected = serial.lower({.threads = 1}), world = together.lower({.threads = 3});
    ASSERT_TRUE(expected && world) << serial.said() << together.said();
    expectSame(*world, *expected);
    EXPECT_EQ(together.said(), serial.said());
    // One default material, and two of the file each time it is loaded.
    EXPECT_EQ(world->materials.size(), 1u + 2 * 9);
    EXPECT_EQ(world->primitives.triangles.materials.size(),
              world->primitives.triangles.indices.size());
}

TEST(LoadTogether, SaysWhatIsWrongInTheOrderOfTheScene) {
    const TemporaryFolder folder;
    const auto say = [&](int threads) {
        Scene scene({kShipped});
        addMesh(scene, folder.write("a.obj", "v 0 0 0\nf 1 2 3\n"));
        addMesh(scene, folder.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "solid");
        addMesh(scene, folder.write("c.obj", ""));
        addMesh(scene, (folder / "d.obj").string());
        EXPECT_FALSE(scene.lower({.threads = threads}));
        return scene.said();
    };
    EXPECT_EQ(
        say(3),
        "scene.yaml:100: error[E0420]: loader 'openmesh': a.obj:2:5: vertex index 2 is out of "
        "range: the file has 1 vertex\n"
        "scene.yaml:100: note: loader 'openmesh': b.obj: 1 component has no defined outside; it "
        "stays as it is wound\n"
        "scene.yaml:100: warning: loader 'openmesh': b.obj: the solid is not closed: it has 3 "
        "boundary edges\n"
        "scene.yaml:100: error[E0420]: loader 'openmesh': c.obj: holds no face\n"
        "scene.yaml:100: error[E0401]: '" +
            (folder / "d.obj").string() + "': there is no such file; did you mean 'a.obj'?\n");
    EXPECT_EQ(say(3), say(1));
}

TEST(LoadTogether, AsksOnlyLoadersThatAllowIt) {
    const TemporaryFolder folder;
    Scene scene({kShipped, kModules / "toy_loader", kModules / "loading"});
    for (int i = 0; i < 4; ++i) {
        scene::Object& object = scene.add("loading", {{"file", folder.write("a.toy", "")}});
        object.loader = test::instance(scene.catalog, scene::TypeKind::loader, "toy_loader");
    }
    const auto world = scene.lower({.threads = 3});
    ASSERT_TRUE(world) << scene.said();
    EXPECT_EQ(world->primitives.count(), 12u);
    EXPECT_FALSE(RT_HAS(scene.catalog.open("toy_loader").module->loader, rt_loader, traits) &&
                 scene.catalog.open("toy_loader").module->loader->traits != 0);
    EXPECT_EQ(scene.catalog.open("openmesh").module->loader->traits, RT_LOADS_CONCURRENTLY);
}

TEST(LoadTogether, RefusesMoreThanIdsCanName) {
    world::World to, from;
    to.primitives.segments.push_back(
        {geometry::PrimitiveId{0}, 0xFFFFFFFD, geometry::Kind::sphere, true, 0, {}, {}});
    from.primitives.segments.push_back(
        {geometry::PrimitiveId{0}, 2, geometry::Kind::sphere, true, 0, {}, {}});
    EXPECT_EQ(world::append(to, std::move(from), 0, 0xFFFFFFFF),
              "the scene has more than 4294967294 primitives");
    EXPECT_EQ(to.primitives.segments.size(), 1u);
}

} // namespace
} // namespace rt::plugin_host
