#include <core/cli/load_scene.hpp>

#include <core/cli/memory.hpp>
#include <core/scene/input_file.hpp>
#include <core/scene/override.hpp>
#include <core/scene/validate.hpp>
#include <formats/yaml_reader.hpp>

namespace rt::cli {

void confine(const std::string& path, const SceneOptions& options) {
    enforceMemoryLimit(options.limits);
    if (!options.sandbox || scene::readingIsConfined()) return;
    std::vector<std::string> folders = options.readableFolders;
    folders.push_back(std::filesystem::path(path).parent_path().string());
    scene::confineReading(folders);
}

std::optional<LoadedScene> loadScene(const std::string& path, const SceneOptions& options,
                                     plugin_host::Catalog& catalog, scene::Diagnostics& diagnostics,
                                     const std::vector<std::string>& alsoSet) {
    confine(path, options);
    std::optional<scene::Node> root = formats::readYaml(path, diagnostics, options.limits);
    if (!root) return {};
    for (const auto* list : {&options.overrides, &alsoSet})
        for (const std::string& word : *list) scene::applyOverride(*root, word, diagnostics);
    if (diagnostics.failed()) return {};
    std::optional<scene::Description> description =
        scene::validate(*root, catalog, diagnostics, options.limits);
    if (!description) return {};
    checkPictureFits(description->image, options.limits, root->location, diagnostics);
    if (diagnostics.failed()) return {};
    return LoadedScene{std::move(*root), std::move(*description)};
}

} // namespace rt::cli
