#include "text_cursor.hpp"

#include <algorithm>
#include <cstring>

namespace rt::loaders {

namespace {
/// Does a comment begin between the start of the line of `where` and `where`?
bool inComment(const char* begin, const char* where) {
    for (const char* p = where; p != begin && !isLineEnd(p[-1]); --p)
        if (p[-1] == '#' && (p - 1 == begin || isBlank(p[-2]) || isLineEnd(p[-2]))) return true;
    return false;
}
} // namespace

std::string quoted(std::string_view text) {
    constexpr std::size_t kLongest = 40;
    std::string out = "'";
    for (const char c : text.substr(0, kLongest)) {
        if (c >= 0x20 && c < 0x7f) {
            out += c;
        } else {
            static constexpr char kHex[] = "0123456789abcdef";
            const auto byte = static_cast<unsigned char>(c);
            out += {'\\', 'x', kHex[byte >> 4], kHex[byte & 15]};
        }
    }
    return out + (text.size() > kLongest ? "...'" : "'");
}

TextCursor::TextCursor(std::string name, std::string text, bool joinLines)
    : name_(std::move(name)), text_(std::move(text)) {
    const auto begins = [&](std::string_view mark) {
        return std::string_view(text_).substr(0, mark.size()) == mark;
    };
    if (begins("\xfe\xff") || begins("\xff\xfe"))
        throw FileError(name_ + ":1:1: is UTF-16; only UTF-8 and ASCII are read");
    at = text_.data();
    end_ = text_.data() + text_.size();
    if (const void* nul = std::memchr(text_.data(), 0, text_.size()))
        fail(static_cast<const char*>(nul), "is binary data, not text (a NUL byte)");
    if (begins("\xef\xbb\xbf")) at += 3;
    if (!joinLines) return;
    char* const begin = text_.data();
    char* const end = begin + text_.size();
    for (char* p = begin;
         (p = static_cast<char*>(std::memchr(p, '\\', static_cast<std::size_t>(end - p))));) {
        char* const slash = p++;
        while (isBlank(*p)) ++p;
        if (!isLineEnd(*p) || p == end || inComment(begin, slash)) continue;
        if (p[0] == '\r' && p[1] == '\n') ++p;
        ++p;
        std::fill(slash, p, ' ');
        joins_.push_back(static_cast<std::size_t>(p - begin));
    }
}

std::string_view TextCursor::restOfLine() {
    skipBlanks();
    const char* const from = at;
    while (!isLineEnd(*at)) ++at;
    const char* to = at;
    for (const char* p = from; p < to; ++p)
        if (*p == '#' && (p == from || isBlank(p[-1]))) to = p;
    while (to != from && isBlank(to[-1])) --to;
    return {from, static_cast<std::size_t>(to - from)};
}

TextCursor::Location TextCursor::locate(const char* where) const {
    const char* const begin = text_.data();
    where = std::min(where, end_);
    const char* lineStart = begin;
    std::uint64_t line = 1;
    for (const char* p = begin; p != where; ++p) {
        if (*p == '\n' || (*p == '\r' && p[1] != '\n')) ++line, lineStart = p + 1;
    }
    for (const std::size_t join : joins_) {
        if (begin + join > where) break;
        ++line;
        lineStart = std::max(lineStart, begin + join);
    }
    const bool mark =
        lineStart == begin && text_.compare(0, 3, "\xef\xbb\xbf") == 0 && where - begin >= 3;
    return {line, static_cast<std::uint64_t>(where - lineStart) + 1 - (mark ? 3 : 0)};
}

std::string TextCursor::place(const char* where) const {
    return name_ + ":" + std::to_string(locate(where).line);
}

void TextCursor::fail(const char* where, const std::string& why) const {
    const auto [line, column] = locate(where);
    throw FileError(name_ + ":" + std::to_string(line) + ":" + std::to_string(column) + ": " + why);
}

std::string TextCursor::notFinite(const char* what) const {
    return std::string(what) + " is not a finite number: " +
           quoted({lastToken_, static_cast<std::size_t>(at - lastToken_)});
}

void TextCursor::failNumber(const char* from, const char* what) const {
    const char* p = from;
    while (!isBlank(*p) && !isLineEnd(*p)) ++p;
    if (p == from || *from == '#') fail(from, std::string(what) + " is missing");
    std::string why = std::string(what) +
                      " is not a number: " + quoted({from, static_cast<std::size_t>(p - from)});
    if (std::count(from, p, ',') == 1) why += "; the decimal point is '.'";
    fail(from, why);
}

} // namespace rt::loaders
