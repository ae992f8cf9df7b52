// A cursor over the text of a file: numbers, words and places in lines. The text has no NUL in it and one behind its end.
#pragma once
#include "mesh_file.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

namespace rt::loaders {

constexpr bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
constexpr bool isLineEnd(char c) { return c == '\n' || c == '\r' || c == '\0'; }
constexpr bool isDigit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

/// `text` for a message: quoted, shortened, with everything but printable ASCII escaped.
std::string quoted(std::string_view text);

class TextCursor {
public:
    /// Takes the text of the file called `name`. A UTF-8 byte-order mark is skipped; with `joinLines`,
    /// a backslash at the end of a line joins it to the next. Throws FileError for UTF-16 and for
    /// text that holds a NUL.
    TextCursor(std::string name, std::string text, bool joinLines);
    TextCursor(const TextCursor&) = delete;
    TextCursor& operator=(const TextCursor&) = delete;

    const char* at = nullptr; // next character; a NUL at the end of the text

    bool atEnd() const { return at >= end_; }
    void skipBlanks() {
        while (isBlank(*at)) ++at;
    }
    /// To the beginning of the next line.
    void skipLine() {
        while (!isLineEnd(*at)) ++at;
        if (*at) ++at;
    }
    /// Does the statement end here: line, text or comment?
    bool statementEnds() const { return isLineEnd(*at) || *at == '#'; }
    /// Characters up to a blank or the end of the line.
    std::string_view word() {
        const char* from = at;
        while (!isBlank(*at) && !isLineEnd(*at)) ++at;
        return {from, static_cast<std::size_t>(at - from)};
    }
    /// The same, without moving.
    std::string_view peekWord() const {
        const char* to = at;
        while (!isBlank(*to) && !isLineEnd(*to)) ++to;
        return {at, static_cast<std::size_t>(to - at)};
    }
    /// The rest of the line without blanks around it and without a comment, which here begins with '#'
    /// behind a blank. Leaves the cursor at the end of the line.
    std::string_view restOfLine();

    /// A finite number that ends at a blank, '#' or the end of the line; blanks before it are
    /// skipped. `what` names it in the message. Throws FileError.
    double real(const char* what) {
        const double value = anyReal(what);
        if (!std::isfinite(value)) fail(lastToken_, notFinite(what));
        return value;
    }
    /// As real(), but infinities and NaN may be written.
    double anyReal(const char* what);

    /// Throws FileError: "name:line:column: why" for the place of `where`.
    [[noreturn]] void fail(const char* where, const std::string& why) const;
    [[noreturn]] void fail(const std::string& why) const { fail(at, why); }
    /// "name:line" of the place of `where`.
    std::string place(const char* where) const;

    const std::string& name() const { return name_; }
    std::size_t size() const { return text_.size(); }

private:
    struct Location {
        std::uint64_t line, column; // from 1
    };
    Location locate(const char* where) const;
    std::string notFinite(const char* what) const;
    [[noreturn]] void failNumber(const char* from, const char* what) const;

    std::string name_, text_;
    std::vector<std::size_t>
        joins_; // offsets at which a line of the file began before it was joined
    const char* end_ = nullptr;
    const char* lastToken_ = nullptr;
};

inline double TextCursor::anyReal(const char* what) {
    skipBlanks();
    const char* const from = at;
    lastToken_ = from;
    const char* p = from;
    const bool negative = *p == '-';
    if (*p == '-' || *p == '+') ++p;

    // At most 19 digits cannot overflow; below 2^53 and with |exponent| <= 22 both factors are exact
    // and one correctly rounded operation gives the nearest double [Clinger 1990].
    std::uint64_t digits = 0;
    const char* const first = p;
    while (isDigit(*p)) digits = 10 * digits + static_cast<unsigned>(*p++ - '0');
    auto count = p - first;
    int exponent = 0;
    if (*p == '.') {
        const char* const fraction = ++p;
        while (isDigit(*p)) digits = 10 * digits + static_cast<unsigned>(*p++ - '0');
        exponent = -static_cast<int>(p - fraction);
        count += p - fraction;
    }
    if (count >= 1 && count <= 19 && (*p == 'e' || *p == 'E')) {
        const char* q = p + 1;
        const bool minus = *q == '-';
        if (*q == '-' || *q == '+') ++q;
        int written = 0;
        const char* const begin = q;
        while (isDigit(*q) && written < 1000) written = 10 * written + (*q++ - '0');
        if (q == begin || isDigit(*q)) count = 0;
        exponent += minus ? -written : written;
        p = q;
    }
    constexpr std::uint64_t kExact = std::uint64_t{1} << 53;
    if (count >= 1 && count <= 19 && digits <= kExact && exponent >= -22 && exponent <= 22 &&
        (isBlank(*p) || isLineEnd(*p) || *p == '#')) {
        static constexpr double kPowers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                             1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                             1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
        const double m = static_cast<double>(digits);
        const double value = exponent < 0 ? m / kPowers[-exponent] : m * kPowers[exponent];
        at = p;
        return negative ? -value : value;
    }

    p = from + (*from == '+');
    if (*p == '-' && p != from) failNumber(from, what);
    double value = 0;
    const auto [stop, error] = std::from_chars(p, end_, value);
    if (error == std::errc::invalid_argument ||
        !(isBlank(*stop) || isLineEnd(*stop) || *stop == '#'))
        failNumber(from, what);
    if (error == std::errc::result_out_of_range) {
        // Too small or too large? Too small when the value written with the exponent taken away from
        // it lies below one: strip the sign and look for a negative exponent or a leading zero.
        const std::string_view token(p, static_cast<std::size_t>(stop - p));
        const auto mark = token.find_first_of("eE");
        const bool tiny = mark != token.npos ? token[mark + 1] == '-'
                                             : token.find_first_of("123456789") > token.find('.');
        value = tiny ? 0.0 : std::numeric_limits<double>::infinity();
        if (*p == '-') value = -value;
    }
    at = stop;
    return value;
}

} // namespace rt::loaders
