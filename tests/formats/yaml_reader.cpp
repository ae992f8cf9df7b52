// The reader's nodes and places, and every way in which a text is no scene, word for word.
#include <formats/yaml_reader.hpp>
#include <tests/formats/temporary_folder.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sys/stat.h>
#include <unistd.h>

namespace rt::formats {
namespace {

using scene::Diagnostics;
using scene::Node;
using Kind = Node::Kind;

std::optional<Node> parse(const std::string& text, Diagnostics& diagnostics) {
    return parseYaml(std::make_shared<scene::Source>(scene::Source{"s.yaml", text}), diagnostics);
}

Node parsed(const std::string& text) {
    Diagnostics diagnostics;
    auto node = parse(text, diagnostics);
    for (const auto& diagnostic : diagnostics.all())
        ADD_FAILURE() << scene::format(diagnostic, false);
    return node.value_or(Node{});
}

/// The messages of a text that must be refused.
std::string refusal(const std::string& text) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse(text, diagnostics)) << text;
    EXPECT_TRUE(diagnostics.failed());
    std::string messages;
    for (const auto& diagnostic : diagnostics.all()) messages += scene::format(diagnostic, false);
    return messages;
}

/// One line: kinds, texts and places.
std::string outline(const Node& node) {
    const auto place = [](const scene::Location& location) {
        return "@" + std::to_string(location.line) + ":" + std::to_string(location.column);
    };
    std::string text;
    switch (node.kind) {
    case Kind::null:
        text = "~";
        break;
    case Kind::scalar:
        text = node.quoted ? "\"" + node.text + "\"" : node.text;
        break;
    case Kind::sequence:
        for (const Node& item : node.items) text += (text.empty() ? "" : " ") + outline(item);
        text = "[" + text + "]";
        break;
    case Kind::map:
        for (const auto& member : node.members)
            text += (text.empty() ? "" : " ") + member.key + place(member.keyLocation) + "=" +
                    outline(member.value);
        text = "{" + text + "}";
        break;
    }
    return text + place(node.location);
}

TEST(YamlReader, KnowsThePlaceOfEveryKeyAndValue) {
    EXPECT_EQ(outline(parsed("a: 1\nb:\n  c: [1, 'x']\n")),
              "{a@1:1=1@1:4 b@2:1={c@3:3=[1@3:7 \"x\"@3:10]@3:6}@3:3}@1:1");
}

TEST(YamlReader, PutsAMissingValueAtItsKey) {
    EXPECT_EQ(outline(parsed("a:\nb: ~\nc:\n")), "{a@1:1=~@1:1 b@2:1=~@2:4 c@3:1=~@3:1}@1:1");
}

TEST(YamlReader, CountsColumnsInBytes) {
    EXPECT_EQ(outline(parsed("中: {a: 1}\n")), "{中@1:1={a@1:7=1@1:10}@1:6}@1:1");
}

TEST(YamlReader, AcceptsWindowsLinesAndAByteOrderMark) {
    EXPECT_EQ(outline(parsed("\xEF\xBB\xBF"
                             "a: 1\r\nb: 2\r\n")),
              "{a@1:1=1@1:4 b@2:1=2@2:4}@1:1");
}

TEST(YamlReader, RepeatsAnchors) {
    EXPECT_EQ(outline(parsed("a: &x {k: 1}\nb: *x\n")),
              "{a@1:1={k@1:8=1@1:11}@1:4 b@2:1={k@1:8=1@1:11}@1:4}@1:1");
}

TEST(YamlReader, MergesMapsOwnKeysFirst) {
    EXPECT_EQ(
        outline(parsed("a: &x {k: 1, l: 2}\nb: {<<: *x, l: 3}\n")),
        "{a@1:1={k@1:8=1@1:11 l@1:14=2@1:17}@1:4 b@2:1={l@2:13=3@2:16 k@1:8=1@1:11}@2:4}@1:1");
}

TEST(YamlReader, MergesAListOfMapsTheFirstOneWins) {
    const Node node = parsed("- &a {k: 1}\n- &b {k: 2, l: 2}\n- {<<: [*a, *b], m: 3}\n");
    EXPECT_EQ(node.items[2].find("k")->text, "1");
    EXPECT_EQ(node.items[2].find("l")->text, "2");
    EXPECT_EQ(node.items[2].find("m")->text, "3");
}

TEST(YamlReader, TakesAQuotedMergeKeyAsAWord) {
    EXPECT_EQ(outline(parsed("{'<<': 1}\n")), "{<<@1:2=1@1:8}@1:1");
}

TEST(YamlReader, FindsTheQuoteThatIsNeverClosed) {
    EXPECT_EQ(refusal("a: 1\nb: \"abc\nc: 2\n"),
              "s.yaml:2:4: error[E0352]: the quote \" that opens here is never closed\n"
              "    2 | b: \"abc\n"
              "      |    ^\n");
    EXPECT_EQ(refusal("a: 'it''s\n"),
              "s.yaml:1:4: error[E0352]: the quote ' that opens here is never closed\n"
              "    1 | a: 'it''s\n"
              "      |    ^\n");
    EXPECT_EQ(refusal("a: &x  \"abc\\\"\n"),
              "s.yaml:1:4: error[E0352]: the quote \" that opens here is never closed\n"
              "    1 | a: &x  \"abc\\\"\n"
              "      |    ^\n");
    EXPECT_EQ(parsed("a: |\n  \"x\n").members[0].value.text, "\"x\n");
}

TEST(YamlReader, RefusesDuplicateKeysNamingBothLines) {
    EXPECT_EQ(
        refusal("radius: 1\nname: a\nradius: 2\n"),
        "s.yaml:3:1: error[E0351]: the key 'radius' stands twice in this map, first in line 1\n"
        "    3 | radius: 2\n"
        "      | ^\n");
}

TEST(YamlReader, FindsEveryDuplicate) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse("a: {b: 1, b: 2}\na: 3\n<<: {c: 1}\n<<: {d: 1}\n", diagnostics));
    EXPECT_EQ(diagnostics.errorCount(), 3u);
    EXPECT_EQ(diagnostics.exitCode(), 3);
}

TEST(YamlReader, RefusesASecondDocument) {
    EXPECT_EQ(refusal("a: 1\n---\nb: 2\n"),
              "s.yaml:2:1: error[E0354]: a second document starts here; a scene is one document\n"
              "    2 | ---\n"
              "      | ^\n");
    EXPECT_EQ(refusal("  a: 1\n b: 2\n"), "s.yaml:2:2: error[E0354]: this line is indented less "
                                          "than the first line, so it cannot belong to it\n"
                                          "    2 |  b: 2\n"
                                          "      |  ^\n");
    EXPECT_EQ(outline(parsed("%YAML 1.2\n---\na: 1\n...\n")), "{a@3:1=1@3:4}@3:1");
}

TEST(YamlReader, RefusesTabsAsIndentation) {
    EXPECT_EQ(refusal("a:\n\tb: 1\n"),
              "s.yaml:2:1: error[E0353]: a tab indents this line; YAML wants spaces\n"
              "    2 |     b: 1\n"
              "      | ^\n");
    EXPECT_EQ(outline(parsed("a: \t1\n")), "{a@1:1=1@1:5}@1:1");
}

TEST(YamlReader, NamesTheBracketThatIsNotClosed) {
    EXPECT_EQ(refusal("a: [1, 2\nb: 3\n"),
              "s.yaml:1:4: error[E0352]: the '[' that opens here is not closed properly; line 2 "
              "has no ',' or ']' where one "
              "must stand\n"
              "    1 | a: [1, 2\n"
              "      |    ^\n");
    EXPECT_EQ(refusal("a: {b: #aabbcc}\n"),
              "s.yaml:1:4: error[E0352]: the '{' that opens here is not closed properly; line 2 "
              "has no ',' or '}' where one must stand; ' #' starts a comment: put a colour in "
              "quotes\n"
              "    1 | a: {b: #aabbcc}\n"
              "      |    ^\n");
    EXPECT_EQ(refusal("a: {b: [1,2}\n"),
              "s.yaml:1:12: error[E0352]: expected ']' for the '[' of line 1, but found '}'\n"
              "    1 | a: {b: [1,2}\n"
              "      |            ^\n");
    EXPECT_EQ(refusal("a: 1\n}\n"),
              "s.yaml:2:1: error[E0350]: this '}' closes nothing that is open\n"
              "    2 | }\n"
              "      | ^\n");
}

TEST(YamlReader, ExplainsSyntaxErrors) {
    const std::pair<const char*, const char*> kCases[] = {
        {"a: b: c\n", "s.yaml:1:5: error[E0350]: a ':' cannot stand here; check the indentation, "
                      "or put text that has ': ' in quotes"},
        {"a: @x\n", "s.yaml:1:4: error[E0350]: a value cannot start with '@'; put it in quotes"},
        {"a: - b\n",
         "s.yaml:1:4: error[E0350]: a list item cannot start here; put '- ' on a line of its own"},
        {"a: \"\\q\"\n", "s.yaml:1:7: error[E0350]: unknown escape in a double-quoted text; write "
                         "'\\\\' for a backslash, or use single quotes"},
        {"a: \"x\" y\n", "s.yaml:1:8: error[E0350]: this does not continue the lines above; check "
                         "the indentation, and the quotes before it"},
        {"a: *nope\n", "s.yaml:1:4: error[E0357]: no anchor of this name stands above; write "
                       "'&name' before '*name'"},
        {"a: &a\n  b: *a\n",
         "s.yaml:2:6: error[E0358]: this alias refers to the very node that it stands in"},
        {"? [a]\n: b\n", "s.yaml:1:3: error[E0359]: a key must be a word, not a list or a map"},
        {": x\n", "s.yaml:1:1: error[E0359]: a key is missing before this ':'"},
        {"<<: 1\n",
         "s.yaml:1:1: error[E0360]: '<<' merges a map or a list of maps, such as '<<: *name'"},
        {"a: !!int 3\n",
         "s.yaml:1:4: error[E0361]: tags such as '!!int' are not part of the scene language"},
        {"a: !Sphere {}\n",
         "s.yaml:1:4: error[E0361]: tags such as '!Sphere' are not part of the scene language"},
        {"a: 1\rb: 2\r", "s.yaml:1:5: error[E0355]: a carriage return without a line feed; save "
                         "the file with Unix or Windows line ends"},
        {"a: \x01\n",
         "s.yaml:1:4: error[E0355]: the control character '\\x01' cannot stand in a scene"},
        {"a: \xff\xfe\n",
         "s.yaml:1:4: error[E0355]: the byte '\\xff' is no UTF-8; save the file as UTF-8"},
        {"a: \xc0\xaf\n",
         "s.yaml:1:4: error[E0355]: the byte '\\xc0' is no UTF-8; save the file as UTF-8"},
    };
    for (const auto& [text, message] : kCases)
        EXPECT_EQ(refusal(text).substr(0, std::string(message).size()), message);
}

TEST(YamlReader, RefusesOtherEncodings) {
    EXPECT_NE(refusal(std::string("\xff\xfe"
                                  "a\0:\0",
                                  6))
                  .find("the file is UTF-16 or UTF-32; save it as UTF-8"),
              std::string::npos);
    EXPECT_NE(refusal(std::string("a\0:\0 \0", 6)).find("the file is UTF-16"), std::string::npos);
    EXPECT_NE(refusal(std::string("ab: 1\nc: \0\n", 11))
                  .find("s.yaml:2:4: error[E0355]: a NUL byte stands here; this is no text file"),
              std::string::npos);
}

TEST(YamlReader, RefusesAnEmptyFile) {
    for (const char* text : {"", "\n\n", "# only a comment\n", "---\n", "~\n"})
        EXPECT_EQ(refusal(text).substr(0, 74),
                  "s.yaml: error[E0356]: the file is empty: a scene starts with 'rt: 1'\n");
}

std::string repeated(const std::string& piece, std::size_t count) {
    std::string text;
    text.reserve(piece.size() * count);
    for (std::size_t i = 0; i < count; ++i) text += piece;
    return text;
}

int limitExit(const std::string& text, const char* code) {
    Diagnostics diagnostics;
    EXPECT_FALSE(parse(text, diagnostics));
    EXPECT_NE(scene::format(diagnostics.all().at(0), false).find(code), std::string::npos)
        << scene::format(diagnostics.all().at(0), false);
    return diagnostics.exitCode();
}

TEST(YamlReader, LimitsTheDepth) {
    const auto nested = [](std::size_t depth) {
        return repeated("[", depth) + repeated("]", depth);
    };
    EXPECT_EQ(parsed(nested(64)).kind, Kind::sequence);
    EXPECT_EQ(limitExit(nested(65), "E0711"), 7);
    for (const char* piece : {"[", "- ", "{a: ", "? "})
        EXPECT_EQ(limitExit(repeated(piece, 100'000), "E0711"), 7) << piece;
    // Without a check of its own yaml-cpp would hold a token for each of these: 2.7 GB.
    EXPECT_EQ(limitExit(repeated("[", 8 << 20), "E0711"), 7);
}

TEST(YamlReader, LimitsTheDepthOfAliases) {
    std::string text = "a0: &a0 [1]\n";
    for (int i = 1; i < 70; ++i)
        text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [*a" +
                std::to_string(i - 1) + "]\n";
    EXPECT_EQ(limitExit(text, "E0711"), 7);
}

TEST(YamlReader, LimitsTheNodesThatAliasesMake) {
    std::string text = "a0: &a0 [x,x,x,x,x,x,x,x,x,x]\n";
    for (int i = 1; i < 10; ++i) {
        const std::string inner = "*a" + std::to_string(i - 1);
        text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + inner +
                repeated("," + inner, 9) + "]\n";
    }
    EXPECT_EQ(limitExit(text, "E0712"), 7);
}

TEST(YamlReader, LimitsTheNodes) {
    EXPECT_EQ(limitExit("k: [1" + repeated(",1", 1'000'000) + "]", "E0712"), 7);
}

TEST(YamlReader, LimitsTheSize) {
    EXPECT_EQ(limitExit("a: " + std::string(scene::kMaxSceneBytes, 'x'), "E0710"), 7);
}

class YamlFiles : public testing::Test {
protected:
    /// Exit code and message without the folder.
    std::string read(const std::string& path) {
        Diagnostics diagnostics;
        const auto node = readYaml(path, diagnostics);
        if (node) return "read";
        std::string message = scene::format(diagnostics.all().at(0), false);
        if (message.starts_with(folder_ / "")) message.erase(0, (folder_ / "").size());
        return std::to_string(diagnostics.exitCode()) + " " + message;
    }

    TemporaryFolder folder_;
};

TEST_F(YamlFiles, ReadsRegularFilesOnly) {
    std::ofstream(folder_ / "a.yaml") << "a: 1\n";
    ASSERT_EQ(mkfifo((folder_ / "fifo").c_str(), 0600), 0);
    EXPECT_EQ(read(folder_ / "a.yaml"), "read");
    EXPECT_EQ(read(folder_ / "none.yaml"), "4 none.yaml: error[E0401]: there is no such file\n");
    EXPECT_EQ(read(folder_ / "a.yaml/b.yaml"),
              "4 a.yaml/b.yaml: error[E0401]: there is no such file\n");
    EXPECT_EQ(read(folder_ / "fifo"), "4 fifo: error[E0403]: is a pipe, not a file\n");
    EXPECT_EQ(read("/"), "4 /: error[E0403]: is a folder, not a file\n");
    EXPECT_EQ(read("/dev/zero"), "4 /dev/zero: error[E0403]: is a device, not a file\n");
}

TEST_F(YamlFiles, SaysWhyAFileCannotBeRead) {
    if (geteuid() == 0) GTEST_SKIP() << "root may read everything";
    std::ofstream(folder_ / "secret.yaml") << "a: 1\n";
    std::filesystem::permissions(folder_ / "secret.yaml", std::filesystem::perms::none);
    EXPECT_EQ(read(folder_ / "secret.yaml"),
              "4 secret.yaml: error[E0402]: cannot be read: Permission denied\n");
}

TEST_F(YamlFiles, RefusesLargeFilesBeforeReadingThem) {
    std::ofstream(folder_ / "large.yaml") << "a: 1\n";
    std::filesystem::resize_file((folder_ / "large.yaml"), std::uintmax_t{1} << 40); // sparse
    EXPECT_EQ(
        read(folder_ / "large.yaml"),
        "7 large.yaml: error[E0710]: is larger than 8 MiB, the most that a text file may have; "
        "--limit-file allows more\n");
}

} // namespace
} // namespace rt::formats
