// Every #include of the tree against core/layering.txt.
#include <tests/structure/tree.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace rt::structure {

namespace {

struct Row {
    std::set<std::string> folders; // "*": all
    std::set<std::string> owned;   // third-party headers, by first path component or file name
};

using Table = std::map<std::string, Row>;

Table readTable(const std::string& text) {
    Table table;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        const std::size_t colon = line.find(':');
        Row& row = table[line.substr(0, colon)];
        std::istringstream words(line.substr(colon + 1));
        bool owned = false;
        for (std::string word; words >> word;) {
            if (word == "|")
                owned = true;
            else
                (owned ? row.owned : row.folders).insert(word);
        }
    }
    return table;
}

const Table& table() {
    static const Table read = readTable(readFile(root() / "core/layering.txt"));
    return read;
}

/// Row of the table that rules `path`, or "".
std::string folderOf(const std::string& path, const Table& rows) {
    std::string best;
    for (const auto& [folder, row] : rows)
        if (path.starts_with(folder + "/") && folder.size() > best.size()) best = folder;
    return best;
}

bool isStandardHeader(const std::string& target) {
    static const std::set<std::string> c{"assert.h", "ctype.h",   "errno.h",  "float.h",
                                         "limits.h", "math.h",    "setjmp.h", "signal.h",
                                         "stdarg.h", "stdbool.h", "stddef.h", "stdint.h",
                                         "stdio.h",  "stdlib.h",  "string.h", "time.h"};
    if (target.find('/') == std::string::npos && target.find('.') == std::string::npos)
        return true; // <vector>
    return c.count(target) || target.starts_with("ext/") || target.starts_with("bits/");
}

/// The kernel's and libc's own interface, and the compiler's: no package to depend on.
bool isSystemHeader(const std::string& target) {
    static const std::set<std::string> posix{
        "unistd.h",    "fcntl.h",     "sched.h",   "dirent.h",   "elf.h",   "link.h",
        "poll.h",      "pthread.h",   "termios.h", "ucontext.h", "spawn.h", "cpuid.h",
        "immintrin.h", "emmintrin.h", "iconv.h",   "x86intrin.h"};
    return posix.count(target) || target.starts_with("sys/") || target.starts_with("linux/");
}

/// What is wrong with this include, or "".
std::string complaint(const std::string& path, const Include& include, const Table& rows) {
    const std::string from = folderOf(path, rows);
    if (from.empty()) return "the file's folder has no row";
    const Row& row = rows.at(from);

    std::string target = include.target;
    if (include.quoted) target = path.substr(0, path.rfind('/') + 1) + target; // beside the file
    if (target.starts_with("rt/")) target = "core/include/" + target;
    if (const std::string to = folderOf(target, rows); !to.empty()) {
        if (to == from || row.folders.count("*") || row.folders.count(to)) return "";
        return from + " may not include " + to;
    }
    if (isStandardHeader(target)) return "";
    if (from == "tests") return ""; // oracles and GoogleTest
    const std::string first = target.substr(0, target.find('/'));
    bool known = false;
    for (const auto& [folder, other] : rows) known = known || other.owned.count(first);
    if (row.owned.count(first)) return "";
    if (known) return from + " does not own " + first;
    if (isSystemHeader(target)) return "";
    return first + " belongs to no folder";
}

} // namespace

TEST(Layering, EveryIncludeIsAllowedByTheTable) {
    ASSERT_FALSE(table().empty());
    std::size_t seen = 0;
    for (const SourceFile& file : sources())
        for (const Include& include : includesOf(file)) {
            ++seen;
            const std::string wrong = complaint(file.path, include, table());
            EXPECT_EQ(wrong, "") << file.path << ":" << include.line << ": #include <"
                                 << include.target << ">";
        }
    EXPECT_GT(seen, 100u);
}

TEST(Layering, EveryProjectIncludeExists) {
    for (const SourceFile& file : sources())
        for (const Include& include : includesOf(file)) {
            const std::string folder = file.path.substr(0, file.path.rfind('/') + 1);
            const std::string target = include.quoted ? folder + include.target
                                       : include.target.starts_with("rt/")
                                           ? "core/include/" + include.target
                                           : include.target;
            if (folderOf(target, table()).empty()) continue;
            EXPECT_TRUE(std::filesystem::exists(root() / target))
                << file.path << ":" << include.line << ": " << include.target;
        }
}

TEST(Layering, TheTableNamesFoldersThatExist) {
    for (const auto& [folder, row] : table()) {
        EXPECT_TRUE(std::filesystem::is_directory(root() / folder)) << folder;
        for (const std::string& other : row.folders)
            EXPECT_TRUE(other == "*" || table().count(other)) << folder << ": " << other;
    }
}

TEST(Layering, TheTableHasNoCycle) {
    for (const auto& [folder, row] : table()) {
        std::set<std::string> reached;
        std::vector<std::string> open(row.folders.begin(), row.folders.end());
        while (!open.empty()) {
            const std::string next = open.back();
            open.pop_back();
            if (next == "*" || !reached.insert(next).second) continue;
            const auto& further = table().at(next).folders;
            open.insert(open.end(), further.begin(), further.end());
        }
        EXPECT_FALSE(reached.count(folder)) << folder << " reaches itself";
    }
}

TEST(Layering, OnlyTheCommandLineAndTheTestsMayIncludeEverything) {
    for (const auto& [folder, row] : table())
        EXPECT_EQ(row.folders.count("*") != 0, folder == "core/cli" || folder == "tests") << folder;
    for (const auto& [folder, row] : table())
        EXPECT_FALSE(row.folders.count("core/cli")) << folder << " includes the command line";
}

TEST(Layering, TheCheckCatchesEachKindOfBreach) {
    const Table rows = readTable("# comment\ncore/include:\ncore/numeric: | glm\ncore/octree: "
                                 "core/numeric\nplugins: core/include | OpenMesh\ntests: *\n");
    const auto of = [&](const char* path, const char* target, bool quoted = false) {
        return complaint(path, {target, quoted, 1}, rows);
    };
    EXPECT_EQ(of("core/octree/a.cpp", "core/numeric/vec.hpp"), "");
    EXPECT_EQ(of("core/octree/a.cpp", "core/octree/b.hpp"), "");
    EXPECT_EQ(of("core/octree/a.cpp", "b.hpp", true), "");
    EXPECT_EQ(of("core/octree/a.cpp", "vector"), "");
    EXPECT_EQ(of("core/octree/a.cpp", "unistd.h"), "");
    EXPECT_EQ(of("tests/a.cpp", "gtest/gtest.h"), "");
    EXPECT_EQ(of("plugins/shapes/a.cpp", "rt/plugin.h"), "");
    EXPECT_EQ(of("core/octree/a.cpp", "glm/vec3.hpp"), "core/octree does not own glm");
    EXPECT_EQ(of("core/numeric/a.cpp", "core/octree/b.hpp"),
              "core/numeric may not include core/octree");
    EXPECT_EQ(of("plugins/shapes/a.cpp", "core/numeric/vec.hpp"),
              "plugins may not include core/numeric");
    EXPECT_EQ(of("core/octree/a.cpp", "png.h"), "png.h belongs to no folder");
    EXPECT_EQ(of("core/octree/a.cpp", "boost/any.hpp"), "boost belongs to no folder");
    EXPECT_EQ(of("elsewhere/a.cpp", "vector"), "the file's folder has no row");
}

} // namespace rt::structure
