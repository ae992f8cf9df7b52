// What is written is read back as the same nodes, and looks as people write YAML.
#include <formats/yaml_reader.hpp>
#include <formats/yaml_writer.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

namespace rt::formats {
namespace {

using scene::Node;
using Kind = Node::Kind;

Node parse(const std::string& text) {
    scene::Diagnostics diagnostics;
    auto node =
        parseYaml(std::make_shared<scene::Source>(scene::Source{"s.yaml", text}), diagnostics);
    for (const auto& diagnostic : diagnostics.all())
        ADD_FAILURE() << scene::format(diagnostic, false) << text;
    return node.value_or(Node{});
}

/// Quotes matter only where the text without them could be a number, an angle, a boolean or nothing.
bool quotesMatter(const std::string& text) {
    static const std::vector<std::string> kWords{"",    "~",   "null",     "true", "false",
                                                 "yes", "no",  "on",       "off",  "y",
                                                 "n",   "nan", "infinity", "inf",  "="};
    std::string lower = text;
    for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return std::find(kWords.begin(), kWords.end(), lower) != kWords.end() ||
           (text.find_first_of("0123456789+-.") == 0 &&
            text.find_first_not_of(
                "0123456789+-._abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ ") ==
                std::string::npos);
}

bool same(const Node& a, const Node& b) {
    if (a.kind != b.kind || a.text != b.text || a.items.size() != b.items.size() ||
        a.members.size() != b.members.size())
        return false;
    if (a.kind == Kind::scalar && a.quoted != b.quoted && quotesMatter(a.text)) return false;
    for (std::size_t i = 0; i < a.items.size(); ++i)
        if (!same(a.items[i], b.items[i])) return false;
    for (std::size_t i = 0; i < a.members.size(); ++i)
        if (a.members[i].key != b.members[i].key || !same(a.members[i].value, b.members[i].value))
            return false;
    return true;
}

Node scalar(std::string text, bool quoted = false) {
    Node node;
    node.kind = Kind::scalar;
    node.text = std::move(text);
    node.quoted = quoted;
    return node;
}

std::string asText(const std::string& text) {
    Node map;
    map.kind = Kind::map;
    map.members.push_back({"k", {}, scalar(text, true)});
    return writeYaml(map);
}

TEST(YamlWriter, KeepsTheLayoutOfAScene) {
    const std::string text = "rt: 1\n"
                             "image: {width: 8, height: 6}\n"
                             "camera:\n"
                             "  position: [0, 0.10, 1e3]\n"
                             "objects:\n"
                             "  - sphere: {name: moon, radius: 4}\n"
                             "  - mesh:\n"
                             "      file: a.obj\n"
                             "      rotate:\n"
                             "        - {axis: [0, 0, 1], angle: 45deg}\n"
                             "  -\n"
                             "    - 1\n"
                             "    - 2\n"
                             "nothing: ~\n"
                             "none: []\n"
                             "empty: {}\n";
    const std::string written = writeYaml(parse(text));
    EXPECT_EQ(written, text);
    EXPECT_EQ(writeYaml(parse(written)), written);
}

TEST(YamlWriter, QuotesOnlyWhatWouldBeMisread) {
    for (const char* plain : {"moon", "a b", "model/dragon.obj", "image_2.png", "中文", "it's",
                              "Ünïcode", "a:b", "x#y", "a,b", "yesterday"})
        EXPECT_EQ(asText(plain), std::string("k: ") + plain + "\n");
    for (const char* misread :
         {"1",          "-1",    "1.5",  ".5",   "010",   "0x1F", "1e3", "1_000", "12:30:45",
          "2001-01-01", "45deg", "+1",   "true", "True",  "NO",   "off", "y",     "N",
          "null",       "~",     ".nan", ".inf", "-.inf", "nan",  "=",   "",      " a",
          "a ",         "a: b",  "a #b", "- a",  "-",     "?",    "[a",  "{a",    "#ff8000",
          "&a",         "*a",    "!a",   "|",    ">",     "%a",   "@a",  "`a",    "'a",
          "---",        "...",   "a:",   "<<"})
        EXPECT_EQ(asText(misread), std::string("k: \"") + misread + "\"\n");
    EXPECT_EQ(asText("say \"hi\": x"), "k: 'say \"hi\": x'\n");
    EXPECT_EQ(asText("C:\\a\\b"), "k: C:\\a\\b\n");
    EXPECT_EQ(asText("a\nb\x1b\xC2\x85"), "k: \"a\\nb\\u001b\\u0085\"\n");
}

TEST(YamlWriter, LeavesNumbersAsTheNodesSpellThem) {
    for (const char* number : {"0.10", "1e3", "-5", ".5", "1.0000000000000002", "45deg", "true"}) {
        Node map;
        map.kind = Kind::map;
        map.members.push_back({"k", {}, scalar(number)});
        EXPECT_EQ(writeYaml(map), std::string("k: ") + number + "\n");
    }
}

TEST(YamlWriter, KeepsComments) {
    Node root =
        parse("image: {width: 8}\nobjects:\n  - sphere: {radius: 1}\n  - sphere: {radius: 2}\n");
    root.comments->before = {"the scene", ""};
    root.members[0].value.comments->before = {"picture"};
    root.members[0].value.comments->after = "small";
    Node& objects = root.members[1].value;
    objects.comments->after = "two";
    objects.items[0].comments->before = {"first\tone\nand \xff more"};
    objects.items[1].members[0].value.comments->before = {"second"};
    objects.comments->atEnd = {"- sphere: {radius: 3}"};
    root.comments->atEnd = {"the end"};
    const std::string written = writeYaml(root);
    EXPECT_EQ(written, "# the scene\n"
                       "#\n"
                       "# picture\n"
                       "image: {width: 8}  # small\n"
                       "objects:  # two\n"
                       "  # first one\\nand \\xff more\n"
                       "  - sphere: {radius: 1}\n"
                       "  # second\n"
                       "  - sphere: {radius: 2}\n"
                       "  # - sphere: {radius: 3}\n"
                       "# the end\n");
    EXPECT_TRUE(same(parse(written), root));
}

TEST(YamlWriter, TurnsCommentedFlowMapsIntoBlocks) {
    Node root = parse("camera: {position: [0, 0, 1], up: [0, 1, 0]}\n");
    root.members[0].value.members[1].value.comments->after = "why";
    EXPECT_EQ(writeYaml(root), "camera:\n"
                               "  position: [0, 0, 1]\n"
                               "  up: [0, 1, 0]  # why\n");
}

TEST(YamlWriter, BreaksLongLines) {
    std::string list = "[1000";
    for (int i = 1001; i < 1200; ++i) list += ", " + std::to_string(i);
    list += "]";
    const Node root = parse("objects:\n  - mesh: {name: a_long_name, triangles: " + list +
                            ", file: \"1.obj\", kind: solid}\n");
    const std::string written = writeYaml(root);
    EXPECT_TRUE(same(parse(written), root)) << written;
    for (std::size_t from = 0; from < written.size();) {
        const std::size_t to = written.find('\n', from);
        EXPECT_LE(to - from, 101u) << written.substr(from, to - from);
        from = to + 1;
    }
}

/// Nodes of every shape, with texts that YAML could take for something else.
class RandomNodes {
public:
    explicit RandomNodes(unsigned seed) : random_(seed) {}

    Node make(int depth) {
        Node node;
        node.flow = below(2) == 0;
        switch (depth >= 5 ? below(2) : below(5)) {
        case 0:
            node.kind = Kind::null;
            break;
        case 1:
            return scalar(text(), true);
        case 2:
        case 3:
            node.kind = Kind::map;
            for (unsigned i = below(4); i > 0; --i) {
                const std::string key = text();
                if (!node.find(key)) node.members.push_back({key, {}, make(depth + 1)});
            }
            break;
        default:
            node.kind = Kind::sequence;
            for (unsigned i = below(5); i > 0; --i) node.items.push_back(make(depth + 1));
        }
        if (below(8) == 0) node.comments->before.push_back(text());
        if (below(8) == 0) node.comments->after = text();
        if (below(8) == 0 && (node.kind == Kind::map || node.kind == Kind::sequence) &&
            node.items.size() + node.members.size() > 0)
            node.comments->atEnd.push_back(text());
        return node;
    }

private:
    unsigned below(unsigned n) { return random_() % n; }

    std::string text() {
        static const std::vector<std::string> kPieces{"a",
                                                      "moon",
                                                      "1",
                                                      "-",
                                                      ".",
                                                      ":",
                                                      " ",
                                                      "#",
                                                      "'",
                                                      "\"",
                                                      "\\",
                                                      "\n",
                                                      "\t",
                                                      ",",
                                                      "[",
                                                      "]",
                                                      "{",
                                                      "}",
                                                      "&",
                                                      "*",
                                                      "!",
                                                      "|",
                                                      ">",
                                                      "%",
                                                      "@",
                                                      "`",
                                                      "?",
                                                      "~",
                                                      "no",
                                                      "0x1",
                                                      "中",
                                                      "é",
                                                      "=",
                                                      "<<",
                                                      "\r",
                                                      "\x7f",
                                                      "\xE2\x80\xAE",
                                                      "\xF0\x9F\x8C\x99"};
        std::string result;
        for (unsigned i = below(5); i > 0; --i)
            result += kPieces[below(static_cast<unsigned>(kPieces.size()))];
        return result;
    }

    std::mt19937 random_;
};

TEST(YamlWriter, IsReadBackAsTheSameNodes) {
    for (unsigned seed = 0; seed < 3000; ++seed) {
        Node root = RandomNodes(seed).make(0);
        if (root.kind == Kind::null) continue; // an empty file is an error
        const std::string written = writeYaml(root);
        ASSERT_TRUE(same(parse(written), root)) << "seed " << seed << "\n" << written;
    }
}

TEST(YamlWriter, RewritesTheScenesOfTheTree) {
    std::size_t scenes = 0;
    for (const auto& entry : std::filesystem::directory_iterator(RT_SOURCE_DIR "/scenes")) {
        if (entry.path().extension() != ".yaml") continue;
        scene::Diagnostics diagnostics;
        const auto node = readYaml(entry.path(), diagnostics);
        ASSERT_TRUE(node) << entry.path();
        const std::string written = writeYaml(*node);
        EXPECT_TRUE(same(parse(written), *node)) << entry.path();
        EXPECT_EQ(writeYaml(parse(written)), written) << entry.path();
        ++scenes;
    }
    EXPECT_GT(scenes, 0u);
}

} // namespace
} // namespace rt::formats
