// FAULTS row 3: every number of the language against values that a program could choke on.
#include <tests/scene/scene_text.hpp>

#include <cmath>

namespace rt::scene::test {
namespace {

const std::vector<std::string> kHostile{"nan",   ".nan",   ".inf", "-.inf", "1e400", "-1", "0",
                                        "1e308", "5e-324", "x",    "\"1\"", "[]",    "{}", "~"};

struct Field {
    std::string scene;                 // with @ in place of the value
    std::vector<std::string> accepted; // all other values are errors
    std::string suffix = "";           // unit
};

const std::vector<std::string> kAnyCoordinate{"-1", "0", "5e-324"}, kNotNegative{"0", "5e-324"},
    kNothing{};

std::vector<Field> fields() {
    const auto section = [](const std::string& text) { return kHead + text + "\n"; };
    const auto camera = [](const std::string& keys) { return "rt: 1\ncamera: {" + keys + "}\n"; };
    const auto material = [&](const std::string& key) {
        return section("materials: {m: {" + key + ": @}}");
    };
    const auto light = [&](const std::string& keys) {
        return section("lights: [point: {" + keys + "}]");
    };
    const auto object = [&](const std::string& keys) {
        return section("objects: [sphere: {radius: 1, " + keys + "}]");
    };
    const auto mesh = [&](const std::string& keys) {
        return section("objects: [mesh: {" + keys + "}]");
    };
    const auto background = [&](const std::string& keys) {
        return section(
            "textures: {t: {checker: {}}}\nbackground: {texture: t, mapping: legacy_hemisphere, " +
            keys + "}");
    };
    const auto track = [&](const std::string& keys) {
        return section(
            "objects: [sphere: {name: moon, radius: 1}]\nanimation: {frames: 9, tracks: [{" + keys +
            "}]}");
    };
    return {
        {section("image: {width: @}"), kNothing},
        {section("image: {height: @}"), kNothing},
        {section("image: {bits: @}"), kNothing},
        {camera("forward: [0, 1, 0], position: [@, 0, 0]"), kAnyCoordinate},
        {camera("position: [0, 0, 0], forward: [@, 1, 0]"), kAnyCoordinate},
        {camera("position: [0, 0, 0], look_at: [@, 1, 0]"), kAnyCoordinate},
        {camera("position: [0, 0, 0], forward: [0, 1, 0], up: [0, @, 1]"), kAnyCoordinate},
        {camera("position: [0, 0, 0], forward: [0, 1, 0], field_of_view: @"), kNothing},
        {camera("position: [0, 0, 0], forward: [0, 1, 0], field_of_view: @"), kNothing, "deg"},
        {camera(
             "position: [0, 0, 0], forward: [0, 1, 0], screen: {width: @, height: 1, distance: 1}"),
         kNothing},
        {camera(
             "position: [0, 0, 0], forward: [0, 1, 0], screen: {width: 1, height: @, distance: 1}"),
         kNothing},
        {camera(
             "position: [0, 0, 0], forward: [0, 1, 0], screen: {width: 1, height: 1, distance: @}"),
         kNothing},
        {section("bounds: {min: [0, @, 0], max: [1, 1, 1]}"), kAnyCoordinate},
        {section("bounds: {min: [-2, -2, -2], max: [1, @, 1]}"), kAnyCoordinate},
        {section("render: {depth: @}"), {"0"}},
        {section("render: {antialias: @}"), kNothing},
        {section("render: {antialias: {grid: @}}"), kNothing},
        {section("render: {antialias: {max_error: @}}"), kNothing},
        {section("render: {smooth: @}"), kNothing},
        {section("render: {cutoff: @}"), kNotNegative},
        {section("render: {octree: {max_objects: @}}"), kNothing},
        {section("render: {octree: {min_size: @}}"), kNotNegative},
        {section("background: {color: @}"), kNotNegative},
        {section("background: {color: [0, @, 0]}"), kNotNegative},
        {background("radius: 1, center: [@, 0, 0]"), kAnyCoordinate},
        {background("center: [0, 0, 0], radius: @"), kNothing},
        {light("position: [0, 0, @]"), kAnyCoordinate},
        {light("position: [0, 0, 0], color: @"), kNotNegative},
        {light("position: [0, 0, 0], color: [@, 0, 0]"), kNotNegative},
        {light("position: [0, 0, 0], brightness: @"), kNotNegative},
        {material("color"), kNotNegative},
        {material("diffuse"), kNotNegative},
        {material("specular"), kNotNegative},
        {material("transmission"), kNotNegative},
        {material("environment"), kNotNegative},
        {material("shininess"), kNotNegative},
        {material("ior"), kNothing},
        {section("objects: [sphere: {radius: @}]"), kNothing},
        {object("center: [0, @, 0]"), kAnyCoordinate},
        {object("scale: @"), {"-1"}},
        {object("scale: [1, 1, @]"), {"-1"}},
        {object("translate: [@, 0, 0]"), kAnyCoordinate},
        {object("rotate: {axis: [@, 0, 1], angle: 9deg}"), kAnyCoordinate},
        {object("rotate: {axis: [0, 0, @], angle: 9deg}"), {"-1", "5e-324"}},
        {object("rotate: {angle: @}"), kNothing},
        {object("rotate: {angle: @}"), {"-1", "0", "5e-324", "1e308"}, "deg"},
        {object("rotate: {angle: @}"), {"-1", "0", "5e-324", "1e308"}, "rad"},
        {mesh("crease: @"), kNothing},
        {mesh("crease: @"), {"0", "5e-324"}, "deg"},
        {mesh("vertices: [[0, 0, 0], [@, 0, 0]]"), kAnyCoordinate},
        {mesh("faces: [[0, 1, @]]"), {"0"}},
        {section("textures: {t: {checker: {rows: @}}}"), kNothing},
        {section("textures: {t: {checker: {a: @}}}"), kNotNegative},
        {section("animation: {frames: @}"), kNothing},
        {section("animation: {frames: 9, fps: @}"), kNothing},
        {track("target: moon, frames: [0, @], move: {position: [0, 0, 0]}"), kNothing},
        {track("target: moon, frames: [@, 8], move: {position: [0, 0, 0]}"), {"0"}},
        {track("target: moon, frames: [0, 8], move: {position: [0, 0, @]}"), kAnyCoordinate},
        {track("target: moon, frames: [0, 8], move_radius: {center: [@, 0, 0], distance: 1}"),
         kAnyCoordinate},
        {track("target: moon, frames: [0, 8], move_radius: {center: [0, 0, 0], distance: @}"),
         kAnyCoordinate},
        {track("target: moon, frames: [0, 8], move_direct: {direction: [@, 0, 0], distance: 1}"),
         {"-1", "5e-324"}},
        {track("target: moon, frames: [0, 8], rotate: {center: [0, 0, 0], axis: [0, @, 0], angle: "
               "1deg}"),
         {"-1", "5e-324"}},
        {track("target: moon, frames: [0, 8], rotate: {center: [0, 0, 0], axis: [0, 1, 0], angle: "
               "@}"),
         {"-1", "0", "5e-324", "1e308"},
         "rad"},
        {track("target: moon, frames: [0, 8], rotate_self: {axis: [0, 1, @], angle: 1deg}"),
         kAnyCoordinate},
        {track("target: moon, frames: [0, 8], rotate_self: {angle: 1deg}, faces: [@, 1]"), {"0"}},
        {track("target: moon.radius, keyframes: {0: @}"), kNothing},
        {track("target: moon.radius, keyframes: {@: 1}"), {"0", "\"1\""}},
        {track("target: camera.position, keyframes: {0: [@, 0, 0]}"), kAnyCoordinate},
    };
}

TEST(HostileValues, AreAcceptedOnlyWhereTheyMeanSomething) {
    for (const Field& field : fields())
        for (const std::string& value : kHostile) {
            std::string scene = field.scene;
            const std::string written =
                value +
                (std::isdigit(static_cast<unsigned char>(value.back())) ? field.suffix : "");
            scene.replace(scene.find('@'), 1, written);
            const Outcome outcome = outcomeOf(scene);
            const bool isAccepted = std::find(field.accepted.begin(), field.accepted.end(),
                                              value) != field.accepted.end();
            EXPECT_EQ(outcome.description.has_value(), isAccepted) << scene << outcome.messages;
            if (isAccepted) continue;
            const Diagnostic& first = outcome.diagnostics.all().at(0);
            EXPECT_EQ(outcome.diagnostics.exitCode(), 3) << scene;
            EXPECT_GT(first.location.line, 1u) << scene << outcome.messages;
        }
}

TEST(HostileValues, LeaveNothingInfiniteInADescription) {
    for (const Field& field : fields())
        for (const std::string& value : field.accepted) {
            std::string scene = field.scene;
            scene.replace(scene.find('@'), 1, value + field.suffix);
            const Description description = described(scene);
            const Camera& camera = description.camera;
            EXPECT_GT(camera.screenWidth * camera.screenHeight * camera.screenDistance, 0) << scene;
            EXPECT_GT(numeric::length(camera.forward), 0) << scene;
            for (const Object& object : description.objects)
                for (int i = 0; i < 3; ++i) {
                    EXPECT_TRUE(numeric::isFinite(object.worldFromObject.linear[i])) << scene;
                    EXPECT_GT(numeric::length(object.worldFromObject.linear[i]), 0) << scene;
                }
        }
}

} // namespace
} // namespace rt::scene::test
