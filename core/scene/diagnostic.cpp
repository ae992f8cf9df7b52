#include <core/scene/diagnostic.hpp>

#include <core/scene/display_text.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

namespace rt::scene {
namespace {

constexpr int kExcerptWidth = 80; // terminal columns of the quoted source line
constexpr int kTabWidth = 4;
constexpr std::size_t kQuotedLength = 60; // characters of file data in one message

std::string_view severityName(Severity severity) {
    switch (severity) {
    case Severity::note:
        return "note";
    case Severity::warning:
        return "warning";
    case Severity::error:
        break;
    }
    return "error";
}

std::string sentenceOf(const Diagnostic& diagnostic) {
    return diagnostic.suggestion.empty() ? diagnostic.message
                                         : diagnostic.message + "; " + diagnostic.suggestion;
}

/// The source line with a caret below it, cut to kExcerptWidth columns around the caret.
std::string excerpt(const Location& location, bool colour) {
    const auto line = lineOf(location);
    if (!line) return {};
    const std::size_t caretByte =
        std::min<std::size_t>(location.column == 0 ? 0 : location.column - 1, line->size());

    // A line may have megabytes: only this many bytes on either side can be visible.
    constexpr std::size_t kReach = 4 * kExcerptWidth;
    std::size_t begin = caretByte > kReach ? caretByte - kReach : 0;
    while (begin > 0 && begin < caretByte &&
           (static_cast<unsigned char>((*line)[begin]) & 0xC0) == 0x80)
        ++begin;
    const std::size_t end = std::min(line->size(), caretByte + kReach);

    std::vector<Glyph> glyphs;
    std::optional<std::size_t> caret; // index of the glyph it points at
    for (std::size_t i = begin; i < end;) {
        const std::string_view rest = line->substr(i);
        const CodePoint codePoint = decodeUtf8(rest);
        if (!caret && i + codePoint.bytes > caretByte) caret = glyphs.size();
        if (codePoint.value == '\t')
            glyphs.push_back({std::string(kTabWidth, ' '), kTabWidth});
        else
            glyphs.push_back(glyphOf(codePoint, rest));
        i += codePoint.bytes;
    }
    if (!caret) {
        caret = glyphs.size();
        glyphs.push_back({" ", 1}); // the end of the line
    }

    const int whole =
        std::accumulate(glyphs.begin(), glyphs.end(), 0,
                        [](int sum, const Glyph& glyph) { return sum + glyph.width; });
    std::size_t first = 0, last = glyphs.size();
    if (begin > 0 || end < line->size() || whole > kExcerptWidth) {
        // Grow a window around the caret, one glyph at a time on alternating sides; "…" marks each
        // cut.
        first = *caret, last = *caret + 1;
        int width = glyphs[*caret].width;
        const auto fits = [&](std::size_t index) {
            return width + glyphs[index].width <= kExcerptWidth - 2;
        };
        for (bool grown = true; grown;) {
            grown = false;
            if (first > 0 && fits(first - 1)) width += glyphs[--first].width, grown = true;
            if (last < glyphs.size() && fits(last)) width += glyphs[last++].width, grown = true;
        }
    }
    const bool cutBefore = first > 0 || begin > 0,
               cutAfter = last < glyphs.size() || end < line->size();

    std::string text = cutBefore ? "…" : "";
    int caretColumn = cutBefore ? 1 : 0;
    for (std::size_t i = first; i < last; ++i) {
        text += glyphs[i].text;
        if (i < *caret) caretColumn += glyphs[i].width;
    }
    if (cutAfter) text += "…";
    while (text.ends_with(' ')) text.pop_back();

    std::string number = std::to_string(location.line);
    number.insert(0, number.size() < 5 ? 5 - number.size() : 0, ' ');
    const std::string pointer = std::string(static_cast<std::size_t>(caretColumn), ' ') +
                                (colour ? "\x1b[1;32m^\x1b[0m" : "^");
    return number + " | " + text + "\n" + std::string(number.size(), ' ') + " | " + pointer + "\n";
}

/// Optimal string alignment distance: insertions, deletions, substitutions, swaps of neighbours.
std::size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> beforePrevious, previous(b.size() + 1), current(b.size() + 1);
    std::iota(previous.begin(), previous.end(), 0);
    for (std::size_t i = 1; i <= a.size(); ++i) {
        current[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            current[j] = std::min(
                {previous[j] + 1, current[j - 1] + 1, previous[j - 1] + (a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                current[j] = std::min(current[j], beforePrevious[j - 2] + 1);
        }
        beforePrevious = std::exchange(previous, current);
    }
    return previous[b.size()];
}

} // namespace

std::optional<std::string_view> lineOf(const Location& location) {
    if (!location.source || location.line == 0) return std::nullopt;
    std::string_view rest = location.source->text;
    for (std::uint32_t line = 1; line < location.line; ++line) {
        const std::size_t end = rest.find('\n');
        if (end == std::string_view::npos) return std::nullopt;
        rest.remove_prefix(end + 1);
    }
    std::string_view line = rest.substr(0, rest.find('\n'));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::string codeName(Code code) {
    std::string digits = std::to_string(static_cast<unsigned>(code));
    return "E" + std::string(digits.size() < 4 ? 4 - digits.size() : 0, '0') + digits;
}

void Diagnostics::error(Code code, Location location, std::string message, std::string suggestion) {
    if (errorCount_++ == 0) exitCode_ = static_cast<int>(code) / 100;
    if (errorCount_ <= kMaxErrors)
        all_.push_back({Severity::error, code, std::move(location), std::move(message),
                        std::move(suggestion)});
}

void Diagnostics::warning(Location location, std::string message) {
    all_.push_back({Severity::warning, Code{}, std::move(location), std::move(message), {}});
}

void Diagnostics::note(Location location, std::string message) {
    all_.push_back({Severity::note, Code{}, std::move(location), std::move(message), {}});
}

void Diagnostics::add(const Diagnostics& others) {
    for (const Diagnostic& diagnostic : others.all_) {
        if (diagnostic.severity != Severity::error)
            all_.push_back(diagnostic);
        else
            error(diagnostic.code, diagnostic.location, diagnostic.message, diagnostic.suggestion);
    }
    errorCount_ +=
        others.errorCount_ - std::min(others.errorCount_, kMaxErrors); // counted, not kept
}

int Diagnostics::exitCode() const { return exitCode_; }

void Diagnostics::sortByPlace() {
    std::vector<const Source*> sources; // in order of first appearance
    const auto rank = [&](const Diagnostic& diagnostic) {
        const Source* source = diagnostic.location.source.get();
        const auto found = std::find(sources.begin(), sources.end(), source);
        if (found == sources.end()) sources.push_back(source);
        return static_cast<std::size_t>(std::find(sources.begin(), sources.end(), source) -
                                        sources.begin());
    };
    for (const Diagnostic& diagnostic : all_) rank(diagnostic);
    std::stable_sort(all_.begin(), all_.end(), [&](const Diagnostic& a, const Diagnostic& b) {
        return std::tuple(rank(a), a.location.line, a.location.column) <
               std::tuple(rank(b), b.location.line, b.location.column);
    });
}

std::string format(const Diagnostic& diagnostic, bool colour) {
    const auto paint = [colour](std::string_view sequence, std::string text) {
        return colour ? "\x1b[" + std::string(sequence) + "m" + text + "\x1b[0m" : text;
    };
    std::string place;
    if (const Location& location = diagnostic.location; location.source) {
        place = displayed(location.source->path);
        if (location.line != 0)
            place += ":" + std::to_string(location.line) + ":" + std::to_string(location.column);
        place = paint("1", place + ":") + " ";
    }
    std::string label(severityName(diagnostic.severity));
    if (diagnostic.severity == Severity::error) label += "[" + codeName(diagnostic.code) + "]";
    const std::string_view hue = diagnostic.severity == Severity::error     ? "1;31"
                                 : diagnostic.severity == Severity::warning ? "1;35"
                                                                            : "1;36";
    return place + paint(hue, label + ":") + " " + displayed(sentenceOf(diagnostic)) + "\n" +
           excerpt(diagnostic.location, colour);
}

std::string formatJson(const Diagnostic& diagnostic) {
    nlohmann::ordered_json json;
    if (const Location& location = diagnostic.location; location.source) {
        json["file"] = location.source->path;
        if (location.line != 0) json["line"] = location.line, json["column"] = location.column;
    }
    json["severity"] = severityName(diagnostic.severity);
    if (diagnostic.severity == Severity::error) json["code"] = codeName(diagnostic.code);
    json["message"] = diagnostic.message;
    if (!diagnostic.suggestion.empty()) json["suggestion"] = diagnostic.suggestion;
    return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
    constexpr std::size_t kMaxDistance = 2;
    std::string best;
    std::size_t bestDistance = kMaxDistance + 1;
    for (const std::string& candidate : candidates) {
        const std::size_t sizes[] = {word.size(), candidate.size()};
        if (std::max(sizes[0], sizes[1]) - std::min(sizes[0], sizes[1]) > kMaxDistance) continue;
        const std::size_t distance = editDistance(word, candidate);
        if (distance < bestDistance && 2 * distance < word.size())
            best = candidate, bestDistance = distance;
    }
    return best;
}

std::string quoted(std::string_view fileData) {
    std::string text = "'";
    std::size_t characters = 0;
    while (!fileData.empty()) {
        if (characters++ == kQuotedLength) {
            text += "…";
            break;
        }
        const CodePoint codePoint = decodeUtf8(fileData);
        text += glyphOf(codePoint, fileData).text;
        fileData.remove_prefix(codePoint.bytes);
    }
    return text + "'";
}

} // namespace rt::scene
