// The loader `assimp`: what a glTF file says arrives in the world, what cannot is said, what is broken is refused.
#include <core/geometry/surface.hpp>
#include <tests/plugin_host/describe.hpp>
#include <tests/plugin_host/temporary_folder.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;
using numeric::Vec3;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

std::string base64(const std::string& bytes) {
    const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (std::size_t i = 0; i < bytes.size(); i += 3) { // the sizes here are multiples of 3
        std::uint32_t group = 0;
        for (std::size_t k = 0; k < 3; ++k)
            group = group << 8 | static_cast<unsigned char>(bytes.at(i + k));
        for (const int shift : {18, 12, 6, 0}) text += digits[group >> shift & 63];
    }
    return text;
}

std::string floats(std::initializer_list<float> values) {
    std::string bytes;
    for (const float value : values)
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return bytes;
}

/// One triangle with normals and uvs in a buffer inside the file; `nodes` place it, `rest` is more of the root.
std::string gltf(const std::string& nodes, const std::string& rest = "",
                 const std::string& primitive = ", \"material\": 0",
                 const std::string& color = "[0.5, 0.25, 0.125, 1]") {
    const std::string bytes = floats({0, 0, 0, 1, 0, 0, 0, 1, 0}) +       // positions
                              floats({0, 0, 1, 0, 0.6F, 0.8F, 0, 0, 1}) + // normals
                              floats({0, 0, 1, 0, 0, 1});                 // uvs, v down
    return "{\"asset\": {\"version\": \"2.0\"}, \"scene\": 0, \"scenes\": [{\"nodes\": [0]}], "
           "\"nodes\": [" +
           nodes +
           "], \"meshes\": [{\"name\": \"leaf\", \"primitives\": [{\"attributes\": {\"POSITION\": "
           "0, \"NORMAL\": 1, "
           "\"TEXCOORD_0\": 2}" +
           primitive +
           "}]}], \"materials\": [{\"name\": \"green\", \"pbrMetallicRoughness\": "
           "{\"baseColorFactor\": " +
           color +
           ", \"metallicFactor\": 0}}], \"buffers\": [{\"byteLength\": 96, \"uri\": "
           "\"data:application/octet-stream;base64," +
           base64(bytes) +
           "\"}], \"bufferViews\": [{\"buffer\": 0, "
           "\"byteOffset\": 0, \"byteLength\": 36}, {\"buffer\": 0, \"byteOffset\": 36, "
           "\"byteLength\": 36}, {\"buffer\": "
           "0, \"byteOffset\": 72, \"byteLength\": 24}], \"accessors\": [{\"bufferView\": 0, "
           "\"componentType\": 5126, "
           "\"type\": \"VEC3\", \"count\": 3}, {\"bufferView\": 1, \"componentType\": 5126, "
           "\"type\": \"VEC3\", "
           "\"count\": 3}, {\"bufferView\": 2, \"componentType\": 5126, \"type\": \"VEC2\", "
           "\"count\": 3}]" +
           rest + "}";
}

class AssimpLoader : public testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(fs::path(RT_SHIPPED_PLUGINS) / "assimp.rtplugin.so"))
            GTEST_SKIP() << "the loader 'assimp' is built where libassimp-dev is installed";
    }

    std::optional<world::World> load(const std::string& text) {
        folder_.write("leaf.gltf", text);
        scene::Object& object = scene_.add("mesh", {{"file", (folder_ / "leaf.gltf").string()}});
        object.loader = test::instance(scene_.catalog, scene::TypeKind::loader, "assimp");
        return scene_.lower();
    }

    const TemporaryFolder folder_;
    test::Scene scene_{{RT_SHIPPED_PLUGINS}};
};

TEST_F(AssimpLoader, CarriesPositionsNormalsAndMaterials) {
    const auto world = load(gltf("{\"mesh\": 0}"));
    ASSERT_TRUE(world) << scene_.said();
    EXPECT_EQ(scene_.said(), "");
    const auto& triangles = world->primitives.triangles;
    ASSERT_EQ(triangles.indices.size(), 1u);
    EXPECT_THAT(triangles.positions, ElementsAre(Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0)));
    const Vec3& tilted = triangles.normals[triangles.normalIndices[0][1]];
    EXPECT_EQ(static_cast<float>(tilted.y), 0.6F); // unit in f64 again, so not the very bits of f32
    EXPECT_EQ(static_cast<float>(tilted.z), 0.8F);
    const geometry::Vec2& uv = triangles.uvs[triangles.uvIndices[0][2]];
    EXPECT_EQ(uv.x, 0);
    EXPECT_EQ(uv.y, 0); // v is up here and down in the file
    const auto id = geometry::materialOf(world->primitives, geometry::PrimitiveId{0});
    const auto index = static_cast<std::size_t>(id);
    EXPECT_EQ(world->materialNames[index], "green");
    EXPECT_EQ(world->materials[index].color, (numeric::LinearRgb{0.5, 0.25, 0.125}));
    EXPECT_EQ(world->materials[index].diffuse, (numeric::LinearRgb{1, 1, 1}));
}

TEST_F(AssimpLoader, PlacesNodesWithinNodes) {
    const auto world = load(gltf(
        "{\"children\": [1, 2], \"translation\": [10, 0, 0]}, {\"mesh\": 0, \"scale\": [2, 4, 1]}, "
        "{\"mesh\": 0, \"translation\": [0, 0, 8], \"scale\": [-1, 1, 1]}"));
    ASSERT_TRUE(world) << scene_.said();
    const auto& triangles = world->primitives.triangles;
    ASSERT_EQ(triangles.indices.size(), 2u);
    const auto corner = [&](std::size_t t, std::size_t i) {
        return triangles.positions[triangles.indices[t][i]];
    };
    EXPECT_EQ(corner(0, 0), Vec3(10, 0, 0));
    EXPECT_EQ(corner(0, 1), Vec3(12, 0, 0));
    EXPECT_EQ(corner(0, 2), Vec3(10, 4, 0));
    // Normals are covectors: (0, 0.6, 0.8) under a scale of (2, 4, 1) is along (0, 0.15, 0.8).
    const Vec3& scaled = triangles.normals[triangles.normalIndices[0][1]];
    EXPECT_EQ(static_cast<float>(scaled.y / scaled.z), 0.1875F);
    // A mirror would turn the winding over: both faces still look along +z.
    for (const std::size_t t : {0u, 1u}) {
        const Vec3 normal = cross(corner(t, 1) - corner(t, 0), corner(t, 2) - corner(t, 0));
        EXPECT_GT(normal.z, 0) << t;
        for (int i = 0; i < 3; ++i)
            EXPECT_GT(triangles.normals[triangles.normalIndices[t][static_cast<std::size_t>(i)]].z,
                      0);
    }
    EXPECT_EQ(corner(1, 0).z, 8);
}

TEST_F(AssimpLoader, GivesMeshesWithoutMaterialTheObjects) {
    const auto world = load(gltf("{\"mesh\": 0}", "", ""));
    ASSERT_TRUE(world) << scene_.said();
    EXPECT_EQ(scene_.said(), "");
    const auto id = geometry::materialOf(world->primitives, geometry::PrimitiveId{0});
    EXPECT_EQ(world->materialNames[static_cast<std::size_t>(id)], "default");
}

TEST_F(AssimpLoader, SaysWhatItCannotCarry) {
    ASSERT_TRUE(load(gltf("{\"mesh\": 0, \"children\": [1]}, {\"camera\": 0}",
                          ", \"cameras\": [{\"type\": \"perspective\", \"perspective\": {\"yfov\": "
                          "1, \"znear\": 0.1}}]",
                          ", \"material\": 0", "[1, 1, 1, 0.5]")))
        << scene_.said();
    EXPECT_EQ(scene_.said(),
              "scene.yaml:100: note: loader 'assimp': leaf.gltf: 1 material says more than a base "
              "color (metal, "
              "roughness, emission, transparency or other maps); only the base color is taken\n"
              "scene.yaml:100: note: loader 'assimp': leaf.gltf: 1 camera not carried over: a "
              "scene has its own\n");
}

TEST_F(AssimpLoader, RefusesWhatIsBrokenAtTheFilesPlace) {
    const auto replaced = [](std::string text, const std::string& what, const std::string& by) {
        const std::size_t at = text.find(what);
        if (at == std::string::npos) throw std::logic_error(what);
        return text.replace(at, what.size(), by);
    };
    const std::string good = gltf("{\"mesh\": 0}");
    const std::string uri =
        good.substr(good.find("data:"), good.find("\"}]", good.find("data:")) - good.find("data:"));
    const std::pair<std::string, std::string> cases[] = {
        {"hello", "Assimp knows no file that begins and ends like this one"},
        {good.substr(0, good.size() / 2),
         "Assimp knows no file that begins and ends like this one"},
        {gltf("{\"mesh\": 9}"), "GLTF: Array index 9 is out of bounds (1) for \"meshes\""},
        {gltf("{\"mesh\": 0, \"children\": [0]}"),
         "GLTF: Object at index 0 in array \"nodes\" has recursive reference to itself"},
        {gltf("{}"), "holds no mesh"},
        {gltf("{\"mesh\": 0, \"scale\": [1e39, 1, 1]}"), "mesh 'leaf', vertex 0 is not finite"},
        {replaced(good, "\"count\": 3", "\"count\": 4000000000"),
         "GLTF: Accessor with offset/length (0/16000000000) is out of range."},
        {replaced(good, uri, "none.bin"),
         "the file '" + (folder_ / "none.bin").string() + "' is not there"},
        {replaced(good, uri, "../../../../../../../../etc/passwd"),
         "the file '" + (folder_ / "../../../../../../../../etc/passwd").string() +
             "' lies above the mesh's folder, where nothing is read"},
    };
    for (const auto& [text, message] : cases) {
        scene_.description.objects.clear();
        scene_.diagnostics = {};
        EXPECT_FALSE(load(text)) << message;
        EXPECT_EQ(scene_.said(),
                  "scene.yaml:100: error[E0420]: loader 'assimp': leaf.gltf: " + message + "\n");
    }
}

} // namespace
} // namespace rt::plugin_host
