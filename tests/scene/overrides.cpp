// --set PATH=VALUE.
#include <core/scene/override.hpp>
#include <formats/yaml_writer.hpp>
#include <tests/scene/scene_text.hpp>

namespace rt::scene::test {
namespace {

const std::string kScene =
    "rt: 1\n"
    "camera: {position: [0, -9, 0], forward: [0, 1, 0], field_of_view: 30deg}\n"
    "textures: {sky: {checker: {rows: 3}}}\n"
    "lights: [point: {name: key, position: [0, 0, 9]}]\n"
    "objects:\n"
    "  - sphere: {name: moon, radius: 4}\n"
    "  - sphere: {radius: 5}\n";

struct Applied {
    std::optional<Description> description;
    std::string messages;
    int exitCode = 0;
};

Applied apply(const std::vector<std::string>& assignments) {
    Diagnostics diagnostics;
    std::optional<Node> root =
        formats::parseYaml(std::make_shared<Source>(Source{"s.yaml", kScene}), diagnostics);
    FakeCatalog catalog;
    Applied applied;
    for (const std::string& assignment : assignments) applyOverride(*root, assignment, diagnostics);
    if (!diagnostics.failed()) applied.description = validate(*root, catalog, diagnostics);
    for (const Diagnostic& diagnostic : diagnostics.all())
        applied.messages += format(diagnostic, false);
    applied.exitCode = diagnostics.exitCode();
    return applied;
}

double radius(const Applied& applied, std::size_t object) {
    return std::get<double>(applied.description.value().objects.at(object).shape.values.at(1).data);
}

TEST(Overrides, ReachObjectsByTheirInventedNames) {
    EXPECT_EQ(radius(apply({"objects.sphere_1.radius=6"}), 1), 6);
    EXPECT_EQ(radius(apply({"sphere_1.radius=6"}), 1), 6);
    EXPECT_EQ(apply({"objects.sphere_2.radius=6"}).messages,
              "--set:1:9: error[E0331]: objects has no item named 'sphere_2'; did you mean "
              "'sphere_1'?\n    1 | objects.sphere_2.radius=6\n      |         ^\n");
}

TEST(Overrides, ReplaceAndAddKeys) {
    EXPECT_EQ(apply({"render.depth=3"}).description.value().render.depth, 3u);
    EXPECT_EQ(apply({"image={width: 8, height: 6}"}).description.value().image.width, 8u);
    EXPECT_EQ(apply({"image.width=8", "image.width=9"}).description.value().image.width, 9u);
    EXPECT_EQ(apply({"camera.position=[1, 2, 3]"}).description.value().camera.position,
              Vec3(1, 2, 3));
    EXPECT_EQ(apply({"background.color=\"#ffffff\""}).description.value().background.color,
              LinearRgb::grey(1));
    EXPECT_EQ(apply({"background.color=#ffffff"}).description.value().background.color,
              LinearRgb::grey(1));
    EXPECT_EQ(apply({"lights.key.brightness=2"}).description.value().lights[0].brightness, 2);
    EXPECT_EQ(apply({"render.antialias={grid: 2}"}).description.value().render.antialias.index(),
              2u);
    EXPECT_EQ(std::get<std::int64_t>(apply({"textures.sky.checker.rows=4"})
                                         .description.value()
                                         .textures[0]
                                         .instance.values[2]
                                         .data),
              4);
    EXPECT_EQ(
        std::get<std::int64_t>(
            apply({"textures.sky.rows=5"}).description.value().textures[0].instance.values[2].data),
        5);
}

TEST(Overrides, FindObjectsByNameAndByNumber) {
    EXPECT_EQ(radius(apply({"objects.moon.radius=2"}), 0), 2);
    EXPECT_EQ(radius(apply({"moon.radius=2.5"}), 0), 2.5);
    EXPECT_EQ(radius(apply({"objects.1.radius=7"}), 1), 7);
    EXPECT_EQ(
        apply({"moon.translate=[0, 0, 1]"}).description.value().objects[0].placement.translation,
        Vec3(0, 0, 1));
}

TEST(Overrides, OfOneCameraKeyReplaceTheOther) {
    EXPECT_EQ(apply({"camera.look_at=[0, 0, 5]"}).description.value().camera.forward,
              Vec3(0, 9, 5));
    EXPECT_EQ(apply({"camera.screen={width: 3, height: 2, distance: 4}"})
                  .description.value()
                  .camera.screenDistance,
              4);
}

TEST(Overrides, AreRefusedWithAPlace) {
    const std::pair<const char*, const char*> kCases[] = {
        {"render.depth", "--set:1:1: error[E0331]: must be PATH=VALUE, such as render.depth=3\n    "
                         "1 | render.depth\n      | ^\n"},
        {"=3", "--set:1:1: error[E0331]: must be PATH=VALUE, such as render.depth=3\n    1 | =3\n  "
               "    | ^\n"},
        {"rendr.depth=3", "--set:1:1: error[E0331]: the scene has no section and no object "
                          "'rendr'; did you mean 'render'?\n"
                          "    1 | rendr.depth=3\n      | ^\n"},
        {"render..depth=3", "--set:1:8: error[E0331]: a key is missing in the path\n    1 | "
                            "render..depth=3\n      |        ^\n"},
        {"objects.mon.radius=3",
         "--set:1:9: error[E0331]: objects has no item named 'mon'; did you mean 'moon'?\n"
         "    1 | objects.mon.radius=3\n      |         ^\n"},
        {"mon.radius=3", "--set:1:1: error[E0331]: the scene has no section and no object 'mon'; "
                         "did you mean 'moon'?\n"
                         "    1 | mon.radius=3\n      | ^\n"},
        {"objects.2.radius=3", "--set:1:9: error[E0331]: objects has 2 items, numbered from 0; "
                               "there is none of number 2\n"
                               "    1 | objects.2.radius=3\n      |         ^\n"},
        {"rt.version=1", "--set:1:4: error[E0331]: rt is a single value and has no key 'version'\n "
                         "   1 | rt.version=1\n      |    ^\n"},
        {"camera.position=[1, 2",
         "--set:1:17: error[E0331]: the value is no number, text, [list] or {map}\n"
         "    1 | camera.position=[1, 2\n      |                 ^\n"},
        {"render.depth=x",
         "--set:1:14: error[E0304]: render, depth: must be a whole number (got x)\n"
         "    1 | render.depth=x\n      |              ^\n"},
        {"render.dept=3",
         "--set:1:8: error[E0301]: render has no key 'dept'; did you mean 'depth'?\n"
         "    1 | render.dept=3\n      |        ^\n"},
        {"moon.radius=",
         "--set:1:13: error[E0303]: sphere 'moon', radius: has no value; it must be a number\n"
         "    1 | moon.radius=\n      |             ^\n"},
    };
    for (const auto& [assignment, messages] : kCases) {
        const Applied applied = apply({assignment});
        EXPECT_EQ(applied.messages, messages);
        EXPECT_EQ(applied.exitCode, 3);
    }
}

TEST(Overrides, SurviveAnyText) {
    const std::string kPieces[] = {"render", ".",    "=", "[",    "]",        "{",
                                   "}",      ",",    ":", "\"",   "'",        "objects",
                                   "0",      "moon", " ", "\xff", "textures", "sky"};
    unsigned state = 1;
    std::size_t refused = 0;
    for (int round = 0; round < 5000; ++round) {
        std::string assignment;
        for (unsigned i = 0; i < 8; ++i) {
            state = state * 1664525u + 1013904223u; // Numerical Recipes' generator
            assignment += kPieces[(state >> 16) % std::size(kPieces)];
        }
        refused += apply({assignment}).exitCode != 0;
    }
    EXPECT_GT(refused, 4000u);
}

} // namespace
} // namespace rt::scene::test
