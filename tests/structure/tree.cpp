#include <tests/structure/tree.hpp>

#include <algorithm>
#include <fstream>
#include <iterator>

namespace rt::structure {

namespace fs = std::filesystem;

namespace {

/// Not the project's: ignored by version control (.gitignore).
bool isIgnored(const fs::path& relative) {
    const std::string first = relative.begin()->string();
    return first == ".git" || first.starts_with("build") || relative == "scenes/generated" ||
           first == "compile_commands.json";
}

/// A project of its own, as a plugin's author has it; the build of the tree does not know its files.
bool isForeignProject(const fs::path& folder) {
    if (folder == root() || !fs::exists(folder / "CMakeLists.txt")) return false;
    return readFile(folder / "CMakeLists.txt").find("project(") != std::string::npos;
}

std::vector<std::string> findFiles() {
    std::vector<std::string> files;
    for (auto entry = fs::recursive_directory_iterator(root());
         entry != fs::recursive_directory_iterator(); ++entry) {
        const fs::path relative = fs::relative(entry->path(), root());
        if (isIgnored(relative) || (entry->is_directory() && isForeignProject(entry->path()))) {
            entry.disable_recursion_pending();
            continue;
        }
        if (entry->is_regular_file()) files.push_back(relative.generic_string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

} // namespace

const fs::path& root() {
    static const fs::path path = RT_SOURCE_DIR;
    return path;
}

std::string readFile(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

const std::vector<std::string>& allFiles() {
    static const std::vector<std::string> files = findFiles();
    return files;
}

const std::vector<SourceFile>& sources() {
    static const std::vector<SourceFile> files = [] {
        std::vector<SourceFile> found;
        for (const std::string& path : allFiles())
            for (const char* const suffix : {".cpp", ".hpp", ".h", ".c", ".inl"})
                if (path.ends_with(suffix)) found.push_back({path, readFile(root() / path)});
        return found;
    }();
    return files;
}

std::vector<Include> includesOf(const SourceFile& file) {
    std::vector<Include> includes;
    int line = 0;
    for (std::size_t from = 0; from < file.text.size();) {
        const std::size_t to = std::min(file.text.find('\n', from), file.text.size());
        std::string text = file.text.substr(from, to - from);
        from = to + 1;
        ++line;
        text.erase(0, text.find_first_not_of(" \t"));
        if (!text.starts_with('#')) continue;
        text.erase(0, std::min(text.find_first_not_of(" \t", 1), text.size()));
        if (!text.starts_with("include")) continue;
        const std::size_t open = text.find_first_of("<\"");
        if (open == std::string::npos) continue;
        const std::size_t close = text.find(text[open] == '<' ? '>' : '"', open + 1);
        includes.push_back({text.substr(open + 1, close - open - 1), text[open] == '"', line});
    }
    return includes;
}

std::string codeOf(const std::string& text) {
    std::string code = text;
    const auto blank = [&](std::size_t from, std::size_t to) {
        for (std::size_t i = from; i < std::min(to, code.size()); ++i)
            if (code[i] != '\n') code[i] = ' ';
    };
    for (std::size_t i = 0; i < text.size();) {
        std::size_t end = i + 1;
        if (text.compare(i, 2, "//") == 0) {
            end = std::min(text.find('\n', i), text.size());
            blank(i, end);
        } else if (text.compare(i, 2, "/*") == 0) {
            end = std::min(text.find("*/", i + 2), text.size() - 2) + 2;
            blank(i, end);
        } else if (text.compare(i, 2, "R\"") == 0) {
            const std::string closing = ")" + text.substr(i + 2, text.find('(', i) - i - 2) + "\"";
            end = std::min(text.find(closing, i), text.size() - closing.size()) + closing.size();
            blank(i, end);
        } else if (text[i] == '"' ||
                   (text[i] == '\'' &&
                    (i == 0 || !std::isalnum(static_cast<unsigned char>(text[i - 1]))))) {
            while (end < text.size() && text[end] != text[i] && text[end] != '\n')
                end += text[end] == '\\' ? 2 : 1;
            blank(i, ++end);
        }
        i = end;
    }
    return code;
}

} // namespace rt::structure
