// What validation says, word for word.
#include <tests/scene/scene_text.hpp>

namespace rt::scene::test {
namespace {

struct Case {
    std::string text; // appended to kHead, from line 3
    std::string messages;
};

void expectAll(const std::vector<Case>& cases) {
    for (const Case& each : cases)
        EXPECT_EQ(refusal(kHead + each.text), each.messages) << each.text;
}

TEST(Messages, ShowTheLineAndACaret) {
    Diagnostics diagnostics;
    FakeCatalog catalog;
    const auto source = std::make_shared<Source>(
        Source{"s.yaml", kHead + "objects:\n  - sphere: {name: 月, radus: 4}   # the moon\n"});
    ASSERT_FALSE(validate(*formats::parseYaml(source, diagnostics), catalog, diagnostics));
    EXPECT_EQ(format(diagnostics.all().at(0), false),
              "s.yaml:4:25: error[E0301]: sphere '月' has no key 'radus'; did you mean 'radius'?\n"
              "    4 |   - sphere: {name: 月, radus: 4}   # the moon\n"
              "      |                        ^\n");
    EXPECT_EQ(diagnostics.all().size(), 1u) << "a misspelt key is not reported as missing, too";
}

TEST(Messages, AboutTheDocument) {
    EXPECT_EQ(refusal("a: 1\n"), "1:1: error[E0302]: the scene needs the key 'rt', the version of "
                                 "its language; start with 'rt: 1'\n"
                                 "1:1: error[E0301]: the scene has no key 'a'; it has rt, "
                                 "textures, image, camera, bounds, render, "
                                 "background, lights, materials, objects and animation\n"
                                 "1:1: error[E0302]: the scene needs the key 'camera'\n");
    EXPECT_EQ(refusal("- 1\n"), "1:1: error[E0303]: a scene is a map of sections that starts with "
                                "'rt: 1'; this is a list\n");
    EXPECT_EQ(refusal("hello\n"), "1:1: error[E0303]: a scene is a map of sections that starts "
                                  "with 'rt: 1'; this is a word or number\n");
    EXPECT_EQ(refusal("rt: 2\nanything: 1\n"),
              "1:5: error[E0322]: the scene needs version 2 of the scene language; this program "
              "knows version 1; install a newer rt\n");
    EXPECT_EQ(refusal("rt: 0\n"),
              "1:5: error[E0322]: there is no version 0 of the scene language; write 'rt: 1'\n");
    EXPECT_EQ(refusal("rt: one\ncamera: {position: [0, 0, 0], forward: [0, 1, 0]}\n"),
              "1:5: error[E0304]: the scene, rt: must be a whole number (got one)\n");
    expectAll(
        {{"objcts: []\n",
          "3:1: error[E0301]: the scene has no key 'objcts'; did you mean 'objects'?\n"},
         {"objects: {}\n", "3:10: error[E0303]: objects: must be a list of objects, such as '- "
                           "sphere: {radius: 1}', not a map\n"},
         {"lights: ~\n", "3:9: error[E0303]: lights: must be a list of lights, such as '- point: "
                         "{position: [0, 0, 9]}', not nothing\n"},
         {"materials: []\n", "3:12: error[E0303]: materials: must be a map of materials, such as "
                             "'red: {color: [1, 0, 0]}', not a list\n"},
         {"textures: 3\n", "3:11: error[E0303]: textures: must be a map of textures, such as 'sky: "
                           "{image: {file: sky.png}}', not a word or number\n"},
         {"render:\n", "3:1: error[E0303]: render: must be a map of keys, but has no value\n"},
         {"image: [1]\n", "3:8: error[E0303]: image: must be a map of keys, not a list\n"}});
}

TEST(Messages, AboutThePicture) {
    expectAll({
        {"image: {width: 0}\n",
         "3:16: error[E0306]: image, width: must be >= 1 and <= 4294967295 (got 0)\n"},
        {"image: {width: -1}\n",
         "3:16: error[E0306]: image, width: must be >= 1 and <= 4294967295 (got -1)\n"},
        {"image: {width: 1.5}\n",
         "3:16: error[E0307]: image, width: must be a whole number (got 1.5)\n"},
        {"image: {width: 46341, height: 46341}\n",
         "3:16: error[E0713]: the picture has 46341 x 46341 = 2147488281 pixels; the limit is "
         "268435456; --limit-pixels raises it\n"},
        {"image: {width: 65536, height: 65536}\n",
         "3:16: error[E0713]: the picture has 65536 x 65536 = 4294967296 pixels; the limit is "
         "268435456; --limit-pixels raises it\n"},
        {"image: {width: 2147483647, height: 2147483647}\n",
         "3:16: error[E0713]: the picture has 2147483647 x 2147483647 = 4611686014132420609 "
         "pixels; the limit is 268435456; "
         "--limit-pixels raises it\n"},
        {"image: {encoding: SRGB}\n",
         "3:19: error[E0310]: image, encoding: must be one of srgb, linear (got SRGB)\n"},
        {"image: {tone: lmit}\n", "3:15: error[E0310]: image, tone: must be one of limit, clamp "
                                  "(got lmit); did you mean 'limit'?\n"},
        {"image: {bits: 10}\n", "3:15: error[E0310]: image, bits: must be one of 8, 16 (got 10)\n"},
    });
    for (const char* path : {"/etc/a.png", "../a.png", "a/../../b.png", ".."})
        EXPECT_EQ(refusal(kHead + "image: {file: " + path + "}\n"),
                  std::string("3:15: error[E0323]: image, file: must be below the current folder, "
                              "relative and without '..' (got ") +
                      path + "); name any other place with -o\n");
}

TEST(Messages, HaveTheExitCodeOfTheFirst) {
    EXPECT_EQ(outcomeOf(kHead + "image: {width: 65536, height: 65536}\n").diagnostics.exitCode(),
              7);
    EXPECT_EQ(outcomeOf(kHead + "image: {width: 0}\n").diagnostics.exitCode(), 3);
    EXPECT_EQ(outcomeOf(kHead + "objects:\n  - broken: {}\n").diagnostics.exitCode(), 5);
    EXPECT_TRUE(
        outcomeOf(kHead + "image: {width: 65536, height: 65536}\n", Limits{.pixels = 1ull << 32})
            .description);
    EXPECT_FALSE(
        outcomeOf(kHead + "image: {width: 65536, height: 65537}\n", Limits{.pixels = 1ull << 32})
            .description);
}

TEST(Messages, AboutTheCamera) {
    const auto camera = [](const std::string& keys) {
        return refusal("rt: 1\ncamera: {" + keys + "}\n");
    };
    EXPECT_EQ(camera(""),
              "2:1: error[E0302]: camera needs the key 'position'\n"
              "2:1: error[E0302]: camera needs the key 'forward' or the key 'look_at'\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0, 1, 0], look_at: [0, 1, 0]"),
              "2:60: error[E0321]: camera: 'forward' and 'look_at' exclude each other\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0, 1, 0], field_of_view: 60deg, screen: "
                     "{width: 1, height: 1, distance: 1}"),
              "2:66: error[E0321]: camera: 'screen' and 'field_of_view' exclude each other\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0, 0, 0]"),
              "2:40: error[E0319]: camera, forward: must not be [0, 0, 0]\n");
    EXPECT_EQ(camera("position: [1, 2, 3], look_at: [1, 2, 3]"),
              "2:40: error[E0319]: camera, look_at: is the camera's own position\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0, 1, 0], up: [0, 0, 0]"),
              "2:55: error[E0319]: camera, up: must not be [0, 0, 0]\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0, 0, -2]"),
              "2:40: error[E0319]: camera: looks along 'up', so that no side of the picture is up; "
              "name another direction with 'up'\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0.1, 0.2, 0.7], up: [1, 2, 7]"),
              "2:61: error[E0319]: camera: looks along 'up', so that no side of the picture is up; "
              "name another direction with 'up'\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0, 1, 0], field_of_view: 180deg"),
              "2:66: error[E0306]: camera, field_of_view: must be >= 0.001deg and <= 179deg (got "
              "180deg)\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0, 1, 0], field_of_view: 60"),
              "2:66: error[E0308]: camera, field_of_view: is an angle and needs a unit (got 60); "
              "write 60deg or 60rad\n");
    EXPECT_EQ(camera("position: [0, 0, 0], forward: [0, 1, 0], screen: {width: 1, hight: 2}"),
              "2:51: error[E0302]: camera.screen needs the key 'distance'\n"
              "2:70: error[E0301]: camera.screen has no key 'hight'; did you mean 'height'?\n");
}

TEST(Messages, AboutDirectionsThatAreOnlyNearlyParallel) {
    // An angle that doubles can tell from 0 is a camera.
    EXPECT_TRUE(
        outcomeOf("rt: 1\ncamera: {position: [0, 0, 0], forward: [0, 1e-12, 1]}\n").description);
    EXPECT_TRUE(outcomeOf("rt: 1\ncamera: {position: [0, 0, 0], forward: [0, 1e18, 1], up: [0, "
                          "-1e-300, 1e-300]}\n")
                    .description);
}

TEST(Messages, AboutBoundsRenderAndBackground) {
    expectAll({
        {"bounds: {min: [0, 0, 0], max: [1, 0, 1]}\n",
         "3:31: error[E0320]: bounds: max must be above min on every axis, but on y 0 is not above "
         "0\n"},
        {"render: {antialias: grid}\n",
         "3:21: error[E0310]: render, antialias: 'grid' needs a value; write {grid: ...}\n"},
        {"render: {antialias: fsaa}\n",
         "3:21: error[E0310]: render, antialias: must be one of none, fsaa4 or {grid: ...} or "
         "{max_error: ...} (got fsaa); did you mean "
         "'fsaa4'?\n"},
        {"render: {antialias: {grd: 2}}\n",
         "3:22: error[E0301]: render.antialias has no key 'grd'; did you mean 'grid'?\n"},
        {"render: {antialias: {grid: 0}}\n",
         "3:28: error[E0306]: render.antialias, grid: must be >= 1 and <= 64 (got 0)\n"},
        {"render: {antialias: {grid: 2, max_error: 1}}\n",
         "3:21: error[E0303]: render, antialias: must be one of none, fsaa4 or {grid: ...} or "
         "{max_error: ...}\n"},
        {"render: {antialias: [2]}\n", "3:21: error[E0303]: render, antialias: must be one of "
                                       "none, fsaa4 or {grid: ...} or {max_error: ...}\n"},
        {"render: {smooth: yes}\n",
         "3:18: error[E0311]: render, smooth: must be true or false (got yes); write true\n"},
        {"render: {smooth: 'true'}\n",
         "3:18: error[E0311]: render, smooth: must be true or false (got the text 'true')\n"},
        {"render: {octree: {max_objects: 0}}\n", "3:32: error[E0306]: render.octree, max_objects: "
                                                 "must be >= 1 and <= 4294967295 (got 0)\n"},
        {"background: {texture: sky}\n", "3:23: error[E0316]: background, texture: there is no "
                                         "texture 'sky'; the scene has no section 'textures'\n"},
        {"background: {mapping: lat_long}\n",
         "3:23: error[E0321]: background, mapping: has no meaning without a texture\n"},
        {"textures: {sky: {checker: {}}}\nbackground: {texture: sky, mapping: legacy_hemisphere, "
         "radius: 0}\n",
         "4:37: error[E0302]: background: mapping legacy_hemisphere needs the key 'center'\n"
         "4:64: error[E0306]: background, radius: must be > 0 (got 0)\n"},
        {"textures: {sky: {checker: {}}}\nbackground: {texture: sky, radius: 1}\n",
         "4:36: error[E0321]: background, radius: belongs to mapping legacy_hemisphere only\n"},
    });
}

TEST(Messages, AboutTexturesAndLights) {
    expectAll({
        {"textures:\n  sky: {imag: {file: a.png}}\n",
         "4:9: error[E0317]: there is no texture 'imag'; did you mean 'image'?\n"},
        {"textures:\n  sky: {clouds: {}}\n",
         "4:9: error[E0520]: texture 'clouds': there is no such plugin in /plugins\n"},
        {"textures:\n  sky: {image: {}}\n",
         "4:9: error[E0302]: texture 'sky' needs the key 'file'\n"},
        {"textures:\n  sky: image\n",
         "4:8: error[E0325]: texture 'sky': must be a map of one type, such as '{image: {file: "
         "sky.png}}', not a word or number\n"},
        {"textures:\n  a.b: {checker: {}}\n", "4:3: error[E0314]: texture 'a.b': a name must not "
                                              "contain '.', which paths such as moon.radius use\n"},
        {"textures:\n  a: {checker: {over: b}}\n  b: {checker: {over: a}}\n",
         "5:23: error[E0349]: texture 'a' needs itself\n"},
        {"textures:\n  a: {checker: {over: a}}\n",
         "4:23: error[E0349]: texture 'a' needs itself\n"},
        {"textures:\n  a: {checker: {rows: 1e3}}\n",
         "4:23: error[E0307]: texture 'a', rows: must be a whole number (got 1e3)\n"},
        {"lights:\n  - spot: {}\n",
         "4:5: error[E0317]: there is no light 'spot'; lights are of type 'point'\n"},
        {"lights:\n  - point: {position: [0, 0, 1], colour: 1}\n",
         "4:34: error[E0301]: point light has no key 'colour'; did you mean 'color'?\n"},
        {"lights:\n  - point: {name: a, position: [0, 0, 1]}\n  - point: {name: a, position: [0, "
         "0, 1]}\n",
         "5:19: error[E0313]: point light, name: the name 'a' is taken in line 4\n"},
    });
}

TEST(Messages, AboutColors) {
    const auto color = [](const std::string& value) {
        return refusal(kHead + "materials:\n  m: {color: " + value + "\n    }\n");
    };
    EXPECT_EQ(color("#ff0000"), "4:7: error[E0303]: material 'm', color: has no value; it must be "
                                "a colour: one number, [r, g, b], or "
                                "\"#rrggbb\"; '#' starts a comment: put the colour in quotes\n");
    EXPECT_EQ(color("\"#ff00\""), "4:14: error[E0309]: material 'm', color: must be \"#\" and six "
                                  "hexadecimal digits, rrggbb (got #ff00)\n");
    EXPECT_EQ(color("red"), "4:14: error[E0309]: material 'm', color: must be a colour: one "
                            "number, [r, g, b], or \"#rrggbb\" (got red)\n");
    EXPECT_EQ(color("[1, 2]"), "4:14: error[E0312]: material 'm', color: must be a colour of three "
                               "numbers [r, g, b] (got 2 entries)\n");
    EXPECT_EQ(color("[1, 2, -1]"),
              "4:21: error[E0306]: material 'm', color: must be >= 0 and <= 1000000 (got -1)\n");
    EXPECT_EQ(color("1e7"),
              "4:14: error[E0306]: material 'm', color: must be >= 0 and <= 1000000 (got 1e7)\n");
}

TEST(Messages, AboutNumbers) {
    const auto radius = [](const std::string& value) {
        return refusal(kHead + "objects:\n  - sphere: {radius: " + value + "}\n");
    };
    const std::pair<const char*, const char*> kCases[] = {
        {"-1", "E0306]: sphere, radius: must be > 0 (got -1)"},
        {"0", "E0306]: sphere, radius: must be > 0 (got 0)"},
        {"1e19", "E0306]: sphere, radius: must be > 0 and <= 1e18 (got 1e19)"},
        {"010", "E0304]: sphere, radius: must be a number without leading zeros (got 010)"},
        {"0x10", "E0304]: sphere, radius: must be a number (got 0x10)"},
        {"1_000", "E0304]: sphere, radius: must be a number (got 1_000)"},
        {"'1,5'", "E0303]: sphere, radius: must be a number (got the text '1,5')"},
        {"1e999", "E0305]: sphere, radius: is beyond the range of numbers, 1e308 (got 1e999)"},
        {".nan", "E0305]: sphere, radius: must be finite (got .nan)"},
        {"-.Inf", "E0305]: sphere, radius: must be finite (got -.Inf)"},
        {"nan", "E0305]: sphere, radius: must be finite (got nan)"},
        {"1.5 m", "E0304]: sphere, radius: must be a number (got 1.5 m)"},
        {"\"1.5\"", "E0303]: sphere, radius: must be a number (got the text '1.5')"},
        {"\"\\e[31m\"", "E0303]: sphere, radius: must be a number (got the text '\\x1b[31m')"},
        {"~", "E0303]: sphere, radius: has no value; it must be a number"},
        {"[1]", "E0303]: sphere, radius: must be a number, not a list"},
        {"{a: 1}", "E0303]: sphere, radius: must be a number, not a map"},
    };
    for (const auto& [value, message] : kCases)
        EXPECT_EQ(radius(value), std::string("4:22: error[") + message + "\n") << value;
    EXPECT_EQ(refusal(kHead + "objects:\n  - sphere:\n      radius: 1,5\n"),
              "5:15: error[E0304]: sphere, radius: must be a number (got 1,5); write 1.5\n");
}

TEST(Messages, AboutObjects) {
    expectAll({
        {"objects:\n  - sphere: {}\n", "4:5: error[E0302]: sphere needs the key 'radius'\n"},
        {"objects:\n  - sphere:\n    radius: 4\n",
         "5:5: error[E0325]: objects[0]: this key stands beside 'sphere' and must stand below it; "
         "indent it further\n"},
        {"objects:\n  - sphere\n", "4:5: error[E0325]: objects[0]: must be a map of one shape, "
                                   "such as '- sphere: {radius: 1}', not a word or number\n"},
        {"objects:\n  - {}\n", "4:5: error[E0325]: objects[0]: must be a map of one shape, such as "
                               "'- sphere: {radius: 1}', but has 0 keys\n"},
        {"objects:\n  - sphere: {radius: 1, center: [0, 0]}\n",
         "4:33: error[E0312]: sphere, center: must be three numbers [x, y, z] (got 2 entries)\n"},
        {"objects:\n  - sphere: {radius: 1, material: rde}\nmaterials: {red: {}}\n",
         "4:35: error[E0315]: sphere, material: there is no material 'rde'; did you mean 'red'?\n"},
        {"objects:\n  - sphere: {radius: 1, material: {ior: 0}}\n",
         "4:41: error[E0306]: sphere 'sphere_0', material, ior: must be >= 0.01 and <= 100 (got "
         "0)\n"},
        {"objects:\n  - sphere: {name: a, radius: 1}\n  - mesh: {name: a}\n",
         "5:18: error[E0313]: mesh, name: the name 'a' is taken in line 4\n"},
        {"objects:\n  - sphere: {name: camera, radius: 1}\n",
         "4:20: error[E0314]: sphere, name: 'camera' is a section of the scene and no name for an "
         "object\n"},
        {"objects:\n  - sphere: {radius: 1, scale: 0}\n",
         "4:32: error[E0318]: sphere, scale: must not be 0\n"},
        {"objects:\n  - sphere: {radius: 1, scale: [1, 5e-324, 1]}\n",
         "4:32: error[E0318]: sphere, scale: is too close to 0\n"},
        {"objects:\n  - sphere: {radius: 1, rotate: {axis: [0, 0, 0], angle: 1deg}}\n",
         "4:33: error[E0319]: sphere, rotate: an axis must not be [0, 0, 0]\n"},
        {"objects:\n  - sphere: {radius: 1, rotate: [{angle: 1deg}, {angel: 1deg}]}\n",
         "4:50: error[E0301]: sphere, rotate[1] has no key 'angel'; did you mean 'angle'?\n"},
        {"objects:\n  - mesh: {file: a.stl}\n",
         "4:18: error[E0324]: mesh, file: no loader is known for files that end with '.stl'; name "
         "one with the key 'loader': openmesh\n"},
        {"objects:\n  - mesh: {file: a}\n",
         "4:18: error[E0324]: mesh, file: the file's name has no suffix that says what reads it; "
         "name one with the key 'loader': openmesh\n"},
        {"objects:\n  - mesh: {file: a.obj, windng: file}\n",
         "4:25: error[E0301]: mesh has no key 'windng'; did you mean 'winding'?\n"},
        {"objects:\n  - mesh: {file: a.dat, loader: openmsh}\n",
         "4:33: error[E0317]: there is no loader 'openmsh'; did you mean 'openmesh'?\n"},
        {"objects:\n  - mesh: {vertices: [[0, 0, 0], [1, 0]]}\n",
         "4:34: error[E0312]: mesh, vertices: must be a list of three numbers [x, y, z] (got 2 "
         "entries)\n"},
        {"objects:\n  - mesh: {faces: [[0, 1, -1]]}\n",
         "4:27: error[E0306]: mesh, faces: must be >= 0 and <= 4294967295 (got -1)\n"},
        {"objects:\n  - mesh: {crease: 181deg}\n",
         "4:20: error[E0306]: mesh, crease: must be >= 0deg and <= 180deg (got 181deg)\n"},
        {"objects:\n  - mesh: {file: \"a\\0b.obj\"}\n",
         "4:18: error[E0323]: mesh, file: has a NUL character in it\n"},
    });
}

TEST(Messages, AboutPlugins) {
    expectAll({
        {"objects:\n  - spher: {radius: 1}\n",
         "4:5: error[E0317]: there is no shape 'spher'; did you mean 'sphere'?\n"},
        {"objects:\n  - torus: {x: 1}\n  - torus: {}\n",
         "4:5: error[E0520]: shape 'torus': there is no such plugin in /plugins\n"},
        {"objects:\n  - broken: {any: thing}\n",
         "4:5: error[E0520]: shape 'broken': its ABI is 2.0; this rt offers 1.0\n"},
        {"objects:\n  - clash: {}\n", "4:5: error[E0521]: the plugin of shape 'clash' has a "
                                      "parameter 'scale', a key that every object has\n"},
    });
    for (const char* name : {"../../evil", "a/b", "evil.so", "Sphere", "1a", "sphere "})
        EXPECT_EQ(refusal(kHead + "objects:\n  - \"" + name + "\": {}\n"),
                  std::string("4:5: error[E0523]: shape '") + name +
                      "': the name of a type is [a-z][a-z0-9_]*, at most 64 characters\n");
    FakeCatalog catalog;
    const Outcome outcome = outcomeOf(kHead + "objects:\n  - " + std::string(500, 'a') +
                                          ": {}\n  - sphere: {radius: 1}\n",
                                      catalog);
    EXPECT_EQ(outcome.diagnostics.exitCode(), 5);
    EXPECT_EQ(catalog.asked.size(), 1u) << "a name that cannot be one is never looked up";
    EXPECT_NE(refusal(kHead + "objects:\n  - " + std::string(100'000, 'a') + ": {}\n"), "");
}

TEST(Messages, AreAllReportedAtOnceInOrderOfPlace) {
    const std::string messages = refusal("rt: 1\n"
                                         "image: {width: x}\n"
                                         "objects:\n"
                                         "  - sphere: {radius: 1, material: m}\n"
                                         "camera: {position: [0, 0, 0], forward: [0, 1]}\n"
                                         "materials: {n: {ior: -1}}\n"
                                         "render: {depth: -1}\n");
    std::vector<std::string> places;
    for (std::size_t at = 0; at < messages.size(); at = messages.find('\n', at) + 1)
        places.push_back(messages.substr(at, messages.find(": error", at) - at));
    EXPECT_EQ(places, (std::vector<std::string>{"2:16", "4:35", "5:40", "6:22", "7:17"}));
}

TEST(Messages, StopAtTwentyAndCountTheRest) {
    std::string text = kHead + "objects:\n";
    for (int i = 0; i < 25; ++i) text += "  - sphere: {radius: 0}\n";
    const Outcome outcome = outcomeOf(text);
    EXPECT_EQ(outcome.diagnostics.all().size(), Diagnostics::kMaxErrors);
    EXPECT_EQ(outcome.diagnostics.errorCount(), 25u);
}

std::string film(const std::string& track) {
    return refusal(kHead +
                   "textures: {sky: {checker: {}}, night: {checker: {}}}\n"
                   "lights: [point: {name: key, position: [0, 0, 9]}]\n"
                   "materials: {steel: {diffuse: 1}}\n"
                   "objects:\n"
                   "  - sphere: {name: moon, radius: 4, material: steel}\n"
                   "  - mesh: {name: dragon, file: a.obj}\n"
                   "animation:\n"
                   "  frames: 97\n"
                   "  tracks:\n"
                   "    - " +
                   track + "\n");
}

TEST(Messages, AboutFilms) {
    expectAll({{"animation: {}\n", "3:1: error[E0302]: animation needs the key 'frames'\n"},
               {"animation: {frames: 0}\n",
                "3:21: error[E0306]: animation, frames: must be >= 1 and <= 1000000 (got 0)\n"},
               {"animation: {frames: 2, fps: 0}\n",
                "3:29: error[E0306]: animation, fps: must be >= 0.001 and <= 1000 (got 0)\n"},
               {"animation: {frames: 2, tracks: {}}\n",
                "3:32: error[E0303]: animation, tracks: must be a list of tracks, such as '- "
                "{target: moon, move: {position: [0, 0, 9]}, "
                "frames: [0, 24]}', not a map\n"}});
    const std::pair<const char*, const char*> kCases[] = {
        {"{}", "12:7: error[E0302]: tracks[0]: needs the key 'target' or the key 'background'\n"},
        {"{target: moon, frames: [0, 9]}",
         "12:7: error[E0302]: tracks[0]: needs a motion: rotate, rotate_self, move, move_radius, "
         "move_direct or keyframes\n"},
        {"{target: moon, move: {position: [0, 0, 0]}}",
         "12:7: error[E0302]: tracks[0]: needs the key 'frames'\n"},
        {"{target: moon, move: {position: [0, 0, 0]}, frames: [0, 1000001]}",
         "12:63: error[E0306]: tracks[0], frames: must be >= 0 and <= 1000000 (got 1000001)\n"},
        {"{target: moon, move: {position: [0, 0, 0]}, frames: [9, 9]}",
         "12:59: error[E0326]: tracks[0], frames: must rise: the first frame 9 is not before the "
         "last, 9\n"},
        {"{target: moon, move: {position: [0, 0, 0]}, frames: [9]}",
         "12:59: error[E0303]: tracks[0], frames: must be [first, last] (got 1 entry)\n"},
        {"{target: moon, move: {position: [0, 0, 0]}, frames: 9}",
         "12:59: error[E0303]: tracks[0], frames: must be [first, last], not a word or number\n"},
        {"{target: mon, move: {position: [0, 0, 0]}, frames: [0, 9]}",
         "12:16: error[E0327]: tracks[0], target: there is no object 'mon'; did you mean "
         "'moon'?\n"},
        {"{target: [moon, moon], move: {position: [0, 0, 0]}, frames: [0, 9]}",
         "12:23: error[E0327]: tracks[0], target: names 'moon' twice\n"},
        {"{target: moon.radius, move: {position: [0, 0, 0]}, frames: [0, 9]}",
         "12:16: error[E0327]: tracks[0], target: 'moon.radius' is a number, which only keyframes "
         "change; write 'keyframes: {FRAME: "
         "VALUE, ...}'\n"},
        {"{target: moon, move: {position: [0, 0, 0]}, rotate_self: {angle: 1deg}, frames: [0, 9]}",
         "12:51: error[E0321]: tracks[0], rotate_self: excludes 'move': a track has one motion; "
         "write a second track for the same target\n"},
        {"{target: camera.top, rotate_self: {angle: 1deg}, frames: [0, 9]}",
         "12:16: error[E0328]: tracks[0], target: a point of the camera cannot turn about itself; "
         "use rotate\n"},
        {"{target: moon, rotate: {center: [0, 0, 0], axis: [0, 0, 0], angle: 1deg}, frames: [0, "
         "9]}",
         "12:56: error[E0319]: tracks[0].rotate, axis: must not be [0, 0, 0]\n"},
        {"{target: moon, rotate: {center: [0, 0, 0], axis: [0, 0, 1], angle: 1}, frames: [0, 9]}",
         "12:74: error[E0308]: tracks[0].rotate, angle: is an angle and needs a unit (got 1); "
         "write 1deg or 1rad\n"},
        {"{target: [moon, dragon], faces: [0, 1], rotate_self: {angle: 1deg}, frames: [0, 9]}",
         "12:32: error[E0327]: tracks[0], faces: needs a target of one object, whose faces they "
         "are\n"},
        {"{target: dragon, faces: [3, 1], rotate_self: {angle: 1deg}, frames: [0, 9]}",
         "12:31: error[E0326]: tracks[0], faces: must rise: the first face 3 is after the last, "
         "1\n"},
        {"{background: nigt, frames: [0, 9]}",
         "12:20: error[E0316]: tracks[0], background, texture: there is no texture 'nigt'; did you "
         "mean 'night'?\n"},
        {"{background: night, move: {position: [0, 0, 0]}, frames: [0, 9]}",
         "12:27: error[E0328]: tracks[0], move: the background fades and has no motion\n"},
        {"{background: night, frames: [0, 9]}\n    - {background: sky, frames: [8, 19]}",
         "13:7: error[E0330]: this fade of the background overlaps that of line 12\n"},
        {"{target: moon.radius, keyframes: {0: 1, -1: 2}}",
         "12:47: error[E0306]: tracks[0], keyframes: a frame must be >= 0 and <= 1000000 (got "
         "-1)\n"},
        {"{target: moon.radius, keyframes: {0: 1, 9: -2}}",
         "12:50: error[E0306]: tracks[0], keyframes: must be > 0 (got -2)\n"},
        {"{target: moon.radius, keyframes: {0: 1, 9: [1, 2, 3]}}",
         "12:50: error[E0303]: tracks[0], keyframes: must be a number, not a list\n"},
        {"{target: moon.radius, keyframes: {}}",
         "12:40: error[E0303]: tracks[0], keyframes: must be a map of frames and values, such as "
         "{0: 1, 48: 2.5}\n"},
        {"{target: moon.radius, keyframes: {0: 1}, frames: [0, 9]}",
         "12:48: error[E0321]: tracks[0], frames: does not belong to this track: the keyframes say "
         "when\n"},
        {"{target: moon.radius, keyframes: {0: 1}, easing: smooth}",
         "12:48: error[E0321]: tracks[0], easing: does not belong to this track: keyframes have "
         "'interpolation'\n"},
        {"{target: moon.radus, keyframes: {0: 1}}",
         "12:16: error[E0327]: tracks[0], target: sphere has no key 'radus'; did you mean "
         "'radius'?\n"},
        {"{target: lights.kye.color, keyframes: {0: 1}}",
         "12:16: error[E0327]: tracks[0], target: there is no light 'kye'; did you mean 'key'?\n"},
        {"{target: dragon.kind, keyframes: {0: 1}}",
         "12:16: error[E0327]: tracks[0], target: 'dragon.kind' is no number: it is surface, "
         "solid\n"},
        {"{target: camera.front, keyframes: {0: [0, 0, 0]}}",
         "12:16: error[E0327]: tracks[0], target: 'camera.front' has no keyframes; use "
         "camera.look_at or camera.forward\n"},
        {"{target: camera.screen.width, keyframes: {0: 1}}",
         "12:16: error[E0327]: tracks[0], target: the scene states field_of_view, not screen; use "
         "camera.field_of_view\n"},
        {"{target: camera.up, keyframes: {0: [0, 0, 0]}}",
         "12:42: error[E0319]: tracks[0], keyframes: a direction must not be [0, 0, 0]\n"},
        {"{target: moon.scale, keyframes: {0: 1, 9: -1}}",
         "12:28: error[E0318]: tracks[0], keyframes: moon.scale changes its sign and would be 0 on "
         "the way; use interpolation: step\n"},
        {"{target: textures.sky.rows, keyframes: {0: 1, 9: 4}}",
         "12:35: error[E0329]: tracks[0], interpolation: 'textures.sky.rows' is a whole number and "
         "has no values in between; write "
         "'interpolation: step'\n"},
        {"{target: moon.radius, keyframes: {0: 1}}\n    - {target: objects.moon.radius, keyframes: "
         "{0: 1}}",
         "13:7: error[E0330]: 'objects.moon.radius' has keyframes in line 12 already\n"},
    };
    for (const auto& [track, messages] : kCases) EXPECT_EQ(film(track), messages) << track;
}

const std::string kShortFilm =
    kHead + "objects: [sphere: {name: moon, radius: 4}]\nanimation:\n  frames: 10\n  tracks:\n";

// Legacy movies cut motions short: "movie 9 24" with "0 move 0 0 0 0 96".
TEST(Films, MotionsMayEndBeyondTheLastFrame) {
    const Description description = described(
        kShortFilm + "    - {target: moon, move: {position: [0, 0, 0]}, frames: [0, 97]}\n"
                     "    - {target: moon.radius, keyframes: {0: 1, 97: 2}}\n");
    EXPECT_EQ(description.animation->tracks[0].frames.last, 97u);
    EXPECT_EQ(description.animation->tracks[1].frames.last, 97u);
}

TEST(Films, WarnOfAMotionThatIsNeverSeen) {
    const Outcome outcome = outcomeOf(
        kShortFilm + "    - {target: moon, move: {position: [0, 0, 0]}, frames: [9, 97]}\n");
    EXPECT_TRUE(outcome.description);
    EXPECT_EQ(outcome.messages, "/scenes/s.yaml:7:59: warning: tracks[0]: begins with the last "
                                "frame, 9, or later and is never seen\n");
}

// The original's `background -1` has the mapping for the texture that a fade brings.
TEST(Films, APlainBackgroundMayFadeToATexture) {
    const std::string scene = kHead + "textures: {sky: {checker: {}}}\n"
                                      "background: {color: 0.5, mapping: lat_long}\n";
    const Description description =
        described(scene + "animation: {frames: 9, tracks: [{background: sky, frames: [0, 4]}]}\n");
    EXPECT_EQ(description.background.mapping, Mapping::latLong);
    EXPECT_FALSE(description.background.texture);
    EXPECT_EQ(refusal(scene + "animation: {frames: 9}\n"),
              "4:35: error[E0321]: background, mapping: has no meaning without a texture\n");
}

} // namespace
} // namespace rt::scene::test
