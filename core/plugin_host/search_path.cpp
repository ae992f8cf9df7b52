#include <core/plugin_host/catalog.hpp>

#include <algorithm>
#include <cstdlib>
#include <string_view>

namespace rt::plugin_host {

std::vector<std::filesystem::path>
searchPath(const std::vector<std::filesystem::path>& pluginDirs) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    std::vector<fs::path> folders;
    for (const fs::path& folder : pluginDirs) folders.push_back(fs::absolute(folder, ignored));
    if (const char* list = secure_getenv("RT_PLUGIN_PATH")) {
        std::string_view rest = list;
        while (!rest.empty()) {
            const std::string_view folder = rest.substr(0, rest.find(':'));
            rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
            if (!folder.empty())
                folders.push_back(
                    fs::absolute(folder, ignored)); // an empty entry is not the current folder
        }
    }
    const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
    if (!program.empty())
        folders.push_back((program.parent_path().parent_path() / "lib/rt/plugins"));
    return folders;
}

} // namespace rt::plugin_host
