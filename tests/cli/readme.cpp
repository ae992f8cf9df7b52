// The README shows what works.
#include <tests/cli/run.hpp>

#include <fstream>
#include <iterator>

namespace rt::cli_tests {

namespace {

std::string source(const std::string& name) {
    std::ifstream file(std::string(RT_SOURCE_DIR) + "/" + name);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// What stands between the first line that opens with ```language and the next ```.
std::string block(const std::string& text, const std::string& language) {
    const std::string fence = "```" + language + "\n";
    const std::size_t start = text.find(fence);
    if (start == std::string::npos) return "";
    return text.substr(start + fence.size(),
                       text.find("```", start + fence.size()) - start - fence.size());
}

} // namespace

using Readme = Cli;

TEST_F(Readme, ItsSceneRenders) {
    const std::string scene = block(source("README.md"), "yaml");
    ASSERT_NE(scene, "");
    write("readme.yaml", scene);
    const Outcome outcome = rt("render readme.yaml --size 32x24");
    EXPECT_EQ(outcome.exitCode, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
}

TEST_F(Readme, ItsExitCodesAreThoseOfTheHelp) {
    const std::string codes = block(source("README.md"), "text");
    ASSERT_NE(codes, "");
    EXPECT_NE(rt("--help").out.find("\nExit codes:\n" + codes), std::string::npos) << codes;
}

/// The committed plot has the dots, and their flags, that rt bench draws today.
TEST_F(Readme, ItsPlotIsOneOfRtBench) {
    ASSERT_NE(source("README.md").find("(scenes/showcase_b.svg)"), std::string::npos);
    ASSERT_NE(source("README.md")
                  .find("`rt bench scenes/showcase.yaml --panels B --threads 1 --rounds 5`"),
              std::string::npos);
    write("scene.yaml", block(source("README.md"), "yaml"));
    ASSERT_EQ(
        rt("bench scene.yaml --panels B --threads 1 -s 16x12 --rounds 1 --reference 3").exitCode,
        0);
    const auto dotsOf = [](const std::string& svg) {
        std::vector<std::string> dots; // name and flags
        for (std::size_t at = 0; (at = svg.find("<title>", at)) != std::string::npos; ++at)
            dots.push_back(svg.substr(at, svg.find('\n', svg.find('\n', at) + 1) - at));
        return dots;
    };
    const auto dots = dotsOf(source("scenes/showcase_b.svg"));
    EXPECT_EQ(dots.size(), 9u);
    EXPECT_EQ(dots, dotsOf(read("bench/scene_b.svg")));
}

/// tests/plugin_host/consumer builds the guide's.
TEST_F(Readme, ItsPluginIsTheGuides) {
    const std::string plugin = block(source("README.md"), "cpp");
    ASSERT_NE(plugin, "");
    EXPECT_EQ(plugin, block(source("plugins/README.md"), "cpp"));
}

} // namespace rt::cli_tests
