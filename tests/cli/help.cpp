// Help, version and completion: what a stranger reads first, and whether it is true.
#include <tests/cli/run.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <regex>

namespace rt::cli_tests {

namespace {

const std::vector<std::string> kCommands{
    "render",  "encode", "farm",    "task",    "view", "bench",   "check",      "info",    "schema",
    "convert", "mesh",   "compare", "plugins", "new",  "explain", "completion", "version", "help"};

class Help : public Cli {
protected:
    /// The commands of the help's examples, without their comments.
    std::vector<std::string> examplesOf(const std::string& help) const {
        std::vector<std::string> examples;
        bool within = false;
        for (const std::string& line : linesOf(help)) {
            if (within)
                examples.push_back(std::regex_replace(line.substr(2), std::regex(" +#.*"), ""));
            if (line == "Examples:") within = true;
        }
        return examples;
    }
};

} // namespace

TEST_F(Help, EachCommandHasOne) {
    for (const std::string& command : kCommands) {
        SCOPED_TRACE(command);
        const Outcome outcome = rt(command + " --help");
        EXPECT_EQ(outcome.exitCode, 0);
        EXPECT_EQ(outcome.err, "");
        EXPECT_EQ(rt(command + " -h").out, outcome.out);
        EXPECT_EQ(rt("help " + command).out, outcome.out);
        const auto lines = linesOf(outcome.out);
        ASSERT_GT(lines.size(), 6u);
        EXPECT_TRUE(std::regex_match(lines[0], std::regex("[A-Z].*\\.")))
            << "begins with a sentence: " << lines[0];
        EXPECT_EQ(examplesOf(outcome.out).size(), 3u) << "ends with three examples";
        EXPECT_TRUE(outcome.out.ends_with("\n") && !outcome.out.ends_with("\n\n"));
        EXPECT_EQ(rt(command + " --help=1").err, "rt " + command +
                                                     ": error: --help takes no value; see rt " +
                                                     command + " --help\n");
    }
}

TEST_F(Help, OfTheProgramHasTheCommandsAndTheExitCodes) {
    const Outcome outcome = rt("--help");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(rt("-h").out, outcome.out);
    EXPECT_EQ(rt("help").out, outcome.out);
    for (const std::string& command : kCommands)
        EXPECT_NE(outcome.out.find("\n  " + command + " "), std::string::npos) << command;
    for (const char* const code :
         {" 0  done", " 1  the pictures differ", " 2  wrong command line", " 3  the scene",
          " 4  an input", " 5  a plugin", " 6  an output", " 7  a limit", " 8  there is no display",
          " 70  internal", " 75  try", "130  interrupted", "143  terminated"})
        EXPECT_NE(outcome.out.find(code), std::string::npos) << code;
}

TEST_F(Help, FitsInto80Columns) {
    for (const std::string& command : kCommands)
        for (const std::string& line : linesOf(rt("help " + command).out))
            EXPECT_LE(line.size(), 80u) << line;
    for (const std::string& line : linesOf(rt("--help").out)) EXPECT_LE(line.size(), 80u) << line;
}

TEST_F(Help, EveryExampleRuns) {
    write("Scene.inf", kOldScene);
    write("keys.txt", "wait\n");
    write("Other.inf", kOldScene);
    write("in.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("in.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                    "y\nproperty float "
                    "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 "
                    "0\n1 0 0\n0 1 0\n3 0 1 2\n");
    std::filesystem::create_directories(folder_ / "new");
    std::filesystem::create_directories(folder_ / "plugins");
    std::filesystem::create_directories(folder_ / ".local/share/bash-completion/completions");
    std::filesystem::create_directories(folder_ / ".zfunc");
    std::filesystem::create_directories(folder_ / ".config/fish/completions");
    write("b.yaml", kThreeSpheres);
    write("a.yaml", kThreeSpheres);
    write("film.yaml", kFilm);
    rt("render film.yaml -o film.mp4");
    rt("render film.yaml -o frame_%04d.png");
    rt("render scene.yaml -o a.png");
    rt("render scene.yaml -o b.png --set render.depth=0");
    for (const std::string& command : kCommands)
        for (const std::string& example : examplesOf(rt("help " + command).out)) {
            std::filesystem::remove(folder_ / "Scene.yaml");
            const Outcome outcome = shell(example);
            const bool window = command == "view" && example.find("--script") == std::string::npos;
            EXPECT_EQ(outcome.exitCode, window                 ? 8
                                        : command == "compare" ? 1
                                                               : 0)
                << example << "\n"
                << outcome.err;
        }
    std::filesystem::remove(folder_ / "Scene.yaml");
    for (const std::string& example : examplesOf(rt("--help").out)) {
        const Outcome outcome = shell(example);
        EXPECT_EQ(outcome.exitCode, 0) << example << "\n" << outcome.err;
    }
}

TEST_F(Help, IsTheSameInsideAPipeAndOnATerminal) {
    RunOptions terminal;
    terminal.terminal = true;
    EXPECT_EQ(rt("--help").out, rt("--help", terminal).out);
}

using Version = Cli;

TEST_F(Version, TellsHowTheProgramWasBuilt) {
    const Outcome outcome = rt("version");
    EXPECT_EQ(outcome.exitCode, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_EQ(rt("--version").out, outcome.out);
    const std::vector<std::string> expected{
        "rt \\d+\\.\\d+\\.\\d+",
        "commit +[0-9a-f]{7,40}(-dirty)?|commit +unknown",
        "build +\\w+",
        "compiler +\\w+ [\\d.]+",
        "libraries +oneTBB [\\d.]+, yaml-cpp [\\d.]+, CLI11 [\\d.]+, nlohmann-json [\\d.]+",
        "plugin ABI +\\d+\\.\\d+",
        "SIMD +(baseline|avx2|avx512)",
        "threads +[1-9]\\d*",
        "plugins +.*/lib/rt/plugins"};
    const auto lines = linesOf(outcome.out);
    ASSERT_EQ(lines.size(), expected.size()) << outcome.out;
    for (std::size_t i = 0; i < lines.size(); ++i)
        EXPECT_TRUE(std::regex_match(lines[i], std::regex(expected[i]))) << lines[i];
}

class Completion : public Help {
protected:
    /// What bash would offer for a line whose last word is being completed.
    std::vector<std::string> offered(const std::string& lineOfWords) const {
        const Outcome outcome = shell(
            "source <(rt completion bash); compopt() { :; }; COMP_WORDS=(" + lineOfWords +
            "); COMP_CWORD=$(( ${#COMP_WORDS[@]} - 1 )); _rt; printf '%s\\n' \"${COMPREPLY[@]}\"");
        EXPECT_EQ(outcome.exitCode, 0);
        EXPECT_EQ(outcome.err, "");
        return words(outcome.out);
    }
};

TEST_F(Completion, OfBashOffersWhatTheParserTakes) {
    using Words = std::vector<std::string>;
    write("old.inf", "");
    EXPECT_EQ(offered("rt re"), Words{"render"});
    EXPECT_EQ(offered("rt c"), (Words{"check", "convert", "compare", "completion"}));
    EXPECT_EQ(offered("rt render --s"),
              (Words{"--size", "--set", "--sandbox", "--shade", "--strict", "--stats"}));
    EXPECT_EQ(offered("rt -q render --pro"), Words{"--progress"});
    EXPECT_EQ(offered("rt render --json"), Words{"--json-errors"});
    EXPECT_EQ(offered("rt render --shade ''"), (Words{"full", "normals", "depth", "id", "cost"}));
    EXPECT_EQ(offered("rt render --shade = n"), Words{"normals"});
    EXPECT_EQ(offered("rt render ''"), Words{"scene.yaml"});
    EXPECT_EQ(offered("rt convert ''"), Words{"old.inf"});
    EXPECT_EQ(offered("rt completion ''"), (Words{"bash", "zsh", "fish"}));
    EXPECT_EQ(offered("rt help pl"), Words{"plugins"});
    EXPECT_EQ(offered("rt render scene.yaml -t ''"), Words{});
}

TEST_F(Completion, KnowsEveryOptionOfTheHelp) {
    static const std::regex option(R"(^ {2,6}(?:-(\w), )?--([\w-]+))");
    for (const char* const name : {"bash", "zsh", "fish"}) {
        const Outcome outcome = rt(std::string("completion ") + name);
        EXPECT_EQ(outcome.exitCode, 0);
        EXPECT_EQ(outcome.err, "");
        for (const std::string& command : kCommands) {
            EXPECT_NE(outcome.out.find(command), std::string::npos);
            for (const std::string& line : linesOf(rt("help " + command).out)) {
                std::smatch match;
                if (!std::regex_search(line, match, option)) continue;
                const std::string longName = match[2];
                EXPECT_NE(outcome.out.find(std::string(name) == "fish" ? "-l " + longName
                                                                       : "--" + longName),
                          std::string::npos)
                    << name << " " << line;
            }
        }
    }
}

} // namespace rt::cli_tests
