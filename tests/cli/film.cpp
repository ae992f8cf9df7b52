// Films from the user's side: frames, manifest, resuming, encoding, signals, kills and full disks.
#include <tests/cli/run.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <map>
#include <random>
#include <regex>
#include <set>
#include <thread>

#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

namespace rt::cli_tests {

namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

constexpr const char* kProbe = "/usr/bin/ffprobe";

class Film : public Cli {
protected:
    Film() { write("film.yaml", kFilm); }

    std::map<std::string, std::string> contents(const std::string& folder) const {
        std::map<std::string, std::string> found;
        for (const auto& entry : fs::directory_iterator(folder_ / folder))
            found[entry.path().filename()] = read(folder + "/" + entry.path().filename().string());
        found.erase(".manifest.lock"); // holds the process
        return found;
    }
    /// What an independent reader says of the picture stream: "h264 64x48 yuv420p bt709 5".
    std::string probed(const std::string& film, const std::string& entries) const {
        RunOptions options;
        options.program = kProbe;
        const Outcome outcome =
            run({"-v", "error", "-count_frames", "-select_streams", "v", "-show_entries",
                 "stream=" + entries, "-of", "csv=p=0:s=\\ ", film},
                options);
        EXPECT_EQ(outcome.err, "");
        return outcome.out.substr(0, outcome.out.find('\n'));
    }
    static bool canProbe() { return fs::exists(kProbe); }
};

} // namespace

TEST_F(Film, IsRenderedAndEncoded) {
    const Outcome outcome = rt("render film.yaml");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.out, "film.mp4\n");
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(files(), (Names{"film.frames/.manifest.lock", "film.frames/frame_0000.png",
                              "film.frames/frame_0001.png", "film.frames/frame_0002.png",
                              "film.frames/frame_0003.png", "film.frames/frame_0004.png",
                              "film.frames/manifest", "film.mp4", "film.yaml"}));
    if (canProbe()) {
        EXPECT_EQ(probed("film.mp4", "codec_name,width,height,pix_fmt,color_range,color_space,"
                                     "color_transfer,color_primaries,r_frame_rate,nb_read_frames"),
                  "h264 64 48 yuv420p tv bt709 iec61966-2-1 bt709 12/1 5");
    }
}

TEST_F(Film, SaysHowTheOctreeFollowed) {
    const Outcome table = rt("render film.yaml --stats");
    EXPECT_EQ(table.exitCode, 0) << table.err;
    EXPECT_TRUE(std::regex_search(
        table.err, std::regex("octree: updated in [0-4] of 5 frames.*; built anew in [1-5], .* ms "
                              "each: [a-z ]+\n$")))
        << table.err;
    const std::string pictures = read("film.mp4");
    EXPECT_EQ(rt("render film.yaml -o a.mp4 --stats=s.json").err, "");
    const std::string json = read("s.json");
    for (const char* const key : {"updated_frames", "update_seconds", "built_frames", "moved",
                                  "rebuilt", "reason", "poses", "trace"})
        EXPECT_NE(json.find('"' + std::string(key) + "\": "), std::string::npos) << key;
    EXPECT_NE(rt("render film.yaml -o b.mp4 -v").err.find("octree: updated in "),
              std::string::npos);
    EXPECT_EQ(rt("render film.yaml -o b.mp4 -v --resume").err.find("octree: "), std::string::npos);
    EXPECT_TRUE(read("a.mp4") == pictures && read("b.mp4") == pictures);
}

TEST_F(Film, GoesWhereTheSceneSays) {
    write("film.yaml",
          std::regex_replace(kFilm, std::regex("height: 48"), "height: 48, file: move.AVI"));
    EXPECT_EQ(rt("render film.yaml").out, "move.AVI\n");
    EXPECT_TRUE(exists("move.frames/manifest"));
}

/// Keyframes of shapes and materials have each frame's octree built anew; without them it follows from frame to frame.
TEST_F(Film, FramesAreTheSameAloneInSequenceAndOnAnyNumberOfThreads) {
    write("tent.obj", "v -1 0 0\nv 1 0 0\nv 0 1 1\nv 0 -1 1\nf 1 2 3\nf 1 4 2\nf 1 3 4\n");
    std::string moving =
        std::regex_replace(kFilm, std::regex("    - \\{target: (materials|right)[^\n]*\n"), "");
    moving = std::regex_replace(moving, std::regex("animation:"),
                                "  - mesh: {name: tent, file: tent.obj, material: red}\n"
                                "  - sphereflake: {name: flake, translate: [0, 0, 1], scale: 0.4, "
                                "material: mirror}\nanimation:");
    write("moving.yaml",
          moving + "    - {target: flake, rotate: {center: [0, 0, 0.5], axis: [1, 1, 0], angle: "
                   "90deg}, frames: [0, 3]}\n"
                   "    - {target: tent, each: true, move_radius: {center: [0, 0, 0], distance: "
                   "1}, frames: [1, 4]}\n");
    for (const std::string film : {"film", "moving"}) {
        SCOPED_TRACE(film);
        const std::string render = "render " + film + ".yaml --overwrite -o ";
        ASSERT_EQ(rt(render + "f_%d.pfm").exitCode, 0);
        ASSERT_EQ(rt(render + "one_%d.pfm -t 1").exitCode, 0);
        ASSERT_EQ(rt(render + "seven_%d.pfm -t 7").exitCode, 0);
        std::set<std::string> different;
        for (const std::string frame : {"0", "1", "2", "3", "4"}) {
            ASSERT_EQ(rt("render " + film + ".yaml -o alone.pfm --frames " + frame).exitCode, 0);
            const std::string bytes = read("f_" + frame + ".pfm");
            EXPECT_EQ(read("alone.pfm"), bytes) << frame;
            EXPECT_EQ(read("one_" + frame + ".pfm"), bytes) << frame;
            EXPECT_EQ(read("seven_" + frame + ".pfm"), bytes) << frame;
            different.insert(bytes);
        }
        EXPECT_EQ(different.size(), 5u);
    }
    const Outcome followed = rt("render moving.yaml -o f_%d.pfm --overwrite -v");
    EXPECT_TRUE(std::regex_search(followed.err, std::regex("octree: updated in [1-4] of 5 frames")))
        << followed.err;
}

// Keyframes of materials, lights and parameters of shapes once reached the description only.
TEST_F(Film, KeyframesReachTheWorld) {
    write("still.yaml", kFilm.substr(0, kFilm.find("animation:")));
    // The camera's front and top point stay in the film, so its motion is left out.
    write("film.yaml",
          std::regex_replace(kFilm, std::regex("    - \\{target: camera.position[^\n]*\n"), ""));
    ASSERT_EQ(rt("render film.yaml -o film.pfm --frames 4").exitCode, 0);
    ASSERT_EQ(rt("render still.yaml -o still.pfm --set materials.mirror.color=[0.2,1,0.2] --set "
                 "objects.right.radius=0.9 --set lights.key.color=[1,0.5,0]")
                  .exitCode,
              0);
    EXPECT_EQ(rt("compare film.pfm still.pfm --tolerance 0.001").exitCode, 0);
}

TEST_F(Film, FramesAreChosen) {
    ASSERT_EQ(rt("render film.yaml -o f_%02d.pfm --frames 3,0-4:2").out,
              "f_00.pfm\nf_02.pfm\nf_03.pfm\nf_04.pfm\n");
    EXPECT_FALSE(exists("f_01.pfm"));
    const Outcome outcome = rt("render film.yaml -o a.mkv --frames 1-3");
    EXPECT_EQ(outcome.out, "a.mkv\n");
    if (canProbe()) {
        EXPECT_EQ(probed("a.mkv", "nb_read_frames"), "3");
    }
}

TEST_F(Film, IsWhatItWasAfterFramesWereLostAndBroken) {
    ASSERT_EQ(rt("render film.yaml").exitCode, 0);
    const auto whole = contents("film.frames");
    const std::string film = read("film.mp4");

    fs::remove(folder_ / "film.frames/frame_0001.png");
    write("film.frames/frame_0002.png", whole.at("frame_0002.png").substr(0, 100));
    std::string damaged = whole.at("frame_0003.png");
    damaged[damaged.size() / 2] ^= 1;
    write("film.frames/frame_0003.png", damaged);
    const auto untouched = fs::last_write_time(folder_ / "film.frames/frame_0000.png");
    const Outcome outcome = rt("render film.yaml --resume -v");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_NE(outcome.err.find("3 of 5 frames to render\n"), std::string::npos) << outcome.err;
    auto resumed = contents("film.frames");
    EXPECT_EQ(fs::last_write_time(folder_ / "film.frames/frame_0000.png"), untouched);
    EXPECT_EQ(rt("render film.yaml --resume -v").err.find("3 of 5"), std::string::npos);
    EXPECT_EQ(contents("film.frames"), whole); // with the lines of the manifest said once
    EXPECT_EQ(read("film.mp4"), film);
}

TEST_F(Film, IsNotContinuedWithAnotherScene) {
    write("tent.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    const std::string scene = std::regex_replace(
        kFilm, std::regex("animation:"), "  - mesh: {name: tent, file: tent.obj}\nanimation:");
    write("film.yaml", scene);
    ASSERT_EQ(rt("render film.yaml -o f.avi --frames 0-1").exitCode, 0);
    const auto frames = contents("f.frames");
    const auto refused = [&](const std::string& options, const std::string& field) {
        const Outcome outcome = rt("render film.yaml -o f.avi --resume -q" + options);
        EXPECT_EQ(outcome.exitCode, 6);
        EXPECT_EQ(outcome.err, "f.frames: error[E0610]: these frames are of another film: " +
                                   field + "; --overwrite starts again\n");
        EXPECT_EQ(contents("f.frames"), frames);
    };
    refused(" --set objects.left.radius=0.4", "objects.left.radius was '0.5' and is '0.4'");
    refused(" --set materials.red.diffuse=0.7",
            "materials.red.diffuse was '[0.8, 0.8, 0.8]' and is '[0.7, 0.7, 0.7]'");
    refused(" --size 32x24", "image.width was '64' and is '32'");
    refused(" --crop 0,0,8,8", "--crop was 'none' and is '0,0,8,8'");
    write("film.yaml", std::regex_replace(scene, std::regex("360deg"), "180deg"));
    const Outcome track = rt("render film.yaml -o f.avi --resume");
    EXPECT_TRUE(std::regex_search(
        track.err, std::regex("another film: animation\\.tracks\\.0\\.rotate\\.angle was '")))
        << track.err;
    write("film.yaml", scene);
    write("tent.obj", "v 0 0 0\nv 1 0 0\nv 0 0 2\nf 1 2 3\n");
    const Outcome mesh = rt("render film.yaml -o f.avi --resume");
    EXPECT_EQ(mesh.exitCode, 6);
    EXPECT_NE(mesh.err.find("the content of tent.obj was '"), std::string::npos) << mesh.err;
    EXPECT_EQ(rt("render film.yaml -o f.avi --overwrite").exitCode, 0);
}

TEST_F(Film, MayMoveWithItsScene) {
    write("a/tent.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    write("a/film.yaml", std::regex_replace(kFilm, std::regex("animation:"),
                                            "  - mesh: {name: tent, file: tent.obj}\nanimation:"));
    ASSERT_EQ(rt("render a/film.yaml -o a/f.avi --frames 0-1").exitCode, 0);
    fs::rename(folder_ / "a", folder_ / "b");
    EXPECT_EQ(rt("render b/film.yaml -o b/f.avi --resume").exitCode, 0);
}

TEST_F(Film, FramesOfAnEarlierRunAreNotLost) {
    ASSERT_EQ(rt("render film.yaml -o f.avi --frames 0-2").exitCode, 0);
    const auto frames = contents("f.frames");
    const Outcome refused = rt("render film.yaml -o f.avi");
    EXPECT_EQ(refused.exitCode, 6);
    EXPECT_EQ(refused.err,
              "f.frames: error[E0609]: has 3 frames of an earlier run; --resume renders what is "
              "missing, --overwrite starts again\n");
    EXPECT_EQ(contents("f.frames"), frames);
    EXPECT_EQ(rt("render film.yaml -o f.avi --overwrite --frames 4").exitCode, 0);
    EXPECT_FALSE(exists("f.frames/frame_0000.png"));
    EXPECT_TRUE(exists("f.frames/frame_0004.png"));
}

TEST_F(Film, TellsItsProgress) {
    const auto lines = linesOf(rt("render film.yaml --progress plain").err);
    ASSERT_GE(lines.size(), 3u);
    for (const std::string& line : lines)
        EXPECT_TRUE(std::regex_match(line, std::regex("film\\.(yaml frame \\d|mp4) \\d+ %, [\\d.]+ "
                                                      "s(, [\\d.]+ s left)?")))
            << line;
}

TEST_F(Film, CommandLinesThatMeanNothingAreRefused) {
    ASSERT_EQ(rt("render film.yaml -o f_%d.png").exitCode, 0);
    const auto before = files();
    const std::vector<std::pair<std::string, std::string>> cases{
        {"scene.yaml -o a.mp4", "--output: 'a.mp4' is a film, and the scene has no section "
                                "'animation'; for a picture: -o a.png\n"},
        {"scene.yaml --frames 0",
         "--frames needs a scene with a section 'animation'; see rt render --help\n"},
        {"film.yaml -o a.png --frames 0-2",
         "--frames: a picture shows one frame, not 3; number them, such as -o frame_%04d.png, or "
         "write a film\n"},
        {"film.yaml --frames 3-9",
         "--frames: there is no frame 9: the film has frames 0 to 4; see rt render --help\n"},
        {"film.yaml -o a.png --resume", "--resume is for films; such as -o film.mp4\n"},
        {"film.yaml -o a.webm --codec h264", "--codec: 'a.webm' takes vp9; see rt render --help\n"},
        {"film.yaml -o a.mp4 -o a.png",
         "--output: 'a.png' is a picture and 'a.mp4' a film; see rt render --help\n"},
        {"film.yaml -o a_%d.tga",
         "--output: the suffix of frames must be png, jpg, jpeg, bmp, exr or pfm (got 'a_%d.tga'); "
         "see rt render --help\n"},
        {"film.yaml -o a.mp4 --time-budget 3",
         "--time-budget is for one picture: the frames of a film are the same on every machine; "
         "use --max-error\n"},
        {"film.yaml -o a.mp4 --resume --overwrite",
         "--resume and --overwrite exclude each other; see rt render --help\n"}};
    for (const auto& [line, message] : cases) {
        const Outcome outcome = rt("render " + line);
        EXPECT_EQ(outcome.exitCode, 2) << line;
        EXPECT_EQ(outcome.err, "rt render: error: " + message);
    }
    EXPECT_EQ(rt("render film.yaml -o no/a.mp4").err,
              "no/a.mp4: error[E0602]: the folder 'no' does not exist; try: mkdir -p no\n");
    EXPECT_EQ(rt("render film.yaml -o no/a_%d.png").exitCode, 6);
    EXPECT_EQ(files(), before);
}

// ---- encoding -----------------------------------------------------------------------------------------------

TEST_F(Film, EveryCodecTakesOddSizes) {
    ASSERT_EQ(rt("render film.yaml -o f_%d.png --size 63x47").exitCode, 0);
    const std::map<std::string, Names> codecs{
        {"mp4", {"h264", "h265", "mpeg4"}},
        {"avi", {"mpeg4", "mjpeg", "ffv1"}},
        {"mkv", {"h264", "h265", "vp9", "mpeg4", "mjpeg", "ffv1"}},
        {"webm", {"vp9"}}};
    for (const auto& [suffix, names] : codecs)
        for (const std::string& codec : names) {
            SCOPED_TRACE(codec + " in " + suffix);
            const std::string film = codec + "." + suffix;
            const Outcome outcome = rt("encode f_%d.png -o " + film + " --codec " + codec);
            EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
            EXPECT_EQ(outcome.out, film + "\n");
            const bool halves = codec == "h264" || codec == "h265";
            EXPECT_EQ(outcome.err.find("sides of 63x47 are odd") != std::string::npos, halves);
            if (canProbe()) {
                EXPECT_EQ(probed(film, "width,height,nb_read_frames"), "63 47 5");
            }
        }
}

TEST_F(Film, LosslessCodecGivesTheFramesBack) {
    ASSERT_EQ(rt("render film.yaml -o f.mkv --codec ffv1").exitCode, 0);
    if (!fs::exists("/usr/bin/ffmpeg")) GTEST_SKIP() << "ffmpeg is not here";
    RunOptions options;
    options.program = "/usr/bin/ffmpeg";
    ASSERT_EQ(run({"-v", "error", "-i", "f.mkv", "-start_number", "0", "back_%04d.png"}, options)
                  .exitCode,
              0);
    for (const std::string frame : {"0000", "0002", "0004"})
        EXPECT_EQ(rt("compare f.frames/frame_" + frame + ".png back_" + frame + ".png").exitCode, 0)
            << frame;
}

TEST_F(Film, QualityIsWhatWasAskedFor) {
    ASSERT_EQ(rt("render film.yaml -o f.mp4 --size 320x240").exitCode, 0);
    for (const std::string suffix : {"mp4", "avi", "webm"}) {
        ASSERT_EQ(rt("encode f.frames -o low." + suffix + " --quality 10").exitCode, 0);
        ASSERT_EQ(rt("encode f.frames -o high." + suffix + " --quality 95").exitCode, 0);
        EXPECT_LT(3 * read("low." + suffix).size(), 2 * read("high." + suffix).size()) << suffix;
    }
}

TEST_F(Film, IsEncodedAloneFromItsFrames) {
    ASSERT_EQ(rt("render film.yaml -o f.mp4").exitCode, 0);
    const std::string film = read("f.mp4");
    fs::remove(folder_ / "f.mp4");
    const Outcome outcome = rt("encode f.frames/");
    EXPECT_EQ(outcome.out, "f.mp4\n");
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(read("f.mp4"), film);
    EXPECT_EQ(rt("encode f.frames -o part.avi --frames 1-4:3 --fps 23.976").out, "part.avi\n");
    if (canProbe()) {
        EXPECT_EQ(probed("part.avi", "r_frame_rate,nb_read_frames"), "2997/125 2");
    }
}

/// x264's macroblock tree read memory that nobody had written: what lay there depended on what the process did before.
TEST_F(Film, BytesDoNotDependOnWhatMemoryHeld) {
    ASSERT_EQ(rt("render film.yaml -o f.mp4 --set animation.frames=24").exitCode, 0);
    const std::string film = read("f.mp4");
    RunOptions filled;
    filled.environment = {"MALLOC_PERTURB_=85"}; // the C library fills what it gives out
    EXPECT_EQ(rt("encode f.frames -o g.mp4", filled).exitCode, 0);
    EXPECT_TRUE(read("g.mp4") == film);
}

TEST_F(Film, IsNotEncodedWithHoles) {
    ASSERT_EQ(rt("render film.yaml -o f.mp4 --frames 0-1,4").exitCode, 0);
    const std::string film = read("f.mp4");
    const Outcome missing = rt("encode f.frames");
    EXPECT_EQ(missing.exitCode, 4);
    EXPECT_EQ(missing.err, "f.frames/manifest: error[E0407]: frames 2-3 are missing; the film of "
                           "those that are there is --frames 0-1,4\n");
    write("f.frames/frame_0001.png", read("f.frames/frame_0000.png"));
    const Outcome broken = rt("encode f.frames --frames 0-1");
    EXPECT_EQ(broken.exitCode, 4);
    EXPECT_EQ(broken.err,
              "f.frames/manifest: error[E0407]: frame 1 is broken: its file is not what the "
              "manifest says; rt render with --resume renders it again\n");
    EXPECT_EQ(read("f.mp4"), film);
    EXPECT_EQ(rt("encode .").exitCode, 2);
    EXPECT_EQ(rt("encode . -o a.mp4").err,
              ".: error[E0406]: is no folder of frames: it has no manifest\n");
}

TEST_F(Film, TheOldFilmStaysWhenTheNewOneCannotBeWritten) {
    ASSERT_EQ(rt("render film.yaml -o f.avi --codec ffv1 --size 320x240").exitCode, 0);
    const std::string film = read("f.avi");
    RunOptions options;
    options.fileSizeLimit = film.size() / 2;
    const Outcome outcome = rt("encode f.frames -o f.avi --codec ffv1", options);
    EXPECT_EQ(outcome.exitCode, 6);
    EXPECT_EQ(outcome.err, "f.avi: error[E0606]: cannot be written: File too large\n");
    EXPECT_EQ(read("f.avi"), film);
    for (const std::string& name : files()) EXPECT_FALSE(name.ends_with(".tmp")) << name;
}

// ---- ends ---------------------------------------------------------------------------------------------------

TEST_F(Film, CtrlCSaysHowToGoOn) {
    using Clock = std::chrono::steady_clock;
    Clock::time_point sent;
    RunOptions options;
    options.whileRunning = [&](int child) {
        EXPECT_TRUE(eventually([&] { return exists("f.frames/frame_0001.png"); }));
        sent = Clock::now();
        ::kill(child, SIGINT);
    };
    const std::string command =
        "render film.yaml -o f.mp4 --size 400x300 --antialias grid=4 --depth 3";
    const Outcome outcome = rt(command, options);
    EXPECT_LT(std::chrono::duration<double>(Clock::now() - sent).count(), 2);
    EXPECT_EQ(outcome.exitCode, 130);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(std::regex_match(
        outcome.err, std::regex("rt render: error: interrupted after [1-4] of 5 frames; to go on: "
                                "rt render film\\.yaml -o f\\.mp4 --size 400x300 --antialias "
                                "grid=4 --depth 3 --resume\n")))
        << outcome.err;
    EXPECT_FALSE(exists("f.mp4"));
    EXPECT_EQ(rt(command + " --resume").out, "f.mp4\n");
    ASSERT_EQ(rt(std::regex_replace(command, std::regex("f\\.mp4"), "g.mp4")).exitCode, 0);
    EXPECT_EQ(read("f.mp4"), read("g.mp4"));
}

TEST_F(Film, TwoProcessesDoNotShareAFolder) {
    RunOptions options;
    Outcome second;
    options.whileRunning = [&](int) {
        EXPECT_TRUE(eventually([&] { return exists("f.frames/frame_0000.png"); }));
        second = rt("render film.yaml -o f.mp4 --size 400x300 --antialias grid=4 --resume");
    };
    EXPECT_EQ(rt("render film.yaml -o f.mp4 --size 400x300 --antialias grid=4", options).exitCode,
              0);
    EXPECT_EQ(second.exitCode, 6);
    EXPECT_TRUE(std::regex_match(
        second.err, std::regex("f\\.frames: error\\[E0608\\]: is in use by process \\d+\n")))
        << second.err;
}

// RT_FILM_KILLS=200 for the long campaign.
TEST_F(Film, SurvivesBeingKilledAtRandomMoments) {
    const char* const asked = std::getenv("RT_FILM_KILLS");
    const int kills = asked ? std::atoi(asked) : 8;
    const std::string command = "render film.yaml -o f.mp4 --size 160x120 -t 2";
    ASSERT_EQ(rt("render film.yaml -o whole.mp4 --size 160x120").exitCode, 0);
    const auto whole = contents("whole.frames");
    const std::string film = read("whole.mp4");
    const auto start = std::chrono::steady_clock::now();
    ASSERT_EQ(rt(command + " --overwrite").exitCode, 0);
    const double runSeconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();

    std::mt19937 random(8);
    std::uniform_real_distribution<double> moment(0, runSeconds);
    int killed = 0;
    for (int i = 0; killed < kills || i % 4; ++i) { // some moments come when the run has ended
        ASSERT_LT(i, 8 * kills) << "the moments lie outside of the run";
        if (i % 4 == 0) fs::remove_all(folder_ / "f.frames"); // else a run is killed several times
        RunOptions options;
        const double seconds = moment(random);
        options.whileRunning = [&](int child) {
            std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
            ::kill(child, SIGKILL);
        };
        killed += rt(command + " --resume", options).signal == SIGKILL;
        if (!exists("f.frames/manifest")) continue;
        // What the manifest vouches for is whole, at any moment.
        for (const std::string& line : linesOf(read("f.frames/manifest"))) {
            static const std::regex frame("frame\t\\d+\t(\\S+)\t(\\d+)\t\\S+\t\\S+");
            std::smatch match;
            if (std::regex_match(line, match, frame)) {
                EXPECT_EQ(read("f.frames/" + match[1].str()), whole.at(match[1])) << i;
            }
        }
        if (i % 4 != 3) continue;
        const Outcome outcome = rt(command + " --resume");
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_EQ(rt(command + " --resume").exitCode, 0); // with a manifest that is made clean
        EXPECT_EQ(contents("f.frames"), whole) << i;
        EXPECT_EQ(read("f.mp4"), film) << i;
        for (const std::string& name : files()) EXPECT_FALSE(name.ends_with(".tmp")) << name;
    }
    RecordProperty("killed", killed);
}

TEST_F(Film, AFullDiskEndsItWithTheFrameNamed) {
    fs::create_directories(folder_ / "small");
    const std::string small = (folder_ / "small").string();
    if (::geteuid() != 0 || ::mount("tmpfs", small.c_str(), "tmpfs", 0, "size=28k") != 0)
        GTEST_SKIP() << "a small file system cannot be mounted here";
    struct Unmount {
        std::string path;
        ~Unmount() { ::umount2(path.c_str(), MNT_DETACH); }
    } unmount{small};
    const std::string command = "render film.yaml -o small/f.mp4 --size 160x120";
    ASSERT_EQ(rt("render film.yaml -o whole.mp4 --size 160x120").exitCode, 0);
    const auto whole = contents("whole.frames");

    const Outcome outcome = rt(command);
    EXPECT_EQ(outcome.exitCode, 6);
    std::smatch match;
    ASSERT_TRUE(std::regex_search(
        outcome.err, match,
        std::regex(
            "^small/f\\.frames/frame_000(\\d)\\.png: error\\[E0605\\]: frame (\\d) cannot be "
            "written: No space left on device; the frames before it are kept; to go on: rt "
            "render film\\.yaml -o small/f\\.mp4 --size 160x120 --resume\n$")))
        << outcome.err;
    const int failed = std::stoi(match[2]);
    EXPECT_GE(failed, 1);
    for (int frame = 0; frame < failed; ++frame) {
        const std::string name = "frame_000" + std::to_string(frame) + ".png";
        EXPECT_EQ(read("small/f.frames/" + name), whole.at(name));
    }
    ASSERT_EQ(::mount("tmpfs", small.c_str(), "tmpfs", MS_REMOUNT, "size=4m"), 0);
    EXPECT_EQ(rt(command + " --resume").exitCode, 0);
    EXPECT_EQ(read("small/f.mp4"), read("whole.mp4"));
    EXPECT_EQ(contents("small/f.frames"), whole);
}

} // namespace rt::cli_tests
