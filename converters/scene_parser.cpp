// The grammar of .inf scene files: one row per statement.
#include <converters/statement_reader.hpp>

#include <algorithm>
#include <cctype>
#include <map>

namespace rt::converters {
namespace {

using scene::Code;
using scene::quoted;

using Labels = std::vector<NumberLabel>;

struct Signature {
    std::string_view spelling;
    Keyword keyword;
    std::vector<std::string_view> words;
    Labels numbers;
    bool material = false;
};

const std::vector<Signature>& signatures() {
    static const std::vector<Signature> kSignatures = [] {
        const Labels size{{"width", true}, {"height", true}}, whole{{"value", true}};
        const Labels box{{"left"}, {"front"}, {"down"}, {"right"}, {"back"}, {"up"}};
        const Labels camera{{"screen width"}, {"screen height"}, {"focus"},     {"position x"},
                            {"position y"},   {"position z"},    {"forward x"}, {"forward y"},
                            {"forward z"},    {"upward x"},      {"upward y"},  {"upward z"}};
        const Labels sphere{{"center x"}, {"center y"}, {"center z"}, {"radius"}};
        const Labels triangle{{"p0 x"}, {"p0 y"}, {"p0 z"}, {"p1 x"}, {"p1 y"},
                              {"p1 z"}, {"p2 x"}, {"p2 y"}, {"p2 z"}};
        const Labels rect{{"corner x"}, {"corner y"}, {"corner z"}, {"length x"}, {"length y"},
                          {"length z"}, {"width x"},  {"width y"},  {"width z"}};
        const Labels mesh{{"center x"}, {"center y"}, {"center z"}, {"scale"}};
        const Labels light{{"position x"}, {"position y"}, {"position z"},
                           {"color r"},    {"color g"},    {"color b"}};
        return std::vector<Signature>{
            {"window", Keyword::window, {}, size},
            {"scene", Keyword::scene, {}, box},
            {"camera", Keyword::camera, {}, camera},
            {"depth", Keyword::depth, {}, whole},
            {"recursivdepth", Keyword::depth, {}, whole},
            {"smooth", Keyword::smooth, {}, whole},
            {"antiAliase", Keyword::antialias, {}, whole},
            {"texture", Keyword::texture, {"file name"}, {}},
            {"back", Keyword::background, {}, whole},
            {"background", Keyword::background, {}, whole},
            {"sphere", Keyword::sphere, {}, sphere, true},
            {"triangle", Keyword::triangle, {}, triangle, true},
            {"rect", Keyword::parallelogram, {}, rect, true},
            {"rectangle", Keyword::parallelogram, {}, rect, true},
            {"obj", Keyword::mesh, {"file name", "name", "mode"}, mesh, true},
            {"object", Keyword::mesh, {"file name", "name", "mode"}, mesh, true},
            {"rs", Keyword::light, {}, light},
            {"raysource", Keyword::light, {}, light},
            {"movie", Keyword::movie, {"file name"}, {}},
            {"save", Keyword::save, {"file name"}, {}},
            {"savename", Keyword::save, {"file name"}, {}}};
    }();
    return kSignatures;
}

constexpr std::array<NumberLabel, kMaterialNumbers> kMaterialLabels{{{"color r"},
                                                                     {"color g"},
                                                                     {"color b"},
                                                                     {"diffuse r"},
                                                                     {"diffuse g"},
                                                                     {"diffuse b"},
                                                                     {"specular r"},
                                                                     {"specular g"},
                                                                     {"specular b"},
                                                                     {"transmiss r"},
                                                                     {"transmiss g"},
                                                                     {"transmiss b"},
                                                                     {"environmentR r"},
                                                                     {"environmentR g"},
                                                                     {"environmentR b"},
                                                                     {"refractivity"},
                                                                     {"s"}}};

const Signature* find(std::string_view word) {
    for (const Signature& signature : signatures()) {
        if (signature.spelling == word) return &signature;
    }
    return nullptr;
}

bool startsStatement(std::string_view word) { return find(word) != nullptr; }

std::string suggestionFor(std::string_view word) {
    std::vector<std::string> spellings;
    for (const Signature& signature : signatures()) {
        spellings.emplace_back(signature.spelling);
        if (std::ranges::equal(word, signature.spelling, [](unsigned char a, unsigned char b) {
                return std::tolower(a) == std::tolower(b);
            })) {
            return spellings.back();
        }
    }
    return scene::nearest(word, spellings);
}

class SceneParser {
public:
    std::optional<Statement> operator()(StatementReader& reader) {
        const Signature* signature = find(reader.cursor.peek());
        if (!signature) {
            reportUnknown(reader);
            return std::nullopt;
        }
        const std::size_t begin = reader.cursor.offset();
        Statement statement;
        statement.keyword = signature->keyword;
        statement.spelled = reader.cursor.take();
        if (!takeArguments(reader, *signature, statement)) {
            reader.recover();
            return std::nullopt;
        }
        lastKeyword_ = statement.spelled.text;
        statement.text = reader.textSince(begin);
        return statement;
    }

private:
    bool takeArguments(StatementReader& reader, const Signature& signature, Statement& statement) {
        for (const std::string_view what : signature.words) {
            // At the end of the file the original's `movie` keeps its default.
            if (signature.keyword == Keyword::movie && reader.cursor.atEnd()) {
                statement.words.push_back({"Movie.inf", statement.spelled.location});
                continue;
            }
            Word word;
            if (!reader.word(statement.spelled, what, word)) return false;
            statement.words.push_back(std::move(word));
        }
        if (signature.keyword == Keyword::mesh && !isMode(reader, statement)) return false;

        auto& previous = previousNumbers_[signature.keyword];
        if (!reader.numbers(statement.spelled, signature.numbers, previous, statement.numbers))
            return false;
        if (signature.keyword == Keyword::light) takeBrightness(reader, statement);
        if (reader.lenient) previous = statement.numbers;

        if (signature.material) {
            std::vector<Number> material;
            if (!reader.numbers(statement.spelled, kMaterialLabels, previousMaterial_, material))
                return false;
            statement.material.emplace();
            std::ranges::copy(material, statement.material->begin());
            if (reader.lenient) previousMaterial_ = std::move(material);
            if (signature.keyword != Keyword::mesh) takeName(reader, statement);
        }
        return true;
    }

    static bool isMode(StatementReader& reader, const Statement& statement) {
        const Word& mode = statement.words[2];
        if (mode.text == "normal" || mode.text == "obj" || mode.text == "object") return true;
        if (reader.lenient) {
            reader.cursor.takeLine();
            reader.diagnostics.note(mode.location, "no object is made: the mode " +
                                                       quoted(mode.text) +
                                                       " is none of 'normal', 'obj' and 'object'");
            return false;
        }
        const std::string near = scene::nearest(mode.text, {"normal", "obj", "object"});
        reader.diagnostics.error(
            Code{385}, mode.location,
            quoted(mode.text) + " is no mode of 'obj': it is one of 'normal', 'obj' and 'object'",
            near.empty() ? "" : "did you mean '" + near + "'?");
        return false;
    }

    static void takeBrightness(StatementReader& reader, Statement& statement) {
        if (reader.cursor.atEnd() || !looksLikeNumber(reader.cursor.peek())) return;
        constexpr NumberLabel kBrightness[] = {{"brightness"}};
        if (!reader.numbers(statement.spelled, kBrightness, {}, statement.numbers))
            reader.cursor.take();
    }

    /// The original read no name here, though its report lists one; real files have it at times.
    static void takeName(StatementReader& reader, Statement& statement) {
        if (reader.cursor.atEnd()) return;
        const std::uint32_t statementLine = reader.cursor.lastLine();
        const std::string_view next = reader.cursor.peek();
        if (next.front() == '#' || startsStatement(next) || looksLikeNumber(next)) return;
        if (reader.cursor.here().line != statementLine) {
            // On a line of its own it may as well be a misspelt keyword: a name has no numbers after it.
            if (!suggestionFor(next).empty()) return;
            Cursor ahead = reader.cursor;
            ahead.take();
            if (!ahead.atEnd() && ahead.peek().front() != '#' && !startsStatement(ahead.peek()))
                return;
        }
        statement.name = reader.cursor.take();
    }

    void reportUnknown(StatementReader& reader) const {
        const std::string word(reader.cursor.peek());
        const scene::Location location = reader.cursor.here();
        if (reader.lenient) {
            reader.diagnostics.note(location, "skipped, as the original did: " +
                                                  quoted(reader.takeUnknown(true)));
            return;
        }
        if (looksLikeNumber(word)) {
            reader.diagnostics.error(
                Code{380}, location,
                lastKeyword_.empty()
                    ? "a statement starts with a keyword, not with " + quoted(word)
                    : quoted(lastKeyword_) + " has all its numbers before " + quoted(word));
        } else {
            const std::string near = suggestionFor(word);
            reader.diagnostics.error(Code{380}, location, "unknown keyword " + quoted(word),
                                     near.empty() ? "" : "did you mean '" + near + "'?");
        }
        reader.cursor.take();
        reader.recover();
    }

    std::map<Keyword, std::vector<Number>> previousNumbers_;
    std::vector<Number> previousMaterial_;
    std::string lastKeyword_;
};

} // namespace

std::string_view materialNumberName(std::size_t index) { return kMaterialLabels[index].name; }

SceneText parseSceneText(const std::shared_ptr<const scene::Source>& source, bool lenient,
                         scene::Diagnostics& diagnostics) {
    StatementReader reader(Cursor(source), lenient, diagnostics, startsStatement);
    return parseStatements<Statement>(source, reader, SceneParser{});
}

} // namespace rt::converters
