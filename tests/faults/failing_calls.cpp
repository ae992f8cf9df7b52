// Threats 5 and 12: every single call that the machine can refuse is refused in turn.
#include <tests/faults/faults.hpp>

#include <cerrno>
#include <set>

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
               long step) {
        ASSERT_EQ(rt(job.arguments).exitCode, 0);
        const std::string complete = read(job.output), old = "the old one";
        const auto names = files();
        long struck = 0, failed = 0;
        for (long n = 1;; n += step) {
            SCOPED_TRACE(job.arguments + ": " + call + " " + std::to_string(n));
            write(job.output, old);
            const Struck result = runFailing(job.arguments, call, n, error);
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

/// Row 5 of the table: all with RT_FAULTS_FULL, else every 89th.
TEST_F(FailingCalls, Threat05AllocationsOfARender) {
    holds(kRender, "malloc", ENOMEM, {7}, isFull() ? 1 : 89);
}
TEST_F(FailingCalls, AllocationsOfAConvert) {
    holds(kConvert, "malloc", ENOMEM, {7}, isFull() ? 1 : 89);
}

} // namespace rt::faults
