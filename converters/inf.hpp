// Scene (.inf) and movie files of the program that rt replaces, to scene-language nodes. Legacy knowledge lives here only.
#pragma once
#include <core/scene/diagnostic.hpp>
#include <core/scene/node.hpp>

#include <cstdint>
#include <optional>
#include <string>

namespace rt::converters {

enum class WindowOrder : std::uint8_t { automatic, widthHeight, heightWidth };

struct InfOptions {
    bool lenient = false; // the original's forgiving rules; each use is a note
    WindowOrder windowOrder = WindowOrder::automatic;
    std::string moviePath;    // overrides the scene's `movie`; relative to the current folder
    std::string outputFolder; // relative paths are re-based to it; empty: the scene's own folder
};

/// The scene as one document, animation included, or nothing when `diagnostics` has gained an error: E0201 a movie
/// file, E0380 to E0395 what is wrong in the files, E0401 to E0410 files that cannot be read. Decisions and changed
/// behaviour are notes. Every node has the place in the legacy file that it comes from.
std::optional<scene::Node> convertInf(const std::string& path, const InfOptions& options,
                                      scene::Diagnostics& diagnostics);

/// The same for a file that is in memory already; `path` is where it would be.
std::optional<scene::Node> convertInfText(const std::string& path, std::string bytes,
                                          const InfOptions& options,
                                          scene::Diagnostics& diagnostics);

/// Is it a movie file, which is converted with the scene that names it? False for files that cannot be read.
bool isMovieFile(const std::string& path);

} // namespace rt::converters
