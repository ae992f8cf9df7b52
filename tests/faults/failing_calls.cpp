// Threats 5 and 12: every single call that the machine can refuse is refused in turn.
#include <tests/faults/faults.hpp>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <map>
#include <set>
#include <thread>

namespace rt::faults {
namespace {

using cli_tests::Outcome;

/// The runs whose calls fail, each with what it writes.
struct Job {
    std::string arguments, output;
};
const Job kRender{"render scene.yaml --size 16x12 -t 2 -o out.pfm", "out.pfm"};
const Job kConvert{"convert old.inf -o out.yaml", "out.yaml"};

} // namespace

class FailingCalls : public Faults {
protected:
    FailingCalls() { write("old.inf", cli_tests::kOldScene); }

    /// Exit 0 with the complete output, or one of `codes`, a sentence and the old one; and no other file either way.
    void holds(const Job& job, const std::string& call, int error, const std::set<int>& codes,
               long step, const std::string& after = "") {
        ASSERT_EQ(rt(job.arguments).exitCode, 0);
        const std::string complete = read(job.output), old = "the old one";
        const auto names = files();
        long struck = 0, failed = 0;
        for (long n = 1;; n += step) {
            SCOPED_TRACE(job.arguments + ": " + call + " " + std::to_string(n));
            write(job.output, old);
            const Struck result = runFailing(job.arguments, call, n, error, after);
            const Outcome& o = result.outcome;
            EXPECT_EQ(o.signal, 0) << o.err;
            EXPECT_EQ(files(), names);
            if (o.exitCode == 0) {
                EXPECT_EQ(read(job.output), complete);
            } else {
                ++failed;
                EXPECT_TRUE(codes.count(o.exitCode)) << o.exitCode << ": " << o.err;
                EXPECT_NE(o.err.find("error"), std::string::npos) << o.err;
                // Only what fails after the renaming leaves the new one, and that complete.
                const std::string now = read(job.output);
                EXPECT_TRUE(now == old || now == complete) << now.size();
            }
            if (HasFailure() || !result.struck) break;
            ++struck;
        }
        RecordProperty(call + "_struck", static_cast<int>(struck));
        std::printf("%s, %s: %ld calls struck, %ld runs ended with an error\n", job.output.c_str(),
                    call.c_str(), struck, failed);
        EXPECT_GT(struck, 0);
    }
};

TEST_F(FailingCalls, OpenOfARender) { holds(kRender, "open", EMFILE, {3, 4, 5, 6, 7}, 1); }
TEST_F(FailingCalls, OpenOfAConvert) { holds(kConvert, "open", EMFILE, {4, 6}, 1); }
TEST_F(FailingCalls, ReadOfARender) { holds(kRender, "read", EIO, {4, 5, 6}, 1); }
TEST_F(FailingCalls, ReadOfAConvert) { holds(kConvert, "read", EIO, {4, 6}, 1); }

/// Row 12 of the table.
TEST_F(FailingCalls, Threat12WritesOfARender) {
    holds(kRender, "write", ENOSPC, {6}, 1);
    holds(kRender, "write", EIO, {6}, 1);
    holds(kRender, "write", EINTR, {}, 1);
    holds(kRender, "short", 0, {}, 1);
}
TEST_F(FailingCalls, WritesOfAConvert) {
    holds(kConvert, "write", ENOSPC, {6}, 1);
    holds(kConvert, "short", 0, {}, 1);
}
TEST_F(FailingCalls, CloseOfARender) { holds(kRender, "close", EIO, {4, 5, 6}, 1); }
TEST_F(FailingCalls, SyncOfARender) { holds(kRender, "fsync", EIO, {6}, 1); }
TEST_F(FailingCalls, SyncOfAConvert) { holds(kConvert, "fsync", EIO, {6}, 1); }
TEST_F(FailingCalls, RenameOfARender) { holds(kRender, "rename", EACCES, {6}, 1); }
TEST_F(FailingCalls, RenameOfAConvert) { holds(kConvert, "rename", EACCES, {6}, 1); }

/// A film of five frames: what it leaves is complete, and --resume makes the rest. All calls with RT_FAULTS_FULL, else every 7th.
class FailingFilm : public Faults {
protected:
    FailingFilm() { write("film.yaml", cli_tests::kFilm); }

    /// Each file is absent or as a whole run leaves it; `output`, which was there before, may be the old one.
    void holds(const std::string& arguments, const std::string& output, const std::string& call,
               int error, const std::set<int>& codes, long step = isFull() ? 1 : 7) {
        const auto written = [&] {
            std::map<std::string, std::string> contents;
            for (const std::string& name : files())
                if (!name.ends_with(".lock") && !name.ends_with("manifest"))
                    contents[name] = read(name);
            return contents;
        };
        const auto before = files();
        ASSERT_EQ(rt(arguments).exitCode, 0);
        const auto complete = written();
        const auto after = files();
        ASSERT_GE(after.size(), before.size() + 6);
        const std::string old = "the old one";
        long struck = 0, failed = 0;
        for (long n = 1;; n += step) {
            SCOPED_TRACE(arguments + ": " + call + " " + std::to_string(n));
            for (const std::string& name : after)
                if (std::ranges::find(before, name) == before.end())
                    std::filesystem::remove(folder_ / name);
            if (!output.empty()) write(output, old);
            const Struck result = runFailing(arguments, call, n, error);
            const Outcome& o = result.outcome;
            EXPECT_EQ(o.signal, 0) << o.err;
            for (const std::string& name : files())
                EXPECT_TRUE(std::ranges::find(after, name) != after.end()) << name;
            for (const auto& [name, content] : written())
                EXPECT_TRUE(content == complete.at(name) ||
                            (name == output && o.exitCode != 0 && content == old))
                    << name;
            if (o.exitCode != 0) {
                ++failed;
                EXPECT_TRUE(codes.contains(o.exitCode)) << o.exitCode << ": " << o.err;
                EXPECT_NE(o.err.find("error"), std::string::npos) << o.err;
                const Outcome resumed = rt(arguments + " --resume");
                EXPECT_EQ(resumed.exitCode, 0) << resumed.err;
            }
            EXPECT_TRUE(written() == complete);
            EXPECT_EQ(files(), after);
            if (HasFailure() || !result.struck) break;
            ++struck;
        }
        std::printf("film, %s: %ld calls struck, %ld runs ended with an error\n", call.c_str(),
                    struck, failed);
        EXPECT_GT(struck, 0);
    }
    const std::string kEncoded = "render film.yaml --size 16x12 -t 2 -o out.mp4";
};

TEST_F(FailingFilm, Open) { holds(kEncoded, "out.mp4", "open", EMFILE, {3, 4, 5, 6, 7}); }
TEST_F(FailingFilm, Read) { holds(kEncoded, "out.mp4", "read", EIO, {4, 5, 6}); }
TEST_F(FailingFilm, WriteWithoutSpace) { holds(kEncoded, "out.mp4", "write", ENOSPC, {6}); }
TEST_F(FailingFilm, WriteErrors) { holds(kEncoded, "out.mp4", "write", EIO, {6}); }
TEST_F(FailingFilm, InterruptedWrites) { holds(kEncoded, "out.mp4", "write", EINTR, {}); }
TEST_F(FailingFilm, ShortWrites) { holds(kEncoded, "out.mp4", "short", 0, {}); }
TEST_F(FailingFilm, Close) { holds(kEncoded, "out.mp4", "close", EIO, {4, 5, 6}); }
TEST_F(FailingFilm, Sync) { holds(kEncoded, "out.mp4", "fsync", EIO, {6}); }
TEST_F(FailingFilm, Rename) { holds(kEncoded, "out.mp4", "rename", EACCES, {6}); }
TEST_F(FailingFilm, Allocations) {
    RT_NOT_SANITIZED("its allocator is the sanitizer's");
    holds("render film.yaml --size 16x12 -t 2 -o f_%04d.pfm", "", "malloc", ENOMEM, {7},
          isFull() ? 1 : 97);
}

/// Row 15 of the table: what cannot be written whole, or is killed, leaves the old film; exit 0 says that its images were counted.
TEST_F(FailingFilm, Threat15TruncatedVideo) {
    ASSERT_EQ(rt("render film.yaml --size 64x48 -t 2 -o kept.mp4").exitCode, 0);
    const std::string old = "the old one";
    for (const std::string suffix : {"mp4", "avi", "mkv", "webm"}) {
        const std::string output = "out." + suffix, line = "encode kept.frames -o " + output;
        SCOPED_TRACE(line);
        const auto start = std::chrono::steady_clock::now();
        ASSERT_EQ(rt(line).exitCode, 0);
        const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
        const std::string complete = read(output);
        const auto names = files();
        for (long n = 1;; ++n) { // containers have their beginning written at last
            write(output, old);
            const Struck result = runFailing(line, "write", n, ENOSPC);
            EXPECT_EQ(files(), names);
            if (!result.struck) break;
            EXPECT_EQ(result.outcome.exitCode, 6) << result.outcome.err;
            EXPECT_EQ(read(output), old);
            ASSERT_FALSE(HasFailure());
        }
        EXPECT_EQ(read(output), complete);
        cli_tests::RunOptions options;
        const int kills = isFull() ? 50 : 4;
        for (int i = 0; i < kills; ++i) {
            write(output, old);
            options.whileRunning = [&](int child) {
                std::this_thread::sleep_for(whole * (i + 0.5) / kills);
                ::kill(child, SIGKILL);
            };
            rt(line, options);
            const std::string now = read(output);
            EXPECT_TRUE(now == old || now == complete) << now.size();
        }
        ASSERT_EQ(rt(line).exitCode, 0); // sweeps up what the killed ones left
        EXPECT_EQ(files(), names);
    }
}

/// Row 5 of the table: all with RT_FAULTS_FULL, else every 89th.
TEST_F(FailingCalls, Threat05AllocationsOfARender) {
    RT_NOT_SANITIZED("its allocator is the sanitizer's");
    holds(kRender, "malloc", ENOMEM, {7}, isFull() ? 1 : 89);
}
/// The lock's file was left where there was no memory for its name.
TEST_F(FailingCalls, AllocationsOnceTheOutputIsLocked) {
    RT_NOT_SANITIZED("its allocator is the sanitizer's");
    holds(kRender, "malloc", ENOMEM, {7}, 1, ".out.pfm.lock");
}
TEST_F(FailingCalls, AllocationsOfAConvert) {
    RT_NOT_SANITIZED("its allocator is the sanitizer's");
    holds(kConvert, "malloc", ENOMEM, {7}, isFull() ? 1 : 89);
}

} // namespace rt::faults
