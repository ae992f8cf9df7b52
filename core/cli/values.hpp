// The words of the command line to values: no octal, no nan, no locale, no rest that is ignored.
#pragma once
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rt::cli {

/// The command line is wrong: a sentence that ends exit 2. `hint` is a suggestion, or empty.
struct UsageError : std::runtime_error {
    explicit UsageError(const std::string& sentence, std::string hint_ = {})
        : std::runtime_error(sentence), hint(std::move(hint_)) {}
    std::string hint;
};

struct Size {
    std::uint32_t width, height;
};

/// x0 <= x < x1 and y0 <= y < y1, pixels from the top left corner.
using Rectangle = std::array<std::uint32_t, 4>;

/// All throw UsageError with a sentence that starts with what the word must be.
std::uint32_t parseWhole(std::string_view word, std::uint32_t min, std::uint32_t max);
/// "4096", "64K", "16M", "2G": powers of 1024, at least 1.
std::uint64_t parseBytes(std::string_view word);
double parseReal(std::string_view word, double min, double max);
/// Seconds, above 0: `10s`, `500ms`, `2min`, or a number of seconds.
double parseDuration(std::string_view word);
Size parseSize(std::string_view word);
Rectangle parseRectangle(std::string_view word);
std::array<std::uint32_t, 2> parsePixel(std::string_view word);

/// Index of `word` in `choices`; suggests the nearest.
std::size_t parseChoice(std::string_view word, const std::vector<std::string>& choices);

/// `a, b or c`.
std::string listed(const std::vector<std::string>& words);

} // namespace rt::cli
