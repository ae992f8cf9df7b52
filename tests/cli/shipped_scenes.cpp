// Shipped scenes against the schema that editors complete from, judged by an independent validator.
#include <tests/cli/run.hpp>

#include <fstream>
#include <iterator>

namespace rt::cli_tests {

namespace {

const std::filesystem::path kScenes = std::filesystem::path(RT_SOURCE_DIR) / "scenes";

std::string contents(const std::filesystem::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// The one plugin that is built only where its library is.
bool hasAssimp() {
    return std::filesystem::exists(std::filesystem::path(RT_PLUGINS) / "assimp.rtplugin.so");
}

std::vector<std::string> shippedScenes() {
    std::vector<std::string> paths;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(kScenes))
        if (entry.path().extension() == ".yaml" && (hasAssimp() || entry.path().stem() != "assimp"))
            paths.push_back(entry.path());
    return paths;
}

} // namespace

using ShippedScenes = Cli;

/// `build/bin/rt schema > scenes/rt.schema.json` brings it up to date.
TEST_F(ShippedScenes, TheSchemaBesideThemIsThatOfTheProgram) {
    EXPECT_TRUE(rt("schema").out == contents(kScenes / "rt.schema.json"));
}

TEST_F(ShippedScenes, EachNamesTheSchemaForEditorsInItsFirstLine) {
    for (const std::string& path : shippedScenes()) {
        SCOPED_TRACE(path);
        const std::string first = linesOf(contents(path)).at(0);
        const std::string modeline = "# yaml-language-server: $schema=";
        ASSERT_TRUE(first.starts_with(modeline));
        EXPECT_TRUE(std::filesystem::exists(std::filesystem::path(path).parent_path() /
                                            first.substr(modeline.size())));
    }
}

TEST_F(ShippedScenes, EachIsValidByTheSchemaAndByCheck) {
    const std::string validator = "import json, sys, yaml, jsonschema\n"
                                  "v = jsonschema.Draft7Validator(json.load(open(sys.argv[1])))\n"
                                  "bad = 0\n"
                                  "for path in sys.argv[2:]:\n"
                                  "    for e in v.iter_errors(yaml.safe_load(open(path))):\n"
                                  "        bad = 1; print(path, list(e.path), e.message)\n"
                                  "sys.exit(bad)\n";
    RunOptions python;
    python.program = "/usr/bin/python3";
    if (run({"-c", "import jsonschema, yaml"}, python).exitCode != 0)
        GTEST_SKIP() << "needs python3-jsonschema and python3-yaml";
    std::vector<std::string> arguments{"-c", validator, kScenes / "rt.schema.json"};
    const auto scenes = shippedScenes();
    ASSERT_FALSE(scenes.empty());
    arguments.insert(arguments.end(), scenes.begin(), scenes.end());
    const Outcome outcome = run(arguments, python);
    EXPECT_EQ(outcome.exitCode, 0) << outcome.out << outcome.err;

    std::vector<std::string> check{"check"};
    check.insert(check.end(), scenes.begin(), scenes.end());
    const Outcome checked = run(check);
    EXPECT_EQ(checked.exitCode, 0) << checked.err;
}

} // namespace rt::cli_tests
