// Habits that a compiler does not hold: the top level, tolerances, reachability, enabled tests, names.
#include <tests/structure/tree.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <regex>
#include <set>

namespace rt::structure {

namespace {

namespace fs = std::filesystem;

/// A literal with a negative exponent: decimal (1e-6), or hexadecimal other than an exact power of
/// two (0x1.8p-20), which scales and counts rounding units but is seldom guessed.
const std::regex& negativeExponent() {
    static const std::regex pattern(
        R"((^|[^\w.])((\d[\d']*\.?[\d']*|\.\d[\d']*)[eE]-\d+|0[xX](?!1\.?[pP])[\da-fA-F.']+[pP]-\d+))");
    return pattern;
}

/// The code with every line blanked that asserts nothing.
std::string assertionsOf(const std::string& code) {
    std::string kept;
    for (std::size_t from = 0; from < code.size();) {
        const std::size_t to = std::min(code.find('\n', from), code.size());
        const std::string line = code.substr(from, to - from);
        for (const char* const word : {"EXPECT_", "ASSERT_"})
            if (line.find(word) != std::string::npos) kept += line;
        kept += '\n';
        from = to + 1;
    }
    return kept;
}

std::vector<std::string> linesWith(const std::regex& pattern, const std::string& code) {
    std::vector<std::string> found;
    int line = 1;
    for (std::size_t from = 0; from <= code.size(); ++line) {
        const std::size_t to = std::min(code.find('\n', from), code.size());
        std::smatch match;
        const std::string text = code.substr(from, to - from);
        if (std::regex_search(text, match, pattern))
            found.push_back(std::to_string(line) + ": " + match[2].str());
        from = to + 1;
    }
    return found;
}

} // namespace

TEST(TopLevel, IsExactlyWhatTheProjectFixed) {
    const std::set<std::string> needed{"CMakeLists.txt", "LICENSE", "converters", "core", "dev",
                                       "formats",        "plugins", "scenes",     "tests"};
    const std::set<std::string> allowed{"CHANGELOG.md", "README.md",
                                        "showcase.png"}; // what the README's first command draws
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(root())) {
        const std::string name = entry.path().filename().string();
        if (name[0] == '.' || name.starts_with("build") || name == "compile_commands.json" ||
            allowed.count(name))
            continue;
        found.insert(name);
    }
    EXPECT_EQ(found, needed);
}

TEST(Tolerances, HaveTwoHomes) {
    // Rule 5: anything small that decides something is derived in one of these two files. Coefficients
    // of polynomials decide nothing, but they live in the one file that approximates functions. A small
    // number in a test's scene is data; one in an assertion is a tolerance.
    const std::set<std::string> homes{"core/numeric/rounding.hpp", "core/numeric/elementary.cpp",
                                      "tests/tolerance.hpp"};
    for (const SourceFile& file : sources()) {
        if (homes.count(file.path)) continue;
        std::string code = codeOf(file.text);
        if (file.path.starts_with("tests/")) code = assertionsOf(code);
        for (const std::string& line : linesWith(negativeExponent(), code))
            ADD_FAILURE() << file.path << ":" << line
                          << ": a tolerance belongs into core/numeric/rounding.hpp or "
                             "tests/tolerance.hpp";
    }
}

TEST(Tolerances, TheLintSeesThem) {
    const auto caught = [](const char* text) {
        return !linesWith(negativeExponent(), codeOf(text)).empty();
    };
    for (const char* const text : {"x < 1e-6", "x<1.5E-3f", ".5e-7", "1.e-4", "1'000.0e-9",
                                   "0x3p-20", "0x1.8P-3", "(1e-6)", "a-1e-2"})
        EXPECT_TRUE(caught(text)) << text;
    for (const char* const text : {"1e6", "// 1e-6", "/* 1e-6 */", "\"1e-6\"", "R\"(1e-6)\"",
                                   "name1e-6", "e-6", "1-6", "0xe-6", "'1' - 6", "0x1p-20"})
        EXPECT_FALSE(caught(text)) << text;
}

TEST(Sources, EveryUnitIsCompiled) {
    const std::string commands = readFile(fs::path(RT_BINARY_DIR) / "compile_commands.json");
    ASSERT_FALSE(commands.empty());
    for (const SourceFile& file : sources())
        if (file.path.ends_with(".cpp") || file.path.ends_with(".c")) {
            EXPECT_NE(commands.find((root() / file.path).string() + "\""), std::string::npos)
                << file.path << " is in no target";
        }
}

TEST(Sources, EveryHeaderIsIncluded) {
    std::set<std::string> included;
    for (const SourceFile& file : sources())
        for (const Include& include : includesOf(file)) {
            if (include.quoted)
                included.insert(file.path.substr(0, file.path.rfind('/') + 1) + include.target);
            included.insert(include.target.starts_with("rt/") ? "core/include/" + include.target
                                                              : include.target);
        }
    for (const SourceFile& file : sources())
        if (file.path.ends_with(".hpp") || file.path.ends_with(".h") ||
            file.path.ends_with(".inl")) {
            EXPECT_TRUE(included.count(file.path)) << file.path << " is included by nothing";
        }
}

TEST(Sources, HeadersAreGuarded) {
    for (const SourceFile& file : sources())
        if (file.path.ends_with(".hpp")) {
            EXPECT_NE(file.text.find("#pragma once"), std::string::npos) << file.path;
        }
}

TEST(Sources, NamesAreSnakeCase) {
    static const std::regex snake(R"([a-z][a-z0-9_]*\.(cpp|hpp|h|c|inl))");
    for (const SourceFile& file : sources())
        EXPECT_TRUE(std::regex_match(file.path.substr(file.path.rfind('/') + 1), snake))
            << file.path;
}

TEST(Sources, NothingIsSwitchedOff) {
    static const std::regex off(R"((^)(\s*#\s*if\s+0\b))");
    for (const SourceFile& file : sources())
        for (const std::string& line : linesWith(off, codeOf(file.text)))
            ADD_FAILURE() << file.path << ":" << line;
}

TEST(Tests, AreAllEnabled) {
    static const std::regex disabled(R"((\W)(DISABLED_\w+))");
    static const std::regex silentSkip(R"((\W)(GTEST_SKIP\(\)\s*;))");
    for (const SourceFile& file : sources()) {
        if (!file.path.starts_with("tests/")) continue;
        for (const std::regex* pattern : {&disabled, &silentSkip})
            for (const std::string& line : linesWith(*pattern, codeOf(file.text)))
                ADD_FAILURE() << file.path << ":" << line;
    }
}

/// `./dev package try` tried the package "debootstrap" where that had to be installed first.
TEST(Dev, InstallKeepsItsCallersVariables) {
    const std::string command =
        "bash -c 'set -eu; source <(sed -n \"/^install()/,/^}/p\" \"" + (root() / "dev").string() +
        "\"); dpkg-query() { echo install ok installed; }; package=rt.deb; missing=none; install "
        "first second; [[ $package == rt.deb && $missing == none ]]'";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
}

} // namespace rt::structure
