#include <core/scene/values.hpp>

#include <core/numeric/angle.hpp>
#include <core/scene/codes.hpp>
#include <core/scene/display_text.hpp>
#include <core/scene/validate.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

namespace rt::scene {
namespace {

using Kind = Node::Kind;

/// File data inside a clause, without quotes: control characters escaped, at most 60 characters.
std::string shown(std::string_view text) {
    const std::string withQuotes = scene::quoted(text);
    return withQuotes.substr(1, withQuotes.size() - 2);
}

std::string got(const Node& node) {
    return node.quoted ? " (got the text " + scene::quoted(node.text) + ")"
                       : " (got " + shown(node.text) + ")";
}

Fault wrongKind(const Node& node, std::string_view wanted) {
    if (node.kind == Kind::null)
        return {codes::kWrongKind,
                node.location,
                "has no value; it must be " + std::string(wanted),
                {}};
    if (node.kind == Kind::scalar)
        return {codes::kWrongKind, node.location, "must be " + std::string(wanted) + got(node), {}};
    return {codes::kWrongKind,
            node.location,
            "must be " + std::string(wanted) + ", not " + std::string(kindName(node)),
            {}};
}

bool hasLeadingZero(std::string_view digits) {
    if (digits.starts_with('-') || digits.starts_with('+')) digits.remove_prefix(1);
    return digits.size() > 1 && digits[0] == '0' && digits[1] >= '0' && digits[1] <= '9';
}

bool isSpelledInfinityOrNan(std::string_view text) {
    if (text.starts_with('-') || text.starts_with('+')) text.remove_prefix(1);
    if (text.starts_with('.')) text.remove_prefix(1);
    std::string lower(text);
    std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return lower == "nan" || lower == "inf" || lower == "infinity";
}

/// The whole of `text` as a finite number. `node` is where it stands.
Parsed<double> parseNumber(std::string_view text, const Node& node, std::string_view wanted) {
    if (isSpelledInfinityOrNan(text))
        return Fault{codes::kNotFinite, node.location, "must be finite" + got(node), {}};
    if (hasLeadingZero(text))
        return Fault{codes::kNotANumber,
                     node.location,
                     "must be " + std::string(wanted) + " without leading zeros" + got(node),
                     {}};
    std::string_view digits = text;
    if (digits.starts_with('+') && !digits.substr(1).starts_with('-')) digits.remove_prefix(1);
    double number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error == std::errc::result_out_of_range && end == digits.data() + digits.size())
        return Fault{codes::kNotFinite,
                     node.location,
                     "is beyond the range of numbers, 1e308" + got(node),
                     {}};
    if (error != std::errc{} || end != digits.data() + digits.size() || digits.empty()) {
        std::string withPoint(text);
        std::replace(withPoint.begin(), withPoint.end(), ',', '.');
        double ignored = 0;
        const auto parsed =
            std::from_chars(withPoint.data(), withPoint.data() + withPoint.size(), ignored);
        const bool isComma = withPoint != text && parsed.ec == std::errc{} && *parsed.ptr == '\0';
        return Fault{codes::kNotANumber, node.location,
                     "must be " + std::string(wanted) + got(node),
                     isComma ? "write " + shown(withPoint) : ""};
    }
    return number;
}

Parsed<double> parseReal(const Node& node) {
    if (node.kind != Kind::scalar || node.quoted) return wrongKind(node, "a number");
    return parseNumber(node.text, node, "a number");
}

/// Written in degrees or radians; in degrees.
struct Angle {
    double degrees, radians;
};

Parsed<Angle> parseAngle(const Node& node) {
    constexpr std::string_view kWanted = "an angle such as 45deg or 0.8rad";
    if (node.kind != Kind::scalar || node.quoted) return wrongKind(node, kWanted);
    std::string_view number = node.text;
    const bool isDegrees = number.ends_with("deg"), isRadians = number.ends_with("rad");
    if (!isDegrees && !isRadians) {
        const Parsed<double> bare = parseNumber(number, node, kWanted);
        if (std::holds_alternative<double>(bare))
            return Fault{codes::kAngle, node.location, "is an angle and needs a unit" + got(node),
                         "write " + shown(number) + "deg or " + shown(number) + "rad"};
        Fault fault = std::get<Fault>(bare);
        if (fault.code == codes::kNotANumber) fault.code = codes::kAngle;
        return fault;
    }
    number.remove_suffix(3);
    if (number.ends_with(' ')) number.remove_suffix(1);
    const Parsed<double> parsed = parseNumber(number, node, kWanted);
    if (const auto* fault = std::get_if<Fault>(&parsed)) return *fault;
    const double value = std::get<double>(parsed);
    return isDegrees ? Angle{value, value * numeric::kRadiansPerDegree}
                     : Angle{value / numeric::kRadiansPerDegree, value};
}

std::string unitSuffix(const rt_param& row) { return row.unit == RT_UNIT_ANGLE ? "deg" : ""; }

double lowest(const rt_param& row) {
    return row.unit == RT_UNIT_LENGTH ? std::max(row.min, -kMaxLength) : row.min;
}
double highest(const rt_param& row) {
    return row.unit == RT_UNIT_LENGTH ? std::min(row.max, kMaxLength) : row.max;
}

/// As people write limits: 1000000 and 1e18.
std::string spelledOut(double limit) {
    constexpr double kLongest = 1e10;
    if (limit == std::floor(limit) && std::fabs(limit) < kLongest)
        return std::to_string(static_cast<std::int64_t>(limit));
    std::string text = shortest(limit);
    std::erase(text, '+');
    return text;
}

/// "> 0 and <= 1", or "" without limits.
std::string limitsOf(const rt_param& row, double low, double high) {
    std::string text;
    if (std::isfinite(low))
        text = (row.flags & RT_MIN_EXCLUSIVE && low == row.min ? "> " : ">= ") + spelledOut(low) +
               unitSuffix(row);
    if (std::isfinite(high))
        text += (text.empty() ? "" : " and ") +
                std::string(row.flags & RT_MAX_EXCLUSIVE && high == row.max ? "< " : "<= ") +
                spelledOut(high) + unitSuffix(row);
    return text;
}

/// Nothing, or why `number`, spelled by `node`, is outside the row's limits.
std::optional<Fault> checkLimits(double number, const Node& node, const rt_param& row) {
    const bool above = row.flags & RT_MIN_EXCLUSIVE ? number > row.min : number >= row.min;
    const bool below = row.flags & RT_MAX_EXCLUSIVE ? number < row.max : number <= row.max;
    const bool isTooSmall = row.unit == RT_UNIT_LENGTH && row.min == 0 &&
                            row.flags & RT_MIN_EXCLUSIVE && above && number * kMaxLength < 1;
    if (isTooSmall)
        return Fault{codes::kOutOfRange,
                     node.location,
                     "must be >= " + spelledOut(1 / kMaxLength) + got(node),
                     {}};
    if (above && below && number >= lowest(row) && number <= highest(row)) return std::nullopt;
    // A coordinate that is merely too far away need not hear of its other limit.
    const bool far = above && below;
    return Fault{codes::kOutOfRange,
                 node.location,
                 "must be " +
                     limitsOf(row, far ? lowest(row) : row.min, far ? highest(row) : row.max) +
                     got(node),
                 {}};
}

Parsed<double> parseLimited(const Node& node, const rt_param& row) {
    if (row.unit == RT_UNIT_ANGLE) {
        const Parsed<Angle> angle = parseAngle(node);
        if (const auto* fault = std::get_if<Fault>(&angle)) return *fault;
        if (auto fault = checkLimits(std::get<Angle>(angle).degrees, node, row)) return *fault;
        return std::get<Angle>(angle).radians;
    }
    Parsed<double> number = parseReal(node);
    if (const auto* value = std::get_if<double>(&number))
        if (auto fault = checkLimits(*value, node, row)) return *fault;
    return number;
}

Parsed<Vec3> parseTriple(const Node& node, const rt_param& row, std::string_view wanted) {
    if (node.kind != Kind::sequence) return wrongKind(node, wanted);
    if (node.items.size() != 3)
        return Fault{codes::kLength,
                     node.location,
                     "must be " + std::string(wanted) + " (got " +
                         std::to_string(node.items.size()) +
                         (node.items.size() == 1 ? " entry)" : " entries)"),
                     {}};
    Vec3 triple;
    for (int i = 0; i < 3; ++i) {
        const Parsed<double> number = parseLimited(node.items[static_cast<std::size_t>(i)], row);
        if (const auto* fault = std::get_if<Fault>(&number)) return *fault;
        triple[i] = std::get<double>(number);
    }
    return triple;
}

/// A '#' after a blank starts a comment, so that an unquoted colour is no value at all.
bool isUnquotedHexColor(const Node& node) {
    if (node.kind != Kind::null) return false;
    const auto line = lineOf(node.location);
    if (!line) return false;
    const std::size_t hash = line->find(": #", node.location.column - 1);
    if (hash == std::string_view::npos || line->size() < hash + 9) return false;
    return std::all_of(line->begin() + static_cast<std::ptrdiff_t>(hash) + 3,
                       line->begin() + static_cast<std::ptrdiff_t>(hash) + 9,
                       [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; });
}

Parsed<Vec3> parseColor(const Node& node, const rt_param& row) {
    constexpr std::string_view kWanted = "a colour: one number, [r, g, b], or \"#rrggbb\"";
    if (node.kind == Kind::sequence)
        return parseTriple(node, row, "a colour of three numbers [r, g, b]");
    if (node.kind == Kind::scalar && node.text.starts_with('#')) {
        std::array<unsigned char, 3> encoded{};
        bool valid = node.text.size() == 7;
        for (std::size_t i = 0; valid && i < 3; ++i) {
            const char* digits = node.text.data() + 1 + 2 * i;
            const auto [end, error] = std::from_chars(digits, digits + 2, encoded[i], 16);
            valid = error == std::errc{} && end == digits + 2;
        }
        if (!valid)
            return Fault{codes::kColor,
                         node.location,
                         "must be \"#\" and six hexadecimal digits, rrggbb (got " +
                             shown(node.text) + ")",
                         {}};
        Vec3 linear;
        for (int i = 0; i < 3; ++i)
            linear[i] = numeric::linearFromSrgb(encoded[static_cast<std::size_t>(i)] / 255.0);
        return linear;
    }
    if (node.kind == Kind::scalar && !node.quoted) {
        const Parsed<double> grey = parseNumber(node.text, node, kWanted);
        if (const auto* fault = std::get_if<Fault>(&grey)) {
            Fault inColor = *fault;
            if (inColor.code == codes::kNotANumber) inColor.code = codes::kColor;
            return inColor;
        }
        if (auto fault = checkLimits(std::get<double>(grey), node, row)) return *fault;
        return Vec3(std::get<double>(grey));
    }
    Fault fault = wrongKind(node, kWanted);
    if (isUnquotedHexColor(node))
        fault.suggestion = "'#' starts a comment: put the colour in quotes";
    return fault;
}

Parsed<Value> parseBool(const Node& node) {
    if (node.kind == Kind::scalar && !node.quoted) {
        if (node.text == "true" || node.text == "True" || node.text == "TRUE")
            return Value{std::int64_t{1}, node.location};
        if (node.text == "false" || node.text == "False" || node.text == "FALSE")
            return Value{std::int64_t{0}, node.location};
        std::string lower(node.text);
        std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
            return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        });
        const bool yes = lower == "yes" || lower == "on" || lower == "y" || lower == "1";
        const bool no = lower == "no" || lower == "off" || lower == "n" || lower == "0";
        return Fault{codes::kBool, node.location, "must be true or false" + got(node),
                     yes  ? "write true"
                     : no ? "write false"
                          : ""};
    }
    Fault fault = wrongKind(node, "true or false");
    fault.code = codes::kBool;
    return fault;
}

Parsed<Value> parseText(const Node& node, const rt_param& row) {
    const bool isFile = row.type == RT_FILE;
    const std::string_view wanted = isFile                   ? "the path of a file"
                                    : row.type == RT_TEXTURE ? "the name of a texture"
                                                             : "text";
    if (node.kind != Kind::scalar) return wrongKind(node, wanted);
    if (node.text.find('\0') != std::string::npos)
        return Fault{codes::kPath, node.location, "has a NUL character in it", {}};
    if (!isFile) return Value{node.text, node.location};
    if (node.text.empty()) return wrongKind(node, wanted);
    constexpr std::size_t kMaxPath = 4095; // PATH_MAX without its NUL
    const std::filesystem::path folder =
        node.location.source ? std::filesystem::path(node.location.source->path).parent_path()
                             : std::filesystem::path{};
    std::error_code error;
    const std::filesystem::path absolute = std::filesystem::absolute(folder / node.text, error);
    if (error || absolute.native().size() > kMaxPath)
        return Fault{codes::kPath, node.location, "is no possible path" + got(node), {}};
    return Value{absolute.native(), node.location};
}

Parsed<Value> parseChoice(const Node& node, const rt_param& row) {
    const std::vector<std::string> choices = choicesOf(row);
    std::string wanted;
    for (const std::string& choice : choices) wanted += (wanted.empty() ? "" : ", ") + choice;
    wanted = (choices.size() == 1 ? "" : "one of ") + wanted;
    if (node.kind != Kind::scalar) return wrongKind(node, wanted);
    const auto found = std::find(choices.begin(), choices.end(), node.text);
    if (found != choices.end())
        return Value{static_cast<std::int64_t>(found - choices.begin()), node.location};
    const std::string near = nearest(node.text, choices);
    return Fault{codes::kChoice, node.location, "must be " + wanted + got(node),
                 near.empty() ? "" : "did you mean '" + near + "'?"};
}

Parsed<Value> parseVectorList(const Node& node, const rt_param& row) {
    if (node.kind != Kind::sequence) return wrongKind(node, "a list of points [[x, y, z], ...]");
    Value::VectorList list;
    list.items.reserve(node.items.size());
    for (const Node& item : node.items) {
        const Parsed<Vec3> vector = parseTriple(item, row, "a list of three numbers [x, y, z]");
        if (const auto* fault = std::get_if<Fault>(&vector)) return *fault;
        list.items.push_back(std::get<Vec3>(vector));
    }
    return Value{std::move(list), node.location};
}

Parsed<std::int64_t> parseLimitedInteger(const Node& node, const rt_param& row) {
    const Parsed<std::int64_t> integer = parseInteger(node);
    if (const auto* value = std::get_if<std::int64_t>(&integer))
        if (auto fault = checkLimits(static_cast<double>(*value), node, row)) return *fault;
    return integer;
}

Parsed<Value> parseIntegerLists(const Node& node, const rt_param& row) {
    if (node.kind != Kind::sequence)
        return wrongKind(node, "a list of lists of whole numbers [[i, j, k], ...]");
    Value::IntegerLists lists;
    lists.entries.reserve(node.items.size());
    for (const Node& item : node.items) {
        if (item.kind != Kind::sequence)
            return wrongKind(item, "a list of whole numbers [i, j, k, ...]");
        std::vector<std::int64_t>& entry = lists.entries.emplace_back();
        for (const Node& number : item.items) {
            const Parsed<std::int64_t> integer = parseLimitedInteger(number, row);
            if (const auto* fault = std::get_if<Fault>(&integer)) return *fault;
            entry.push_back(std::get<std::int64_t>(integer));
        }
    }
    return Value{std::move(lists), node.location};
}

template <class T> Parsed<Value> valueFrom(Parsed<T> parsed, const Location& location) {
    if (auto* fault = std::get_if<Fault>(&parsed)) return std::move(*fault);
    return Value{std::get<T>(parsed), location};
}

/// A default, which is trusted text of the form that rows use: scalars and nested flow lists.
class FallbackText {
public:
    explicit FallbackText(std::string_view text) : text_(text) {}

    std::optional<Node> parse() {
        std::optional<Node> node = parseNode(0);
        skipBlanks();
        return at_ == text_.size() ? std::move(node) : std::nullopt;
    }

private:
    std::optional<Node> parseNode(int depth) {
        skipBlanks();
        if (at_ < text_.size() && text_[at_] == '[') {
            if (depth == 3) return std::nullopt;
            ++at_;
            Node list = flowNode(Kind::sequence);
            for (skipBlanks(); at_ < text_.size() && text_[at_] != ']'; skipBlanks()) {
                std::optional<Node> item = parseNode(depth + 1);
                if (!item) return std::nullopt;
                list.items.push_back(std::move(*item));
                skipBlanks();
                if (at_ < text_.size() && text_[at_] == ',')
                    ++at_;
                else if (at_ >= text_.size() || text_[at_] != ']')
                    return std::nullopt;
            }
            if (at_ >= text_.size()) return std::nullopt;
            ++at_;
            return list;
        }
        const bool isQuoted = at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\'');
        const std::size_t begin = at_ + (isQuoted ? 1 : 0);
        const std::size_t end = isQuoted     ? text_.find(text_[at_], begin)
                                : depth == 0 ? text_.size()
                                             : text_.find_first_of(",]", begin);
        if (end == std::string_view::npos) return std::nullopt;
        at_ = end + (isQuoted ? 1 : 0);
        std::string_view scalar = text_.substr(begin, end - begin);
        if (!isQuoted)
            while (scalar.ends_with(' ')) scalar.remove_suffix(1);
        Node node = scalarNode(std::string(scalar));
        node.quoted = isQuoted;
        return node;
    }

    void skipBlanks() {
        while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    }

    std::string_view text_;
    std::size_t at_ = 0;
};

} // namespace

std::string_view kindName(const Node& node) {
    switch (node.kind) {
    case Kind::null:
        return "nothing";
    case Kind::scalar:
        return node.quoted ? "text" : "a word or number";
    case Kind::sequence:
        return "a list";
    case Kind::map:
        break;
    }
    return "a map";
}

std::string shortest(double number) {
    std::array<char, 32> buffer{};
    const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
    return {buffer.data(), end};
}

Node scalarNode(std::string text) {
    Node node;
    node.kind = Kind::scalar;
    node.text = std::move(text);
    return node;
}

Node flowNode(Kind kind) {
    Node node;
    node.kind = kind;
    node.flow = true;
    return node;
}

std::vector<std::string> choicesOf(const rt_param& row) {
    std::vector<std::string> choices;
    for (std::string_view rest = row.choices ? row.choices : ""; !rest.empty();) {
        const std::size_t bar = std::min(rest.find('|'), rest.size());
        choices.emplace_back(rest.substr(0, bar));
        rest.remove_prefix(std::min(bar + 1, rest.size()));
    }
    return choices;
}

std::string describe(const rt_param& row) {
    const std::string limits = limitsOf(row, row.min, row.max);
    const auto with = [&](std::string noun) { return limits.empty() ? noun : noun + " " + limits; };
    switch (row.type) {
    case RT_BOOL:
        return "true or false";
    case RT_INTEGER:
        return with("whole number");
    case RT_REAL:
        return with(row.unit == RT_UNIT_ANGLE ? "angle (deg or rad)" : "number");
    case RT_VECTOR3:
        return with(row.flags & kUniform ? "number or [x, y, z]" : "[x, y, z]");
    case RT_COLOR:
        return with("number, [r, g, b] or \"#rrggbb\"");
    case RT_CHOICE: {
        std::string text;
        for (const std::string& choice : choicesOf(row))
            text += (text.empty() ? "" : ", ") + choice;
        return text;
    }
    case RT_FILE:
        return row.flags & RT_LOADS ? "file that a loader reads" : "file";
    case RT_TEXTURE:
        return "name of a texture";
    case RT_VECTOR3_LIST:
        return with("[[x, y, z], ...]");
    case RT_INTEGER_LISTS:
        return with("[[i, j, k, ...], ...]");
    default:
        return "text";
    }
}

Parsed<std::int64_t> parseInteger(const Node& node) {
    if (node.kind != Kind::scalar || node.quoted) return wrongKind(node, "a whole number");
    const Parsed<double> asNumber = parseNumber(node.text, node, "a whole number");
    if (const auto* fault = std::get_if<Fault>(&asNumber)) return *fault;
    std::string_view digits = node.text;
    if (digits.starts_with('+')) digits.remove_prefix(1);
    std::int64_t integer = 0;
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + digits.size(), integer);
    if (error == std::errc::result_out_of_range)
        return Fault{codes::kOutOfRange,
                     node.location,
                     "is beyond the range of whole numbers, 9223372036854775807" + got(node),
                     {}};
    if (error != std::errc{} || end != digits.data() + digits.size())
        return Fault{codes::kNotWhole, node.location, "must be a whole number" + got(node), {}};
    return integer;
}

Parsed<Value> parseValue(const Node& node, const rt_param& row) {
    switch (row.type) {
    case RT_BOOL:
        return parseBool(node);
    case RT_INTEGER:
        return valueFrom(parseLimitedInteger(node, row), node.location);
    case RT_REAL:
        return valueFrom(parseLimited(node, row), node.location);
    case RT_VECTOR3:
        if (row.flags & kUniform && node.kind == Kind::scalar) {
            const Parsed<double> all = parseLimited(node, row);
            if (const auto* fault = std::get_if<Fault>(&all)) return *fault;
            return Value{Vec3(std::get<double>(all)), node.location};
        }
        return valueFrom(parseTriple(node, row,
                                     row.flags & kUniform ? "a number or three numbers [x, y, z]"
                                                          : "three numbers [x, y, z]"),
                         node.location);
    case RT_COLOR:
        return valueFrom(parseColor(node, row), node.location);
    case RT_CHOICE:
        return parseChoice(node, row);
    case RT_VECTOR3_LIST:
        return parseVectorList(node, row);
    case RT_INTEGER_LISTS:
        return parseIntegerLists(node, row);
    default:
        return parseText(node, row);
    }
}

Parsed<Value> parseFallback(const rt_param& row) {
    if (row.fallback == nullptr) return Fault{codes::kBadFallback, {}, "needs a value", {}};
    if (*row.fallback == '\0') {
        const bool mayBeAbsent =
            row.type == RT_TEXT || row.type == RT_FILE || row.type == RT_TEXTURE;
        if (mayBeAbsent) return Value{};
    }
    const std::optional<Node> node = FallbackText(row.fallback).parse();
    if (!node)
        return Fault{codes::kBadFallback,
                     {},
                     "is no value of the scene language (got " + scene::quoted(row.fallback) + ")",
                     {}};
    if (row.type == RT_FILE || row.type == RT_TEXTURE)
        return Fault{codes::kBadFallback,
                     {},
                     "can only be absent by default (got " + scene::quoted(row.fallback) + ")",
                     {}};
    return parseValue(*node, row);
}

std::variant<Value, std::string> defaultValue(const rt_param& row) {
    Parsed<Value> parsed = parseFallback(row);
    if (auto* fault = std::get_if<Fault>(&parsed)) return std::move(fault->clause);
    return std::get<Value>(std::move(parsed));
}

Node nodeOf(const Value& value, const rt_param& row) {
    const auto numberNode = [&](double number) {
        if (row.unit != RT_UNIT_ANGLE) return scalarNode(shortest(number));
        std::string spelled = shortest(number) + "rad";
        const double degrees = number / numeric::kRadiansPerDegree;
        for (const double candidate : {std::round(degrees), degrees}) {
            const std::string inDegrees = shortest(candidate) + "deg";
            const bool isExact = candidate * numeric::kRadiansPerDegree == number;
            if (isExact && inDegrees.size() < spelled.size()) spelled = inDegrees;
        }
        return scalarNode(spelled);
    };
    const auto vectorNode = [&](const Vec3& vector) {
        Node list = flowNode(Kind::sequence);
        for (int i = 0; i < 3; ++i) list.items.push_back(numberNode(vector[i]));
        return list;
    };
    if (const auto* integer = std::get_if<std::int64_t>(&value.data)) {
        if (row.type == RT_BOOL) return scalarNode(*integer != 0 ? "true" : "false");
        if (row.type == RT_CHOICE)
            return scalarNode(choicesOf(row)[static_cast<std::size_t>(*integer)]);
        return scalarNode(std::to_string(*integer));
    }
    if (const auto* number = std::get_if<double>(&value.data)) return numberNode(*number);
    if (const auto* vector = std::get_if<Vec3>(&value.data)) return vectorNode(*vector);
    if (const auto* text = std::get_if<std::string>(&value.data)) {
        Node node = scalarNode(*text);
        node.quoted = true;
        return node;
    }
    Node list = flowNode(Kind::sequence);
    if (const auto* vectors = std::get_if<Value::VectorList>(&value.data))
        for (const Vec3& vector : vectors->items) list.items.push_back(vectorNode(vector));
    else if (const auto* lists = std::get_if<Value::IntegerLists>(&value.data))
        for (const auto& entry : lists->entries) {
            Node inner = flowNode(Kind::sequence);
            for (const std::int64_t integer : entry)
                inner.items.push_back(scalarNode(std::to_string(integer)));
            list.items.push_back(std::move(inner));
        }
    return list;
}

} // namespace rt::scene
