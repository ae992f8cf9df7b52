// From values to primitives: what arrives in the world, and every complaint on the way.
#include <core/numeric/rounding.hpp>
#include <core/numeric/transform.hpp>
#include <tests/plugin_host/describe.hpp>
#include <tests/plugin_host/temporary_folder.hpp>

#include <gtest/gtest.h>

#include <sys/stat.h>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;
using namespace std::literals;
using geometry::Kind;
using numeric::AffineTransform;
using numeric::Mat3;
using numeric::Vec3;
using scene::TypeKind;
using test::Scene;
using test::TemporaryFolder;

const fs::path kModules = RT_TEST_MODULES;
const fs::path kShipped = RT_SHIPPED_PLUGINS;

Scene shipped() { return Scene({kShipped}); }

Scene withTestModules() {
    return Scene({kShipped, kModules / "misfit", kModules / "rude", kModules / "toy_loader",
                  kModules / "loading"});
}

const AffineTransform kTurned{Mat3(Vec3(0, 2, 0), Vec3(-2, 0, 0), Vec3(0, 0, 2)),
                              Vec3(10, 0, 0)}; // and doubled
const AffineTransform kMirrored{Mat3(Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)), Vec3(0.0)};
const AffineTransform kStretched{Mat3(Vec3(2, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)), Vec3(0.0)};

Vec3 normalOf(const geometry::Triangles& t, std::size_t i) {
    const auto& c = t.indices[i];
    return cross(t.positions[c[1]] - t.positions[c[0]], t.positions[c[2]] - t.positions[c[0]]);
}

// ---- the shipped shapes ------------------------------------------------------------------------------------

TEST(Lower, SphereIsOnePrimitive) {
    Scene scene = shipped();
    scene.add("sphere", {{"center", Vec3(1, 2, 3)}, {"radius", 4.0}});
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    ASSERT_EQ(world->primitives.spheres.size(), 1u);
    EXPECT_EQ(world->primitives.spheres[0].center, Vec3(1, 2, 3));
    EXPECT_EQ(world->primitives.spheres[0].radius, 4);
    ASSERT_EQ(world->primitives.segments.size(), 1u);
    EXPECT_TRUE(world->primitives.segments[0].solid);
    EXPECT_EQ(world->primitives.segments[0].kind, Kind::sphere);
    EXPECT_EQ(world->objectNames, (std::vector<std::string>{"sphere0"}));
}

TEST(Lower, SphereUnderASimilarityStaysASphere) {
    Scene scene = shipped();
    scene.add("sphere", {{"center", Vec3(1, 0, 0)}}).worldFromObject = kTurned;
    scene.add("sphere", {{"center", Vec3(1, 0, 0)}}).worldFromObject = kMirrored;
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    ASSERT_EQ(world->primitives.spheres.size(), 2u);
    EXPECT_EQ(world->primitives.spheres[0].center, Vec3(10, 2, 0));
    EXPECT_EQ(world->primitives.spheres[0].radius, 2);
    EXPECT_EQ(world->primitives.spheres[1].center, Vec3(-1, 0, 0));
    EXPECT_EQ(world->primitives.spheres[1].radius, 1);
    EXPECT_TRUE(world->primitives.customs.primitives.empty());
}

TEST(Lower, TriangleKeepsItsCornersAndWinding) {
    Scene scene = shipped();
    const test::Values corners{{"a", Vec3(0, 0, 0)}, {"b", Vec3(1, 0, 0)}, {"c", Vec3(0, 1, 0)}};
    scene.add("triangle", corners);
    scene.add("triangle", corners).worldFromObject = kMirrored;
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    const auto& triangles = world->primitives.triangles;
    ASSERT_EQ(triangles.indices.size(), 2u);
    EXPECT_EQ(normalOf(triangles, 0), Vec3(0, 0, 1));
    EXPECT_EQ(normalOf(triangles, 1),
              Vec3(0, 0, 1)); // +z is outside, and a mirror in x leaves it there
    // The uv stays with its corner.
    for (std::size_t i = 0; i < 2; ++i)
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3 p = triangles.positions[triangles.indices[i][k]];
            EXPECT_EQ(triangles.uvs[triangles.uvIndices[i][k]], numeric::Vec2(std::fabs(p.x), p.y));
        }
}

TEST(Lower, ParallelogramKeepsItsEdges) {
    Scene scene = shipped();
    scene
        .add("parallelogram",
             {{"origin", Vec3(1, 1, 0)}, {"edge_u", Vec3(1, 0, 0)}, {"edge_v", Vec3(0, 3, 0)}})
        .worldFromObject = kTurned;
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    ASSERT_EQ(world->primitives.parallelograms.size(), 1u);
    EXPECT_EQ(world->primitives.parallelograms[0].origin, Vec3(8, 2, 0));
    EXPECT_EQ(world->primitives.parallelograms[0].edgeU, Vec3(0, 2, 0));
    EXPECT_EQ(world->primitives.parallelograms[0].edgeV, Vec3(-6, 0, 0));
    EXPECT_FALSE(world->primitives.segments[0].solid);
}

using VectorList = scene::Value::VectorList;
using IntegerLists = scene::Value::IntegerLists;

const VectorList kPyramid{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}}};

TEST(Lower, MeshCutsPolygonsIntoTriangles) {
    Scene scene = shipped();
    scene.add("mesh",
              {{"vertices", kPyramid},
               {"faces", IntegerLists{{{3, 2, 1, 0}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}}},
               {"kind", std::int64_t{1}}});
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    const auto& triangles = world->primitives.triangles;
    ASSERT_EQ(triangles.indices.size(), 6u);
    EXPECT_EQ(triangles.sourceFaces, (std::vector<std::uint32_t>{0, 0, 1, 2, 3, 4}));
    double volume = 0; // by the divergence theorem; positive when every triangle faces outward
    for (std::size_t i = 0; i < 6; ++i)
        volume += dot(triangles.positions[triangles.indices[i][0]], normalOf(triangles, i)) / 6;
    EXPECT_DOUBLE_EQ(volume, 1.0 / 3);
    EXPECT_TRUE(world->primitives.segments[0].solid);
}

TEST(Lower, MeshCutsAConcavePolygonWithoutLeavingIt) {
    Scene scene =
        shipped(); // a dart: from its first corner the fan would cover area 2.5 instead of 1.5
    scene.add("mesh", {{"vertices", VectorList{{{2, 0, 0}, {0, 2, 0}, {0, 0, 0}, {0.5, 0.5, 0}}}},
                       {"faces", IntegerLists{{{0, 1, 2, 3}}}}});
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    double area = 0;
    for (std::size_t i = 0; i < 2; ++i) area += normalOf(world->primitives.triangles, i).z / 2;
    EXPECT_DOUBLE_EQ(area, 1.5);
    EXPECT_GT(normalOf(world->primitives.triangles, 0).z, 0);
    EXPECT_GT(normalOf(world->primitives.triangles, 1).z, 0);
}

struct Complaint {
    std::string shape;
    test::Values values;
    std::string said;
};

TEST(Lower, ShapesExplainWhatTheyCannotUse) {
    const std::vector<Complaint> complaints{
        {"triangle",
         {{"a", Vec3(0, 0, 0)}, {"b", Vec3(1, 1, 1)}, {"c", Vec3(2, 2, 2)}},
         "scene.yaml:102: error[E0348]: shape 'triangle', c: lies on the line through a and b, so "
         "that there is no triangle\n"},
        {"parallelogram",
         {{"edge_u", Vec3(1, 0, 0)}, {"edge_v", Vec3(-2, 0, 0)}},
         "scene.yaml:102: error[E0348]: shape 'parallelogram', edge_v: is parallel to edge_u, so "
         "that there is no "
         "parallelogram\n"},
        {"mesh",
         {},
         "scene.yaml:100: error[E0420]: shape 'mesh', file: is missing, and there are no vertices "
         "either\n"},
        {"mesh",
         {{"vertices", kPyramid}},
         "scene.yaml:103: error[E0348]: shape 'mesh', faces: are missing\n"},
        {"mesh",
         {{"vertices", kPyramid}, {"faces", IntegerLists{{{0, 1, 5}}}}},
         "scene.yaml:103: error[E0348]: shape 'mesh', faces: faces[0] names vertex 5, and the "
         "vertices are 0 to 4\n"},
        {"mesh",
         {{"vertices", kPyramid}, {"faces", IntegerLists{{{0, 1, 2}, {0, -1, 2}}}}},
         "scene.yaml:103: error[E0348]: shape 'mesh', faces: faces[1] names vertex -1, and the "
         "vertices are 0 to 4\n"},
        {"mesh",
         {{"vertices", kPyramid}, {"faces", IntegerLists{{{0, 1}}}}},
         "scene.yaml:103: error[E0348]: shape 'mesh', faces: faces[0] has fewer than three "
         "corners\n"},
        {"mesh",
         {{"vertices", kPyramid}, {"faces", IntegerLists{{{0, 1, 1}}}}},
         "scene.yaml:103: error[E0348]: shape 'mesh', faces: faces[0] names vertex 1 twice\n"},
        {"mesh", // a bow tie
         {{"vertices", kPyramid}, {"faces", IntegerLists{{{0, 2, 1, 3}}}}},
         "scene.yaml:103: error[E0348]: shape 'mesh', faces: faces[0] has no area or crosses "
         "itself\n"},
    };
    for (const Complaint& complaint : complaints) {
        Scene scene = shipped();
        scene.add(complaint.shape, complaint.values);
        EXPECT_FALSE(scene.lower()) << complaint.said;
        EXPECT_EQ(scene.said(), complaint.said);
    }
}

TEST(Lower, ReportsTheErrorsOfAllObjects) {
    Scene scene = withTestModules();
    for (int i = 0; i < 3; ++i) scene.add("misfit", {{"act", std::string("nan radius")}});
    EXPECT_FALSE(scene.lower());
    EXPECT_EQ(scene.diagnostics.errorCount(), 3u);
    EXPECT_EQ(scene.diagnostics.exitCode(), 5);
}

// ---- order and identity ------------------------------------------------------------------------------------

TEST(Lower, NumbersPrimitivesInTheOrderOfTheScene) {
    Scene scene = shipped();
    scene.add("sphere");
    scene.add("mesh", {{"vertices", kPyramid}, {"faces", IntegerLists{{{0, 1, 4}, {1, 2, 4}}}}});
    scene.add("sphere");
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    const auto& segments = world->primitives.segments;
    ASSERT_EQ(segments.size(), 3u);
    const std::uint32_t first[] = {0, 1, 3}, index[] = {0, 0, 1};
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_EQ(static_cast<std::uint32_t>(segments[i].first), first[i]);
        EXPECT_EQ(segments[i].index, index[i]);
        EXPECT_EQ(static_cast<std::uint32_t>(segments[i].object), i);
    }
    EXPECT_EQ(world->primitives.count(), 4u);
}

TEST(Lower, GivesObjectsTheirMaterial) {
    Scene scene = shipped();
    scene.description.materials.resize(2);
    scene.description.materials[1].name = "red";
    scene.description.materials[1].color = {1, 0, 0};
    scene.add("sphere").material = 1;
    scene.add("sphere");
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    EXPECT_EQ(static_cast<std::uint32_t>(world->primitives.segments[0].material), 1u);
    EXPECT_EQ(static_cast<std::uint32_t>(world->primitives.segments[1].material), 2u);
    EXPECT_EQ(world->materialNames[2], "default");
    EXPECT_FALSE(world->materials[2].diffuse.isBlack());
}

// ---- files and loaders -------------------------------------------------------------------------------------

scene::Object& addLoading(Scene& scene, const std::string& path,
                          const test::Values& loaderValues = {}) {
    scene::Object& object = scene.add("loading", {{"file", path}});
    object.loader = test::instance(scene.catalog, TypeKind::loader, "toy_loader", loaderValues);
    object.loader->location = test::at(11);
    return object;
}

TEST(Lower, LoadsFilesWithTheirOwnMaterials) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.toy", "");
    Scene scene = withTestModules();
    scene.add("triangle", {{"a", Vec3(0, 0, 0)},
                           {"b", Vec3(1, 0, 0)},
                           {"c", Vec3(0, 1, 0)}}); // no materials of its own
    addLoading(scene, path, {{"size", 2.0}});
    scene.add("triangle", {{"a", Vec3(0, 0, 0)}, {"b", Vec3(1, 0, 0)}, {"c", Vec3(0, 1, 0)}});
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    const auto& t = world->primitives.triangles;
    ASSERT_EQ(t.indices.size(), 5u);
    ASSERT_EQ(t.materials.size(), 5u);
    std::vector<std::string> names;
    for (auto material : t.materials)
        names.push_back(world->materialNames[static_cast<std::uint32_t>(material)]);
    EXPECT_EQ(names, (std::vector<std::string>{"default", "red", "blue", "default", "default"}));
    EXPECT_EQ(t.sourceFaces, (std::vector<std::uint32_t>{0, 0, 0, 7, 0}));
    EXPECT_EQ(t.positions[t.indices[1][1]], Vec3(2, 0, 0));
    EXPECT_TRUE(world->primitives.segments[1].solid);
}

TEST(Lower, LeavesTheFilesMaterialsAsideWhenTheObjectNamesOne) {
    const TemporaryFolder folder;
    Scene scene = withTestModules();
    scene.description.materials.resize(1);
    // Not even its picture is looked for.
    addLoading(scene, folder.write("a.toy", "")).material = 0;
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    EXPECT_TRUE(world->primitives.triangles.materials.empty());
    EXPECT_EQ(world->materials.size(), 1u);
}

TEST(Lower, ReportsWhatALoaderSaysAtTheFile) {
    const TemporaryFolder folder;
    const std::string path = folder.write("a.toy", "");
    const std::pair<std::string, std::string> cases[] = {
        {"fail", "scene.yaml:100: error[E0420]: loader 'toy_loader': a.toy:3:1: no such vertex\n"},
        {"parameter",
         "scene.yaml:101: error[E0348]: loader 'toy_loader', size: is too large for this file\n"},
        {"note", "scene.yaml:100: note: loader 'toy_loader': 2 faces were mended\n"}};
    for (const auto& [act, said] : cases) {
        Scene scene = withTestModules();
        addLoading(scene, path, {{"act", act}});
        EXPECT_EQ(scene.lower().has_value(), act == "note");
        EXPECT_EQ(scene.said(), said);
    }
}

TEST(Lower, NamesAMissingFileAndItsNeighbour) {
    const TemporaryFolder folder;
    folder.write("dragon.toy", "");
    Scene scene = withTestModules();
    addLoading(scene, folder / "dragn.toy");
    EXPECT_FALSE(scene.lower());
    EXPECT_EQ(scene.said(), "scene.yaml:100: error[E0401]: '" + (folder / "dragn.toy").string() +
                                "': there is no such file; did you mean 'dragon.toy'?\n");
    EXPECT_EQ(scene.diagnostics.exitCode(), 4);
}

TEST(Lower, LeavesAnObjectOutWhenItsFileMayMiss) {
    const TemporaryFolder folder;
    Scene scene = withTestModules();
    addLoading(scene, folder / "a.toy");
    scene.add("sphere");
    const auto world = scene.lower({.allowMissing = true});
    ASSERT_TRUE(world) << scene.said();
    EXPECT_EQ(scene.said(), "scene.yaml:100: warning: '" + (folder / "a.toy").string() +
                                "': there is no such file; object 'loading0' is left out\n");
    EXPECT_EQ(world->primitives.count(), 1u);
    EXPECT_EQ(world->objectNames.size(), 2u); // numbers of objects stay those of the scene
    EXPECT_EQ(static_cast<std::uint32_t>(world->primitives.segments[0].object), 1u);
}

TEST(Lower, ReadsRegularFilesOnly) {
    const TemporaryFolder folder;
    ASSERT_EQ(mkfifo((folder / "pipe.toy").c_str(), 0600), 0);
    fs::create_directory(folder / "folder.toy");
    const std::pair<std::string, std::string> cases[] = {{"pipe.toy", "is a pipe, not a file"},
                                                         {"folder.toy", "is a folder, not a file"}};
    for (const auto& [name, why] : cases) {
        Scene scene = withTestModules();
        addLoading(scene, folder / name);
        EXPECT_FALSE(scene.lower({.allowMissing = true})); // it is there, and no file
        EXPECT_EQ(scene.said(), "scene.yaml:100: error[E0403]: '" + (folder / name).string() +
                                    "': " + why + "\n");
    }
}

TEST(Lower, GivesMaterialsOfFilesTheirPicture) {
    const TemporaryFolder folder;
    const std::string picture = folder.write("red.ppm", "P6 1 1 255\n\xFF\0\0"sv);
    const std::string file = folder.write("a.toy", "");
    Scene scene = withTestModules();
    addLoading(scene, file, {{"picture", picture}});
    addLoading(scene, file, {{"picture", picture}});
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    EXPECT_EQ(world->textures.size(), 1u); // one file, one texture
    ASSERT_NE(world->materials[1].colorTexture, nullptr);
    double rgb[3];
    const rt_surface_point point{};
    world->materials[1].colorTexture->type->evaluate(world->materials[1].colorTexture->state,
                                                     &point, 1, rgb);
    EXPECT_EQ(rgb[0], 1);
    EXPECT_EQ(rgb[1], 0);
}

TEST(Lower, MissesThePictureOfAMaterial) {
    const TemporaryFolder folder;
    const std::string file = folder.write("a.toy", ""),
                      picture = folder.write("red.txt", "not a picture");
    Scene scene = withTestModules();
    addLoading(scene, file, {{"picture", picture}});
    EXPECT_FALSE(scene.lower());
    EXPECT_EQ(scene.said(), "scene.yaml:100: error[E0450]: texture 'image', file: is not a PNG, "
                            "JPEG, BMP, HDR, EXR, PFM, PGM or "
                            "PPM file\n");
}

// ---- plugins that break the rules --------------------------------------------------------------------------

TEST(Lower, RefusesGeometryThatBreaksTheRules) {
    const std::pair<std::string, std::string> cases[] = {
        {"nan vertex", "E0532]: shape 'misfit': vertex 1 is not finite"},
        {"far vertex", "E0702]: shape 'misfit': vertex 2 lies farther out than 2^100"},
        {"vertex index", "E0532]: shape 'misfit': triangle 0 names vertex 3 of 3"},
        {"normal index", "E0532]: shape 'misfit': triangle 0 names normal 1 of 1"},
        {"zero normal", "E0532]: shape 'misfit': normal 0 has no direction"},
        {"uv index", "E0532]: shape 'misfit': triangle 0 names uv 1 of 1"},
        {"nan uv", "E0532]: shape 'misfit': uv 0 is not finite"},
        {"material index", "E0532]: shape 'misfit': triangle 0 names material 0 of 0"},
        {"kind", "E0532]: shape 'misfit': the kind of the mesh is neither surface nor solid"},
        {"negative radius", "E0532]: shape 'misfit': sphere 0 has a radius that is not positive"},
        {"nan radius", "E0532]: shape 'misfit': sphere 0 has a radius that is not positive"},
        {"nan center", "E0532]: shape 'misfit': the center of sphere 0 is not finite"},
        {"tiny radius",
         "E0702]: shape 'misfit': sphere 0 is too small for its surface to be computed"},
        {"parallel edges", "E0532]: shape 'misfit': the edges of parallelogram 0 are parallel"},
        {"empty bounds",
         "E0532]: shape 'misfit': the bounds of primitive 0 are empty or not a number"},
        {"nan bounds",
         "E0532]: shape 'misfit': the bounds of primitive 0 are empty or not a number"},
        {"infinite bounds", "E0532]: shape 'misfit': the box of primitive 0 is not finite"},
        {"no primitives", "E0532]: shape 'misfit': the custom shape has no primitives"},
        {"material color",
         "E0532]: shape 'misfit': material '' has a colour that is negative or not finite"},
        {"unknown parameter", "E0530]: shape 'misfit': must be even"},
        {"throw", "E0530]: shape 'misfit': the sky is falling"},
        {"throw int", "E0530]: shape 'misfit': threw something that is no std::exception"},
        {"memory", "E0703]: shape 'misfit': there is not enough memory for it"},
        {"load", "E0530]: shape 'misfit': it asked to load a parameter that is no file to load"},
        {"ignore", "E0532]: shape 'misfit': sphere 0 has a radius that is not positive"},
    };
    for (const auto& [act, said] : cases) {
        Scene scene = withTestModules();
        scene.add("misfit", {{"act", act}});
        EXPECT_FALSE(scene.lower()) << act;
        EXPECT_EQ(scene.said(), "scene.yaml:10: error[" + said + "\n");
    }
}

TEST(Lower, PlacesAComplaintAboutAParameterAtItsValue) {
    Scene scene = withTestModules();
    scene.add("misfit", {{"act", std::string("parameter")}});
    EXPECT_FALSE(scene.lower());
    EXPECT_EQ(scene.said(),
              "scene.yaml:101: error[E0348]: shape 'misfit', counter: must be even\n");
    EXPECT_EQ(scene.diagnostics.exitCode(), 3);
}

TEST(Lower, SurvivesRudePlugins) {
    const std::pair<std::string, std::string> cases[] = {
        {"throw",
         "E0531]: shape 'rude': it threw an exception across the plugin boundary: out of my way"},
        {"throw int", "E0531]: shape 'rude': it threw an exception across the plugin boundary"},
        {"null reason", "E0530]: shape 'rude': it gave no reason"},
        {"bad parameter", "E0530]: shape 'rude': parameter 99 is wrong"},
        {"", "E0530]: shape 'rude': it failed and gave no reason"}};
    for (const auto& [act, said] : cases) {
        Scene scene = withTestModules();
        scene.add("rude", {{"act", act}});
        EXPECT_FALSE(scene.lower()) << act;
        EXPECT_EQ(scene.said(), "scene.yaml:10: error[" + said + "\n");
        EXPECT_EQ(scene.diagnostics.exitCode(), 5);
    }
}

TEST(Lower, BrokenModulesDoNotHurtASceneThatNeedsNoneOfThem) {
    const TemporaryFolder broken;
    broken.write("blob.rtplugin.so", "no module");
    broken.write("Bad-Name.rtplugin.so", "");
    fs::create_symlink("/nowhere", broken / "lost.rtplugin.so");
    Scene scene(
        {broken.path(), kModules / "major_2", kModules / "layout", kShipped, "/no/such/folder"});
    scene.add("sphere"); // two modules claim "dot", and none of them is opened
    EXPECT_TRUE(scene.lower());
    EXPECT_EQ(scene.said(), "");
    ASSERT_EQ(scene.catalog.opened().size(), 1u);
    EXPECT_EQ(scene.catalog.opened()[0].name, "sphere");
}

TEST(Lower, PassesNotesOn) {
    Scene scene = withTestModules();
    scene.add("misfit", {{"act", std::string("note")}});
    EXPECT_TRUE(scene.lower());
    EXPECT_EQ(scene.said(), "scene.yaml:10: note: shape 'misfit': one thing was mended\n");
}

TEST(Lower, WarnsOfObjectsAndTrianglesThatAreNotThere) {
    Scene scene = withTestModules();
    scene.add("misfit", {{"act", std::string("nothing")}});
    scene.add("misfit", {{"act", std::string("flat triangle")}});
    const auto world = scene.lower();
    ASSERT_TRUE(world);
    EXPECT_EQ(world->primitives.count(), 1u);
    EXPECT_EQ(
        scene.said(),
        "scene.yaml:5: warning: object 'misfit0' has no geometry\n"
        "scene.yaml:10: warning: shape 'misfit': 1 of 2 triangles have no area and are left out\n");
}

TEST(Lower, ReleasesACustomShapeOnce) {
    int released = 0;
    const auto address = static_cast<std::int64_t>(reinterpret_cast<std::intptr_t>(&released));
    {
        Scene scene = withTestModules();
        scene.add("misfit", {{"act", std::string("custom")}, {"counter", address}});
        auto world = scene.lower();
        ASSERT_TRUE(world) << scene.said();
        const world::World copy = *world;
        world.reset();
        EXPECT_EQ(released, 0);
        EXPECT_TRUE(copy.primitives.segments[0].solid);
    }
    EXPECT_EQ(released, 1);
    Scene scene = withTestModules();
    scene.add("misfit", {{"act", std::string("empty bounds")}, {"counter", address}});
    EXPECT_FALSE(scene.lower());
    EXPECT_EQ(released, 2); // by the plugin, to whom it still belonged
}

TEST(Lower, RefusesATransformThatFlattens) {
    Scene scene = shipped();
    scene.add("sphere").worldFromObject.linear = Mat3(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 0));
    EXPECT_FALSE(scene.lower());
    EXPECT_EQ(
        scene.said(),
        "scene.yaml:10: error[E0348]: shape 'sphere': its transform flattens it to nothing\n");
}

} // namespace
} // namespace rt::plugin_host
