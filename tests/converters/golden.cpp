// Conversions kept on disk: X.inf beside the YAML and the notes that it gives. After a change that is meant,
// RT_WRITE_GOLDENS=1 build/bin/test_converters --gtest_filter='Goldens*' writes them anew; the commit says why.
#include <formats/yaml_writer.hpp>
#include <tests/converters/converting.hpp>

#include <cstdlib>

namespace rt::converters {
namespace {

const std::filesystem::path kFolder =
    std::filesystem::path(RT_SOURCE_DIR) / "tests/converters/golden";

std::string contents(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

std::string notesOf(const Converted& converted) {
    std::string text;
    for (const auto& [word, severity] :
         {std::pair("error", scene::Severity::error),
          std::pair("warning", scene::Severity::warning), std::pair("note", scene::Severity::note)})
        for (const std::string& line : converted.lines(severity)) {
            std::string said = line;
            for (std::size_t at; (at = said.find(kFolder.string() + "/")) != said.npos;)
                said.erase(at, kFolder.string().size() + 1);
            text += std::string(word) + " " + said + "\n";
        }
    return text;
}

class Goldens : public testing::TestWithParam<std::string> {};

TEST_P(Goldens, AreWhatConversionGives) {
    const std::filesystem::path inf = kFolder / (GetParam() + ".inf");
    InfOptions options;
    options.lenient = GetParam().starts_with("lenient");
    const Converted converted = convertText(contents(inf), options, inf.string());
    const std::string yaml = converted.document ? formats::writeYaml(*converted.document) : "",
                      notes = notesOf(converted);
    if (std::getenv("RT_WRITE_GOLDENS")) {
        if (converted.document)
            std::ofstream(kFolder / (GetParam() + ".yaml"), std::ios::binary) << yaml;
        std::ofstream(kFolder / (GetParam() + ".notes"), std::ios::binary) << notes;
    }
    EXPECT_EQ(yaml, contents(kFolder / (GetParam() + ".yaml")));
    EXPECT_EQ(notes, contents(kFolder / (GetParam() + ".notes")));
}

std::vector<std::string> names() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(kFolder))
        if (entry.path().extension() == ".inf" && !isMovieFile(entry.path().string()))
            names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

INSTANTIATE_TEST_SUITE_P(Files, Goldens, testing::ValuesIn(names()),
                         [](const auto& tested) { return tested.param; });

} // namespace
} // namespace rt::converters
