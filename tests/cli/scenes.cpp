// Scenes that somebody got wrong: the exit code, the place, the sentence and the suggestion, word for word.
#include <tests/cli/run.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <regex>

namespace rt::cli_tests {

namespace {

struct Malformed {
    std::string
        scene; // '@' stands for the folder in the message and for a good camera in the scene
    int exitCode;
    std::string message; // first line of stderr
};

std::vector<Malformed> malformed() {
    // clang-format off
    return {
        {"", 3, "scene.yaml: error[E0356]: the file is empty: a scene starts with 'rt: 1'"},
        {"# nothing\n", 3, "scene.yaml: error[E0356]: the file is empty: a scene starts with 'rt: 1'"},
        {"rt: 1\n---\nrt: 1\n", 3, "scene.yaml:2:1: error[E0354]: a second document starts here; a scene is one document"},
        {"[1, 2]\n", 3, "scene.yaml:1:1: error[E0303]: a scene is a map of sections that starts with 'rt: 1'; this is a list"},
        {"hello\n", 3, "scene.yaml:1:1: error[E0303]: a scene is a map of sections that starts with 'rt: 1'; this is a word or number"},
        {"rt: 1\nobjects: [\n", 3, "scene.yaml:2:10: error[E0352]: the '[' that opens here is not closed properly; line 3 has no ',' or ']' where one must stand"},
        {"rt: 1\ncamera: {position: [0, 0, 0}\n", 3, "scene.yaml:2:28: error[E0352]: expected ']' for the '[' of line 2, but found '}'"},
        {"rt: 1\nname: \"open\n", 3, "scene.yaml:2:7: error[E0352]: the quote \" that opens here is never closed"},
        {"rt: 1\n\timage: 3\n", 3, "scene.yaml:2:1: error[E0353]: a tab indents this line; YAML wants spaces"},
        {"rt: 1\nrt: 1\n", 3, "scene.yaml:2:1: error[E0351]: the key 'rt' stands twice in this map, first in line 1"},
        {"rt: 1\n@a: &a [*a]\n", 3, "scene.yaml:3:8: error[E0358]: this alias refers to the very node that it stands in"},
        {"rt: 1\n@x: *nobody\n", 3, "scene.yaml:3:4: error[E0357]: no anchor of this name stands above; write '&name' before '*name'"},
        {"rt: 1\nimage: !!python/object {}\n", 3, "scene.yaml:2:8: error[E0361]: tags such as '!!python/object' are not part of the scene language"},
        {"rt: 1\nimage: \377\n", 3, "scene.yaml:2:8: error[E0355]: the byte '\\xff' is no UTF-8; save the file as UTF-8"},
        {"rt: 1\n[1, 2]: 3\n", 3, "scene.yaml:2:1: error[E0359]: a key must be a word, not a list or a map"},
        {"rt: 1\n<<: 3\n", 3, "scene.yaml:2:1: error[E0360]: '<<' merges a map or a list of maps, such as '<<: *name'"},
        {"rt: 1\nobjects: [[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]]\n", 7, "scene.yaml:2:73: error[E0711]: lists and maps are nested deeper than 64 levels here; --limit-nesting allows more"},
        {"@objects:\n  - sphere: {radius: 1}\n", 3, "scene.yaml:1:1: error[E0302]: the scene needs the key 'rt', the version of its language; start with 'rt: 1'"},
        {"rt: 2\n@", 3, "scene.yaml:1:5: error[E0322]: the scene needs version 2 of the scene language; this program knows version 1; install a newer rt"},
        {"rt: one\n@", 3, "scene.yaml:1:5: error[E0304]: the scene, rt: must be a whole number (got one)"},
        {"rt: 0\n@", 3, "scene.yaml:1:5: error[E0322]: there is no version 0 of the scene language; write 'rt: 1'"},
        {"rt: 1\ncamra: {}\n", 3, "scene.yaml:2:1: error[E0301]: the scene has no key 'camra'; did you mean 'camera'?"},
        {"rt: 1\n@objets:\n  - sphere: {radius: 1}\n", 3, "scene.yaml:3:1: error[E0301]: the scene has no key 'objets'; did you mean 'objects'?"},
        {"rt: 1\n@objects:\n  - sphere: {radus: 1}\n", 3, "scene.yaml:4:14: error[E0301]: sphere has no key 'radus'; did you mean 'radius'?"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 1, radius: 2}\n", 3, "scene.yaml:4:25: error[E0351]: the key 'radius' stands twice in this map, first in line 4"},
        {"rt: 1\n@objects:\n  - shpere: {radius: 1}\n", 3, "scene.yaml:4:5: error[E0317]: there is no shape 'shpere'; did you mean 'sphere'?"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 1}\n    box: {}\n", 3, "scene.yaml:4:5: error[E0325]: objects[0]: must be a map of one shape, such as '- sphere: {radius: 1}', but has 2 keys"},
        {"rt: 1\n@objects:\n  - sphere\n", 3, "scene.yaml:4:5: error[E0325]: objects[0]: must be a map of one shape, such as '- sphere: {radius: 1}', not a word or number"},
        {"rt: 1\n@objects: 3\n", 3, "scene.yaml:3:10: error[E0303]: objects: must be a list of objects, such as '- sphere: {radius: 1}', not a word or number"},
        {"rt: 1\n@objects:\n  - ../../evil: {}\n", 5, "scene.yaml:4:5: error[E0523]: shape '../../evil': the name of a type is [a-z][a-z0-9_]*, at most 64 characters"},
        {"rt: 1\ncamera: {position: [0, -5, 0], look_at: [0, 0, 0], forward: [0, 1, 0]}\n", 3, "scene.yaml:2:41: error[E0321]: camera: 'forward' and 'look_at' exclude each other"},
        {"rt: 1\ncamera: {position: [0, 0, 0], look_at: [0, 0, 0]}\n", 3, "scene.yaml:2:40: error[E0319]: camera, look_at: is the camera's own position"},
        {"rt: 1\ncamera: {position: [0, -5, 0], forward: [0, 0, 1], up: [0, 0, 2]}\n", 3, "scene.yaml:2:56: error[E0319]: camera: looks along 'up', so that no side of the picture is up; name another direction with 'up'"},
        {"rt: 1\ncamera: {position: [0, -5, 0], field_of_view: 60, look_at: [0, 1, 0]}\n", 3, "scene.yaml:2:47: error[E0308]: camera, field_of_view: is an angle and needs a unit (got 60); write 60deg or 60rad"},
        {"rt: 1\ncamera: {position: [0, -5, 0], field_of_view: 60grad, look_at: [0, 1, 0]}\n", 3, "scene.yaml:2:47: error[E0304]: camera, field_of_view: must be an angle such as 45deg or 0.8rad (got 60grad)"},
        {"rt: 1\ncamera: {position: [0, -5, 0], field_of_view: 200deg, look_at: [0, 1, 0]}\n", 3, "scene.yaml:2:47: error[E0306]: camera, field_of_view: must be >= 0.001deg and <= 179deg (got 200deg)"},
        {"rt: 1\ncamera: {position: [0, -5, 0], screen: {width: 0, height: 1, distance: 1}, look_at: [0, 1, 0]}\n", 3, "scene.yaml:2:48: error[E0306]: camera.screen, width: must be > 0 (got 0)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: .nan}\n", 3, "scene.yaml:4:22: error[E0305]: sphere, radius: must be finite (got .nan)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: .inf}\n", 3, "scene.yaml:4:22: error[E0305]: sphere, radius: must be finite (got .inf)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: -1}\n", 3, "scene.yaml:4:22: error[E0306]: sphere, radius: must be > 0 (got -1)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 0}\n", 3, "scene.yaml:4:22: error[E0306]: sphere, radius: must be > 0 (got 0)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 1e400}\n", 3, "scene.yaml:4:22: error[E0305]: sphere, radius: is beyond the range of numbers, 1e308 (got 1e400)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 010}\n", 3, "scene.yaml:4:22: error[E0304]: sphere, radius: must be a number without leading zeros (got 010)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 0x10}\n", 3, "scene.yaml:4:22: error[E0304]: sphere, radius: must be a number (got 0x10)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: \"1\"}\n", 3, "scene.yaml:4:22: error[E0303]: sphere, radius: must be a number (got the text '1')"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 1,5}\n", 3, "scene.yaml:4:24: error[E0301]: sphere has no key '5'; it has name, material, scale, rotate, translate, center and radius"},
        {"rt: 1\n@objects:\n  - sphere: {radius: ~}\n", 3, "scene.yaml:4:22: error[E0303]: sphere, radius: has no value; it must be a number"},
        {"rt: 1\n@objects:\n  - sphere: {radius: []}\n", 3, "scene.yaml:4:22: error[E0303]: sphere, radius: must be a number, not a list"},
        {"rt: 1\n@objects:\n  - sphere: {radius: x}\n", 3, "scene.yaml:4:22: error[E0304]: sphere, radius: must be a number (got x)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 1_000}\n", 3, "scene.yaml:4:22: error[E0304]: sphere, radius: must be a number (got 1_000)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: true}\n", 3, "scene.yaml:4:22: error[E0304]: sphere, radius: must be a number (got true)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 1e19}\n", 3, "scene.yaml:4:22: error[E0306]: sphere, radius: must be > 0 and <= 1e18 (got 1e19)"},
        {"rt: 1\n@image: {width: 0, height: 48}\n", 3, "scene.yaml:3:16: error[E0306]: image, width: must be >= 1 and <= 4294967295 (got 0)"},
        {"rt: 1\n@image: {width: -1, height: 48}\n", 3, "scene.yaml:3:16: error[E0306]: image, width: must be >= 1 and <= 4294967295 (got -1)"},
        {"rt: 1\n@image: {width: 1.5, height: 48}\n", 3, "scene.yaml:3:16: error[E0307]: image, width: must be a whole number (got 1.5)"},
        {"rt: 1\n@image: {width: 1e9, height: 48}\n", 3, "scene.yaml:3:16: error[E0307]: image, width: must be a whole number (got 1e9)"},
        {"rt: 1\n@image: {width: 65536.0, height: 48}\n", 3, "scene.yaml:3:16: error[E0307]: image, width: must be a whole number (got 65536.0)"},
        {"rt: 1\n@image: {width: , height: 48}\n", 3, "scene.yaml:3:9: error[E0303]: image, width: has no value; it must be a whole number"},
        {"rt: 1\n@image: {width: 65536, height: 65536}\n", 7, "scene.yaml:3:16: error[E0713]: the picture has 65536 x 65536 = 4294967296 pixels; the limit is 268435456; --limit-pixels raises it"},
        {"rt: 1\n@image: {file: ../up.png}\n", 3, "scene.yaml:3:15: error[E0323]: image, file: must be below the current folder, relative and without '..' (got ../up.png); name any other place with -o"},
        {"rt: 1\n@image: {encoding: sgrb}\n", 3, "scene.yaml:3:19: error[E0310]: image, encoding: must be one of srgb, linear (got sgrb); did you mean 'srgb'?"},
        {"rt: 1\n@image: {bits: 12}\n", 3, "scene.yaml:3:15: error[E0310]: image, bits: must be one of 8, 16 (got 12)"},
        {"rt: 1\n@objects:\n  - sphere: {center: [0, 0]}\n", 3, "scene.yaml:4:22: error[E0312]: sphere, center: must be three numbers [x, y, z] (got 2 entries)"},
        {"rt: 1\n@objects:\n  - sphere: {center: [0, 0, 0, 0]}\n", 3, "scene.yaml:4:22: error[E0312]: sphere, center: must be three numbers [x, y, z] (got 4 entries)"},
        {"rt: 1\n@objects:\n  - sphere: {center: 3}\n", 3, "scene.yaml:4:22: error[E0303]: sphere, center: must be three numbers [x, y, z] (got 3)"},
        {"rt: 1\n@objects:\n  - sphere: {center: [0, .nan, 0]}\n", 3, "scene.yaml:4:26: error[E0305]: sphere, center: must be finite (got .nan)"},
        {"rt: 1\n@materials:\n  steel: {}\nobjects:\n  - sphere: {material: stele}\n", 3, "scene.yaml:6:24: error[E0315]: sphere, material: there is no material 'stele'; did you mean 'steel'?"},
        {"rt: 1\n@background: {texture: sky}\n", 3, "scene.yaml:3:23: error[E0316]: background, texture: there is no texture 'sky'; the scene has no section 'textures'"},
        {"rt: 1\n@textures:\n  a: {checkr: {}}\n", 3, "scene.yaml:4:7: error[E0317]: there is no texture 'checkr'; did you mean 'checker'?"},
        {"rt: 1\n@materials:\n  m: {ior: 0}\n", 3, "scene.yaml:4:12: error[E0306]: material 'm', ior: must be >= 0.01 and <= 100 (got 0)"},
        {"rt: 1\n@materials:\n  m: {diffuse: -1}\n", 3, "scene.yaml:4:16: error[E0306]: material 'm', diffuse: must be >= 0 and <= 1000000 (got -1)"},
        {"rt: 1\n@materials:\n  m: {color: \"#12345\"}\n", 3, "scene.yaml:4:14: error[E0309]: material 'm', color: must be \"#\" and six hexadecimal digits, rrggbb (got #12345)"},
        {"rt: 1\n@materials:\n  m: {color: red}\n", 3, "scene.yaml:4:14: error[E0309]: material 'm', color: must be a colour: one number, [r, g, b], or \"#rrggbb\" (got red)"},
        {"rt: 1\n@objects:\n  - sphere: {name: a}\n  - sphere: {name: a}\n", 3, "scene.yaml:5:20: error[E0313]: sphere, name: the name 'a' is taken in line 4"},
        {"rt: 1\n@objects:\n  - mesh: {file: nosuch.obj}\n", 4, "scene.yaml:4:18: error[E0401]: '@/nosuch.obj': there is no such file"},
        {"rt: 1\n@textures:\n  t: {image: {file: nosuch.png}}\nbackground: {texture: t}\n", 4, "scene.yaml:4:21: error[E0401]: '@/nosuch.png': there is no such file"},
        {"rt: 1\n@objects:\n  - sphere: {scale: 0}\n", 3, "scene.yaml:4:21: error[E0318]: sphere, scale: must not be 0"},
        {"rt: 1\n@objects:\n  - sphere: {rotate: {axis: [0, 0, 0], angle: 3deg}}\n", 3, "scene.yaml:4:22: error[E0319]: sphere, rotate: an axis must not be [0, 0, 0]"},
        {"rt: 1\n@lights:\n  - point: {position: [0, 0, 9], color: 1e9}\n", 3, "scene.yaml:4:41: error[E0306]: point light, color: must be >= 0 and <= 1000000 (got 1e9)"},
        {"rt: 1\n@lights:\n  - spot: {}\n", 3, "scene.yaml:4:5: error[E0317]: there is no light 'spot'; lights are of type 'point'"},
        {"rt: 1\n@render: {antialias: fsa4}\n", 3, "scene.yaml:3:21: error[E0310]: render, antialias: must be one of none, fsaa4 or {grid: ...} or {max_error: ...} (got fsa4); did you mean 'fsaa4'?"},
        {"rt: 1\n@render: {antialias: {grid: 0}}\n", 3, "scene.yaml:3:28: error[E0306]: render.antialias, grid: must be >= 1 and <= 64 (got 0)"},
        {"rt: 1\n@render: {depth: -1}\n", 3, "scene.yaml:3:17: error[E0306]: render, depth: must be >= 0 and <= 1000 (got -1)"},
        {"rt: 1\n@bounds: {min: [1, 1, 1], max: [0, 0, 0]}\n", 3, "scene.yaml:3:31: error[E0320]: bounds: max must be above min on every axis, but on x 0 is not above 1"},
        {"rt: 1\n@animation: {frames: 0}\n", 3, "scene.yaml:3:21: error[E0306]: animation, frames: must be >= 1 and <= 1000000 (got 0)"},
        {"rt: 1\n@objects:\n  - sphere: {radius: 1}\nanimation: {frames: 10, tracks: [{target: moon, rotate: {center: [0, 0, 0], axis: [0, 0, 1], angle: 90deg}, frames: [0, 5]}]}\n", 3, "scene.yaml:5:43: error[E0327]: tracks[0], target: there is no object 'moon'"},
        {"rt: 1\n@objects:\n  - sphere: {name: moon}\nanimation: {frames: 10, tracks: [{target: moo, rotate: {center: [0, 0, 0], axis: [0, 0, 1], angle: 90deg}, frames: [0, 5]}]}\n", 3, "scene.yaml:5:43: error[E0327]: tracks[0], target: there is no object 'moo'; did you mean 'moon'?"},
        {"rt: 1\n@objects:\n  - sphere: {name: m}\nanimation: {frames: 10, tracks: [{target: m, rotate: {center: [0, 0, 0], axis: [0, 0, 1], angle: 90deg}, frames: [5, 2]}]}\n", 3, "scene.yaml:5:114: error[E0326]: tracks[0], frames: must rise: the first frame 5 is not before the last, 2"},
        {"rt: 1\n@objects:\n  - sphere: {name: \"a\\u001b[31m\", radus: 1}\n", 3, "scene.yaml:4:20: error[E0314]: sphere, name: a name must not contain '\\x1b', which paths such as moon.radius use"},
        {"rt: 1\n@objects:\n  - sphere: {radus: 0}\n  - sphere: {radus: 1}\n  - sphere: {radus: 2}\n  - sphere: {radus: 3}\n  - sphere: {radus: 4}\n  - sphere: {radus: 5}\n  - sphere: {radus: 6}\n  - sphere: {radus: 7}\n  - sphere: {radus: 8}\n  - sphere: {radus: 9}\n  - sphere: {radus: 10}\n  - sphere: {radus: 11}\n  - sphere: {radus: 12}\n  - sphere: {radus: 13}\n  - sphere: {radus: 14}\n  - sphere: {radus: 15}\n  - sphere: {radus: 16}\n  - sphere: {radus: 17}\n  - sphere: {radus: 18}\n  - sphere: {radus: 19}\n  - sphere: {radus: 20}\n  - sphere: {radus: 21}\n  - sphere: {radus: 22}\n  - sphere: {radus: 23}\n  - sphere: {radus: 24}\n  - sphere: {radus: 25}\n  - sphere: {radus: 26}\n  - sphere: {radus: 27}\n  - sphere: {radus: 28}\n  - sphere: {radus: 29}\n", 3, "scene.yaml:4:14: error[E0301]: sphere has no key 'radus'; did you mean 'radius'?"},
    };
    // clang-format on
}

std::string with(const std::string& text, const std::string& at) {
    return std::regex_replace(text, std::regex("@"), at);
}

} // namespace

using MalformedScene = Cli;

TEST_F(MalformedScene, IsRefusedWithItsPlace) {
    const auto table = malformed();
    EXPECT_GE(table.size(), 60u);
    for (const Malformed& row : table) {
        SCOPED_TRACE(row.scene);
        write("bad.yaml", with(row.scene, "camera: {position: [0, -5, 0], look_at: [0, 0, 0]}\n"));
        const Outcome outcome = rt("check bad.yaml");
        EXPECT_EQ(outcome.exitCode, row.exitCode);
        EXPECT_EQ(outcome.out, "");
        ASSERT_NE(outcome.err, "");
        EXPECT_EQ(linesOf(outcome.err)[0],
                  std::regex_replace(with(row.message, folder_.string()), std::regex("scene.yaml"),
                                     "bad.yaml"));
        const Outcome rendered = rt("render bad.yaml -o picture.pfm");
        EXPECT_EQ(rendered.exitCode, row.exitCode);
        EXPECT_EQ(rendered.err, outcome.err);
        EXPECT_FALSE(exists("picture.pfm"));
    }
}

TEST_F(MalformedScene, NoMessageIsLongerThanAScreen) {
    for (const Malformed& row : malformed()) {
        write("bad.yaml", with(row.scene, "camera: {position: [0, -5, 0], look_at: [0, 0, 0]}\n"));
        std::size_t length = 0; // lines of 80 columns of one message, its excerpt included
        for (const std::string& line : linesOf(rt("check bad.yaml").err)) {
            if (line.starts_with("bad.yaml")) length = 0;
            length += 1 + line.size() / 80;
            EXPECT_LE(length, 24u) << line;
            EXPECT_TRUE(
                std::none_of(line.begin(), line.end(), [](unsigned char c) { return c < ' '; }))
                << "control characters of the file are escaped: " << line;
        }
    }
}

TEST_F(MalformedScene, IsSaidAsJsonLinesWhenAskedFor) {
    write("bad.yaml", "rt: 1\ncamra: {}\nobjects:\n  - sphere: {radus: 1}\n");
    const Outcome outcome = rt("check bad.yaml --json-errors");
    EXPECT_EQ(outcome.exitCode, 3);
    EXPECT_EQ(outcome.out, "");
    const auto lines = linesOf(outcome.err);
    ASSERT_GE(lines.size(), 2u);
    for (const std::string& line : lines) EXPECT_TRUE(nlohmann::json::accept(line)) << line;
    const auto first = nlohmann::json::parse(lines[0]);
    EXPECT_EQ(first["file"], "bad.yaml");
    EXPECT_EQ(first["line"], 2);
    EXPECT_EQ(first["column"], 1);
    EXPECT_EQ(first["severity"], "error");
    EXPECT_EQ(first["code"], "E0301");
}

TEST_F(MalformedScene, ShowsTheLineAndACaretUnderTheWord) {
    write("bad.yaml", "rt: 1\ncamera: {position: [0, -5, 0], look_at: [0, 0, 0]}\nobjects:\n"
                      "  - sphere: {radus: 1}\n");
    EXPECT_EQ(rt("check bad.yaml").err,
              "bad.yaml:4:14: error[E0301]: sphere has no key 'radus'; did you mean 'radius'?\n"
              "    4 |   - sphere: {radus: 1}\n"
              "      |              ^\n");
}

TEST_F(MalformedScene, TellsEveryErrorOfAFileUpToTwenty) {
    std::string scene = "rt: 1\ncamera: {position: [0, -5, 0], look_at: [0, 0, 0]}\nobjects:\n";
    for (int i = 0; i < 30; ++i) scene += "  - sphere: {radus: 1}\n";
    write("bad.yaml", scene);
    const auto lines = linesOf(rt("check bad.yaml").err);
    EXPECT_EQ(std::count_if(lines.begin(), lines.end(),
                            [](const std::string& line) { return line.starts_with("bad.yaml:"); }),
              20);
    EXPECT_EQ(lines.back(), "and 10 more errors");
}

using Check = Cli;

TEST_F(Check, NamesEachSceneAndEndsWithTheFirstFailure) {
    write("bad.yaml", "rt: 1\ncamra: {}\n");
    const Outcome outcome = rt("check scene.yaml bad.yaml nosuch.yaml");
    EXPECT_EQ(outcome.exitCode, 3);
    EXPECT_EQ(outcome.out, "scene.yaml: no errors\n");
    EXPECT_NE(outcome.err.find("bad.yaml:2:1: error[E0301]"), std::string::npos);
    EXPECT_NE(outcome.err.find("nosuch.yaml: error[E0401]: there is no such file\n"),
              std::string::npos)
        << outcome.err;
    EXPECT_EQ(rt("check scene.yaml").exitCode, 0);
    EXPECT_EQ(rt("check nosuch.yaml scene.yaml").exitCode, 4);
}

TEST_F(Check, FindsWhatOnlyLoadingShows) {
    write("mesh.yaml", "rt: 1\ncamera: {position: [0, -5, 0], look_at: [0, 0, 0]}\nobjects:\n"
                       "  - mesh: {file: bad.obj}\n");
    write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n");
    const Outcome outcome = rt("check mesh.yaml");
    EXPECT_EQ(outcome.exitCode, 4);
    EXPECT_NE(outcome.err.find("bad.obj:4:"), std::string::npos) << outcome.err;
}

TEST_F(Check, OverridesAreCheckedToo) {
    const Outcome outcome = rt("check scene.yaml --set objects.left.radius=-1");
    EXPECT_EQ(outcome.exitCode, 3);
    EXPECT_NE(outcome.err.find("must be > 0 (got -1)"), std::string::npos) << outcome.err;
    EXPECT_EQ(rt("check scene.yaml --set objects.lft.radius=1").exitCode, 3);
}

using Explain = Cli;

TEST_F(Explain, KnowsTheCodeOfEveryMalformedScene) {
    static const std::regex code(R"(error\[(E\d{4})\])");
    for (const Malformed& row : malformed()) {
        std::smatch match;
        ASSERT_TRUE(std::regex_search(row.message, match, code));
        const Outcome outcome = rt("explain " + match[1].str());
        EXPECT_EQ(outcome.exitCode, 0);
        EXPECT_TRUE(outcome.out.starts_with(match[1].str() + ": ")) << outcome.out;
        EXPECT_EQ(outcome.err, "");
    }
}

TEST_F(Explain, TakesACodeInAnySpelling) {
    EXPECT_EQ(rt("explain e0301").out, rt("explain E0301").out);
    EXPECT_EQ(rt("explain 301").out, rt("explain E0301").out);
    const Outcome all = rt("explain");
    EXPECT_NE(all.out.find("E0301  "), std::string::npos);
    for (const char* const wrong :
         {"E9999", "radius", "E", "-1", "E0301x", "99999999999999999999"}) {
        const Outcome outcome = rt(std::string("explain -- ") + wrong);
        EXPECT_EQ(outcome.exitCode, 2) << wrong;
        EXPECT_EQ(outcome.err, "rt explain: error: there is no code '" + std::string(wrong) +
                                   "'; rt explain lists them\n");
    }
}

} // namespace rt::cli_tests
