// YAML text to nodes, on yaml-cpp's events: places for keys, duplicates, alias, depth and size
// budgets, merge keys.
#pragma once
#include <core/scene/node.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

namespace rt::formats {

inline constexpr std::size_t kMaxYamlBytes = 16 << 20;
inline constexpr std::size_t kMaxDepth = 64;        // nested lists and maps
inline constexpr std::size_t kMaxNodes = 1'000'000; // aliases expanded

/// The document's root, or nothing when `diagnostics` has gained an error (E03xx: not YAML,
/// duplicate key, tab, second document, bad UTF-8; E04xx: unreadable; E07xx: too large or too
/// deep).
std::optional<scene::Node> readYaml(const std::string& path, scene::Diagnostics& diagnostics);
std::optional<scene::Node> parseYaml(std::shared_ptr<const scene::Source> source,
                                     scene::Diagnostics& diagnostics);

} // namespace rt::formats
