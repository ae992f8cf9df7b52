// A scene file to a validated description: read, --set applied, validated.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/plugin_host/catalog.hpp>
#include <core/scene/description.hpp>
#include <core/scene/node.hpp>

#include <optional>

namespace rt::cli {

struct LoadedScene {
    scene::Node root; // overrides applied
    scene::Description description;
};

/// What the options say of files and memory holds from here on: call it before the first byte of `path` is read.
void confine(const std::string& path, const SceneOptions& options);

/// Nothing when `diagnostics` has gained an error. `alsoSet` acts after the options' own overrides.
std::optional<LoadedScene> loadScene(const std::string& path, const SceneOptions& options,
                                     plugin_host::Catalog& catalog, scene::Diagnostics& diagnostics,
                                     const std::vector<std::string>& alsoSet = {});

} // namespace rt::cli
