#include <core/scene/file_suffix.hpp>

#include <algorithm>
#include <filesystem>

namespace rt::scene {

std::string fileSuffix(const std::string& path) {
    std::filesystem::path name = std::filesystem::path(path).filename();
    const auto lowerSuffix = [&] {
        std::string suffix = name.extension().native();
        std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](char c) {
            return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        });
        return suffix.empty() ? suffix : suffix.substr(1);
    };
    if (lowerSuffix() == "gz") name = name.stem();
    return lowerSuffix();
}

} // namespace rt::scene
