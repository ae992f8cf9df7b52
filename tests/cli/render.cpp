// rt render: where the picture goes, what is said, what is left behind when something fails.
#include <tests/cli/run.hpp>
#include <tests/sanitized.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstring>
#include <regex>
#include <set>
#include <thread>

#include <sys/stat.h>

namespace rt::cli_tests {

namespace {

using Names = std::vector<std::string>;

/// Traces for minutes: what a signal interrupts.
const std::string kLong = "render scene.yaml --size 1600x1200 --antialias grid=32 --depth 3";

struct Pixels {
    unsigned width = 0, height = 0;
    std::vector<float> values; // row 0 is the top

    float at(unsigned x, unsigned y, unsigned channel) const {
        return values[(std::size_t(y) * width + x) * 3 + channel];
    }
};

/// A little-endian colour PFM, whose rows stand from the bottom.
Pixels readPfm(const std::string& bytes) {
    Pixels pixels;
    const auto header = words(bytes.substr(0, 40));
    if (header.size() < 4 || header[0] != "PF" || header[3] != "-1.0") {
        ADD_FAILURE() << "not a PFM: " << bytes.substr(0, 20);
        return pixels;
    }
    pixels.width = static_cast<unsigned>(std::stoul(header[1]));
    pixels.height = static_cast<unsigned>(std::stoul(header[2]));
    const std::size_t row = std::size_t(pixels.width) * 3,
                      size = row * pixels.height * sizeof(float);
    EXPECT_EQ(bytes.size(), ("PF\n" + header[1] + " " + header[2] + "\n-1.0\n").size() + size);
    pixels.values.resize(row * pixels.height);
    for (unsigned y = 0; y < pixels.height; ++y)
        std::memcpy(&pixels.values[row * y],
                    bytes.data() + bytes.size() - size +
                        (pixels.height - 1 - y) * row * sizeof(float),
                    row * sizeof(float));
    return pixels;
}

} // namespace

using Render = Cli;

TEST_F(Render, WritesThePngBesideTheUserAndSaysWhereOnStdout) {
    const Outcome outcome = rt("render scene.yaml");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out, "scene.png\n");
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(files(), Names{"scene.png"});
    EXPECT_TRUE(read("scene.png").starts_with("\x89PNG\r\n"));
}

TEST_F(Render, WritesIntoTheCurrentFolderWhereverTheSceneLies) {
    write("deep/down/other.yaml", kThreeSpheres);
    const Outcome outcome = rt("render deep/down/other.yaml");
    EXPECT_EQ(outcome.out, "other.png\n");
    EXPECT_TRUE(exists("other.png"));
}

TEST_F(Render, WritesWhereTheSceneSays) {
    write("named.yaml", std::regex_replace(kThreeSpheres, std::regex("height: 48"),
                                           "height: 48, file: said.pfm"));
    const Outcome outcome = rt("render named.yaml");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "said.pfm\n");
    EXPECT_EQ(rt("render named.yaml -o other.pfm").out, "other.pfm\n");
}

TEST_F(Render, AFilmsFirstImageIsDrawnWhereTheSceneNamesAFilm) {
    write("film.yaml", std::regex_replace(kThreeSpheres, std::regex("height: 48"),
                                          "height: 48, file: move.AVI"));
    const Outcome outcome = rt("render film.yaml");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out, "film.png\n");
    EXPECT_EQ(outcome.err,
              "film.yaml: warning: image.file is a film, 'move.AVI'; its first image is "
              "drawn into 'film.png'\n");
    EXPECT_EQ(files(), (Names{"film.png", "film.yaml"}));
}

TEST_F(Render, WritesEveryFormatBySuffix) {
    const Outcome outcome =
        rt("render scene.yaml -o a.png -o a.jpg -o a.jpeg -o a.BMP -o a.exr -o a.pfm");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "a.png\na.jpg\na.jpeg\na.BMP\na.exr\na.pfm\n");
    EXPECT_TRUE(read("a.png").starts_with("\x89PNG"));
    EXPECT_TRUE(read("a.jpg").starts_with("\xff\xd8\xff"));
    EXPECT_EQ(read("a.jpg"), read("a.jpeg"));
    EXPECT_TRUE(read("a.BMP").starts_with("BM"));
    EXPECT_TRUE(read("a.exr").starts_with("\x76\x2f\x31\x01"));
    EXPECT_EQ(readPfm(read("a.pfm")).height, 48u);
}

TEST_F(Render, DashIsStdoutAndNothingElseIsPrintedThere) {
    rt("render scene.yaml -o a.pfm -o a.png");
    const Outcome png = rt("render scene.yaml -o -");
    EXPECT_EQ(png.exitCode, 0);
    EXPECT_EQ(png.out, read("a.png"));
    EXPECT_EQ(png.err, "");
    EXPECT_EQ(rt("render scene.yaml -o - --format pfm").out, read("a.pfm"));
}

TEST_F(Render, IsTheSameForAnyNumberOfThreads) {
    for (const char* const scene : {"", " --antialias fsaa4", " --antialias max_error=0.01",
                                    " --shade cost", " --set render.smooth=true"}) {
        rt(std::string("render scene.yaml -o 1.pfm -t 1") + scene);
        rt(std::string("render scene.yaml -o 2.pfm -t 2") + scene);
        rt(std::string("render scene.yaml -o 7.pfm -t 7") + scene);
        EXPECT_NE(read("1.pfm"), "");
        EXPECT_EQ(read("1.pfm"), read("2.pfm")) << scene;
        EXPECT_EQ(read("1.pfm"), read("7.pfm")) << scene;
    }
}

TEST_F(Render, CropIsThatPartOfThePicture) {
    rt("render scene.yaml -o whole.pfm");
    rt("render scene.yaml -o part.pfm --crop 10,8,30,20");
    const Pixels whole = readPfm(read("whole.pfm")), part = readPfm(read("part.pfm"));
    ASSERT_EQ(part.width, 20u);
    ASSERT_EQ(part.height, 12u);
    for (unsigned y = 0; y < part.height; ++y)
        for (unsigned x = 0; x < part.width; ++x)
            for (unsigned c = 0; c < 3; ++c)
                ASSERT_EQ(part.at(x, y, c), whole.at(x + 10, y + 8, c)) << x << "," << y;
}

TEST_F(Render, OverridesAreAsIfTheSceneSaidSo) {
    write("edited.yaml",
          std::regex_replace(kThreeSpheres, std::regex("0, 0.5\\], radius: 0.5, material: mirror"),
                             "0, 0.5], radius: 0.3, material: red"));
    rt("render edited.yaml -o edited.pfm");
    rt("render scene.yaml -o set.pfm --set objects.middle.radius=0.3 --set "
       "objects.middle.material=red");
    EXPECT_EQ(read("edited.pfm"), read("set.pfm"));
    rt("render scene.yaml -o size.pfm --size 20x10");
    rt("render scene.yaml -o set.pfm --set image.width=20 --set image.height=10");
    EXPECT_EQ(read("size.pfm"), read("set.pfm"));
}

TEST_F(Render, PreviewIsAQuarterWithoutAntialiasingAndWithOneBounce) {
    write("fine.yaml", kThreeSpheres + "render: {antialias: {grid: 4}, depth: 6}\n");
    rt("render fine.yaml -o preview.pfm --preview");
    rt("render scene.yaml -o small.pfm --size 16x12 --antialias none --depth 1");
    EXPECT_NE(read("preview.pfm"), "");
    EXPECT_EQ(read("preview.pfm"), read("small.pfm"));
}

TEST_F(Render, ASizeOfOtherProportionsIsWarnedOfWhenTheScreenIsFixed) {
    write("screen.yaml", std::regex_replace(kThreeSpheres, std::regex("field_of_view: 50deg"),
                                            "screen: {width: 4, height: 3, distance: 5}"));
    EXPECT_EQ(rt("render screen.yaml -o a.pfm --size 32x24").err, "");
    EXPECT_EQ(rt("render screen.yaml -o a.pfm --size 40x24").err,
              "screen.yaml: warning: --size has other proportions than camera.screen: the picture "
              "is stretched\n");
    EXPECT_EQ(rt("render scene.yaml -o a.pfm --size 40x24").err, "");
}

TEST_F(Render, QuietIsQuietAndVerboseNamesThePlugins) {
    EXPECT_EQ(rt("render scene.yaml -q -o a.pfm").err, "");
    const Outcome outcome = rt("render scene.yaml -v -o a.pfm");
    EXPECT_TRUE(
        std::regex_search(outcome.err, std::regex("^plugin sphere: /.*/sphere\\.rtplugin\\.so\n")))
        << outcome.err;
}

// ---- outputs that cannot be written -------------------------------------------------------------------------

TEST_F(Render, UnknownSuffixIsRefusedBeforeTracing) {
    const Outcome outcome = rt("render scene.yaml -o a.pgn --size 9000x9000 --antialias grid=32");
    EXPECT_EQ(outcome.exitCode, 6);
    const std::string must =
        ": error[E0601]: the suffix must be png, jpg, jpeg, bmp, exr or pfm, or mp4, avi, mkv or "
        "webm for a film";
    EXPECT_EQ(outcome.err, "a.pgn" + must + "; did you mean '.png'?\n");
    EXPECT_EQ(rt("render scene.yaml -o a").err, "a" + must + "\n");
    EXPECT_EQ(files(), Names{});
}

TEST_F(Render, MissingFolderIsRefusedBeforeTracing) {
    const Outcome outcome =
        rt("render scene.yaml -o out/a.png --size 9000x9000 --antialias grid=32");
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err,
              "out/a.png: error[E0602]: the folder 'out' does not exist; try: mkdir -p out\n");
}

TEST_F(Render, AFileIsNoFolder) {
    const Outcome outcome = rt("render scene.yaml -o scene.yaml/a.png");
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(outcome.err, "scene.yaml/a.png: error[E0602]: 'scene.yaml' is not a folder\n");
}

TEST_F(Render, AFolderIsNoPicture) {
    std::filesystem::create_directories(folder_ / "dir.png");
    const Outcome outcome = rt("render scene.yaml -o dir.png");
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(outcome.err, "dir.png: error[E0604]: is a folder; name a file in it\n");
}

TEST_F(Render, ADeviceIsNotReplaced) {
    const Outcome outcome = rt("render scene.yaml --format png -o /dev/null");
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(
        outcome.err,
        "/dev/null: error[E0604]: is not a regular file; for a pipe use -o - and the shell's |\n");
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/null"));
}

TEST_F(Render, AProtectedFolderIsRefusedBeforeTracing) {
    RunOptions unprivileged;
    unprivileged.unprivileged = true;
    std::filesystem::create_directories(folder_ / "locked");
    std::filesystem::permissions(folder_, std::filesystem::perms::all);
    ::chmod((folder_ / "locked").c_str(), 0555);
    const Outcome outcome =
        rt("render scene.yaml -o locked/a.pfm --size 9000x9000 --antialias grid=32", unprivileged);
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(
        outcome.err,
        "locked/a.pfm: error[E0603]: cannot write into the folder 'locked': Permission denied\n");
}

TEST_F(Render, AFullFileSystemLeavesTheOldPictureAlone) {
    write("a.pfm", "old");
    RunOptions limited;
    limited.fileSizeLimit = 4096; // a write beyond it fails as on a full disk
    const Outcome outcome = rt("render scene.yaml -o a.pfm", limited);
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.err, "a.pfm: error[E0605]: cannot be written: File too large; what was there "
                           "before is untouched\n");
    EXPECT_EQ(read("a.pfm"), "old");
    EXPECT_EQ(files(), Names{"a.pfm"});
}

TEST_F(Render, AFullStdoutIsAnError) {
    RunOptions full;
    full.standardOutput = "/dev/full";
    for (const char* const line :
         {"render scene.yaml -o -", "schema", "--help", "completion bash", "check scene.yaml"}) {
        const Outcome outcome = rt(line, full);
        EXPECT_EQ(outcome.exitCode, 6) << line;
        EXPECT_TRUE(std::regex_match(
            outcome.err,
            std::regex("rt( \\w+)?: error: cannot write to stdout: No space left on device\n")))
            << outcome.err;
    }
}

TEST_F(Render, NothingIsWrittenWhenOneOfSeveralOutputsIsImpossible) {
    const Outcome outcome = rt("render scene.yaml -o a.pfm -o out/b.pfm -o c.xyz");
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(linesOf(outcome.err).size(), 2u) << outcome.err;
    EXPECT_EQ(files(), Names{});
}

TEST_F(Render, ALinkIsWrittenThrough) {
    write("real.pfm", "old");
    std::filesystem::create_symlink("real.pfm", folder_ / "link.pfm");
    EXPECT_EQ(rt("render scene.yaml -o link.pfm").exitCode, 0);
    EXPECT_TRUE(std::filesystem::is_symlink(folder_ / "link.pfm"));
    EXPECT_EQ(readPfm(read("real.pfm")).width, 64u);
}

TEST_F(Render, ClosedStandardStreamsHarmNoFile) {
    RunOptions options;
    options.program = "/bin/sh";
    const Outcome outcome =
        run({"-c", std::string(RT_BINARY) + " render scene.yaml -o a.pfm >&- 2>&- <&-; echo $?"},
            options);
    EXPECT_EQ(outcome.out, "6\n"); // where the picture is cannot be said
    EXPECT_EQ(readPfm(read("a.pfm")).width, 64u);
}

// ---- signals ------------------------------------------------------------------------------------------------

class Interrupt : public Cli {
protected:
    struct Interrupted {
        Outcome outcome;
        double seconds; // from the signal to the end
    };
    Interrupted interrupt(const std::string& arguments, const std::vector<int>& signals) const {
        using Clock = std::chrono::steady_clock;
        Clock::time_point sent;
        RunOptions options;
        options.whileRunning = [&](int child) {
            std::this_thread::sleep_for(std::chrono::milliseconds(1500)); // it traces by now
            sent = Clock::now();
            for (const int signal : signals) {
                ::kill(child, signal);
                std::this_thread::sleep_for(std::chrono::milliseconds(20));
            }
        };
        const Outcome outcome = rt(arguments, options);
        return {outcome, std::chrono::duration<double>(Clock::now() - sent).count()};
    }
};

/// ThreadSanitizer sleeps a second before the end, and all before takes ten times as long.
bool endsWithin(double most, double seconds) { return kThreadSanitized || seconds < most; }

TEST_F(Interrupt, CtrlCWritesWhatIsThereUnderAnotherName) {
    write("out/a.pfm", "old");
    const auto [outcome, seconds] = interrupt(kLong + " -o out/a.pfm", {SIGINT});
    EXPECT_EQ(outcome.exitCode, 130);
    EXPECT_TRUE(endsWithin(2, seconds)) << seconds;
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(std::regex_match(
        outcome.err, std::regex("rt render: error: interrupted after \\d+ % of the picture; what "
                                "was drawn is in out/a\\.partial\\.pfm\n")))
        << outcome.err;
    EXPECT_EQ(read("out/a.pfm"), "old");
    EXPECT_EQ(files(), (Names{"out/a.partial.pfm", "out/a.pfm"}));
    EXPECT_EQ(readPfm(read("out/a.partial.pfm")).width, 1600u);
}

TEST_F(Interrupt, TerminationDoesTheSame) {
    const auto [outcome, seconds] = interrupt(kLong, {SIGTERM});
    EXPECT_EQ(outcome.exitCode, 143);
    EXPECT_TRUE(endsWithin(2, seconds)) << seconds;
    EXPECT_EQ(files(), Names{"scene.partial.png"});
}

TEST_F(Interrupt, NothingGoesToStdout) {
    const auto [outcome, seconds] = interrupt(kLong + " -o -", {SIGINT});
    EXPECT_EQ(outcome.exitCode, 130);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(files(), Names{});
}

TEST_F(Interrupt, TheSecondSignalEndsAtOnce) {
    const auto [outcome, seconds] = interrupt(kLong + " --size 4000x3000", {SIGINT, SIGINT});
    EXPECT_EQ(outcome.exitCode, 130);
    EXPECT_TRUE(endsWithin(1, seconds)) << seconds;
}

TEST_F(Interrupt, AnIgnoredSignalStaysIgnored) {
    RunOptions options;
    options.program = "/bin/sh";
    const Outcome outcome = run({"-c", "trap '' INT; " + std::string(RT_BINARY) +
                                           " render scene.yaml --size 640x480 -o a.pfm & sleep "
                                           "0.05; kill -INT $!; wait $!; echo $?"},
                                options);
    EXPECT_EQ(outcome.out, "a.pfm\n0\n");
}

// ---- progress -----------------------------------------------------------------------------------------------

class Progress : public Cli {
protected:
    RunOptions terminal() const {
        RunOptions options;
        options.terminal = true;
        return options;
    }
    const std::string medium_ = "render scene.yaml --size 640x480 --antialias grid=4 -o a.pfm";
};

TEST_F(Progress, IsABarOnATerminalWithOneNewlineAtTheEnd) {
    const Outcome outcome = rt(medium_, terminal());
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_TRUE(outcome.err.starts_with("\rscene.yaml [")) << outcome.err;
    EXPECT_TRUE(std::regex_search(
        outcome.err, std::regex("\rscene\\.yaml \\[#{30}\\] 100 %, [\\d.]+ s\033\\[K\n$")))
        << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
    EXPECT_TRUE(
        std::regex_search(outcome.err, std::regex(" \\d+ %, [\\d.]+ s, [\\d.]+ s left\033")))
        << outcome.err;
}

TEST_F(Progress, IsNotThereInAPipe) { EXPECT_EQ(rt(medium_).err, ""); }

TEST_F(Progress, IsNotThereWhereABarWouldHarm) {
    for (const char* const variable : {"TERM=dumb", "CI=true"}) {
        RunOptions options = terminal();
        options.environment = {variable};
        EXPECT_EQ(rt(medium_, options).err, "") << variable;
    }
    EXPECT_EQ(rt(medium_ + " -q", terminal()).err, "");
    EXPECT_EQ(rt(medium_ + " --progress none", terminal()).err, "");
}

TEST_F(Progress, IsLinesForLogs) {
    const Outcome outcome = rt(medium_ + " --progress plain");
    const auto lines = linesOf(outcome.err);
    EXPECT_GE(lines.size(), 2u);
    EXPECT_LE(lines.size(), 11u);
    for (const std::string& line : lines)
        EXPECT_TRUE(
            std::regex_match(line, std::regex("scene\\.yaml \\d+ %, [\\d.]+ s(, [\\d.]+ s left)?")))
            << line;
    EXPECT_EQ(outcome.err.find('\r'), std::string::npos);
}

TEST_F(Progress, EndsItsLineBeforeAnErrorIsSaid) {
    RunOptions options = terminal();
    options.whileRunning = [](int child) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1500));
        ::kill(child, SIGINT);
    };
    const Outcome outcome = rt(kLong + " -o a.pfm", options);
    EXPECT_TRUE(
        std::regex_search(outcome.err, std::regex("\033\\[K\nrt render: .*error:.* interrupted")))
        << outcome.err;
}

using Colour = Cli;

TEST_F(Colour, IsForTerminalsAndForThoseWhoWantIt) {
    RunOptions terminal;
    terminal.terminal = true;
    EXPECT_NE(rt("render nosuch.yaml", terminal).err.find("\033["), std::string::npos);
    EXPECT_NE(rt("rendr", terminal).err.find("\033["), std::string::npos);
    EXPECT_EQ(rt("render nosuch.yaml").err.find("\033["), std::string::npos);
    for (const char* const variable : {"NO_COLOR=1", "TERM=dumb"}) {
        terminal.environment = {variable};
        EXPECT_EQ(rt("render nosuch.yaml", terminal).err.find("\033["), std::string::npos)
            << variable;
        EXPECT_EQ(rt("rendr", terminal).err.find("\033["), std::string::npos) << variable;
    }
    terminal.environment = {"NO_COLOR="};
    EXPECT_NE(rt("rendr", terminal).err.find("\033["), std::string::npos)
        << "an empty NO_COLOR says nothing";
}

// ---- frugality ----------------------------------------------------------------------------------------------

using Frugality = Cli;

TEST_F(Frugality, MapsOnlyWhatTheSceneNeeds) {
    // The dynamic linker itself tells which objects it initialises, those opened later included.
    RunOptions options;
    options.environment = {"LD_DEBUG=files", "LD_DEBUG_OUTPUT=" + (folder_ / "linker").string()};
    ASSERT_EQ(rt("render scene.yaml -o a.pfm", options).exitCode, 0);
    std::set<std::string> mapped;
    for (const std::string& file : files()) {
        if (!file.starts_with("linker.")) continue;
        const std::string text = read(file);
        static const std::regex initialised("calling init: (\\S+)");
        for (auto match = std::sregex_iterator(text.begin(), text.end(), initialised);
             match != std::sregex_iterator(); ++match)
            mapped.insert(std::filesystem::path((*match)[1].str()).filename());
    }
    for (const char* const own : {"libc.so.6", "libm.so.6", "ld-linux-x86-64.so.2"})
        mapped.erase(own);
    EXPECT_EQ(mapped, (std::set<std::string>{"libgcc_s.so.1", "libstdc++.so.6", "libtbb.so.12",
                                             "libtbbmalloc.so.2", "libyaml-cpp.so.0.7",
                                             "sphere.rtplugin.so"}));
    EXPECT_LE(mapped.size(), 12u);
}

// ---- the report ---------------------------------------------------------------------------------------------

using Stats = Cli;

TEST_F(Stats, AddUp) {
    ASSERT_EQ(rt("render scene.yaml -o a.pfm --stats=s.json").exitCode, 0);
    const auto json = nlohmann::json::parse(read("s.json"));
    EXPECT_EQ(json["rays"]["primary"], 64 * 48);
    EXPECT_GT(json["rays"]["reflected"], 0);
    EXPECT_EQ(json["rays"]["refracted"], 0);
    EXPECT_GT(json["rays"]["shadow"], 0);
    EXPECT_GT(json["tests"]["spheres"], 0);
    EXPECT_EQ(json["tests"]["triangles"], 0);
    EXPECT_GT(json["hits"]["spheres"], 0);
    EXPECT_LE(json["hits"]["spheres"].get<int>(),
              json["rays"]["primary"].get<int>() + json["rays"]["reflected"].get<int>());
    EXPECT_EQ(json["hits"]["triangles"], 0);
    EXPECT_LE(json["hits"]["blocked_shadow"], json["rays"]["shadow"]);
    EXPECT_EQ(json["not_finite"], 0);
    EXPECT_GT(json["peak_memory_bytes"], 1'000'000);
    std::uint64_t leaves = 0;
    for (const auto& count : json["octree"]["leaf_histogram"]) leaves += count.get<std::uint64_t>();
    EXPECT_EQ(leaves, json["octree"]["leaves"]);
    Names phases;
    for (const auto& phase : json["phases"]) {
        phases.push_back(phase["name"]);
        EXPECT_GE(phase["wall_seconds"], 0);
        EXPECT_GE(phase["cpu_seconds"], 0);
    }
    EXPECT_EQ(phases, (Names{"read", "load", "build", "trace", "write"}));
}

TEST_F(Stats, CountTheSameOnAnyNumberOfThreads) {
    rt("render scene.yaml -o a.pfm --stats=1.json -t 1");
    rt("render scene.yaml -o a.pfm --stats=7.json -t 7");
    const auto one = nlohmann::json::parse(read("1.json")),
               seven = nlohmann::json::parse(read("7.json"));
    for (const char* const key : {"rays", "tests", "hits", "octree", "deepest_recursion",
                                  "cut_by_depth", "cut_by_contribution", "not_finite"})
        EXPECT_EQ(one[key], seven[key]) << key;
}

TEST_F(Stats, AreATableOnStderr) {
    const Outcome outcome = rt("render scene.yaml -o a.pfm --stats");
    EXPECT_EQ(outcome.out, "a.pfm\n");
    for (const char* const row :
         {"phase", "  trace", "rays", "  primary                          3 072", "tests",
          "nearest hits", "  spheres", "octree depth", "peak memory"})
        EXPECT_NE(outcome.err.find(row), std::string::npos) << row;
    for (const std::string& line : linesOf(outcome.err)) {
        EXPECT_LE(line.size(), 80u);
        EXPECT_FALSE(line.ends_with(' ')) << "'" << line << "'";
    }
}

TEST_F(Stats, IntoAMissingFolderAreRefusedBeforeTracing) {
    const Outcome outcome = rt("render scene.yaml -o a.pfm --stats=no/s.json");
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(outcome.err,
              "no/s.json: error[E0602]: the folder 'no' does not exist; try: mkdir -p no\n");
    EXPECT_EQ(files(), Names{});
}

TEST_F(Stats, DoNotChangeThePicture) {
    rt("render scene.yaml -o a.pfm --stats");
    rt("render scene.yaml -o b.pfm");
    EXPECT_EQ(read("a.pfm"), read("b.pfm"));
}

} // namespace rt::cli_tests
