#include <converters/comment_lines.hpp>

#include <core/scene/display_text.hpp>

namespace rt::converters {

std::string commentText(std::string_view text) {
    const auto isBlank = [](char c) { return c == ' ' || c == '\t'; };
    while (!text.empty() && isBlank(text.front())) text.remove_prefix(1);
    while (!text.empty() && isBlank(text.back())) text.remove_suffix(1);
    std::string out;
    while (!text.empty()) {
        const scene::CodePoint codePoint = scene::decodeUtf8(text);
        out += codePoint.value == '\t' ? "\t" : scene::glyphOf(codePoint, text).text;
        text.remove_prefix(codePoint.bytes);
    }
    return out;
}

void HeldComments::moveTo(std::vector<std::string>& lines, std::string_view section) {
    const auto held = lines_.find(std::string(section));
    if (held == lines_.end()) return;
    for (std::string& line : held->second) lines.push_back(std::move(line));
    lines_.erase(held);
}

} // namespace rt::converters
