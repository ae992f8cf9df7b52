// Every command that a guide shows runs.
//
// A guide is a Markdown file. A fence after `<!-- file: NAME -->` is a file of the reader's folder; in a fence of `sh` each line
// is a command, run in order, that succeeds. Commands that build or install are run by tests of their own.
#include <tests/cli/run.hpp>

#include <fstream>
#include <iterator>
#include <sstream>

namespace rt::cli_tests {
namespace {

std::string textOf(const std::filesystem::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

bool isOurs(const std::string& command) {
    return command.starts_with("rt ") || command.starts_with("cd ") ||
           command.starts_with("mkdir ") || command.starts_with("cp ");
}

} // namespace

class Guides : public Cli, public testing::WithParamInterface<const char*> {};

TEST_P(Guides, EveryCommandRuns) {
    std::istringstream guide(textOf(std::filesystem::path(RT_SOURCE_DIR) / GetParam()));
    const std::string kFile = "<!-- file: ";
    std::string name, script;
    int commands = 0;
    for (std::string line; std::getline(guide, line);) {
        if (line.starts_with(kFile))
            name = line.substr(kFile.size(), line.find(" -->") - kFile.size());
        if (!line.starts_with("```")) continue;
        const bool isShell = line == "```sh";
        std::string text;
        for (std::string inner; std::getline(guide, inner) && inner != "```";) {
            text += inner + "\n";
            if (!isShell) continue;
            ASSERT_TRUE(isOurs(inner)) << inner;
            script += inner + "\n";
            ++commands;
        }
        if (!isShell && !name.empty()) write(name, text);
        name.clear();
    }
    ASSERT_GT(commands, 0);
    const Outcome outcome = shell("set -e\n" + script);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
}

INSTANTIATE_TEST_SUITE_P(Tree, Guides,
                         testing::Values("converters/README.md", "converters/README.zh.md",
                                         "scenes/FROM_POVRAY.md", "core/octree/README.md",
                                         "plugins/loaders/README.md"),
                         [](const auto& tested) {
                             std::string name;
                             for (const char c : std::string(tested.param))
                                 name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
                             return name;
                         });

} // namespace rt::cli_tests
