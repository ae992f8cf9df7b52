// A plugin that ends the program is named, with the call and the place in the scene (FAULTS row 11).
#include <tests/cli/run.hpp>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <csignal>

#include <unistd.h>

namespace rt::cli_tests {

namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

const char* const kStart =
    "rt: 1\nimage: {width: 8, height: 6}\ncamera: {position: [0, -5, 1], look_at: [0, 0, 0]}\n";

class Crash : public Cli {
protected:
    Outcome render(const std::string& rest, const std::string& module, int threads = 1) const {
        write("crash.yaml", kStart + rest);
        return rt("render crash.yaml -o picture.pfm --threads " + std::to_string(threads) +
                  " --plugin-dir " + RT_TEST_MODULES + "/" + module);
    }
};

struct Fault {
    const char* act;
    const char* described;
};
const Fault kFaults[] = {
    {"address", "a segmentation fault \\(SIGSEGV\\)"},
    {"divide", "a wrong integer operation, such as a division by 0 \\(SIGFPE\\)"},
    {"illegal", "an illegal instruction \\(SIGILL\\)"},
    {"abort", "a call of abort \\(SIGABRT\\)"},
    {"terminate", "a call of abort \\(SIGABRT\\)"},
    {"exit", "a call of exit"},
    {"overflow", "a segmentation fault \\(SIGSEGV\\)"},
};

const std::string kPlace = ", at crasher.rtplugin.so\\+0x[0-9a-f]+ \\(addr2line -Cfe "
                           "/.*/crasher.rtplugin.so 0x[0-9a-f]+\\); nothing is written\n";

} // namespace

TEST_F(Crash, InASerialCallIsLocatedInTheScene) {
    for (const Fault& fault : kFaults) {
        const Outcome outcome =
            render("objects:\n  - crasher: {lower: " + std::string(fault.act) + "}\n", "crasher");
        EXPECT_EQ(outcome.exitCode, 5) << fault.act << outcome.err;
        const std::string last = linesOf(outcome.err).back() + "\n"; // after terminate's own words
        EXPECT_THAT(
            last, MatchesRegex("crash.yaml:5:5: error\\[E0533\\]: shape 'crasher': its code ended "
                               "in " +
                               std::string(fault.described) + " in its function lower" + kPlace));
        EXPECT_FALSE(exists("picture.pfm")) << fault.act;
    }
}

TEST_F(Crash, WhileRenderingIsNamed) {
    for (const int threads : {1, 3})
        for (const Fault& fault : kFaults) {
            const Outcome outcome =
                render("objects:\n  - crasher: {intersect: " + std::string(fault.act) + "}\n",
                       "crasher", threads);
            EXPECT_EQ(outcome.exitCode, 5) << fault.act << outcome.err;
            const std::string last = linesOf(outcome.err).back() + "\n";
            EXPECT_THAT(last,
                        MatchesRegex("rt: error\\[E0533\\]: plugin 'crasher': its code ended in " +
                                     std::string(fault.described) + " in its function intersect" +
                                     kPlace));
            EXPECT_FALSE(exists("picture.pfm")) << fault.act;
        }
}

TEST_F(Crash, IsSaidAsJsonWhereErrorsAre) {
    write("cr\"ash.yaml", kStart + std::string("objects:\n  - crasher: {lower: abort}\n"));
    const Outcome outcome = rt(std::string("render cr\"ash.yaml --json-errors --plugin-dir ") +
                               RT_TEST_MODULES + "/crasher");
    EXPECT_EQ(outcome.exitCode, 5);
    const auto json = nlohmann::json::parse(outcome.err);
    EXPECT_EQ(json["file"], "cr\"ash.yaml");
    EXPECT_EQ(json["line"], 5);
    EXPECT_EQ(json["column"], 5);
    EXPECT_EQ(json["severity"], "error");
    EXPECT_EQ(json["code"], "E0533");
    EXPECT_THAT(json["message"].get<std::string>(),
                testing::StartsWith("shape 'crasher': its code ended in a call of abort (SIGABRT) "
                                    "in its function lower, at crasher.rtplugin.so+0x"));
}

TEST_F(Crash, OfATextureIsNamed) {
    const Outcome outcome =
        render("textures:\n  t: {crash_texture: {}}\nlights:\n  - point: {position: [0, -5, 5]}\n"
               "objects:\n  - sphere: {radius: 1, material: {texture: t, diffuse: 1}}\n",
               "crash_texture");
    EXPECT_EQ(outcome.exitCode, 5) << outcome.err;
    EXPECT_THAT(
        outcome.err,
        HasSubstr("error[E0533]: plugin 'crash_texture': its code ended in a segmentation fault "
                  "(SIGSEGV) in its function evaluate, at crash_texture.rtplugin.so+0x"));
}

TEST_F(Crash, OfRtItselfBlamesNoPlugin) {
    RunOptions options;
    options.whileRunning = [](int processId) {
        ::usleep(500'000); // long after the handler is there, long before the picture is
        ::kill(processId, SIGABRT);
    };
    write("long.yaml", kStart + std::string("objects:\n  - sphere: {radius: 1}\n"));
    const Outcome outcome =
        rt("render long.yaml -o picture.png --size 1600x1200 --antialias grid=16", options);
    EXPECT_EQ(outcome.exitCode, 70);
    EXPECT_EQ(outcome.err,
              "rt: error: internal error: a call of abort (SIGABRT); please report it\n");
    EXPECT_FALSE(exists("picture.png"));
}

} // namespace rt::cli_tests
