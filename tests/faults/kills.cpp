// Threat 13: after a kill at any time the output is the old file or the complete new one. A film's frames: tests/cli/film.cpp.
#include <tests/faults/faults.hpp>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

namespace rt::faults {

using cli_tests::RunOptions;

/// 200 with RT_FAULTS_FULL, else 25.
TEST_F(Faults, Threat13KillsOfAStill) {
    const std::string line = "render scene.yaml --size 320x240 -o a.pfm";
    const auto whole = rt(line);
    ASSERT_EQ(whole.exitCode, 0);
    const std::string complete = read("a.pfm");
    std::minstd_rand random(1);
    int killed = 0, kept = 0, replaced = 0;
    for (int i = 0; killed < (isFull() ? 200 : 25); ++i) {
        ASSERT_LT(i, 1000) << "the moments lie outside of the run";
        const std::string old = "picture " + std::to_string(i);
        write("a.pfm", old);
        RunOptions options;
        options.whileRunning = [&](int child) { // some time of the run, its end included
            const double wait =
                whole.seconds * 1.1 * static_cast<double>(random()) / std::minstd_rand::max();
            std::this_thread::sleep_for(std::chrono::duration<double>(wait));
            ::kill(child, SIGKILL);
        };
        const auto outcome = rt(line, options);
        killed += outcome.signal == SIGKILL;
        const std::string now = read("a.pfm");
        EXPECT_TRUE(now == old || now == complete) << now.size();
        ++(now == old ? kept : replaced);
    }
    std::printf("%d of %d runs killed: %d old, %d new\n", killed, kept + replaced, kept, replaced);
    ASSERT_EQ(rt(line).exitCode, 0); // sweeps up what the killed ones left
    EXPECT_EQ(files(), std::vector<std::string>{"a.pfm"});
    EXPECT_EQ(read("a.pfm"), complete);
}

} // namespace rt::faults
