// Every code that a source file names has its text.
#include <core/scene/explanations.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

namespace rt::faults {

TEST(Codes, EachOneIsExplained) {
    namespace fs = std::filesystem;
    static const std::regex declared(R"((?:scene::)?Code\s+k\w+\{[^;]*;)"),
        number(R"(\{(\d{3})\})");
    std::set<int> codes;
    for (const char* const folder : {"core", "formats", "converters"})
        for (const auto& entry :
             fs::recursive_directory_iterator(fs::path(RT_SOURCE_DIR) / folder)) {
            if (entry.path().extension() != ".cpp" && entry.path().extension() != ".hpp") continue;
            std::ifstream file(entry.path());
            const std::string text{std::istreambuf_iterator<char>(file), {}};
            for (auto d = std::sregex_iterator(text.begin(), text.end(), declared);
                 d != std::sregex_iterator(); ++d) {
                const std::string all = d->str();
                for (auto n = std::sregex_iterator(all.begin(), all.end(), number);
                     n != std::sregex_iterator(); ++n)
                    codes.insert(std::stoi((*n)[1]));
            }
        }
    EXPECT_GT(codes.size(), 80u);
    for (const int code : codes)
        EXPECT_TRUE(scene::explanation(static_cast<scene::Code>(code)))
            << "E0" << code << " has no text in core/scene/explanations.cpp";
}

} // namespace rt::faults
