#include <core/cli/values.hpp>

#include <core/scene/diagnostic.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

namespace rt::cli {

namespace {

constexpr std::uint32_t kMaxPixels =
    std::numeric_limits<std::int32_t>::max(); // of one side; the scene has its own limit

bool isWhole(std::string_view word) {
    return !word.empty() &&
           std::all_of(word.begin(), word.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// The value of digits without a leading zero that fit, or false.
bool readWhole(std::string_view word, std::uint32_t& value) {
    if (!isWhole(word) || (word.size() > 1 && word[0] == '0')) return false;
    return std::from_chars(word.data(), word.data() + word.size(), value).ec == std::errc();
}

std::vector<std::string_view> split(std::string_view word, char separator) {
    std::vector<std::string_view> parts;
    for (std::size_t from = 0;;) {
        const std::size_t to = word.find(separator, from);
        parts.push_back(word.substr(from, to - from));
        if (to == std::string_view::npos) return parts;
        from = to + 1;
    }
}

std::string spelled(double value) {
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

[[noreturn]] void refuse(const std::string& must, std::string_view word) {
    throw UsageError(must + " (got " + scene::quoted(word) + ")");
}

} // namespace

std::uint32_t parseWhole(std::string_view word, std::uint32_t min, std::uint32_t max) {
    std::uint32_t value = 0;
    if (!readWhole(word, value) || value < min || value > max)
        refuse("must be a whole number from " + std::to_string(min) + " to " + std::to_string(max),
               word);
    return value;
}

std::uint64_t parseBytes(std::string_view word) {
    constexpr std::string_view kUnits = "KMGT";
    std::string_view digits = word;
    unsigned shift = 0;
    if (!word.empty())
        if (const std::size_t unit = kUnits.find(word.back()); unit != kUnits.npos)
            shift = 10 * (static_cast<unsigned>(unit) + 1), digits.remove_suffix(1);
    std::uint32_t value = 0;
    if (!readWhole(digits, value) || value == 0)
        refuse("must be a number of bytes, such as 4096, 64K, 16M or 2G", word);
    return std::uint64_t{value} << shift;
}

double parseReal(std::string_view word, double min, double max) {
    double value = 0;
    const char* const end = word.data() + word.size();
    const auto [rest, error] = std::from_chars(word.data(), end, value);
    if (error != std::errc() || rest != end || !std::isfinite(value) ||
        !(value >= min && value <= max))
        refuse("must be a number from " + spelled(min) + " to " + spelled(max), word);
    return value;
}

double parseDuration(std::string_view word) {
    constexpr std::pair<std::string_view, double> kUnits[] = {{"ms", 0.001}, {"min", 60}, {"s", 1}};
    std::string_view digits = word;
    double unit = 1;
    for (const auto& [suffix, seconds] : kUnits)
        if (digits.size() == word.size() && word.ends_with(suffix))
            digits.remove_suffix(suffix.size()), unit = seconds;
    double value = 0;
    const char* const end = digits.data() + digits.size();
    const auto [rest, error] = std::from_chars(digits.data(), end, value);
    if (error != std::errc() || rest != end || !std::isfinite(value) || !(value > 0))
        refuse("must be a time above 0, such as 10s, 500ms or 2min", word);
    return value * unit;
}

Size parseSize(std::string_view word) {
    const auto parts = split(word, 'x');
    Size size{};
    if (parts.size() != 2 || !readWhole(parts[0], size.width) ||
        !readWhole(parts[1], size.height) || size.width == 0 || size.height == 0 ||
        size.width > kMaxPixels || size.height > kMaxPixels)
        refuse("must be WIDTHxHEIGHT in pixels, such as 640x480", word);
    return size;
}

Rectangle parseRectangle(std::string_view word) {
    const auto parts = split(word, ',');
    Rectangle r{};
    bool good = parts.size() == r.size();
    for (std::size_t i = 0; good && i < r.size(); ++i) good = readWhole(parts[i], r[i]);
    if (!good || r[0] >= r[2] || r[1] >= r[3])
        refuse("must be X0,Y0,X1,Y1 in pixels with X0 < X1 and Y0 < Y1, such as 0,0,320,240", word);
    return r;
}

std::array<std::uint32_t, 2> parsePixel(std::string_view word) {
    const auto parts = split(word, ',');
    std::array<std::uint32_t, 2> pixel{};
    if (parts.size() != 2 || !readWhole(parts[0], pixel[0]) || !readWhole(parts[1], pixel[1]))
        refuse("must be X,Y in pixels from the top left corner, such as 320,240", word);
    return pixel;
}

std::string listed(const std::vector<std::string>& words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i)
        text += (i == 0 ? "" : i + 1 == words.size() ? " or " : ", ") + words[i];
    return text;
}

std::size_t parseChoice(std::string_view word, const std::vector<std::string>& choices) {
    const auto found = std::find(choices.begin(), choices.end(), word);
    if (found == choices.end()) {
        const std::string near = scene::nearest(word, choices);
        throw UsageError("must be " + listed(choices) + " (got " + scene::quoted(word) + ")",
                         near.empty() ? "" : "did you mean '" + near + "'?");
    }
    return static_cast<std::size_t>(found - choices.begin());
}

} // namespace rt::cli
