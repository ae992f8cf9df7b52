// Every error of the .inf converter, word for word.
#include <tests/converters/converting.hpp>

#include <algorithm>

namespace rt::converters {
namespace {

using testing::ElementsAre;

TEST(InfErrors, MisspeltKeywordsAreSuggested) {
    EXPECT_THAT(
        convertText(kHead +
                    "shpere 1 2 3 4\nSphere 1 2 3\nrecursivedepth 3\nbakground 0\nnonsense 1 2\n")
            .errors(),
        ElementsAre("4:1 E0380 unknown keyword 'shpere'; did you mean 'sphere'?",
                    "5:1 E0380 unknown keyword 'Sphere'; did you mean 'sphere'?",
                    "6:1 E0380 unknown keyword 'recursivedepth'; did you mean 'recursivdepth'?",
                    "7:1 E0380 unknown keyword 'bakground'; did you mean 'background'?",
                    "8:1 E0380 unknown keyword 'nonsense'"));
}

TEST(InfErrors, AllOfAFileAtOnceAndNoneThatFollowsFromAnother) {
    // The window is misspelt, a texture has no name: neither "no window" nor "no texture 0" is said.
    EXPECT_THAT(convertText("windw 64 48\nscene 0 0 0 100 100 100\ncamera 8 6 6 50 10 50 0 1 0 0 0 "
                            "1\ntexture\nback 0\n"
                            "sphere 1 2 x 4\n")
                    .errors(),
                ElementsAre("1:1 E0380 unknown keyword 'windw'; did you mean 'window'?",
                            "4:1 E0386 'texture': the file name is missing",
                            "6:12 E0381 'sphere', 'center z': 'x' is not a number"));
}

TEST(InfErrors, NumbersTooMany) {
    EXPECT_THAT(convertText(kHead + "depth 3 4\n").errors(),
                ElementsAre("4:9 E0380 'depth' has all its numbers before '4'"));
    EXPECT_THAT(convertText("640 480\n").errors(),
                ElementsAre("1:1 E0380 a statement starts with a keyword, not with '640'"));
}

TEST(InfErrors, NotANumber) {
    EXPECT_THAT(convertText(kHead + "depth three\n").errors(),
                ElementsAre("4:7 E0381 'depth', 'value': 'three' is not a number"));
    EXPECT_THAT(convertText("window 64px 48\n" + kHead.substr(13)).errors(),
                ElementsAre("1:8 E0382 'window', 'width': '64px' is not a whole number"));
    EXPECT_THAT(convertText("window 64.5 48\n" + kHead.substr(13)).errors(),
                ElementsAre("1:8 E0382 'window', 'width': '64.5' is not a whole number"));
    EXPECT_THAT(convertText(kHead + "rs 1,2,3 1 1 1\n").errors(),
                ElementsAre("4:4 E0381 'rs', 'position x': '1,2,3' is not a number"));
    EXPECT_THAT(convertText(kHead + "rs nan 1 1 1 1 1\n").errors(),
                ElementsAre("4:4 E0381 'rs', 'position x': 'nan' is not a number"));
}

TEST(InfErrors, OutOfRange) {
    EXPECT_THAT(convertText(kHead + "rs 1e999 1 1 1 1 1\n").errors(),
                ElementsAre("4:4 E0384 'rs', 'position x': '1e999' is out of range"));
    EXPECT_THAT(convertText("window 99999999999 48\n" + kHead.substr(13)).errors(),
                ElementsAre("1:8 E0384 'window', 'width': '99999999999' is out of range"));
    EXPECT_THAT(
        convertText(
            "window 0 48\nscene 0 0 0 100 -1 100\ncamera 0 6 -6 50 10 50 0 1 0 0 0 1\ndepth -1\n"
            "sphere 1 2 3 0" +
            kMatte + "\nrs 1 1 1 -1 0 0 \n")
            .errors(),
        ElementsAre("1:8 E0384 'window': width must be 1 or more, not 0",
                    "2:17 E0384 'scene': back must be more than 0, not -1",
                    "3:8 E0384 'camera': screen width must be more than 0, not 0",
                    "3:12 E0384 'camera': focus must be more than 0, not -6",
                    "4:7 E0384 'depth': the number of bounces must be from 0 to 1000, not -1",
                    "5:14 E0384 'sphere': radius must be more than 0, not 0",
                    "6:10 E0384 'rs': colour and brightness must be from 0 to 1e+06, not -1"));
    EXPECT_THAT(
        convertText(kHead + "sphere 1 2 3 4 1 1 1 0 -0.5 0 0 0 0 0 0 0 0 0 0 -1 -3\n").errors(),
        ElementsAre("4:24 E0384 'sphere': 'diffuse g' must be from 0 to 1e+06, not -0.5",
                    "4:52 E0384 'sphere': 's' must be from 0 to 1e+06, not -3"));
}

TEST(InfErrors, StatementsCutShort) {
    EXPECT_THAT(convertText(kHead + "sphere 1 2 3 # the radius is missing\n").errors(),
                ElementsAre("4:14 E0383 this comment ends 'sphere' early: 'radius' is missing"));
    EXPECT_THAT(convertText(kHead + "rs 1 2 3 1\ndepth 3\n").errors(),
                ElementsAre("4:1 E0383 'rs' is not complete: 'color g' and 'color b' are missing"));
    EXPECT_THAT(
        convertText(kHead + "sphere 1 2 3 4 1 1 1").errors(),
        ElementsAre(
            "4:1 E0383 'sphere' ends with the file: 'diffuse r' and 13 more numbers are missing"));
    EXPECT_THAT(convertText(kHead + "save\ndepth 3\n").errors(),
                ElementsAre("4:1 E0386 'save': the file name is missing"));
    EXPECT_THAT(convertText(kHead + "obj a.obj box # mode?\n").errors(),
                ElementsAre("4:1 E0386 'obj': the mode is missing"));
}

TEST(InfErrors, MissingStatements) {
    EXPECT_THAT(convertText("# nothing\n").errors(),
                ElementsAre("- E0390 the file has no 'window WIDTH HEIGHT' statement",
                            "- E0390 the file has no 'scene' statement",
                            "- E0390 the file has no 'camera' statement"));
}

TEST(InfErrors, ModesOfMeshes) {
    EXPECT_THAT(
        convertText(kHead + "obj a.obj box nromal 1 1 1 1" + kMatte + "\n").errors(),
        ElementsAre(
            "4:15 E0385 'nromal' is no mode of 'obj': it is one of 'normal', 'obj' and 'object'; "
            "did you mean 'normal'?"));
}

TEST(InfErrors, TexturesThatAreNotThere) {
    EXPECT_THAT(convertText(kHead + "back 0\n").errors(),
                ElementsAre("4:6 E0391 there is no texture 0: the scene has none"));
    EXPECT_THAT(convertText(kHead + "texture a.bmp\nback 1\n").errors(),
                ElementsAre("5:6 E0391 there is no texture 1: the scene has one, number 0"));
    EXPECT_THAT(convertText(kHead + "texture a.bmp\ntexture b.bmp\nback -2\n").errors(),
                ElementsAre("6:6 E0391 there is no texture -2: the scene has 2, numbers 0 to 1"));
}

TEST(InfErrors, ClearObjectsNeedAnIndex) {
    EXPECT_THAT(
        convertText(kHead + "sphere 1 2 3 4 1 1 1 0 0 0 0 0 0 0.5 0 0 0 0 0 -1 20\n").errors(),
        ElementsAre("4:48 E0393 light passes through this object, so its refractivity must be more "
                    "than 0, not -1"));
}

TEST(InfErrors, ACameraThatLooksAlongItsUp) {
    EXPECT_THAT(
        convertText("window 64 48\nscene 0 0 0 100 100 100\ncamera 8 6 6 50 10 50 0 0 2 0 0 1\n")
            .errors(),
        ElementsAre("3:23 E0394 'camera': forward and upward must be two different directions"));
    EXPECT_THAT(
        convertText("window 64 48\nscene 0 0 0 100 100 100\ncamera 8 6 6 50 10 50 0 0 0 0 0 1\n")
            .errors(),
        ElementsAre("3:23 E0394 'camera': forward and upward must be two different directions"));
}

TEST(InfErrors, FilesThatCannotBeRead) {
    const ScratchFolder folder;
    scene::Diagnostics diagnostics;
    EXPECT_FALSE(convertInf(folder.path("none.inf"), {}, diagnostics));
    EXPECT_EQ(diagnostics.exitCode(), 4);
    EXPECT_EQ(convertText(std::string("window\0 64", 10)).errors(),
              std::vector<std::string>{"- E0410 this is no text file: it holds a zero byte"});
}

TEST(InfErrors, AMissingMovieFile) {
    const ScratchFolder folder;
    const Converted converted =
        convertText(kHead + "movie film.inf\n", {}, folder.path("scene.inf"));
    EXPECT_EQ(converted.diagnostics.exitCode(), 4);
    ASSERT_EQ(converted.diagnostics.errorCount(), 1u);
    EXPECT_THAT(converted.errors()[0],
                testing::StartsWith("4:7 E0401 '" + folder.path("film.inf").substr(0, 20)));
}

TEST(InfErrors, AMovieFileAloneSaysHow) {
    const Converted converted =
        convertText("#Movie\nmovie 96 24\n1 rotate 50 65 30 0 0 1 6.28 0 96\n", {}, "Movie.inf");
    EXPECT_THAT(
        converted.errors(),
        ElementsAre(
            "- E0201 this is a movie file: it is converted with the scene that names it, or "
            "with --movie; rt convert Scene.inf --movie Movie.inf"));
    EXPECT_EQ(converted.diagnostics.exitCode(), 2);
}

// ---- movie files -----------------------------------------------------------------------------------------------

Converted convertWithMovie(const std::string& movie,
                           const std::string& scene = kHead + kSphere + kSphere) {
    static const ScratchFolder folder;
    InfOptions options;
    options.moviePath = folder.write("Movie.inf", movie);
    return convertText(scene, options);
}

TEST(InfErrors, MovieLines) {
    EXPECT_THAT(
        convertWithMovie(
            "movie 24 24\n0 rotat 1 2 3 0 0 1 1 0 4\n1 spin 3\ncamera w move 1 2 3 0 4\n"
            "camera v rotateSelf 1 0 4\nfoo 1 2\nbacc 0 1 2\n3-1 move 1 2 3 0 4\n0 move 1 2 3 0\n")
            .errors(),
        ElementsAre(
            "2:3 E0388 unknown motion 'rotat'; did you mean 'rotate'?",
            "3:3 E0388 unknown motion 'spin'; it is one of rotate, rotateSelf, move, moveRadius "
            "and moveDirect",
            "4:8 E0387 'w' is no camera point: v is the eye, f the front point, u the top point",
            "5:10 E0388 a camera point has no rotateSelf: it is a point",
            "6:1 E0380 'foo' starts no line of a movie file: movie, back, camera, an object number "
            "or a range "
            "such as 3-6",
            "7:1 E0380 'bacc' starts no line of a movie file: movie, back, camera, an object "
            "number or a range "
            "such as 3-6; did you mean 'back'?",
            "8:1 E0389 the range '3-1' runs backwards and moves nothing",
            "9:1 E0383 '0 move' ends with the file: 'last frame' is missing"));
}

TEST(InfErrors, MovieNumbersThatMeanNothing) {
    EXPECT_THAT(
        convertWithMovie("movie -1 0\n1-2 move 1 2 3 0 4\nback 0 0 4\n0 rotate 1 2 3 0 0 0 1 0 "
                         "4\n0 moveDirect 0 0 0 1 0 4\n"
                         "0 move 1 2 3 -1 4\n")
            .errors(),
        ElementsAre("1:7 E0384 'movie': the number of frames must be from 0 to 999999, not -1",
                    "1:10 E0384 'movie': the number of frames per second must be more than 0 and "
                    "at most 1000, not 0",
                    "2:1 E0389 there is no object 2: the scene has 2, numbers 0 to 1, each face of "
                    "a mesh counting as one",
                    "3:6 E0391 there is no texture 0: the scene has none",
                    "4:16 E0384 the axis must not be 0 0 0",
                    "5:14 E0384 the direction must not be 0 0 0",
                    "6:14 E0384 the first frame must be 0 or more, not -1"));
}

TEST(InfErrors, AMovieWithoutItsHeader) {
    EXPECT_THAT(convertWithMovie("0 move 1 2 3 0 4\n").errors(),
                ElementsAre("- E0390 the movie file has no 'movie FRAMES FPS' line"));
}

TEST(InfErrors, FadesOneAtATime) {
    EXPECT_THAT(
        convertWithMovie("movie 24 24\nback 0 0 8\nback 1 7 9\nback 0 8 10\n",
                         kHead + "texture a.bmp\ntexture b.bmp\nback 0\n")
            .errors(),
        ElementsAre("3:1 E0395 this fade overlaps that of line 2, and there is one at a time"));
}

TEST(InfErrors, NumbersBehindAMeshThatCannotBeRead) {
    const std::string scene =
        kHead + kSphere + "obj gone.obj dragon normal 0 0 0 1" + kMatte + "\n" + kSphere;
    EXPECT_THAT(convertWithMovie(
                    "movie 24 24\n0 move 1 2 3 0 4\n0-1 move 1 2 3 4 8\n5 move 1 2 3 4 8\n", scene)
                    .errors(),
                ElementsAre("3:1 E0392 what number 1 means depends on the faces of the mesh "
                            "'dragon', whose file cannot be read",
                            "4:1 E0392 what number 5 means depends on the faces of the mesh "
                            "'dragon', whose file cannot be read"));
    EXPECT_THAT(convertWithMovie("movie 24 24\n0 move 1 2 3 0 4\n", scene).errors(),
                testing::IsEmpty());
}

TEST(InfErrors, TheCaretStandsUnderTheWord) {
    const Converted converted = convertText(kHead + "\tback\tnine\n");
    ASSERT_EQ(converted.diagnostics.errorCount(), 1u);
    const auto& all = converted.diagnostics.all();
    const auto error = std::ranges::find(all, scene::Severity::error, &scene::Diagnostic::severity);
    EXPECT_EQ(scene::format(*error, false),
              "scene.inf:4:7: error[E0381]: 'back', 'value': 'nine' is not a number\n"
              "    4 |     back    nine\n"
              "      |             ^\n");
}

} // namespace
} // namespace rt::converters
