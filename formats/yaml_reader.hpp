// YAML text to nodes, on yaml-cpp's events: places for keys, duplicates, alias, depth and size
// budgets, merge keys.
#pragma once
#include <core/scene/limits.hpp>
#include <core/scene/node.hpp>

#include <memory>
#include <optional>
#include <string>

namespace rt::formats {

/// The document's root, or nothing when `diagnostics` has gained an error (E03xx: not YAML,
/// duplicate key, tab, second document, bad UTF-8; E04xx: unreadable; E07xx: too large or too
/// deep).
std::optional<scene::Node> readYaml(const std::string& path, scene::Diagnostics& diagnostics,
                                    const scene::Limits& limits = {});
std::optional<scene::Node> parseYaml(std::shared_ptr<const scene::Source> source,
                                     scene::Diagnostics& diagnostics,
                                     const scene::Limits& limits = {});

} // namespace rt::formats
