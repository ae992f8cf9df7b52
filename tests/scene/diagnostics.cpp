// How messages look, which suggestions are made, and that every code is explained.
#include <core/scene/diagnostic.hpp>
#include <core/scene/explanations.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>

namespace rt::scene {
namespace {

Diagnostic at(const std::string& path, const std::string& text, std::uint32_t line,
              std::uint32_t column) {
    Diagnostic diagnostic;
    diagnostic.location.source = std::make_shared<Source>(Source{path, text});
    diagnostic.location.line = line;
    diagnostic.location.column = column;
    return diagnostic;
}

std::string shown(const std::string& text, std::uint32_t line, std::uint32_t column) {
    Diagnostic diagnostic = at("s.yaml", text, line, column);
    diagnostic.code = Code{301};
    diagnostic.message = "wrong";
    return format(diagnostic, false);
}

TEST(Diagnostic, PointsBelowWideCharactersTabsAndEscapes) {
    EXPECT_EQ(shown("月: x\n", 1, 6),
              "s.yaml:1:6: error[E0301]: wrong\n    1 | 月: x\n      |     ^\n");
    EXPECT_EQ(shown("e\xCC\x81: x\n", 1, 6),
              "s.yaml:1:6: error[E0301]: wrong\n    1 | e\xCC\x81: x\n      |    ^\n");
    EXPECT_EQ(shown("a:\tx\n", 1, 4),
              "s.yaml:1:4: error[E0301]: wrong\n    1 | a:    x\n      |       ^\n");
    EXPECT_EQ(shown("\x1b[31m\xff\xE2\x80\xAE: x\n", 1, 12),
              "s.yaml:1:12: error[E0301]: wrong\n    1 | \\x1b[31m\\xff\\u{202e}: x\n      |       "
              "                ^\n");
}

TEST(Diagnostic, CutsLongLinesAroundTheCaret) {
    const std::string line = std::string(100, 'a') + "X" + std::string(100, 'b');
    EXPECT_EQ(shown(line + "\n", 1, 101), "s.yaml:1:101: error[E0301]: wrong\n"
                                          "    1 | …" +
                                              std::string(39, 'a') + "X" + std::string(38, 'b') +
                                              "…\n"
                                              "      | " +
                                              std::string(40, ' ') + "^\n");
    EXPECT_EQ(shown(std::string(80, 'a') + "\n", 1, 1),
              "s.yaml:1:1: error[E0301]: wrong\n    1 | " + std::string(80, 'a') + "\n      | ^\n");
    const std::string wide = shown(
        [] {
            std::string text;
            for (int i = 0; i < 200; ++i) text += "月";
            return text;
        }(),
        1, 301);
    EXPECT_NE(wide.find("    1 | …月"), std::string::npos) << wide;
    EXPECT_EQ(shown(std::string(10'000'000, 'a'), 1, 5'000'000).size(),
              shown(line, 1, 101).size() + 4);
}

TEST(Diagnostic, StandsAtLineEndsAndWholeFiles) {
    EXPECT_EQ(shown("abc\r\n", 1, 4),
              "s.yaml:1:4: error[E0301]: wrong\n    1 | abc\n      |    ^\n");
    EXPECT_EQ(shown("abc", 0, 0), "s.yaml: error[E0301]: wrong\n");
    EXPECT_EQ(shown("abc", 7, 1), "s.yaml:7:1: error[E0301]: wrong\n");
    Diagnostic nowhere;
    nowhere.code = Code{703};
    nowhere.message = "out of memory";
    EXPECT_EQ(format(nowhere, false), "error[E0703]: out of memory\n");
    nowhere.severity = Severity::warning;
    EXPECT_EQ(format(nowhere, false), "warning: out of memory\n");
    EXPECT_EQ(shown("a\n", 123456, 1), "s.yaml:123456:1: error[E0301]: wrong\n");
}

TEST(Diagnostic, EscapesThePath) {
    Diagnostic diagnostic = at("a\x1b[2J\n.yaml", "", 0, 0);
    diagnostic.severity = Severity::note;
    diagnostic.message = "hm";
    EXPECT_EQ(format(diagnostic, false), "a\\x1b[2J\\n.yaml: note: hm\n");
}

TEST(Diagnostic, IsPaintedOnRequest) {
    Diagnostic diagnostic = at("s.yaml", "ab\n", 1, 2);
    diagnostic.code = Code{301};
    diagnostic.message = "wrong";
    diagnostic.suggestion = "fix it";
    EXPECT_EQ(format(diagnostic, true),
              "\x1b[1ms.yaml:1:2:\x1b[0m \x1b[1;31merror[E0301]:\x1b[0m wrong; fix it\n"
              "    1 | ab\n      |  \x1b[1;32m^\x1b[0m\n");
}

TEST(Diagnostic, IsALineOfJson) {
    Diagnostic diagnostic = at("s\n.yaml", "ab\n", 1, 2);
    diagnostic.code = Code{301};
    diagnostic.message = "say \"hi\" \xff";
    diagnostic.suggestion = "fix it";
    EXPECT_EQ(
        formatJson(diagnostic),
        "{\"file\":\"s\\n.yaml\",\"line\":1,\"column\":2,\"severity\":\"error\",\"code\":\"E0301\","
        "\"message\":\"say \\\"hi\\\" \xEF\xBF\xBD\",\"suggestion\":\"fix it\"}");
    Diagnostic note;
    note.severity = Severity::note;
    note.message = "hm";
    EXPECT_EQ(formatJson(note), "{\"severity\":\"note\",\"message\":\"hm\"}");
}

TEST(Diagnostics, KeepTwentyErrorsAndEveryNote) {
    Diagnostics diagnostics;
    EXPECT_EQ(diagnostics.exitCode(), 0);
    for (int i = 0; i < 30; ++i) {
        diagnostics.error(Code{i == 0 ? std::uint16_t{710} : std::uint16_t{301}}, {}, "e");
        diagnostics.note({}, "n");
    }
    EXPECT_EQ(diagnostics.all().size(), 50u);
    EXPECT_EQ(diagnostics.errorCount(), 30u);
    EXPECT_EQ(diagnostics.exitCode(), 7);
    Diagnostics sum;
    sum.error(Code{401}, {}, "first");
    sum.add(diagnostics);
    EXPECT_EQ(sum.errorCount(), 31u);
    EXPECT_EQ(sum.exitCode(), 4);
    EXPECT_EQ(sum.all().size(), Diagnostics::kMaxErrors + 30);
}

TEST(Suggestions, AreNearAndNotSilly) {
    const std::vector<std::string> keys{"radius", "center", "material", "up", "field_of_view"};
    EXPECT_EQ(nearest("radus", keys), "radius");
    EXPECT_EQ(nearest("raduis", keys), "radius"); // neighbours swapped
    EXPECT_EQ(nearest("centre", keys), "center"); // and again
    EXPECT_EQ(nearest("fieldOfView", keys), "");  // four changes
    EXPECT_EQ(nearest("Radius", keys), "radius");
    EXPECT_EQ(nearest("x", keys), "");  // nothing is near one letter
    EXPECT_EQ(nearest("us", keys), ""); // one change is half of it
    EXPECT_EQ(nearest("material", {}), "");
    EXPECT_EQ(nearest(std::string(1'000'000, 'a'), keys), "");
}

TEST(Quoted, EscapesAndCuts) {
    EXPECT_EQ(scene::quoted("a\nb\x7f"), "'a\\nb\\x7f'");
    EXPECT_EQ(scene::quoted("\xC0\xAF"), "'\\xc0\\xaf'");
    EXPECT_EQ(scene::quoted(std::string(61, 'x')), "'" + std::string(60, 'x') + "…'");
    EXPECT_EQ(scene::quoted(std::string(60, 'x')), "'" + std::string(60, 'x') + "'");
}

TEST(Explanations, AreInOrderAndWhole) {
    Code last{0};
    for (const Explanation& explanation : explanations()) {
        EXPECT_LT(last, explanation.code) << codeName(explanation.code);
        EXPECT_FALSE(explanation.title.empty());
        EXPECT_TRUE(explanation.text.ends_with('.') ||
                    explanation.text.find("\n    ") != std::string_view::npos)
            << codeName(explanation.code);
        last = explanation.code;
    }
    EXPECT_EQ(explanation(Code{301}).value().title, "unknown key");
    EXPECT_FALSE(explanation(Code{399}));
}

/// Codes that the program's sources use, each with the files.
std::map<std::uint16_t, std::set<std::string>> usedCodes() {
    const std::regex declaration(R"(Code\s+((k\w+\{\d{3}\}[,\s]*)+);)"), number(R"(\{(\d{3})\})"),
        literal(R"(Code\{(\d{3})\})");
    std::map<std::uint16_t, std::set<std::string>> used;
    for (const char* folder : {"core", "formats", "converters"})
        for (const auto& entry : std::filesystem::recursive_directory_iterator(
                 std::filesystem::path(RT_SOURCE_DIR) / folder)) {
            const auto suffix = entry.path().extension();
            if ((suffix != ".cpp" && suffix != ".hpp") ||
                entry.path().filename() == "explanations.cpp")
                continue;
            std::ifstream file(entry.path());
            const std::string text{std::istreambuf_iterator<char>(file), {}};
            const auto add = [&](const std::string& part, const std::regex& pattern) {
                for (std::sregex_iterator match(part.begin(), part.end(), pattern), end;
                     match != end; ++match)
                    used[static_cast<std::uint16_t>(std::stoi((*match)[1]))].insert(
                        entry.path().filename());
            };
            add(text, literal);
            for (std::sregex_iterator match(text.begin(), text.end(), declaration), end;
                 match != end; ++match)
                add((*match)[1], number);
        }
    return used;
}

TEST(Explanations, ExistForEveryCodeInUse) {
    const auto used = usedCodes();
    EXPECT_GT(used.size(), 60u);
    for (const auto& [code, files] : used)
        EXPECT_TRUE(explanation(Code{code}))
            << codeName(Code{code}) << " is used in " << testing::PrintToString(files);
}

} // namespace
} // namespace rt::scene
