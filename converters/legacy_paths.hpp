// File names as a Windows program wrote them, found on this machine and said relative to another folder.
#pragma once
#include <string>
#include <string_view>

namespace rt::converters {

struct FoundPath {
    std::string
        spelled; // to write: '/', relative to the output folder unless absolute, case as on disk
    std::string local; // to open from here
    bool exists = false;
    bool caseDiffers = false;
};

/// `outputFolder` empty: `sceneFolder`.
FoundPath findPath(std::string_view legacy, const std::string& sceneFolder,
                   const std::string& outputFolder);

/// Identifier-like name from `text`: other characters become '_'.
std::string toName(std::string_view text);
/// File name without folder and suffix.
std::string stemOf(std::string_view path);

} // namespace rt::converters
