// rt compare, convert, plugins, info, schema and new, as scripts use them.
#include <tests/cli/run.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstring>
#include <limits>
#include <regex>

namespace rt::cli_tests {

namespace {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

/// A PFM whose every channel is `value`.
std::string grey(unsigned width, unsigned height, float value) {
    std::string bytes = "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
    for (unsigned i = 0; i < width * height * 3; ++i)
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    return bytes;
}

/// The same with one pixel's red replaced; (x, y) from the top left.
std::string withRed(std::string bytes, unsigned width, unsigned height, unsigned x, unsigned y,
                    float value) {
    const std::size_t header = bytes.size() - std::size_t(width) * height * 3 * sizeof value;
    std::memcpy(bytes.data() + header +
                    (std::size_t(height - 1 - y) * width + x) * 3 * sizeof value,
                &value, sizeof value);
    return bytes;
}

} // namespace

class Compare : public Cli {
protected:
    Compare() {
        write("half.pfm", grey(16, 8, 0.5f));
        write("quarter.pfm", grey(16, 8, 0.25f));
        write("spot.pfm", withRed(grey(16, 8, 0.5f), 16, 8, 11, 3, 0.75f));
    }
};

TEST_F(Compare, EqualPicturesEndWith0) {
    const Outcome outcome = rt("compare half.pfm half.pfm");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(outcome.out, "pixels         128\nRMSE           0\nPSNR           inf dB\nSSIM      "
                           "     1\nmean absolute  0\n"
                           "max            0 at 0,0\nover 0         0 (0 %)\n");
}

TEST_F(Compare, DifferentPicturesEndWith1AndTheFigures) {
    const Outcome outcome = rt("compare half.pfm quarter.pfm --json");
    EXPECT_EQ(outcome.exitCode, 1);
    EXPECT_EQ(outcome.err, "");
    const Json json = Json::parse(outcome.out);
    EXPECT_EQ(json["rmse"], 0.25);
    EXPECT_EQ(json["mean_absolute"], 0.25);
    EXPECT_EQ(json["max"], 0.25);
    EXPECT_EQ(json["over"], 128);
    EXPECT_EQ(json["over_share"], 1);
    EXPECT_DOUBLE_EQ(json["psnr"], 20 * std::log10(1 / 0.25));
    EXPECT_EQ(json["equal"], false);
}

TEST_F(Compare, TheLargestDifferenceHasItsPixel) {
    const Json json = Json::parse(rt("compare spot.pfm half.pfm --json").out);
    EXPECT_EQ(json["max"], 0.25);
    EXPECT_EQ(json["max_pixel"], Json({11, 3}));
    EXPECT_EQ(json["over"], 1);
}

TEST_F(Compare, ToleranceCropAndMaskDecideWhatCounts) {
    EXPECT_EQ(rt("compare spot.pfm half.pfm --tolerance 0.25").exitCode, 0);
    EXPECT_EQ(rt("compare spot.pfm half.pfm --tolerance 0.2").exitCode, 1);
    EXPECT_EQ(rt("compare spot.pfm half.pfm --crop 0,0,11,8").exitCode, 0);
    EXPECT_EQ(rt("compare spot.pfm half.pfm --crop 11,3,12,4").exitCode, 1);
    write("mask.pfm", grey(16, 8, 0));
    EXPECT_EQ(rt("compare spot.pfm half.pfm --mask mask.pfm").exitCode, 0);
    write("mask.pfm", grey(16, 8, 1));
    EXPECT_EQ(rt("compare spot.pfm half.pfm --mask mask.pfm").exitCode, 1);
}

TEST_F(Compare, NanAndInfinityAreCountedAndDiffer) {
    write("nan.pfm",
          withRed(grey(16, 8, 0.5f), 16, 8, 0, 0, std::numeric_limits<float>::quiet_NaN()));
    write("inf.pfm",
          withRed(grey(16, 8, 0.5f), 16, 8, 0, 0, std::numeric_limits<float>::infinity()));
    const Json nan = Json::parse(rt("compare nan.pfm half.pfm --json").out);
    EXPECT_EQ(nan["nan"], 1);
    EXPECT_EQ(nan["rmse"], 0);
    const Outcome inf = rt("compare inf.pfm half.pfm");
    EXPECT_EQ(inf.exitCode, 1);
    EXPECT_NE(inf.out.find("infinite       1\n"), std::string::npos) << inf.out;
}

TEST_F(Compare, DifferentSizesAreRefused) {
    write("wide.pfm", grey(17, 8, 0.5f));
    const Outcome outcome = rt("compare half.pfm wide.pfm");
    EXPECT_EQ(outcome.exitCode, 4);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err,
              "rt compare: error: the sizes differ: half.pfm is 16x8, wide.pfm is 17x8\n");
    EXPECT_EQ(rt("compare half.pfm half.pfm --mask wide.pfm").err,
              "rt compare: error: the mask is 17x8, the pictures are 16x8\n");
    EXPECT_EQ(rt("compare half.pfm half.pfm --crop 0,0,17,8").err,
              "rt compare: error: --crop: must lie inside the pictures, which are 16x8; see rt "
              "compare --help\n");
}

TEST_F(Compare, TellsMissingAndBrokenPicturesFromDifferentOnes) {
    EXPECT_EQ(rt("compare half.pfm nosuch.png").exitCode, 4);
    write("broken.png", "\x89PNG\r\n\x1a\nxxxx");
    EXPECT_EQ(rt("compare half.pfm broken.png").exitCode, 4);
    write("text.png", "hello");
    EXPECT_EQ(rt("compare half.pfm text.png").exitCode, 4);
    EXPECT_EQ(rt("compare half.pfm quarter.pfm --diff no/d.png").exitCode, 6);
}

TEST_F(Compare, TheDifferencePictureIsWritten) {
    EXPECT_EQ(rt("compare spot.pfm half.pfm --diff d.pfm").exitCode, 1);
    EXPECT_EQ(read("d.pfm"), withRed(grey(16, 8, 0), 16, 8, 11, 3, 0.25f));
}

TEST_F(Compare, EncodedPicturesAreComparedInLinearLight) {
    rt("render scene.yaml -o a.png -o a.pfm");
    const Json json = Json::parse(rt("compare a.png a.pfm --json").out);
    // 8 bits of sRGB are at most half a step off; the steepest step near white is 1/255 * 2.4 / 1.055.
    EXPECT_LE(json["max"], 0.5 / 255 * 2.4 / 1.055);
    EXPECT_GT(json["psnr"], 50);
}

using Convert = Cli;

TEST_F(Convert, WritesBesideTheOldSceneAndSaysWhere) {
    write("deep/Old.inf", kOldScene);
    const Outcome outcome = rt("convert deep/Old.inf");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "deep/Old.yaml\n");
    EXPECT_NE(outcome.err.find("deep/Old.inf:1:1: note: window"), std::string::npos) << outcome.err;
    EXPECT_EQ(rt("check deep/Old.yaml").exitCode, 0);
    EXPECT_EQ(rt("render deep/Old.yaml").out, "Old.png\n");
}

TEST_F(Convert, NeverReplacesASceneUnasked) {
    write("Old.inf", kOldScene);
    write("Old.yaml", "edited");
    const Outcome outcome = rt("convert Old.inf -q");
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(outcome.err, "Old.yaml: error[E0607]: exists already and may have been edited; to "
                           "replace it: -o Old.yaml\n");
    EXPECT_EQ(read("Old.yaml"), "edited");
    EXPECT_EQ(rt("convert Old.inf -q -o Old.yaml").exitCode, 0);
    EXPECT_NE(read("Old.yaml"), "edited");
}

TEST_F(Convert, QuietKeepsTheNotesAway) {
    write("Old.inf", kOldScene);
    EXPECT_EQ(rt("convert Old.inf -q -o -").err, "");
    EXPECT_TRUE(rt("convert Old.inf -q -o -").out.starts_with("#"));
}

TEST_F(Convert, SeveralFilesAreConvertedWhateverHappensToOne) {
    write("a.inf", kOldScene);
    write("b.inf", "windoww 3\n");
    write("c.inf", kOldScene);
    const Outcome outcome = rt("convert a.inf b.inf c.inf");
    EXPECT_EQ(outcome.exitCode, 3);
    EXPECT_EQ(outcome.out, "a.yaml\nc.yaml\n");
    EXPECT_NE(outcome.err.find(
                  "b.inf:1:1: error[E0380]: unknown keyword 'windoww'; did you mean 'window'?"),
              std::string::npos)
        << outcome.err;
    EXPECT_FALSE(exists("b.yaml"));
}

TEST_F(Convert, AMovieFileAloneIsRefused) {
    write("film.inf", "movie 10 24\n0 move 50 50 50 0 10\n");
    const Outcome outcome = rt("convert film.inf");
    EXPECT_EQ(outcome.exitCode, 2);
    EXPECT_NE(outcome.err.find("E0201"), std::string::npos) << outcome.err;
}

class Plugins : public Cli {
protected:
    RunOptions withPath(const std::string& path) const {
        RunOptions options;
        options.environment = {"RT_PLUGIN_PATH=" + path};
        return options;
    }
};

TEST_F(Plugins, AreListedByKindWithVersionFileAndOneLine) {
    const Outcome outcome = rt("plugins");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_TRUE(
        std::regex_search(outcome.out, std::regex("shapes\n(  .*\n)*  sphere +\\d+\\.\\d+\\.\\d+ "
                                                  "+A sphere.*\n +/.*/sphere\\.rtplugin\\.so\n")))
        << outcome.out;
    EXPECT_NE(outcome.out.find("\ntextures\n"), std::string::npos);
    EXPECT_NE(outcome.out.find("\nloaders\n"), std::string::npos);
}

TEST_F(Plugins, OneIsShownWithParametersAndAnExample) {
    const Outcome outcome = rt("plugins sphere");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.err, "");
    for (const char* const part :
         {"sphere, a shape: ", "\nParameters:\n", "  radius: number, scene units, default 1, > 0\n",
          "\nExample:\n", "- sphere: {"})
        EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out;
}

TEST_F(Plugins, EveryExampleIsAScene) {
    for (const Json& plugin : Json::parse(rt("plugins --json").out)) {
        SCOPED_TRACE(plugin["name"]);
        ASSERT_TRUE(plugin.contains("kind")) << plugin.dump();
        EXPECT_NE(plugin["doc"], "");
        EXPECT_NE(plugin["example"], "");
        EXPECT_EQ(rt("plugins " + plugin["name"].get<std::string>()).exitCode, 0);
    }
}

TEST_F(Plugins, AnUnknownOneIsSuggested) {
    const Outcome outcome = rt("plugins shpere");
    EXPECT_EQ(outcome.exitCode, 5);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err,
              "rt plugins: error: there is no plugin 'shpere'; did you mean 'sphere'?\n");
}

TEST_F(Plugins, ABrokenOneIsListedWithItsReasonAndHarmsNoOther) {
    write("mine/wreck.rtplugin.so", "this is no ELF file");
    const Outcome list = rt("plugins --plugin-dir mine");
    EXPECT_EQ(list.exitCode, 0);
    EXPECT_NE(list.out.find("\nrefused\n  wreck"), std::string::npos) << list.out;
    EXPECT_EQ(rt("render scene.yaml --plugin-dir mine -o a.pfm").exitCode, 0);
    EXPECT_EQ(rt("plugins wreck", withPath(folder_ / "mine")).exitCode, 5);
    const Outcome check = rt("plugins --check mine/wreck.rtplugin.so");
    EXPECT_EQ(check.exitCode, 5);
    EXPECT_NE(check.err, "");
}

using Info = Cli;

TEST_F(Info, TellsWhatASceneHoldsLoadsAndWhy) {
    const Outcome outcome = rt("info scene.yaml");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.err, "");
    for (const char* const part :
         {"picture      64x48, sRGB -> scene.png\n",
          "primitives   3: 0 triangles, 3 spheres, 0 parallelograms, 0 customs\n",
          "bounds       [-1.7, -0.5, 0] to [1.7, 0.5, 1]\n",
          "plugin       sphere, because of objects.left, objects.middle, objects.right\n",
          "0 let light through: shadow rays stop at the first hit\n",
          "codec        opened while the picture is traced, because of scene.png\n"})
        EXPECT_NE(outcome.out.find(part), std::string::npos) << part << "\n" << outcome.out;
    EXPECT_EQ(files(), Names{});
}

TEST_F(Info, OfAMissingSceneIsAnInputError) {
    const Outcome outcome = rt("info nosuch.yaml");
    EXPECT_EQ(outcome.exitCode, 4);
    EXPECT_EQ(outcome.err, "nosuch.yaml: error[E0401]: there is no such file\n");
}

const std::string kDirty =
    "# two alike, one turned, one flat\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nl 1 2\n"
    "f 1 3 2\nf 1 2 4\nf 1 3 4\nf 2 3 4\nf 2 1 3\nf 1 2 2\n";

TEST_F(Info, OfAMeshSaysWhatHasToBeRepaired) {
    write("dirty.obj", kDirty);
    const Outcome outcome = rt("info dirty.obj");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out, "mesh         dirty.obj\n"
                           "faces        6: 3 kept, 1 flipped, 2 dropped\n"
                           "dropped      1 duplicate, 1 with a repeated corner\n"
                           "flipped      1 against its neighbours\n"
                           "vertices     4 vertices\n"
                           "components   1 component\n"
                           "edges        closed\n"
                           "bounds       [0,0,0] to [1,1,1]\n");
    EXPECT_NE(outcome.err.find("dirty.obj: note: dirty.obj:6: 1 lines (l) are not drawn\n"),
              std::string::npos)
        << outcome.err;
    const Json json = Json::parse(rt("info dirty.obj --json").out);
    EXPECT_EQ(json["summary"]["dropped"], 2);
    EXPECT_EQ(json["closed"], true);
    EXPECT_FALSE(json.contains("faces"));
    EXPECT_EQ(files(), Names{"dirty.obj"});
}

using MeshRepair = Cli;

TEST_F(MeshRepair, WritesTheMeshAndWhatBecameOfEachFace) {
    write("dirty.obj", kDirty);
    const Outcome outcome = rt("mesh repair dirty.obj -o clean.obj --report r.json");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out, "clean.obj\nr.json\n");
    EXPECT_NE(outcome.err.find("faces        6: 3 kept, 1 flipped, 2 dropped\n"), std::string::npos)
        << outcome.err;
    std::vector<std::string> actions;
    const Json report = Json::parse(read("r.json"));
    for (const Json& face : report["faces"]) actions.push_back(face["action"]);
    EXPECT_EQ(actions, (Names{"kept", "kept", "flipped", "kept", "dropped", "dropped"}));
    EXPECT_EQ(rt("info clean.obj").out.substr(0, 52),
              "mesh         clean.obj\nfaces        4: 4 kept\nvertic");
    EXPECT_EQ(rt("mesh repair dirty.obj -o -").out, read("clean.obj"));
    EXPECT_EQ(rt("-q mesh repair clean.obj -o again.obj").err, "");
    EXPECT_EQ(read("again.obj"), read("clean.obj"));
}

TEST_F(MeshRepair, RefusesAndWritesNothing) {
    write("bad.obj", "v 0 0 0\nf 1 2 3\n");
    write("wrong.stl", "solid\n");
    Outcome outcome = rt("mesh repair bad.obj -o out.obj --report r.json");
    EXPECT_EQ(outcome.exitCode, 4);
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find("error[E0420]: loader 'openmesh': bad.obj:2:5: "), std::string::npos)
        << outcome.err;
    outcome = rt("mesh repair bda.obj -o out.obj");
    EXPECT_EQ(outcome.exitCode, 4);
    EXPECT_EQ(outcome.err, "bda.obj: error[E0401]: 'bda.obj': there is no such file; "
                           "did you mean 'bad.obj'?\n");
    outcome = rt("mesh repair bad.obj -o nowhere/out.obj");
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(rt("mesh repair wrong.stl -o out.obj").exitCode, 3);
    EXPECT_EQ(files(), (Names{"bad.obj", "wrong.stl"}));
}

TEST_F(MeshRepair, SaysThatTheMaterialsStayBehind) {
    write("in/a.mtl", "newmtl red\nKd 1 0 0\n");
    write("in/a.obj", "mtllib a.mtl\nusemtl red\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    EXPECT_NE(rt("mesh repair in/a.obj -o b.obj")
                  .err.find("b.obj: warning: its material library, 'a.mtl', lies beside "
                            "'in/a.obj': copy it to where the mesh goes\n"),
              std::string::npos);
    EXPECT_EQ(rt("mesh repair in/a.obj -o in/b.obj").err.find("warning"), std::string::npos);
}

using Solids = Cli;

TEST_F(Solids, ThatAreNotClosedAreWarnedOfWhereTheSceneNamesThem) {
    write("open.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\n");
    write("solid.yaml", kThreeSpheres + "  - mesh: {file: open.obj, kind: solid}\n"
                                        "  - mesh: {kind: solid, vertices: [[0, 0, 0], [1, 0, 0], "
                                        "[1, 1, 0], [0, 1, 0]], faces: [[0, 1, 2, 3]]}\n"
                                        "  - mesh: {file: open.obj}\n");
    for (const char* const command : {"check solid.yaml", "render solid.yaml -o a.pfm"}) {
        const Outcome outcome = rt(command);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_NE(outcome.err.find(": warning: loader 'openmesh': open.obj: the solid is not "
                                   "closed: it has 3 boundary edges\n"),
                  std::string::npos)
            << outcome.err;
        EXPECT_NE(
            outcome.err.find(
                ": warning: shape 'mesh': the solid is not closed: it has 4 boundary edges\n"),
            std::string::npos)
            << outcome.err;
        EXPECT_EQ(outcome.err.rfind("open.obj: the solid"), outcome.err.find("open.obj: the solid"))
            << "the surface is no solid";
        EXPECT_TRUE(outcome.err.starts_with("solid.yaml:")) << outcome.err;
    }
}

using Schema = Cli;

TEST_F(Schema, IsJsonWithEveryShapeAndTexture) {
    const Json schema = Json::parse(rt("schema").out);
    EXPECT_EQ(schema["$schema"], "http://json-schema.org/draft-07/schema#");
    const std::string text = schema.dump();
    for (const Json& plugin : Json::parse(rt("plugins --json").out))
        if (plugin["kind"] != "loader") {
            EXPECT_NE(text.find("\"" + plugin["name"].get<std::string>() + "\""), std::string::npos)
                << plugin["name"];
        }
}

using New = Cli;

TEST_F(New, WritesASceneThatRendersAndNeverOverOne) {
    EXPECT_EQ(rt("new scene first --folder mine").out, "mine/first.yaml\n");
    EXPECT_EQ(rt("check mine/first.yaml").out, "mine/first.yaml: no errors\n");
    EXPECT_EQ(rt("render mine/first.yaml --size 32x24 -o first.png").exitCode, 0);
    const Outcome again = rt("new scene first.yaml --folder mine");
    EXPECT_EQ(again.exitCode, 6);
    EXPECT_EQ(again.err, "rt new: error: 'mine/first.yaml' exists already\n");
    EXPECT_EQ(rt("new scene ../evil").err,
              "rt new: error: the name of a scene has no '/': --folder tells where it goes\n");
}

TEST_F(New, WritesAProjectOnceAndNeverOverOne) {
    const Outcome outcome = rt("new shape ring");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("ring/ring.cpp\n"), std::string::npos) << outcome.out;
    for (const std::string& file : linesOf(outcome.out)) EXPECT_TRUE(exists(file)) << file;
    const std::string source = read("ring/ring.cpp");
    const Outcome again = rt("new shape ring");
    EXPECT_EQ(again.exitCode, 6);
    EXPECT_EQ(again.out, "");
    EXPECT_EQ(read("ring/ring.cpp"), source);
    EXPECT_EQ(rt("new shap ring").err,
              "rt new: error: must be scene, shape, texture or loader (got 'shap'); did you mean "
              "'shape'?\n");
    EXPECT_NE(rt("new shape ../evil").exitCode, 0);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "../evil"));
}

} // namespace rt::cli_tests
