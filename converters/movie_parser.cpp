// The grammar of legacy movie files: a header, background fades, motions of objects and of the camera.
#include <converters/statement_reader.hpp>

#include <charconv>
#include <map>

namespace rt::converters {
namespace {

using scene::Code;
using scene::quoted;

struct MotionSignature {
    std::string_view spelling;
    MotionType type;
    std::vector<NumberLabel> numbers;
};

const std::vector<MotionSignature>& motions() {
    static const std::vector<MotionSignature> kMotions{
        {"rotate",
         MotionType::rotate,
         {{"center x"},
          {"center y"},
          {"center z"},
          {"axis x"},
          {"axis y"},
          {"axis z"},
          {"angle"},
          {"first frame", true},
          {"last frame", true}}},
        {"rotateSelf",
         MotionType::rotateSelf,
         {{"angle"}, {"first frame", true}, {"last frame", true}}},
        {"move",
         MotionType::move,
         {{"position x"},
          {"position y"},
          {"position z"},
          {"first frame", true},
          {"last frame", true}}},
        {"moveRadius",
         MotionType::moveRadius,
         {{"center x"},
          {"center y"},
          {"center z"},
          {"distance"},
          {"first frame", true},
          {"last frame", true}}},
        {"moveDirect",
         MotionType::moveDirect,
         {{"direction x"},
          {"direction y"},
          {"direction z"},
          {"distance"},
          {"first frame", true},
          {"last frame", true}}}};
    return kMotions;
}

const MotionSignature* findMotion(std::string_view word) {
    for (const MotionSignature& motion : motions()) {
        if (motion.spelling == word) return &motion;
    }
    return nullptr;
}

/// "4" or "4-7"; nothing for anything else.
std::optional<std::array<std::uint64_t, 2>> objectRange(std::string_view word) {
    std::array<std::uint64_t, 2> range{};
    const char* const end = word.data() + word.size();
    const auto first = std::from_chars(word.data(), end, range[0]);
    if (first.ec != std::errc{}) return std::nullopt;
    range[1] = range[0];
    if (first.ptr == end) return range;
    if (*first.ptr != '-') return std::nullopt;
    const auto last = std::from_chars(first.ptr + 1, end, range[1]);
    if (last.ec != std::errc{} || last.ptr != end) return std::nullopt;
    return range;
}

bool startsStatement(std::string_view word) {
    return word == "movie" || word == "back" || word == "background" || word == "camera" ||
           objectRange(word);
}

class MovieParser {
public:
    std::optional<MovieStatement> operator()(StatementReader& reader) {
        const std::string_view next = reader.cursor.peek();
        const std::size_t begin = reader.cursor.offset();
        MovieStatement statement;
        if (!startsStatement(next)) {
            reportUnknown(reader);
            return std::nullopt;
        }
        statement.spelled = reader.cursor.take();
        if (!takeArguments(reader, statement)) {
            if (reader.lenient) reader.cursor.takeLine();
            reader.recover();
            return std::nullopt;
        }
        statement.text = reader.textSince(begin);
        return statement;
    }

private:
    bool takeArguments(StatementReader& reader, MovieStatement& statement) {
        const std::string& keyword = statement.spelled.text;
        if (keyword == "movie") {
            constexpr NumberLabel kHeader[] = {{"frames", true}, {"frames per second"}};
            return takeNumbers(reader, statement, kHeader);
        }
        if (keyword == "back" || keyword == "background") {
            statement.kind = MovieStatement::Kind::fade;
            constexpr NumberLabel kFade[] = {
                {"texture", true}, {"first frame", true}, {"last frame", true}};
            return takeNumbers(reader, statement, kFade);
        }
        statement.kind = MovieStatement::Kind::motion;
        if (keyword == "camera") {
            if (!takeCameraPoint(reader, statement)) return false;
        } else {
            statement.objectNumbers = *objectRange(keyword);
            if (statement.objectNumbers[0] > statement.objectNumbers[1]) {
                return refuse(reader, Code{389}, statement.spelled.location,
                              "the range " + quoted(keyword) + " runs backwards and moves nothing");
            }
        }
        return takeMotion(reader, statement);
    }

    bool takeNumbers(StatementReader& reader, MovieStatement& statement,
                     std::span<const NumberLabel> labels) {
        auto& previous = previousNumbers_[labels.front().name];
        if (!reader.numbers(statement.spelled, labels, previous, statement.numbers)) return false;
        if (reader.lenient) previous = statement.numbers;
        return true;
    }

    static bool takeCameraPoint(StatementReader& reader, MovieStatement& statement) {
        Word point;
        if (!reader.word(statement.spelled, "camera point (v, f or u)", point)) return false;
        switch (point.text.front()) {
        case 'v':
            statement.camera = CameraPoint::position;
            return true;
        case 'f':
            statement.camera = CameraPoint::front;
            return true;
        case 'u':
            statement.camera = CameraPoint::top;
            return true;
        default:
            return refuse(
                reader, Code{387}, point.location,
                quoted(point.text) +
                    " is no camera point: v is the eye, f the front point, u the top point");
        }
    }

    bool takeMotion(StatementReader& reader, MovieStatement& statement) {
        Word type;
        if (!reader.word(statement.spelled, "type of motion", type)) return false;
        const MotionSignature* const motion = findMotion(type.text);
        if (!motion) {
            std::vector<std::string> spellings;
            for (const MotionSignature& each : motions()) spellings.emplace_back(each.spelling);
            const std::string near = scene::nearest(type.text, spellings);
            return refuse(reader, Code{388}, type.location, "unknown motion " + quoted(type.text),
                          near.empty()
                              ? "it is one of rotate, rotateSelf, move, moveRadius and moveDirect"
                              : "did you mean '" + near + "'?");
        }
        if (statement.camera && motion->type == MotionType::rotateSelf) {
            return refuse(reader, Code{388}, type.location,
                          "a camera point has no rotateSelf: it is a point");
        }
        statement.type = motion->type;
        Word context = statement.spelled;
        context.text += " " + type.text;
        auto& previous = previousNumbers_[motion->spelling];
        if (!reader.numbers(context, motion->numbers, previous, statement.numbers)) return false;
        if (reader.lenient) previous = statement.numbers;
        return true;
    }

    /// An error, or in lenient reading a note that the statement is left out.
    static bool refuse(StatementReader& reader, Code code, const scene::Location& place,
                       const std::string& message, const std::string& suggestion = {}) {
        if (reader.lenient) {
            reader.diagnostics.note(place, message + "; the line is left out");
        } else {
            reader.diagnostics.error(code, place, message, suggestion);
        }
        return false;
    }

    static void reportUnknown(StatementReader& reader) {
        const scene::Location location = reader.cursor.here();
        if (reader.lenient) {
            reader.diagnostics.note(location, "skipped: " + quoted(reader.takeUnknown(false)));
            return;
        }
        const std::string word(reader.cursor.peek());
        const std::string near = scene::nearest(word, {"movie", "back", "background", "camera"});
        reader.diagnostics.error(
            Code{380}, location,
            quoted(word) + " starts no line of a movie file: movie, back, camera, an object number "
                           "or a range such as 3-6",
            near.empty() ? "" : "did you mean '" + near + "'?");
        reader.cursor.take();
        reader.recover();
    }

    std::map<std::string_view, std::vector<Number>> previousNumbers_;
};

} // namespace

MovieText parseMovieText(const std::shared_ptr<const scene::Source>& source, bool lenient,
                         scene::Diagnostics& diagnostics) {
    StatementReader reader(Cursor(source), lenient, diagnostics, startsStatement);
    return parseStatements<MovieStatement>(source, reader, MovieParser{});
}

bool looksLikeMovie(const std::shared_ptr<const scene::Source>& source) {
    Cursor cursor(source);
    while (!cursor.atEnd()) {
        if (cursor.peek().front() == '#') {
            cursor.takeLine();
            continue;
        }
        const std::string word = cursor.take().text;
        const std::string_view next = cursor.peek();
        if (word == "movie" && !next.empty()) return objectRange(next).has_value();
        if (word == "camera" && !next.empty()) return next == "v" || next == "f" || next == "u";
        if (objectRange(word) && findMotion(next)) return true;
        if (word == "window" || word == "scene" || word == "sphere") return false;
    }
    return false;
}

} // namespace rt::converters
