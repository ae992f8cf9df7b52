// plugins/TYPES.md says of every shipped plugin what its rows say. RT_WRITE_REFERENCES=1 writes it.
#include <tests/cli/run.hpp>

#include <nlohmann/json.hpp>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace rt::cli_tests {
namespace {

using Json = nlohmann::json;

/// A bar would end the cell.
std::string cell(std::string text) {
    for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2)
        text.insert(at, "\\");
    return text;
}

std::string section(const Json& plugin) {
    const std::string name = plugin["name"];
    std::string text = "### " + name + "\n\n![" + name + "](../scenes/plugins/" + name +
                       ".png)\n\n" + plugin["doc"].get<std::string>() + "\n\n";
    if (plugin.contains("extensions")) text += "Files: " + cell(plugin["extensions"]) + "\n\n";
    if (!plugin["parameters"].empty()) text += "| key | value | default | |\n|---|---|---|---|\n";
    for (const Json& row : plugin["parameters"]) {
        std::string value = row["type"];
        if (row.contains("unit")) value += ", " + row["unit"].get<std::string>();
        if (row.contains("limits")) value += ", " + row["limits"].get<std::string>();
        std::string otherwise = "required";
        if (!row["required"]) {
            const std::string fallback = row["default"];
            otherwise = fallback.empty() ? "" : "`" + fallback + "`";
        }
        text += "| `" + row["name"].get<std::string>() + "` | " + cell(value) + " | " + otherwise +
                " | " + cell(row["doc"]) + " |\n";
    }
    return text + "\n```yaml\n" + plugin["example"].get<std::string>() + "```\n\n";
}

} // namespace

using TypesPage = Cli;

TEST_F(TypesPage, SaysWhatTheRowsSay) {
    const Outcome outcome = rt("plugins --json");
    ASSERT_EQ(outcome.exitCode, 0) << outcome.err;
    const Json plugins = Json::parse(outcome.out);
    std::string page =
        "# The types that rt ships\n\nMade of the rows that parse them, as `rt plugins TYPE` shows "
        "them; a test holds this page up to date. Objects have more keys, such as `material` and "
        "`translate`: [LANGUAGE.md](../scenes/LANGUAGE.md). Each picture's scene lies beside "
        "it.\n\n";
    bool hasAssimp = false;
    for (const char* const kind : {"shape", "texture", "loader"}) {
        page += "## " + std::string(kind) + "s\n\n";
        for (const Json& plugin : plugins) {
            ASSERT_FALSE(plugin.contains("refused")) << plugin["refused"];
            hasAssimp = hasAssimp || plugin["name"] == "assimp";
            if (plugin["kind"] == kind) page += section(plugin);
        }
    }
    if (!hasAssimp) GTEST_SKIP() << "the page has the loader 'assimp', which is not built here";
    page.pop_back();
    const std::string path = std::string(RT_SOURCE_DIR) + "/plugins/TYPES.md";
    if (std::getenv("RT_WRITE_REFERENCES") != nullptr) std::ofstream(path) << page;
    std::ifstream file(path);
    EXPECT_TRUE(std::string(std::istreambuf_iterator<char>(file), {}) == page);
}

} // namespace rt::cli_tests
