// Scene (.inf) and movie files of the program that rt replaces, to scene-language nodes. Legacy knowledge lives here only.
#pragma once
#include <core/scene/diagnostic.hpp>
#include <core/scene/node.hpp>

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

namespace rt::converters {

enum class WindowOrder : std::uint8_t { automatic, widthHeight, heightWidth };

struct InfOptions {
    bool lenient = false; // the original's forgiving rules; each use is a note
    WindowOrder windowOrder = WindowOrder::automatic;
    std::string moviePath;    // overrides the scene's `movie`
    std::string outputFolder; // relative paths are re-based to it; empty: the scene's own folder
    /// Faces of an OBJ as the original counts them (one per `f` line); nothing when the file cannot be read.
    std::function<std::optional<std::uint64_t>(const std::string& path)> countFaces;
};

/// The scene as one document, animation included, or nothing when `diagnostics` has gained an error.
std::optional<scene::Node> convertInf(const std::string& path, const InfOptions& options, scene::Diagnostics& diagnostics);

} // namespace rt::converters
