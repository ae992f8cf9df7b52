// Farms: the same bytes as rt render, whatever happens to the tasks.
#include <tests/cli/run.hpp>

#include <algorithm>
#include <csignal>
#include <regex>

#include <sys/mount.h>
#include <unistd.h>

namespace rt::cli_tests {

namespace {

namespace fs = std::filesystem;
using Names = std::vector<std::string>;

class Farm : public Cli {
protected:
    Farm() { write("film.yaml", kFilm); }

    void renderWhole(const std::string& options = "") const {
        ASSERT_EQ(rt("render film.yaml -o whole.mp4 --frames 0-4 " + options).exitCode, 0);
    }
    void expectWhole(const std::string& name) const {
        EXPECT_EQ(read(name + ".mp4"), read("whole.mp4"));
        for (const std::string frame : {"0000", "0001", "0002", "0003", "0004"})
            EXPECT_EQ(read(name + ".frames/frame_" + frame + ".png"),
                      read("whole.frames/frame_" + frame + ".png"))
                << frame;
    }
    std::size_t attempts(const std::string& job, int task) const {
        const std::string events = read(job + "/log/task_000" + std::to_string(task) + ".events");
        const auto lines = linesOf(events);
        return static_cast<std::size_t>(std::ranges::count_if(
            lines, [](const std::string& line) { return line.starts_with("start "); }));
    }
};

} // namespace

TEST_F(Farm, MakesTheFilmThatOneProcessMakes) {
    renderWhole();
    const Outcome outcome = rt("farm submit film.yaml -o f.mp4 --chunk 2 --jobs 3");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "f.mp4\n");
    expectWhole("f");
    EXPECT_EQ(rt("farm status f.job").out, "f.job: 3 of 3 tasks, 5 of 5 frames\n");
}

TEST_F(Farm, MergesTilesToThePictureThatOneProcessDraws) {
    for (const std::string options :
         {"", " --set render.smooth=true --set render.antialias=fsaa4"}) {
        ASSERT_EQ(rt("render scene.yaml -o whole.png -o whole.pfm" + options).exitCode, 0);
        const Outcome outcome = rt("farm submit scene.yaml -o t.png -o t.pfm --tiles=8 --jobs 3 "
                                   "--job t" +
                                   std::to_string(options.size()) + options);
        EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
        EXPECT_EQ(outcome.out, "t.png\nt.pfm\n");
        EXPECT_EQ(read("t.png"), read("whole.png"));
        EXPECT_EQ(read("t.pfm"), read("whole.pfm"));
    }
    EXPECT_EQ(rt("farm status t0").out, "t0: 48 of 48 tiles\n");
    ASSERT_EQ(rt("render film.yaml -o whole.png --frames 3").exitCode, 0);
    ASSERT_EQ(rt("farm submit film.yaml -o t.png --tiles=40 --frames 3").exitCode, 0);
    EXPECT_EQ(read("t.png"), read("whole.png"));
}

TEST_F(Farm, PrintsCommandsForOtherSchedulers) {
    renderWhole();
    const Outcome outcome = rt("farm submit film.yaml -o f.mp4 --chunk 2 --engine print");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    const auto commands = linesOf(outcome.out);
    ASSERT_EQ(commands.size(), 4u);
    EXPECT_TRUE(std::regex_match(commands[1], std::regex("'/.*/rt' task run '/.*/f\\.job' 1")))
        << commands[1];
    RunOptions shell;
    shell.program = "/bin/sh";
    for (const std::string& command : {commands[2], commands[0], commands[1], commands[3]})
        EXPECT_EQ(run({"-c", command}, shell).exitCode, 0) << command;
    expectWhole("f");
}

TEST_F(Farm, ATaskDoneAgainDoesOnlyWhatIsMissing) {
    ASSERT_EQ(rt("farm submit film.yaml -o f.mp4 --chunk 3 --engine print").exitCode, 0);
    ASSERT_EQ(rt("task run f.job 0").exitCode, 0);
    const auto first = fs::last_write_time(folder_ / "f.job/out/task_0000/frame_0000.png");
    fs::remove(folder_ / "f.job/out/task_0000/frame_0001.png");
    ASSERT_EQ(rt("task run f.job 0").exitCode, 0);
    EXPECT_EQ(fs::last_write_time(folder_ / "f.job/out/task_0000/frame_0000.png"), first);
    EXPECT_TRUE(exists("f.job/out/task_0000/frame_0001.png"));
    EXPECT_EQ(rt("task run f.job 2").err,
              "rt task: error: INDEX: must be a whole number from 0 to 1 (got '2'); see rt task "
              "--help\n");
}

TEST_F(Farm, FinishSaysWhatIsMissingAndResumeDoesIt) {
    renderWhole();
    ASSERT_EQ(rt("farm submit film.yaml -o f.mp4 --chunk 2 --engine print").exitCode, 0);
    ASSERT_EQ(rt("task run f.job 0").exitCode, 0);
    const Outcome unfinished = rt("farm finish f.job");
    EXPECT_EQ(unfinished.exitCode, 75);
    EXPECT_NE(
        unfinished.err.find("error[E0612]: 2 of 3 tasks are not done: 1-2; their logs are in "),
        std::string::npos)
        << unfinished.err;
    EXPECT_FALSE(exists("f.mp4"));
    EXPECT_TRUE(
        std::regex_match(rt("farm status f.job").out,
                         std::regex("f\\.job: 1 of 3 tasks, 2 of 5 frames; [\\d.]+ s of work left\n"
                                    "task 1, frames 2-3: waiting\ntask 2, frames 4: waiting\n")))
        << rt("farm status f.job").out;
    EXPECT_EQ(rt("farm resume f.job").out, "f.mp4\n");
    EXPECT_EQ(attempts("f.job", 0), 1u) << "what is done is not done again";
    expectWhole("f");
}

TEST_F(Farm, AKilledTaskAndADamagedFrameAreDoneAgain) {
    const std::string size = "--size 400x300 --set render.antialias={grid:4}";
    renderWhole(size);
    RunOptions options;
    options.whileRunning = [&](int) { // kills the first task's process, once
        const std::string events = "f.job/log/task_0000.events";
        ASSERT_TRUE(eventually([&] { return exists(events) && words(read(events)).size() >= 4; }));
        ::kill(std::stoi(words(read(events))[3]), SIGKILL);
    };
    const Outcome outcome = rt("farm submit film.yaml -o f.mp4 --chunk 3 " + size, options);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(attempts("f.job", 0), 2u);
    EXPECT_EQ(attempts("f.job", 1), 1u);
    expectWhole("f");
    EXPECT_TRUE(std::regex_search(rt("farm status f.job").out,
                                  std::regex("task 0, frames 0-2: done, attempt 2 on \\S+; "
                                             "attempt 1 on \\S+ was killed\n")))
        << rt("farm status f.job").out;

    write("f.job/out/task_0001/frame_0004.png", "damaged");
    fs::remove_all(folder_ / "f.frames");
    EXPECT_EQ(rt("farm finish f.job").exitCode, 75);
    EXPECT_NE(
        rt("farm status f.job").out.find("task 1, frames 3-4: lost or damaged since, attempt 1"),
        std::string::npos);
    EXPECT_EQ(rt("farm resume f.job").exitCode, 0);
    EXPECT_EQ(attempts("f.job", 0), 2u);
    EXPECT_EQ(attempts("f.job", 1), 2u);
    EXPECT_TRUE(
        std::regex_search(rt("farm status f.job").out,
                          std::regex("task 1, frames 3-4: done, attempt 2 on \\S+; attempt 1 "
                                     "on \\S+ was done, and then lost or damaged\n")))
        << rt("farm status f.job").out;
    expectWhole("f");
}

TEST_F(Farm, AChangedSceneIsNotContinued) {
    ASSERT_EQ(rt("farm submit film.yaml -o f.mp4 --chunk 2 --engine print").exitCode, 0);
    ASSERT_EQ(rt("task run f.job 0").exitCode, 0);
    write("film.yaml", std::regex_replace(kFilm, std::regex("name: left, center: \\[-1.2"),
                                          "name: left, center: [-1.3"));
    for (const std::string command : {"farm resume f.job", "task run f.job 1"}) {
        const Outcome outcome = rt(command);
        EXPECT_EQ(outcome.exitCode, 6) << command;
        EXPECT_NE(outcome.err.find("error[E0610]: the scene is not what it was when the job was "
                                   "made: objects.left.center was '[-1.2, 0, 0.5]' and is '[-1.3, "
                                   "0, 0.5]'; undo the change, or submit another job\n"),
                  std::string::npos)
            << outcome.err;
    }
    write("film.yaml", kFilm);
    EXPECT_EQ(rt("farm resume f.job").exitCode, 0);
}

TEST_F(Farm, AFullDiskInATaskIsTransient) {
    renderWhole("--size 160x120");
    ASSERT_EQ(rt("farm submit film.yaml -o f.mp4 --size 160x120 --chunk 2 --engine print").exitCode,
              0);
    fs::create_directories(folder_ / "f.job/out/task_0001");
    const std::string small = (folder_ / "f.job/out/task_0001").string();
    if (::geteuid() != 0 || ::mount("tmpfs", small.c_str(), "tmpfs", 0, "size=16k") != 0)
        GTEST_SKIP() << "a small file system cannot be mounted here";
    struct Unmount {
        std::string path;
        ~Unmount() { ::umount2(path.c_str(), MNT_DETACH); }
    } unmount{small};
    EXPECT_EQ(rt("farm resume f.job").exitCode, 75);
    EXPECT_EQ(attempts("f.job", 1), 3u);
    EXPECT_TRUE(std::regex_search(
        rt("farm status f.job").out,
        std::regex("task 1, frames 2-3: failed, attempt 3 on \\S+, exit 75; attempt 1 "
                   "on \\S+, exit 75; attempt 2 on \\S+, exit 75\n")))
        << rt("farm status f.job").out;
    ASSERT_EQ(::mount("tmpfs", small.c_str(), "tmpfs", MS_REMOUNT, "size=4m"), 0);
    EXPECT_EQ(rt("farm resume f.job").exitCode, 0);
    EXPECT_EQ(attempts("f.job", 0), 1u);
    EXPECT_TRUE(std::regex_search(
        rt("farm status f.job").out,
        std::regex("task 1, frames 2-3: done, attempt 4 on \\S+; attempt 1 on \\S+, exit 75; ")))
        << rt("farm status f.job").out;
    expectWhole("f");
}

TEST_F(Farm, IsCancelled) {
    RunOptions options;
    options.whileRunning = [&](int) {
        EXPECT_TRUE(eventually([&] { return exists("f.job/log/task_0000.events"); }));
        rt("farm cancel f.job");
    };
    const Outcome outcome = rt("farm submit film.yaml -o f.mp4 --chunk 1 --size 400x300", options);
    EXPECT_EQ(outcome.exitCode, 75);
    EXPECT_NE(outcome.err.find("the job was cancelled; to go on: rt farm resume "),
              std::string::npos)
        << outcome.err;
    EXPECT_NE(rt("farm status f.job").out.find("; cancelled"), std::string::npos);
    EXPECT_EQ(rt("farm resume f.job").out, "f.mp4\n");
}

TEST_F(Farm, CommandLinesThatMeanNothingAreRefused) {
    ASSERT_EQ(rt("farm submit film.yaml -o f.mp4 --engine print").exitCode, 0);
    EXPECT_TRUE(std::regex_match(
        rt("farm submit film.yaml -o f.mp4 --engine print").err,
        std::regex("/.*/f\\.job: error\\[E0611\\]: is a job already; to go on with it: rt farm "
                   "resume /.*/f\\.job\n")));
    const std::vector<std::pair<std::string, std::string>> cases{
        {"sumbit film.yaml",
         "ACTION must be submit, status, resume, cancel or finish (got 'sumbit'); see rt farm "
         "--help\n"},
        {"submit scene.yaml",
         "a farm renders films, and one picture with --tiles; such as -o film.mp4\n"},
        {"submit film.yaml -o a.mp4 --tiles",
         "--tiles is for one picture; such as --frames 0 -o frame.png\n"},
        {"submit scene.yaml --tiles --set render.antialias={max_error:0.1}",
         "--tiles cannot keep max_error, a promise about the whole picture; use antialias: {grid: "
         "N}\n"},
        {"status f.job --size 3x3", "--size is for submit; see rt farm --help\n"}};
    for (const auto& [line, message] : cases) {
        const Outcome outcome = rt("farm " + line);
        EXPECT_EQ(outcome.exitCode, 2) << line;
        EXPECT_EQ(outcome.err, "rt farm: error: " + message);
    }
    const Outcome none = rt("farm status film.frames");
    EXPECT_EQ(none.exitCode, 4);
    EXPECT_EQ(none.err, "film.frames: error[E0408]: is no job directory of this version of rt; rt "
                        "farm submit makes one\n");
    EXPECT_EQ(rt("task walk f.job 0").exitCode, 2);
}

} // namespace rt::cli_tests
