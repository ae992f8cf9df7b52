#include <converters/obj_faces.hpp>

#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

namespace rt::converters {
namespace {

bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

std::string_view takeWord(std::string_view& line) {
    while (!line.empty() && isBlank(line.front())) line.remove_prefix(1);
    std::size_t end = 0;
    while (end < line.size() && !isBlank(line[end])) ++end;
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

} // namespace

ObjFaces countObjFaces(std::string_view text) {
    struct Corner {
        std::int64_t vertex;
        std::uint64_t line;
    };
    ObjFaces faces;
    std::int64_t vertices = 0;
    std::vector<Corner>
        corners; // the first three of each face; the original read all vertices before it looked
    for (std::uint64_t lineNumber = 1; !text.empty(); ++lineNumber) {
        const std::size_t end = text.find('\n');
        std::string_view line = text.substr(0, end);
        text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
        const std::string_view keyword = takeWord(line);
        if (keyword == "v") {
            ++vertices;
        } else if (keyword == "f") {
            ++faces.count;
            int corner = 0;
            for (std::string_view word; !(word = takeWord(line)).empty() && word.front() != '#';
                 ++corner) {
                if (corner >= 3) continue;
                std::int64_t index = 0;
                std::from_chars(word.data(), word.data() + word.size(), index);
                corners.push_back({index, lineNumber});
            }
            if (corner > 3) ++faces.polygons;
        }
    }
    for (const Corner& corner : corners) {
        if (corner.vertex < 1 || corner.vertex > vertices) return {0, 0, corner.line};
    }
    return faces;
}

std::optional<ObjFaces> readObjFaces(const std::string& path) {
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error)) return std::nullopt;
    std::ifstream file(path, std::ios::binary);
    if (!file) return std::nullopt;
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    if (file.bad()) return std::nullopt;
    return countObjFaces(text);
}

} // namespace rt::converters
