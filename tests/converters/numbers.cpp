// Every number of a legacy file is, to the last bit, in the description that rt reads back from the YAML made of it.
#include <converters/text.hpp>
#include <core/numeric/angle.hpp>
#include <core/scene/full.hpp>
#include <formats/yaml_reader.hpp>
#include <formats/yaml_writer.hpp>
#include <tests/converters/converting.hpp>
#include <tests/converters/legacy_stage.hpp>

#include <bit>
#include <charconv>
#include <random>
#include <set>
#include <sstream>

namespace rt::converters {
namespace {

using Bits = std::multiset<std::uint64_t>;

/// The numbers in a word such as 0.1, -3, 2.5rad or 480; nothing for names.
std::optional<double> numberIn(std::string_view word) {
    const bool degrees = word.ends_with("deg"); // as the reader takes them
    if (degrees || word.ends_with("rad")) word.remove_suffix(3);
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
    return degrees ? value * numeric::kRadiansPerDegree : value;
}

void collect(const scene::Node& node, Bits& bits) {
    for (const scene::Node& item : node.items) collect(item, bits);
    for (const auto& member : node.members) collect(member.value, bits);
    if (node.kind == scene::Node::Kind::scalar)
        if (const auto value = numberIn(node.text))
            bits.insert(std::bit_cast<std::uint64_t>(*value));
}

/// All numbers of the description that the YAML text of `document` gives.
Bits numbersReadBack(const scene::Node& document, const std::string& path) {
    scene::Diagnostics diagnostics;
    const auto source =
        std::make_shared<scene::Source>(scene::Source{path, formats::writeYaml(document)});
    plugin_host::Catalog catalog({RT_SHIPPED_PLUGINS});
    const auto root = formats::parseYaml(source, diagnostics);
    const auto description = root ? scene::validate(*root, catalog, diagnostics) : std::nullopt;
    EXPECT_TRUE(description) << errorsOf(diagnostics);
    Bits bits;
    if (description) collect(scene::fullScene(*description), bits);
    return bits;
}

/// A legacy file as words, each number among them held to be in `found`; comments passed over. What the language says
/// otherwise is listed: see `says`.
class Numbers {
public:
    explicit Numbers(Bits found) : found_(std::move(found)) {}

    void expect(double value, const std::string& what) {
        ++count_;
        EXPECT_TRUE(found_.count(std::bit_cast<std::uint64_t>(value)))
            << shortest(value) << ", " << what;
    }
    std::size_t count() const { return count_; }

private:
    Bits found_;
    std::size_t count_ = 0;
};

std::vector<std::vector<std::string>> statementsOf(const std::string& text) {
    std::vector<std::vector<std::string>> statements;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::vector<std::string> statement;
        for (std::string word; words >> word;) statement.push_back(word);
        if (!statement.empty()) statements.push_back(std::move(statement));
    }
    return statements;
}

class Random {
public:
    /// 53 random bits, so that only a shortest form that round-trips gives them back.
    std::string in(double low, double high) {
        const double unit = static_cast<double>(generator_() >> 11) * 0x1p-53;
        return shortest(low + (high - low) * unit);
    }
    std::string vec(double low, double high) {
        return in(low, high) + " " + in(low, high) + " " + in(low, high);
    }
    std::string material() { // that transmits, so that no number of it means nothing
        return " " + vec(0, 1) + " " + vec(0, 1) + " " + vec(0, 1) + " " + vec(0.001, 1) + " " +
               vec(0, 1) + " " + in(1, 2) + " " + in(1, 90);
    }

private:
    std::mt19937_64 generator_{20140901};
};

TEST(InfNumbers, OfASceneAreFoundBitEqual) {
    const ScratchFolder folder;
    Random random;
    std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    folder.write("a.obj", obj);
    std::string text = "window 62 34\nscene -" + random.in(1, 9) + " -1e-3 -5e-300 1000.1 " +
                       random.in(900, 999) + " 900.7\ncamera " + random.in(1, 9) + " " +
                       random.in(1, 9) + " " + random.in(1, 9) + " " + random.vec(10, 90) + " 0 " +
                       random.in(1, 9) + " 0 0 0 " + random.in(1, 9) +
                       "\ndepth 7\nsmooth 0\nantiAliase 0\n";
    for (int i = 0; i < 40; ++i) {
        text += "sphere " + random.vec(-1e6, 1e6) + " " + random.in(1e-9, 1e3) + random.material() +
                "\n";
        text += "triangle " + random.vec(-1, 1) + " " + random.vec(-1e-3, 1e-3) + " " +
                random.vec(-1e9, 1e9) + random.material() + "\n";
        text += "rect " + random.vec(0, 100) + " " + random.vec(0, 1) + " " + random.vec(-1, 0) +
                random.material() + "\n";
        text += "obj a.obj o" + std::to_string(i) + " normal " + random.vec(0, 100) + " " +
                random.in(0.1, 10) + random.material() + "\n";
        text += "rs " + random.vec(0, 100) + " " + random.vec(0, 2) + " " + random.in(0, 3) + "\n";
    }
    const std::string path = folder.write("s.inf", text);
    const Converted converted = convertText(text, {}, path);
    ASSERT_TRUE(converted.document) << testing::PrintToString(converted.errors());
    Numbers numbers(numbersReadBack(*converted.document, folder.path("s.yaml")));
    for (const auto& statement : statementsOf(text)) {
        if (statement[0] == "smooth" || statement[0] == "antiAliase") continue; // on or off
        const std::size_t from = statement[0] == "obj" ? 4 : 1;
        for (std::size_t i = from; i < statement.size(); ++i)
            numbers.expect(*numberIn(statement[i]), statement[0] + ", number " + std::to_string(i));
    }
    EXPECT_GT(numbers.count(), 40u * (21 + 26 + 26 + 21 + 7));
}

TEST(InfNumbers, OfAMovieAreFoundBitEqual) {
    const ScratchFolder folder;
    Random random;
    const std::string obj =
        folder.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\n");
    std::string movie = "movie 999 23.976\n";
    int frame = 0;
    const auto frames = [&] { // one after the other, as no two motions of an object may overlap
        frame += 9;
        return " " + std::to_string(frame) + " " + std::to_string(frame + 8) + "\n";
    };
    for (int i = 0; i < 20; ++i) {
        movie += "0 rotate " + random.vec(0, 9) + " " + random.vec(0.1, 1) + " " +
                 random.in(-7, 7) + frames();
        movie += "1-2 rotateSelf " + random.in(-7, 7) + frames();
        movie += "0 move " + random.vec(0, 9) + frames();
        movie += "camera v moveDirect " + random.vec(0.1, 1) + " " + random.in(-7, 7) + frames();
        movie += "1 moveRadius " + random.vec(10, 11) + " " + random.in(-3, 3) + frames();
    }
    InfOptions options;
    options.moviePath = folder.write("m.inf", movie);
    const std::string path = folder.write("s.inf", "");
    const Converted converted =
        convertText(kHead + kSphere + "obj a.obj a normal 1 2 3 4" + kMatte + "\n", options, path);
    ASSERT_TRUE(converted.document) << testing::PrintToString(converted.errors());
    Numbers numbers(numbersReadBack(*converted.document, folder.path("s.yaml")));
    for (const auto& statement : statementsOf(movie)) {
        const bool header = statement[0] == "movie";
        const std::size_t from = header ? 1 : statement[0] == "camera" ? 3 : 2;
        const bool turns = !header && statement[1].starts_with("rotate");
        for (std::size_t i = from; i < statement.size(); ++i) {
            double value = *numberIn(statement[i]);
            if (header && i == 1) value += 1;                       // steps, and the start image
            if (turns && i + 3 == statement.size()) value = -value; // counter-clockwise is positive
            numbers.expect(value, statement[1] + ", number " + std::to_string(i));
        }
    }
    EXPECT_GT(numbers.count(), 20u * 20);
}

TEST(InfNumbers, OfTheAuthorsScenesAreFoundBitEqual) {
    if (!std::filesystem::exists(legacy("author_b/Scene.inf")))
        GTEST_SKIP() << "the legacy files are not here";
    std::size_t count = 0;
    for (const char* const name : {"author_b/Scene.inf", "cases/s1_spheres.inf", "cases/s4_aa.inf",
                                   "cases/s6_axes.inf", "cases/chk_bg.inf"}) {
        scene::Diagnostics diagnostics;
        const std::string path = legacy(name);
        const auto document = convertInf(path, {}, diagnostics);
        ASSERT_TRUE(document) << name << errorsOf(diagnostics);
        Numbers numbers(numbersReadBack(*document, path + ".yaml"));
        std::ifstream file(path, std::ios::binary);
        const std::string text{std::istreambuf_iterator<char>(file), {}};
        for (const auto& statement : statementsOf(text)) {
            const std::string& keyword = statement[0];
            if (keyword == "smooth" || keyword == "antiAliase" || keyword == "back" ||
                keyword == "background")
                continue;
            const bool material =
                keyword == "sphere" || keyword == "triangle" || keyword.starts_with("rect");
            for (std::size_t i = 1; i < statement.size(); ++i) {
                const auto value = numberIn(statement[i]);
                if (!value || (keyword == "texture" || keyword == "save" || keyword == "movie"))
                    continue;
                if (keyword == "camera" && i <= 2) continue; // the effective screen, as a note says
                if (material && (*value == -1 || *value == 0) && i + 2 >= statement.size())
                    continue; // no index where nothing passes
                numbers.expect(*value, std::string(name) + ": " + keyword + ", number " +
                                           std::to_string(i));
            }
        }
        count += numbers.count();
    }
    EXPECT_GT(count, 500u);
}

} // namespace
} // namespace rt::converters
