#include <core/scene/display_text.hpp>

#include <algorithm>
#include <array>

namespace rt::scene {
namespace {

struct Range {
    char32_t first, last;
};

// Combining marks and zero-width characters of the scripts met in file names [Unicode 15, Mn and
// Cf].
constexpr Range kZeroWidth[] = {
    {0x0300, 0x036F}, {0x0483, 0x0489}, {0x0591, 0x05BD}, {0x0610, 0x061A}, {0x064B, 0x065F},
    {0x0E31, 0x0E31}, {0x0E34, 0x0E3A}, {0x0E47, 0x0E4E}, {0x1AB0, 0x1AFF}, {0x1DC0, 0x1DFF},
    {0x20D0, 0x20FF}, {0xFE00, 0xFE0F}, {0xFE20, 0xFE2F}};

// East Asian wide and full-width, and pictographs [Unicode 15, UAX 11].
constexpr Range kDoubleWidth[] = {{0x1100, 0x115F},   {0x2E80, 0x303E},   {0x3041, 0x33FF},
                                  {0x3400, 0x4DBF},   {0x4E00, 0x9FFF},   {0xA000, 0xA4CF},
                                  {0xAC00, 0xD7A3},   {0xF900, 0xFAFF},   {0xFE30, 0xFE6F},
                                  {0xFF00, 0xFF60},   {0xFFE0, 0xFFE6},   {0x1F300, 0x1F64F},
                                  {0x1F680, 0x1F6FF}, {0x1F900, 0x1F9FF}, {0x20000, 0x3FFFD}};

// Direction overrides and other invisible characters that make a line read as something else.
constexpr Range kInvisible[] = {{0x00AD, 0x00AD}, {0x061C, 0x061C}, {0x180E, 0x180E},
                                {0x200B, 0x200F}, {0x2028, 0x202E}, {0x2060, 0x206F},
                                {0xFEFF, 0xFEFF}, {0xFFF9, 0xFFFB}, {0xE0000, 0xE0FFF}};

template <std::size_t n> bool isIn(const Range (&ranges)[n], char32_t c) {
    return std::any_of(std::begin(ranges), std::end(ranges),
                       [c](const Range& range) { return c >= range.first && c <= range.last; });
}

std::string hexadecimal(char32_t value, int atLeastDigits) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string text;
    while (value != 0 || static_cast<int>(text.size()) < atLeastDigits) {
        text.insert(text.begin(), kDigits[value & 15]);
        value >>= 4;
    }
    return text;
}

} // namespace

CodePoint decodeUtf8(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned char lead = byte(0);
    if (lead < 0x80) return {lead, 1, true};
    const std::size_t length = lead >= 0xC2 && lead <= 0xDF   ? 2
                               : lead >= 0xE0 && lead <= 0xEF ? 3
                               : lead >= 0xF0 && lead <= 0xF4 ? 4
                                                              : 0;
    const CodePoint invalid{lead, 1, false};
    if (length == 0 || text.size() < length) return invalid;
    char32_t value = lead & (0xFFu >> (length + 1));
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0) != 0x80) return invalid;
        value = value << 6 | (byte(i) & 0x3Fu);
    }
    constexpr std::array<char32_t, 5> kSmallest{0, 0, 0x80, 0x800, 0x10000};
    if (value < kSmallest[length] || value > 0x10FFFF || (value >= 0xD800 && value <= 0xDFFF))
        return invalid;
    return {value, length, true};
}

std::size_t findInvalidUtf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        if (static_cast<unsigned char>(text[i]) < 0x80) {
            ++i;
            continue;
        }
        const CodePoint codePoint = decodeUtf8(text.substr(i));
        if (!codePoint.valid) return i;
        i += codePoint.bytes;
    }
    return std::string_view::npos;
}

Glyph glyphOf(const CodePoint& codePoint, std::string_view bytes) {
    const char32_t c = codePoint.value;
    std::string escaped;
    if (!codePoint.valid)
        escaped = "\\x" + hexadecimal(c, 2);
    else if (c == '\n')
        escaped = "\\n";
    else if (c == '\r')
        escaped = "\\r";
    else if (c == '\t')
        escaped = "\\t";
    else if (c < 0x20 || c == 0x7F)
        escaped = "\\x" + hexadecimal(c, 2);
    else if ((c >= 0x80 && c < 0xA0) || isIn(kInvisible, c))
        escaped = "\\u{" + hexadecimal(c, 4) + "}";
    if (!escaped.empty()) {
        const int width = static_cast<int>(escaped.size());
        return {std::move(escaped), width};
    }
    return {std::string(bytes.substr(0, codePoint.bytes)), isIn(kZeroWidth, c)     ? 0
                                                           : isIn(kDoubleWidth, c) ? 2
                                                                                   : 1};
}

std::string displayed(std::string_view text) {
    std::string shown;
    while (!text.empty()) {
        const CodePoint codePoint = decodeUtf8(text);
        shown += glyphOf(codePoint, text).text;
        text.remove_prefix(codePoint.bytes);
    }
    return shown;
}

} // namespace rt::scene
