#include <formats/yaml_writer.hpp>

#include <core/scene/display_text.hpp>

#include <algorithm>
#include <array>

namespace rt::formats {
namespace {

using scene::Node;
using Kind = Node::Kind;

constexpr std::size_t kLineWidth = 100; // longer flow collections are broken
constexpr std::size_t kStep = 2;

// ---- scalars -------------------------------------------------------------------------------------------------

/// Words that YAML 1.1 or 1.2 reads as null, boolean or number.
bool isReservedWord(std::string_view text) {
    constexpr std::array<std::string_view, 14> kWords{"~",   "null", "true",     "false", "yes",
                                                      "no",  "on",   "off",      "y",     "n",
                                                      "nan", "inf",  "infinity", "="};
    std::string lower(text);
    std::transform(lower.begin(), lower.end(), lower.begin(), [](char c) {
        return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    });
    return std::find(kWords.begin(), kWords.end(), lower) != kWords.end();
}

/// A text that starts like this may be a number, a date or an angle to somebody.
bool startsLikeNumber(std::string_view text) {
    return !text.empty() && ((text[0] >= '0' && text[0] <= '9') || text[0] == '-' ||
                             text[0] == '+' || text[0] == '.');
}

bool needsEscapes(std::string_view text) {
    for (std::string_view rest = text; !rest.empty();) {
        const scene::CodePoint codePoint = scene::decodeUtf8(rest);
        if (!codePoint.valid ||
            scene::glyphOf(codePoint, rest).text != rest.substr(0, codePoint.bytes))
            return true;
        rest.remove_prefix(codePoint.bytes);
    }
    return false;
}

/// Does YAML read the text, without quotes, as one scalar of just this text?
bool isPlainSafe(std::string_view text, bool inFlow) {
    if (text.empty() || text.front() == ' ' || text.back() == ' ' || needsEscapes(text))
        return false;
    if (text.starts_with("---") || text.starts_with("...")) return false;
    constexpr std::string_view kIndicators = "-?:,[]{}#&*!|>'\"%@`<=~";
    const bool isNegative =
        text.size() > 1 && text[0] == '-' && (startsLikeNumber(text.substr(1)) && text[1] != '-');
    if (kIndicators.find(text[0]) != std::string_view::npos && !isNegative) return false;
    if (text.find(": ") != std::string_view::npos || text.ends_with(':') ||
        text.find(" #") != std::string_view::npos)
        return false;
    return !inFlow || text.find_first_of(",[]{}:?") == std::string_view::npos;
}

std::string doubleQuoted(std::string_view text) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string quoted = "\"";
    for (std::string_view rest = text; !rest.empty();) {
        const scene::CodePoint codePoint = scene::decodeUtf8(rest);
        const std::string_view bytes = rest.substr(0, codePoint.bytes);
        const char32_t c = codePoint.value;
        if (c == '"' || c == '\\')
            quoted += '\\', quoted += bytes;
        else if (c == '\n')
            quoted += "\\n";
        else if (c == '\t')
            quoted += "\\t";
        else if (!codePoint.valid)
            quoted += "\xEF\xBF\xBD"; // U+FFFD: no byte that is no UTF-8 can be written
        else if (scene::glyphOf(codePoint, rest).text != bytes) {
            quoted += c > 0xFFFF ? "\\U" : "\\u";
            for (int shift = c > 0xFFFF ? 28 : 12; shift >= 0; shift -= 4)
                quoted += kDigits[(c >> shift) & 15];
        } else
            quoted += bytes;
        rest.remove_prefix(codePoint.bytes);
    }
    return quoted + '"';
}

std::string inQuotes(std::string_view text) {
    const bool isSingle =
        text.find_first_of("\"\\") != std::string_view::npos && !needsEscapes(text);
    if (!isSingle) return doubleQuoted(text);
    std::string quoted = "'";
    for (const char c : text) quoted += c == '\'' ? std::string("''") : std::string(1, c);
    return quoted + '\'';
}

std::string scalarText(const Node& node, bool inFlow) {
    const bool couldBeMisread =
        node.quoted && (isReservedWord(node.text) || startsLikeNumber(node.text));
    return !couldBeMisread && isPlainSafe(node.text, inFlow) ? node.text : inQuotes(node.text);
}

std::string keyText(const std::string& key) {
    return isPlainSafe(key, true) && !isReservedWord(key) ? key : inQuotes(key);
}

// ---- layout --------------------------------------------------------------------------------------------------

bool hasInnerComments(const Node& node) {
    const auto commented = [](const Node& child) {
        return !child.comments->before.empty() || !child.comments->after.empty() ||
               hasInnerComments(child);
    };
    return !node.comments->atEnd.empty() ||
           std::any_of(node.items.begin(), node.items.end(), commented) ||
           std::any_of(node.members.begin(), node.members.end(),
                       [&](const Node::Member& member) { return commented(member.value); });
}

/// Flow style, appended to `text`. Gives up beyond `width` bytes: false.
bool appendFlow(std::string& text, const Node& node, std::size_t width) {
    if (text.size() > width) return false;
    switch (node.kind) {
    case Kind::null:
        text += "~";
        break;
    case Kind::scalar:
        text += scalarText(node, true);
        break;
    case Kind::sequence:
        text += '[';
        for (std::size_t i = 0; i < node.items.size(); ++i) {
            if (i > 0) text += ", ";
            if (!appendFlow(text, node.items[i], width)) return false;
        }
        text += ']';
        break;
    case Kind::map:
        text += '{';
        for (std::size_t i = 0; i < node.members.size(); ++i) {
            text += (i > 0 ? ", " : "") + keyText(node.members[i].key) + ": ";
            if (!appendFlow(text, node.members[i].value, width)) return false;
        }
        text += '}';
        break;
    }
    return text.size() <= width;
}

class Writer {
public:
    std::string text;

    void writeRoot(const Node& root) {
        writeComments(root.comments->before, 0);
        if (isBlock(root, 0)) {
            writeBlock(root, 0);
        } else {
            text += inline_;
            writeCommentAfter(root);
        }
    }

private:
    /// False where the node fits behind `column`, and inline_ then holds its text.
    bool isBlock(const Node& node, std::size_t column) {
        inline_.clear();
        const bool isCollection = node.kind == Kind::sequence || node.kind == Kind::map;
        if (!isCollection) {
            inline_ = node.kind == Kind::null ? "~" : scalarText(node, false);
            return false;
        }
        if (node.items.empty() && node.members.empty() && node.comments->atEnd.empty()) {
            inline_ = node.kind == Kind::map ? "{}" : "[]";
            return false;
        }
        if (!node.flow || hasInnerComments(node)) return true;
        const std::size_t width = column < kLineWidth ? kLineWidth - column : 0;
        const bool fits = appendFlow(inline_, node, width);
        const bool isScalarList =
            node.kind == Kind::sequence &&
            std::all_of(node.items.begin(), node.items.end(), [](const Node& item) {
                return item.kind == Kind::scalar || item.kind == Kind::null;
            });
        if (fits) return false;
        if (!isScalarList) return true;
        inline_ = filledList(node, column);
        return false;
    }

    /// A long list of scalars, as many as fit on each line.
    static std::string filledList(const Node& node, std::size_t column) {
        const std::string indent(std::min(column, kLineWidth / 2) + 1, ' ');
        std::string list = "[";
        std::size_t used = column + 1;
        for (std::size_t i = 0; i < node.items.size(); ++i) {
            const Node& item = node.items[i];
            const std::string word = (item.kind == Kind::null ? "~" : scalarText(item, true)) +
                                     (i + 1 < node.items.size() ? "," : "]");
            if (i > 0 && used + 1 + word.size() > kLineWidth) {
                list += "\n" + indent;
                used = indent.size();
            } else if (i > 0) {
                list += ' ', ++used;
            }
            list += word;
            used += word.size();
        }
        return list;
    }

    void writeBlock(const Node& node, std::size_t indent) {
        for (const Node::Member& member : node.members) writeMember(member, indent, false);
        for (const Node& item : node.items) writeItem(item, indent);
        writeComments(node.comments->atEnd, indent);
    }

    /// isInItem: the key stands behind a "- ", and its comments have been written.
    void writeMember(const Node::Member& member, std::size_t indent, bool isInItem) {
        if (!isInItem) {
            writeComments(member.value.comments->before, indent);
            text.append(indent, ' ');
        }
        const std::string key = keyText(member.key);
        text += key + ":";
        if (isBlock(member.value, indent + key.size() + 2)) {
            writeCommentAfter(member.value);
            writeBlock(member.value, indent + kStep);
        } else {
            text += " " + inline_;
            writeCommentAfter(member.value);
        }
    }

    void writeItem(const Node& item, std::size_t indent) {
        writeComments(item.comments->before, indent);
        const bool isMap = item.kind == Kind::map && !item.members.empty();
        const bool block = isBlock(item, indent + kStep);
        const std::string inlineText = inline_;
        if (block && isMap) {
            writeComments(item.members.front().value.comments->before, indent);
            const bool hasOwnLine = !item.comments->after.empty();
            text.append(indent, ' ');
            text += "-";
            if (hasOwnLine) {
                writeCommentAfter(item);
                text.append(indent + kStep, ' ');
            } else {
                text += ' ';
            }
            for (std::size_t i = 0; i < item.members.size(); ++i)
                writeMember(item.members[i], indent + kStep, i == 0);
            writeComments(item.comments->atEnd, indent + kStep);
            return;
        }
        text.append(indent, ' ');
        text += block ? "-" : "- " + inlineText;
        writeCommentAfter(item);
        if (block) writeBlock(item, indent + kStep);
    }

    void writeComments(const std::vector<std::string>& lines, std::size_t indent) {
        for (const std::string& line : lines) {
            text.append(indent, ' ');
            text += comment(line) + "\n";
        }
    }

    void writeCommentAfter(const Node& node) {
        if (!node.comments->after.empty()) text += "  " + comment(node.comments->after);
        text += '\n';
    }

    /// Whatever the line holds, it stays one line and UTF-8.
    static std::string comment(std::string_view line) {
        std::string result = "#";
        if (!line.empty()) result += ' ';
        for (; !line.empty();) {
            const scene::CodePoint codePoint = scene::decodeUtf8(line);
            result += codePoint.value == '\t' ? " " : scene::glyphOf(codePoint, line).text;
            line.remove_prefix(codePoint.bytes);
        }
        return result;
    }

    std::string inline_;
};

} // namespace

std::string writeYaml(const Node& root) {
    Writer writer;
    writer.writeRoot(root);
    return std::move(writer.text);
}

} // namespace rt::formats
