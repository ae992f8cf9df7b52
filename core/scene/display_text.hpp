// UTF-8 as a terminal shows it: code points, column widths, escapes.
#pragma once
#include <cstddef>
#include <string>
#include <string_view>

namespace rt::scene {

struct CodePoint {
    char32_t value = 0;
    std::size_t bytes = 1;
    bool valid = true; // false: one byte that is no UTF-8
};

/// The code point at the start of `text`, which is not empty. Overlong forms, surrogates and values
/// beyond U+10FFFF are invalid [RFC 3629].
CodePoint decodeUtf8(std::string_view text);

/// Offset of the first byte that is no UTF-8, or npos.
std::size_t findInvalidUtf8(std::string_view text);

struct Glyph {
    std::string text;
    int width; // terminal columns
};

/// Control characters and invalid bytes as \n, \t, \x1b, \u{200e}; everything else as it is.
Glyph glyphOf(const CodePoint& codePoint, std::string_view bytes);

/// All of `text` as glyphs: what a file or plugin says cannot move the cursor or colour the terminal.
std::string displayed(std::string_view text);

} // namespace rt::scene
