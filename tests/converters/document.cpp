// What a converted scene says: values, decisions, comments, names, paths, tracks.
#include <converters/node_building.hpp>
#include <converters/obj_faces.hpp>
#include <tests/converters/converting.hpp>

namespace rt::converters {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// ---- decisions -------------------------------------------------------------------------------------------------

Converted withWindow(const std::string& window, const std::string& screen,
                     WindowOrder order = WindowOrder::automatic) {
    InfOptions options;
    options.windowOrder = order;
    return convertText("window " + window + "\nscene 0 0 0 100 100 100\ncamera " + screen +
                           " 6 50 10 50 0 1 0 0 0 1\n",
                       options);
}

TEST(InfDocument, WindowOrderFollowsTheScreen) {
    Converted converted = withWindow("854 480", "17.79 10.0");
    EXPECT_EQ(converted.at("image.width").text, "854");
    EXPECT_THAT(
        converted.notes(),
        Contains(
            "1:1 window: width 854, height 480: the order whose ratio fits the camera's screen"));
    converted = withWindow("480 854", "17.79 10.0");
    EXPECT_EQ(converted.at("image.width").text, "854");
    EXPECT_THAT(
        converted.notes(),
        Contains(
            "1:1 window: width 854, height 480: the order whose ratio fits the camera's screen"));
    converted = withWindow("100 100", "5 5");
    EXPECT_THAT(converted.notes(), Contains("1:1 window: width 100, height 100: both orders fit "
                                            "the camera's screen, and this is how "
                                            "the original read them"));
    converted = withWindow("480 640", "1 1");
    EXPECT_EQ(converted.at("image.width").text, "480");
    EXPECT_THAT(
        converted.notes(),
        Contains(
            "1:1 window: width 480, height 640: no order fits the camera's screen, and this is how "
            "the original read them"));
    EXPECT_EQ(withWindow("480 854", "17.79 10.0", WindowOrder::widthHeight).at("image.width").text,
              "480");
    EXPECT_EQ(withWindow("854 480", "17.79 10.0", WindowOrder::heightWidth).at("image.width").text,
              "480");
}

TEST(InfDocument, ThePictureIsEncodedAsTheOriginalDid) {
    const Converted converted = convertText(kHead);
    EXPECT_EQ(converted.at("image.encoding").text, "linear");
    EXPECT_EQ(converted.at("image.tone").text, "limit");
    EXPECT_EQ(converted.at("render.sampling").text, "corner");
    EXPECT_EQ(converted.at("render.near_plane").text, "screen");
}

TEST(InfDocument, DefaultsAreWrittenOut) {
    const Converted converted = convertText(kHead);
    EXPECT_EQ(flowText(converted.at("background")), "{color: [0, 0, 1]}");
    EXPECT_EQ(converted.at("render.depth").text, "2");
}

TEST(InfDocument, TheScreenIsTheEffectiveOne) {
    // forward . up of the unit vectors is 0.6, so the sine is 0.8.
    const Converted converted =
        convertText("window 64 48\nscene 0 0 0 9 9 9\ncamera 8 6 5 1 1 1 0 4 3 0 0 1\n");
    EXPECT_EQ(flowText(converted.at("camera.screen")),
              "{width: 6.4, height: 4.800000000000001, distance: 5}");
    EXPECT_EQ(converted.at("camera.screen").comments->after, "stated as 8 x 6");
    EXPECT_THAT(converted.notes(), Contains("3:8 upward is not perpendicular to forward, so the "
                                            "original's screen was not 8 x 6 but 0.8 "
                                            "times that, which is written"));
    EXPECT_EQ(flowText(convertText(kHead).at("camera.screen")),
              "{width: 8, height: 6, distance: 6}");
}

TEST(InfDocument, TheBackgroundKeepsItsOddSphere) {
    const Converted converted = convertText("window 64 48\nscene 10 20 30 40 60 42\ncamera 8 6 6 "
                                            "50 10 50 0 1 0 0 0 1\ntexture sky.bmp\nback 0\n");
    // sqrt(15^2 + 20^2 + 12^2)
    EXPECT_EQ(flowText(converted.at("background")),
              "{texture: sky, mapping: legacy_hemisphere, center: [50, 50, 0], radius: "
              "27.730849247724095}");
    EXPECT_EQ(flowText(converted.at("textures.sky")),
              "{image: {file: sky.bmp, encoding: linear, filter: nearest, wrap: horizontal}}");
}

TEST(InfDocument, BrightnessStaysANumberOfItsOwn) {
    const Converted converted =
        convertText(kHead + "rs 1 2 3 0.3 0.3 0.6 0.7\nraysource 4 5 6 1 1 1\n");
    EXPECT_EQ(flowText(converted.at("lights.0")),
              "{point: {position: [1, 2, 3], color: [0.3, 0.3, 0.6], brightness: 0.7}}");
    EXPECT_EQ(flowText(converted.at("lights.1")),
              "{point: {position: [4, 5, 6], color: [1, 1, 1]}}");
}

TEST(InfDocument, SwitchesAreOnForOneAlone) {
    const Converted converted = convertText(kHead + "smooth 2\nantiAliase 1\n");
    EXPECT_EQ(converted.at("render.smooth").text, "false");
    EXPECT_EQ(converted.at("render.antialias").text, "fsaa4");
    EXPECT_THAT(converted.notes(), Contains("4:8 'smooth' is on for 1 alone, so 2 is off"));
}

// ---- materials and objects -------------------------------------------------------------------------------------

TEST(InfDocument, EqualMaterialsAreOne) {
    const Converted converted =
        convertText(kHead + kSphere + "sphere 1 2 3 4 1 1 1 0 0 0 1 1 1 0 0 0 0 0 0 -1 30\n" +
                    kSphere + "sphere 1 2 3 4 1 1 1 0 0 0 0.1 0.1 0.1 0.5 0.6 0.7 0 0 0 1.5 30\n");
    EXPECT_EQ(converted.at("materials").members.size(), 3u);
    EXPECT_EQ(flowText(converted.at("materials.matte_0")),
              "{color: [1, 0.5, 0.5], diffuse: 0.6, environment: 0.1, shininess: 20}");
    EXPECT_EQ(flowText(converted.at("materials.mirror_0")),
              "{color: [1, 1, 1], specular: 1, shininess: 30}");
    EXPECT_EQ(flowText(converted.at("materials.glass_0")),
              "{color: [1, 1, 1], specular: 0.1, transmission: [0.5, 0.6, 0.7], ior: 1.5, "
              "shininess: 30}");
    EXPECT_EQ(converted.at("objects.2.sphere.material").text, "matte_0");
    EXPECT_THAT(converted.notes(),
                Contains("4:65 refractivity -1 is dropped: nothing passes through 'matte_0'"));
}

TEST(InfDocument, AMaterialWithoutAnyShareStaysBlack) {
    EXPECT_EQ(flowText(convertText(kHead + "sphere 1 2 3 4 1 1 1 0 0 0 0 0 0 0 0 0 0 0 0 0 0\n")
                           .at("materials.black_0")),
              "{color: [1, 1, 1], diffuse: 0, shininess: 0}");
}

TEST(InfDocument, ObjectsInTheirOrder) {
    const Converted converted = convertText(kHead + "rectangle 1 2 3 4 5 6 7 8 9" + kMatte +
                                            "\ntriangle 1 2 3 4 5 6 7 8 10" + kMatte +
                                            "\nobject model\\a.obj box obj 1 2 3 0.5" + kMatte +
                                            "\nrect 1 2 3 4 5 6 7 8 9" + kMatte + "\n");
    EXPECT_EQ(flowText(converted.at("objects.0")),
              "{parallelogram: {name: parallelogram_0, origin: [1, 2, 3], edge_u: [4, 5, 6], "
              "edge_v: [7, 8, 9], material: matte_0}}");
    EXPECT_EQ(flowText(converted.at("objects.1")), "{triangle: {name: triangle_0, a: [1, 2, 3], b: "
                                                   "[4, 5, 6], c: [7, 8, 10], material: matte_0}}");
    EXPECT_EQ(flowText(converted.at("objects.2")),
              "{mesh: {name: box, file: model/a.obj, kind: solid, normals: flat, scale: 0.5, "
              "translate: [1, 2, 3], material: matte_0}}");
    EXPECT_EQ(converted.at("objects.3.parallelogram.name").text, "parallelogram_1");
}

TEST(InfDocument, SectionsInTheOrderOfTheFile) {
    std::vector<std::string> keys;
    const Converted converted = convertText("camera 8 6 6 50 10 50 0 1 0 0 0 1\n" + kSphere +
                                            "scene 0 0 0 9 9 9\nwindow 4 3\nrs 1 2 3 1 1 1\n");
    for (const auto& member : converted.at("").members) keys.push_back(member.key);
    EXPECT_THAT(keys, ElementsAre("rt", "camera", "render", "background", "materials", "objects",
                                  "bounds", "image", "lights"));
}

// ---- comments --------------------------------------------------------------------------------------------------

TEST(InfDocument, CommentsStandBesideWhatTheyCommented) {
    const Converted converted = convertText("#Window\nwindow 64 48 # small\n# the box\nscene 0 0 0 "
                                            "9 9 9\ncamera 8 6 6 1 1 1 0 1 0 0 0 1\n"
                                            "#how deep\ndepth 3\n#things\n" +
                                            kSphere + "# the end\n");
    EXPECT_THAT(converted.at("image").comments->before, ElementsAre("Window"));
    EXPECT_EQ(converted.at("image").comments->after, "small");
    EXPECT_THAT(converted.at("bounds").comments->before, ElementsAre("the box"));
    EXPECT_THAT(converted.at("render.depth").comments->before, ElementsAre("how deep"));
    EXPECT_THAT(converted.at("objects.0").comments->before, ElementsAre("things"));
    EXPECT_THAT(converted.at("").comments->atEnd, ElementsAre("the end"));
    EXPECT_THAT(
        converted.at("").comments->before,
        ElementsAre("yaml-language-server: $schema=./rt.schema.json", "$schema: ./rt.schema.json"));
}

TEST(InfDocument, CommentedOutStatementsAreCommentedYaml) {
    const Converted converted =
        convertText(kHead + "#camera 1 1 1 0 0 0 0 1 0 0 0 1\n#four balls\n#" + kSphere + kSphere +
                    "#sphere 5 6 7 8" +
                    " 0.5 0.5 0.5 0.25 0.25 0.25 0 0 0 0 0 0 0 0 0 -1 5\n#lamps\n#rs 1 2 3 1 1 "
                    "1\nrs 4 5 6 1 1 1\n"
                    "#rs 7 8 9 1 1 1 0.5\n#save out.bmp\nsave out.png\n#depth is 3\n");
    EXPECT_THAT(converted.at("materials").comments->before,
                ElementsAre("camera: {position: [0, 0, 0], forward: [0, 1, 0], up: [0, 0, 1], "
                            "screen: {width: 1, height: 1, distance: 1}}"));
    EXPECT_THAT(converted.at("objects.0").comments->before,
                ElementsAre("four balls",
                            "- sphere: {center: [50, 50, 50], radius: 4, material: matte_0}"));
    EXPECT_THAT(converted.at("objects").comments->atEnd,
                ElementsAre("- sphere: {center: [5, 6, 7], radius: 8, material: matte_1}"));
    EXPECT_THAT(converted.at("materials").comments->atEnd,
                ElementsAre("matte_1: {color: [0.5, 0.5, 0.5], diffuse: 0.25, shininess: 5}"));
    EXPECT_THAT(converted.at("lights.0").comments->before,
                ElementsAre("lamps", "- point: {position: [1, 2, 3], color: [1, 1, 1]}"));
    EXPECT_THAT(converted.at("lights").comments->atEnd,
                ElementsAre("- point: {position: [7, 8, 9], color: [1, 1, 1], brightness: 0.5}"));
    EXPECT_THAT(converted.at("image.file").comments->before, ElementsAre("file: out.bmp"));
    EXPECT_THAT(converted.at("").comments->atEnd, ElementsAre("depth is 3"));
}

TEST(InfDocument, CommentedOutLightsOfASceneWithoutLights) {
    EXPECT_THAT(convertText(kHead + kSphere + "#rs 1 2 3 1 1 1\n").at("").comments->atEnd,
                ElementsAre("lights:", "  - point: {position: [1, 2, 3], color: [1, 1, 1]}"));
}

// ---- paths -----------------------------------------------------------------------------------------------------

TEST(InfDocument, PathsAreRebasedToTheOutput) {
    const ScratchFolder folder;
    folder.write("in/texture/Sky.BMP", "");
    folder.write("in/model/box.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    std::filesystem::create_directories(folder.path("out"));
    const std::string text =
        kHead + "texture texture\\sky.bmp\nback 0\nobj model\\box.obj box normal 0 0 0 1" + kMatte +
        "\n";
    InfOptions options;
    options.outputFolder = folder.path("out");
    Converted converted = convertText(text, options, folder.path("in/scene.inf"));
    EXPECT_EQ(converted.at("textures.Sky.image.file").text, "../in/texture/Sky.BMP");
    EXPECT_EQ(converted.at("objects.0.mesh.file").text, "../in/model/box.obj");
    EXPECT_THAT(
        converted.notes(),
        Contains("4:9 'texture\\sky.bmp' is '../in/texture/Sky.BMP' on disk: here case matters"));
    converted = convertText(text, {}, folder.path("in/scene.inf"));
    EXPECT_EQ(converted.at("objects.0.mesh.file").text, "model/box.obj");
    EXPECT_THAT(converted.lines(scene::Severity::warning), IsEmpty());
}

TEST(InfDocument, AMeshThatIsNotThereIsKept) {
    const ScratchFolder folder;
    const Converted converted = convertText(
        kHead + "obj gone.obj box normal 0 0 0 1" + kMatte + "\n", {}, folder.path("scene.inf"));
    EXPECT_EQ(converted.at("objects.0.mesh.name").text, "box");
    EXPECT_THAT(
        converted.lines(scene::Severity::warning),
        ElementsAre(testing::AllOf(
            testing::StartsWith("4:5 there is no file '"),
            HasSubstr(": the object is kept; rt render --allow-missing draws without it"))));
}

TEST(InfDocument, WhereThePictureGoes) {
    EXPECT_EQ(convertText(kHead + "save out\\a.png\n").at("image.file").text, "out/a.png");
    EXPECT_EQ(convertText(kHead + "save C:\\art\\a.BMP\n").at("image.file").text, "a.BMP");
    EXPECT_EQ(convertText(kHead + "save ..\\a.png\n").at("image.file").text, "a.png");
    EXPECT_EQ(convertText(kHead + "save film.avi\n").at("image.file").text, "film.png");
    EXPECT_EQ(convertText(kHead + "save v1.2\n").at("image.file").text, "v1.2.png");
    EXPECT_EQ(convertText(kHead).at("image").find("file"), nullptr);
}

// ---- movies ----------------------------------------------------------------------------------------------------

/// Two spheres, a box of 12 faces, a rect: numbers 0, 1, 2 to 13, 14.
Converted convertFilm(const std::string& movie) {
    static const ScratchFolder folder;
    std::string cube;
    for (int i = 0; i < 8; ++i)
        cube += "v " + std::to_string(i & 1) + " " + std::to_string(i >> 1 & 1) + " " +
                std::to_string(i >> 2) + "\n";
    for (int i = 0; i < 12; ++i) cube += "f 1 2 3\n";
    folder.write("box.obj", cube);
    folder.write("Movie.inf", movie);
    return convertText(kHead + "texture a.bmp\ntexture b.bmp\nback 0\n" + kSphere + kSphere +
                           "obj box.obj box normal 0 0 0 1" + kMatte + "\nrect 1 2 3 4 5 6 7 8 9" +
                           kMatte + "\nmovie Movie.inf\nsave film.avi\n",
                       {}, folder.path("scene.inf"));
}

std::vector<std::string> tracksOf(const Converted& converted) {
    std::vector<std::string> tracks;
    for (const scene::Node& track : converted.at("animation.tracks").items)
        tracks.push_back(flowText(track));
    return tracks;
}

TEST(InfMovies, StepsBecomeImages) {
    const Converted converted = convertFilm("movie 288 24\n0 move 1 2 3 0 288\n");
    EXPECT_EQ(converted.at("animation.frames").text, "289");
    EXPECT_EQ(converted.at("animation.fps").text, "24");
    EXPECT_EQ(converted.at("image.file").text, "film.avi");
    EXPECT_THAT(converted.notes(),
                Contains("1:1 'movie 288' drew its start and 288 steps: frames is 289"));
}

TEST(InfMovies, EveryMotion) {
    EXPECT_THAT(
        tracksOf(convertFilm("movie 12 24\n0 rotate 1 2 3 0 0 2 1.5708 0 6\n14 rotateSelf -0.5 1 "
                             "2\n0 move 7 8 9 2 3\n"
                             "0 moveRadius 1 2 3 10 3 4\n0 moveDirect 0 0 5 -12 4 5\nback 1 5 "
                             "9\ncamera v rotate 1 2 3 0 0 1 3.14 0 6\n"
                             "camera front move 1 2 3 0 1\ncamera u moveRadius 1 2 3 -5 0 4\n")),
        ElementsAre(
            "{target: sphere_0, rotate: {center: [1, 2, 3], axis: [0, 0, 2], angle: -1.5708rad}, "
            "frames: [0, 6]}",
            "{target: parallelogram_0, rotate_self: {angle: 0.5rad}, frames: [1, 2]}",
            "{target: sphere_0, move: {position: [7, 8, 9]}, frames: [2, 3]}",
            "{target: sphere_0, move_radius: {center: [1, 2, 3], distance: 10}, frames: [3, 4]}",
            "{target: sphere_0, move_direct: {direction: [0, 0, 5], distance: -12}, frames: [4, "
            "5]}",
            "{background: b, frames: [5, 9]}",
            "{target: camera.position, rotate: {center: [1, 2, 3], axis: [0, 0, 1], angle: "
            "-3.14rad}, frames: [0, 6]}",
            "{target: camera.front, move: {position: [1, 2, 3]}, frames: [0, 1]}",
            "{target: camera.top, move_radius: {center: [1, 2, 3], distance: -5}, frames: [0, "
            "4]}"));
}

TEST(InfMovies, NumbersBecomeNamesAndFaces) {
    EXPECT_THAT(
        tracksOf(convertFilm("movie 12 24\n2-13 rotate 0 0 0 0 0 1 1 0 6\n2-13 rotateSelf 1 0 "
                             "6\n2-13 moveDirect 0 0 1 1 0 6\n"
                             "3-5 moveRadius 0 0 0 1 0 6\n4 rotate 0 0 0 0 0 1 1 0 6\n0-14 "
                             "moveDirect 1 0 0 1 0 6\n1-2 move 0 0 0 0 6\n")),
        ElementsAre(
            "{target: box, rotate: {center: [0, 0, 0], axis: [0, 0, 1], angle: -1rad}, frames: [0, "
            "6]}",
            "{target: box, each: true, rotate_self: {angle: -1rad}, frames: [0, 6]}",
            "{target: box, move_direct: {direction: [0, 0, 1], distance: 1}, frames: [0, 6]}",
            "{target: box, faces: [1, 3], each: true, move_radius: {center: [0, 0, 0], distance: "
            "1}, frames: [0, 6]}",
            "{target: box, faces: [2, 2], rotate: {center: [0, 0, 0], axis: [0, 0, 1], angle: "
            "-1rad}, frames: [0, 6]}",
            "{target: [sphere_0, sphere_1], move_direct: {direction: [1, 0, 0], distance: 1}, "
            "frames: [0, 6]}",
            "{target: box, move_direct: {direction: [1, 0, 0], distance: 1}, frames: [0, 6]}",
            "{target: parallelogram_0, move_direct: {direction: [1, 0, 0], distance: 1}, frames: "
            "[0, 6]}",
            "{target: sphere_1, move: {position: [0, 0, 0]}, frames: [0, 6]}",
            "{target: box, faces: [0, 0], each: true, move: {position: [0, 0, 0]}, frames: [0, "
            "6]}"));
}

TEST(InfMovies, SpheresDoNotTurnAboutThemselves) {
    const Converted converted =
        convertFilm("movie 12 24\n0-1 rotateSelf 1 0 6\n0 move 1 2 3 0 6\n");
    EXPECT_EQ(tracksOf(converted).size(), 1u);
    EXPECT_THAT(converted.notes(),
                Contains("2:1 rotateSelf does nothing to the sphere 'sphere_0'; left out"));
    EXPECT_THAT(converted.at("animation.tracks.0").comments->before,
                ElementsAre("0-1 rotateSelf 1 0 6"));
}

TEST(InfMovies, MotionsOfNoFramesAreComments) {
    const Converted converted = convertFilm("movie 12 24\n0 move 1 2 3 6 6\n");
    EXPECT_THAT(converted.at("animation").comments->atEnd, ElementsAre("0 move 1 2 3 6 6"));
    EXPECT_THAT(converted.notes(),
                Contains("2:1 nothing happens from frame 6 to 6; kept as a comment"));
}

TEST(InfMovies, CommentsStandBesideTheirTracks) {
    const Converted converted =
        convertFilm("#Movie\nmovie 12 24 # short\n\n#movements\n0 move 1 2 3 0 6 # first\n#1 move "
                    "4 5 6 0 6\n#camera u "
                    "rotate 1 2 3 0 0 1 3 0 6\n0 move 1 2 3 6 8\n#back 1 2 3\n# the end\n");
    EXPECT_THAT(converted.at("animation.frames").comments->before, ElementsAre("Movie"));
    EXPECT_EQ(converted.at("animation.frames").comments->after, "short");
    EXPECT_THAT(converted.at("animation.tracks.0").comments->before, ElementsAre("movements"));
    EXPECT_EQ(converted.at("animation.tracks.0").comments->after, "first");
    EXPECT_THAT(converted.at("animation.tracks.1").comments->before,
                ElementsAre("- {target: sphere_1, move: {position: [4, 5, 6]}, frames: [0, 6]}",
                            "- {target: camera.top, rotate: {center: [1, 2, 3], axis: [0, 0, 1], "
                            "angle: -3rad}, frames: [0, 6]}"));
    EXPECT_THAT(converted.at("animation.tracks").comments->atEnd,
                ElementsAre("- {background: b, frames: [2, 3]}", "the end"));
}

TEST(InfMovies, WhatMovesOtherwiseIsSaidOnce) {
    const Converted converted = convertFilm("movie 12 24\n0 rotate 1 2 3 0 0 1 1 0 12\n0 rotate 1 "
                                            "2 3 0 0 1 1 0 12\n0 move 1 2 3 2 4\n");
    EXPECT_THAT(converted.notes(),
                testing::IsSupersetOf({"2:1 the original's angles run clockwise about their axis, "
                                       "rt's counter-clockwise: the sign is turned",
                                       "2:1 what lies above or below the pivot keeps its distance: "
                                       "the original drew it nearer with every step",
                                       "4:1 a motion ends at its last frame: where one that began "
                                       "earlier was still running, the original "
                                       "carried on with both"}));
}

TEST(InfMovies, OnlyWhatHasAPlaneIsSaidToHaveLeftIt) {
    const auto saysPlane = [](const std::string& number) {
        for (const std::string& note :
             convertFilm("movie 12 24\n" + number + " move 1 2 3 0 6\n").notes())
            if (note.starts_with("2:1 moved triangles, rects and meshes")) return true;
        return false;
    };
    EXPECT_FALSE(saysPlane("0"));
    EXPECT_FALSE(saysPlane("0-1"));
    EXPECT_TRUE(saysPlane("1-2")); // the first face of the box
    EXPECT_TRUE(saysPlane("13"));
    EXPECT_TRUE(saysPlane("14"));
    EXPECT_FALSE(saysPlane("camera v"));
}

TEST(InfMovies, FacesAreCountedAsTheOriginalCounted) {
    const ObjFaces faces =
        countObjFaces("# cube\nv 0 0 0\n v 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nf 1/1 2/1 3/1\nf 1 2 3 "
                      "4\r\n\tf 1//2 2//2 4//2\ng f\nf 1 3 4");
    EXPECT_EQ(faces.count, 4u);
    EXPECT_EQ(faces.polygons, 1u);
    EXPECT_EQ(faces.refusedLine, 0u);
    EXPECT_EQ(countObjFaces("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf -1 -2 -3\n").refusedLine, 5u);
    EXPECT_EQ(countObjFaces("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\nf 1 2 3\n").count, 0u);
    EXPECT_EQ(countObjFaces("").count, 0u);
}

} // namespace
} // namespace rt::converters
