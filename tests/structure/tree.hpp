// The project's own files, as the structure tests read them.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace rt::structure {

struct SourceFile {
    std::string path; // relative to the root, with '/'
    std::string text;
};

struct Include {
    std::string target; // between the brackets or quotes
    bool quoted;
    int line;
};

const std::filesystem::path& root();

/// All regular files below the root but those of version control, builds and out-of-tree projects that only tests build.
const std::vector<std::string>& allFiles();

/// Those of allFiles() that are C or C++: .cpp .hpp .h .c .inl.
const std::vector<SourceFile>& sources();

std::vector<Include> includesOf(const SourceFile& file);

/// The text with comments, strings and character literals blanked, line breaks kept.
std::string codeOf(const std::string& text);

std::string readFile(const std::filesystem::path& path);

} // namespace rt::structure
