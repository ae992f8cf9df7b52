#include <core/cli/load_scene.hpp>

#include <core/scene/override.hpp>
#include <core/scene/validate.hpp>
#include <formats/yaml_reader.hpp>

namespace rt::cli {

std::optional<LoadedScene> loadScene(const std::string& path, const SceneOptions& options,
                                     plugin_host::Catalog& catalog, scene::Diagnostics& diagnostics,
                                     const std::vector<std::string>& alsoSet) {
    std::optional<scene::Node> root = formats::readYaml(path, diagnostics);
    if (!root) return {};
    for (const auto* list : {&options.overrides, &alsoSet})
        for (const std::string& word : *list) scene::applyOverride(*root, word, diagnostics);
    if (diagnostics.failed()) return {};
    std::optional<scene::Description> description =
        scene::validate(*root, catalog, diagnostics, {.pixels = options.limitPixels});
    if (!description) return {};
    return LoadedScene{std::move(*root), std::move(*description)};
}

} // namespace rt::cli
