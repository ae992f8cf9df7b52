#include <converters/text.hpp>

#include <core/scene/display_text.hpp>
#include <core/scene/source.hpp>

#include <iconv.h>

#include <charconv>
#include <cmath>
#include <limits>

namespace rt::converters {
namespace {

using scene::Code;

constexpr std::size_t kMaxBytes = std::size_t(64) << 20;

bool isBlank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
bool isDigit(char c) { return c >= '0' && c <= '9'; }

std::optional<std::string> utf8From(const char* encoding, std::string_view bytes) {
    const iconv_t converter = iconv_open("UTF-8", encoding);
    if (converter == reinterpret_cast<iconv_t>(-1)) return std::nullopt;
    std::string out(bytes.size() * 4, '\0');
    std::string input(bytes);
    char* from = input.data();
    char* to = out.data();
    std::size_t fromLeft = input.size(), toLeft = out.size();
    const bool converted =
        iconv(converter, &from, &fromLeft, &to, &toLeft) != static_cast<std::size_t>(-1);
    iconv_close(converter);
    if (!converted) return std::nullopt;
    out.resize(out.size() - toLeft);
    return out;
}

std::string utf8FromLatin1(std::string_view bytes) {
    std::string out;
    for (const char c : bytes) {
        const auto code = static_cast<unsigned char>(c);
        if (code < 0x80) {
            out += c;
        } else {
            out += static_cast<char>(0xC0 | code >> 6);
            out += static_cast<char>(0x80 | (code & 0x3F));
        }
    }
    return out;
}

std::string withUnixLineEnds(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\r') {
            out += text[i];
        } else if (i + 1 == text.size() || text[i + 1] != '\n') {
            out += '\n';
        }
    }
    return out;
}

/// The prefix of `word` that scanf would read as a number.
std::string_view numberPrefix(std::string_view word, bool whole) {
    std::size_t i = 0;
    const auto digits = [&] {
        const std::size_t start = i;
        while (i < word.size() && isDigit(word[i])) ++i;
        return i - start;
    };
    if (i < word.size() && (word[i] == '-' || word[i] == '+')) ++i;
    std::size_t mantissa = digits();
    if (whole) return mantissa ? word.substr(0, i) : std::string_view{};
    if (i < word.size() && word[i] == '.') ++i, mantissa += digits();
    if (mantissa == 0) return {};
    const std::size_t beforeExponent = i;
    if (i < word.size() && (word[i] == 'e' || word[i] == 'E')) {
        ++i;
        if (i < word.size() && (word[i] == '-' || word[i] == '+')) ++i;
        if (digits() == 0) i = beforeExponent;
    }
    return word.substr(0, i);
}

} // namespace

std::shared_ptr<const scene::Source> toText(std::string path, std::string bytes,
                                            scene::Diagnostics& diagnostics) {
    auto source = std::make_shared<scene::Source>(scene::Source{std::move(path), {}});
    if (bytes.find('\0') != std::string::npos) {
        diagnostics.error(Code{410}, {source}, "this is no text file: it holds a zero byte");
        return nullptr;
    }
    if (bytes.starts_with("\xEF\xBB\xBF")) bytes.erase(0, 3);
    std::string_view encoding;
    if (scene::findInvalidUtf8(bytes) != std::string::npos) {
        if (auto chinese = utf8From("GB18030", bytes)) {
            bytes = std::move(*chinese), encoding = "GB18030 (Chinese)";
        } else {
            bytes = utf8FromLatin1(bytes), encoding = "ISO 8859-1 (Latin)";
        }
    }
    source->text = withUnixLineEnds(bytes);
    if (!encoding.empty()) {
        diagnostics.note({source, 0, 0},
                         "the file is not UTF-8; it is read as " + std::string(encoding));
    }
    return source;
}

std::shared_ptr<const scene::Source>
readText(const std::string& path, const scene::Location& namedAt, scene::Diagnostics& diagnostics) {
    const auto bytes = scene::readSource(path, kMaxBytes, diagnostics, namedAt);
    return bytes ? toText(path, bytes->text, diagnostics) : nullptr;
}

Cursor::Cursor(std::shared_ptr<const scene::Source> source)
    : Cursor(source, 0, source->text.size(), {source, 1, 1}) {}

Cursor::Cursor(std::shared_ptr<const scene::Source> source, std::size_t begin, std::size_t end,
               const scene::Location& start)
    : source_(std::move(source)), text_(source_->text), begin_(begin), offset_(begin), end_(end),
      line_(start.line), column_(start.column), lastLine_(start.line) {}

void Cursor::advance(std::size_t count) {
    for (; count; --count, ++offset_) {
        if (text_[offset_] == '\n') {
            ++line_, column_ = 1;
        } else {
            ++column_;
        }
    }
}

void Cursor::skipBlanks() {
    while (offset_ < end_ && isBlank(text_[offset_])) advance(1);
}

std::string_view Cursor::peek() {
    skipBlanks();
    std::size_t stop = offset_;
    while (stop < end_ && !isBlank(text_[stop])) ++stop;
    return text_.substr(offset_, stop - offset_);
}

Word Cursor::take() {
    const std::string_view word = peek();
    Word taken{std::string(word), here()};
    lastLine_ = line_;
    advance(word.size());
    return taken;
}

Cursor::Reading Cursor::number(bool whole, Number& out) {
    std::string_view word = peek();
    const std::string_view prefix = numberPrefix(word, whole);
    if (prefix.empty()) return Reading::notANumber;
    std::string_view digits = prefix;
    if (digits.front() == '+') digits.remove_prefix(1);
    if (whole) {
        std::int64_t value = 0;
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc{} || value > std::numeric_limits<std::int32_t>::max() ||
            value < std::numeric_limits<std::int32_t>::min()) {
            return Reading::outOfRange;
        }
        out.value = static_cast<double>(value);
    } else {
        double value = 0;
        const auto [end, error] =
            std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (error != std::errc{} || !std::isfinite(value)) return Reading::outOfRange;
        out.value = value;
    }
    out.location = here();
    lastLine_ = line_;
    advance(prefix.size());
    return Reading::number;
}

bool Cursor::insideWord() const {
    return offset_ > begin_ && offset_ < end_ && !isBlank(text_[offset_]) &&
           !isBlank(text_[offset_ - 1]);
}

std::string_view Cursor::wordAround() const {
    std::size_t start = offset_, stop = offset_;
    while (start > begin_ && !isBlank(text_[start - 1])) --start;
    while (stop < end_ && !isBlank(text_[stop])) ++stop;
    return text_.substr(start, stop - start);
}

std::string_view Cursor::takeLine() {
    std::size_t stop = offset_;
    while (stop < end_ && text_[stop] != '\n') ++stop;
    const std::string_view line = text_.substr(offset_, stop - offset_);
    lastLine_ = line_;
    advance(line.size());
    return line;
}

scene::Location Cursor::here() {
    skipBlanks();
    return {source_, line_, column_};
}

std::string Cursor::textSince(std::size_t begin) const {
    std::string text;
    for (std::size_t i = begin; i < offset_; ++i) {
        if (!isBlank(text_[i])) {
            text += text_[i];
        } else if (!text.empty() && text.back() != ' ') {
            text += ' ';
        }
    }
    if (text.ends_with(' ')) text.pop_back();
    return text;
}

bool Cursor::firstOnLine() {
    skipBlanks();
    std::size_t i = offset_;
    while (i > begin_ && isBlank(text_[i - 1])) {
        if (text_[i - 1] == '\n') return true;
        --i;
    }
    return i == begin_;
}

std::string shortest(double value) {
    char buffer[32];
    const auto end = std::to_chars(buffer, buffer + sizeof buffer, value).ptr;
    return {buffer, end};
}

} // namespace rt::converters
