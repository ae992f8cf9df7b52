// What is generated from the table of the language: the guide and the JSON Schema.
#include <core/scene/guide.hpp>
#include <core/scene/language.hpp>
#include <tests/scene/scene_text.hpp>

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace rt::scene::test {
namespace {

TEST(Guide, IsUpToDate) {
    const std::string path = RT_SOURCE_DIR "/scenes/LANGUAGE.md";
    if (std::getenv("RT_REGENERATE")) std::ofstream(path) << languageGuide();
    std::ifstream file(path);
    const std::string found{std::istreambuf_iterator<char>(file), {}};
    EXPECT_EQ(found, languageGuide())
        << "RT_REGENERATE=1 build/bin/test_scene --gtest_filter='Guide.*' writes it again";
}

nlohmann::json schema() {
    FakeCatalog catalog;
    return nlohmann::json::parse(jsonSchema(catalog));
}

TEST(Schema, HasEverySectionAndRefusesOthers) {
    const auto root = schema();
    EXPECT_EQ(root["$schema"], "http://json-schema.org/draft-07/schema#");
    EXPECT_EQ(root["additionalProperties"], false);
    EXPECT_EQ(root["required"], (nlohmann::json{"rt", "camera"}));
    EXPECT_EQ(root["properties"].size(), sections().size());
    for (const Section& section : sections())
        EXPECT_TRUE(root["properties"][std::string(section.name)].contains("description"))
            << section.name;
}

TEST(Schema, SaysLimitsDefaultsAndChoices) {
    const auto properties = schema()["properties"];
    EXPECT_EQ(
        properties["image"]["properties"]["width"],
        nlohmann::json::parse(
            R"({"description": "Width of the picture in pixels.", "default": 640, "type": "integer",
                                        "minimum": 1, "maximum": 4294967295})"));
    EXPECT_EQ(properties["image"]["properties"]["bits"]["enum"], (nlohmann::json{8, 16}));
    EXPECT_EQ(properties["camera"]["required"], nlohmann::json{"position"});
    EXPECT_EQ(properties["camera"]["properties"]["up"]["default"], (nlohmann::json{0, 0, 1}));
    EXPECT_EQ(
        properties["camera"]["properties"]["screen"]["properties"]["width"]["exclusiveMinimum"], 0);
    EXPECT_EQ(properties["camera"]["properties"]["field_of_view"]["type"], "string");
    EXPECT_EQ(properties["render"]["properties"]["antialias"]["oneOf"].size(), 3u);
    EXPECT_EQ(properties["rt"]["const"], 1);
}

TEST(Schema, OffersEveryTypeThatOpens) {
    const auto properties = schema()["properties"];
    std::vector<std::string> shapes;
    for (const auto& alternative : properties["objects"]["items"]["oneOf"])
        shapes.push_back(alternative["required"][0]);
    EXPECT_EQ(shapes, (std::vector<std::string>{"clash", "mesh", "sphere"})); // broken is refused
    const auto& mesh = properties["objects"]["items"]["oneOf"][1]["properties"]["mesh"];
    for (const char* key : {"name", "material", "loader", "scale", "rotate", "translate", "file",
                            "kind", "vertices", "winding"})
        EXPECT_TRUE(mesh["properties"].contains(key)) << key;
    const auto& sphere = properties["objects"]["items"]["oneOf"][2]["properties"]["sphere"];
    EXPECT_EQ(sphere["required"], nlohmann::json{"radius"});
    EXPECT_FALSE(sphere["properties"].contains("loader"));
    EXPECT_EQ(properties["textures"]["additionalProperties"]["oneOf"].size(), 2u);
    EXPECT_EQ(properties["lights"]["items"]["properties"]["point"]["required"],
              nlohmann::json{"position"});
}

} // namespace
} // namespace rt::scene::test
