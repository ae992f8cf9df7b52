#include <converters/legacy_paths.hpp>

#include <core/scene/input_file.hpp>

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace rt::converters {
namespace {

namespace fs = std::filesystem;

bool equalIgnoringCase(std::string_view a, std::string_view b) {
    return std::ranges::equal(
        a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

/// `relative` below `folder` with the case that the disk has; empty when there is no or more than one such file.
fs::path onDisk(const fs::path& folder, const fs::path& relative) {
    fs::path found;
    std::error_code error;
    for (const fs::path& part : relative) {
        if (fs::exists(folder / found / part, error)) {
            found /= part;
            continue;
        }
        fs::path match;
        const fs::path parent = found.empty() ? folder : folder / found;
        for (const std::string& name : scene::namesIn(parent.empty() ? "." : parent.string())) {
            if (!equalIgnoringCase(name, part.string())) continue;
            if (!match.empty()) return {};
            match = name;
        }
        if (match.empty()) return {};
        found /= match;
    }
    return found;
}

} // namespace

FoundPath findPath(std::string_view legacy, const std::string& sceneFolder,
                   const std::string& outputFolder) {
    std::string slashed(legacy);
    std::ranges::replace(slashed, '\\', '/');
    FoundPath result;
    std::error_code error;
    fs::path path(slashed);
    const bool drive = slashed.size() > 1 && slashed[1] == ':' &&
                       std::isalpha(static_cast<unsigned char>(slashed[0]));
    if (path.is_absolute() || drive) {
        result.exists = fs::exists(path, error);
        result.spelled = result.local = slashed;
        return result;
    }
    const fs::path folder(sceneFolder);
    result.exists = fs::exists(folder / path, error);
    if (!result.exists) {
        if (const fs::path actual = onDisk(folder, path); !actual.empty()) {
            path = actual, result.exists = result.caseDiffers = true;
        }
    }
    result.local = (folder / path).string();
    result.spelled = path.generic_string();
    if (!outputFolder.empty()) {
        const fs::path from = fs::weakly_canonical(fs::absolute(outputFolder), error);
        const fs::path home =
            fs::weakly_canonical(fs::absolute(folder.empty() ? fs::path(".") : folder), error);
        if (from != home)
            result.spelled =
                (home / path).lexically_normal().lexically_relative(from).generic_string();
    }
    return result;
}

std::string toName(std::string_view text) {
    std::string name;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        name += std::isalnum(byte) || c == '_' || c == '-' || byte >= 0x80 ? c : '_';
    }
    if (name.empty() || std::isdigit(static_cast<unsigned char>(name.front())) ||
        name.front() == '-')
        name.insert(0, "_");
    return name;
}

std::string stemOf(std::string_view path) {
    const std::size_t slash = path.find_last_of("/\\");
    if (slash != std::string_view::npos) path.remove_prefix(slash + 1);
    const std::size_t dot = path.rfind('.');
    return std::string(dot == std::string_view::npos || dot == 0 ? path : path.substr(0, dot));
}

} // namespace rt::converters
