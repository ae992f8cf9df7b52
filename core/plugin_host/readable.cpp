#include <core/plugin_host/readable.hpp>

#include <core/plugin_host/call.hpp>
#include <core/scene/input_file.hpp>

#include <algorithm>
#include <filesystem>

namespace rt::plugin_host {

namespace fs = std::filesystem;

std::optional<std::pair<scene::Code, std::string>> whyUnreadable(const std::string& path,
                                                                 std::uint64_t maxBytes) {
    const auto file = scene::InputFile::open(path);
    if (const auto* refusal = std::get_if<scene::FileRefusal>(&file))
        return std::pair(refusal->code, "'" + path + "': " + refusal->reason);
    if (std::get<scene::InputFile>(file).size() > maxBytes)
        return std::pair(kFileTooLarge, "'" + path + "': is larger than " +
                                            std::to_string(maxBytes) +
                                            " bytes, the limit of input files");
    return {};
}

std::string suggestionFor(const std::string& missing) {
    const fs::path path(missing);
    constexpr std::size_t kMostNames = 10000; // a folder with more is not worth the wait
    auto names = scene::namesIn(
        path.has_parent_path() ? path.parent_path().string() : std::string("."), kMostNames);
    std::ranges::sort(names); // of those that are as near, the first, on any file system
    const std::string name = scene::nearest(path.filename().string(), names);
    return name.empty() ? "" : "did you mean '" + name + "'?";
}

} // namespace rt::plugin_host
