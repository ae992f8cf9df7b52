#include <core/cli/check_plugin.hpp>

#include <core/cli/exit_codes.hpp>
#include <core/plugin_host/check.hpp>
#include <core/scene/validate.hpp>
#include <formats/yaml_reader.hpp>

#include <algorithm>

namespace rt::cli {

namespace {

constexpr std::string_view kSuffix = ".rtplugin.so";

/// The instances of the module's own example: validated as part of a scene, without the material
/// that it borrows. Errors are in `diagnostics`.
std::vector<scene::Instance> examplesOf(const rt_module& module, plugin_host::Catalog& catalog,
                                        scene::Diagnostics& diagnostics) {
    const auto parse = [&](const char* name, std::string text) {
        return formats::parseYaml(
            std::make_shared<scene::Source>(scene::Source{name, std::move(text)}), diagnostics);
    };
    auto example = parse("example", module.example);
    auto root = parse("scene", "rt: 1\ncamera: {position: [0, -9, 0], look_at: [0, 0, 0]}\n");
    if (!example || !root) return {};
    for (scene::Node& item : example->items)
        for (scene::Node::Member& type : item.members)
            std::erase_if(type.value.members,
                          [](const scene::Node::Member& row) { return row.key == "material"; });
    scene::Node::Member section;
    section.key = module.texture ? "textures" : "objects";
    section.value = std::move(*example);
    root->members.push_back(std::move(section));
    const auto description = scene::validate(*root, catalog, diagnostics);
    std::vector<scene::Instance> instances;
    if (!description) return instances;
    for (const scene::Object& object : description->objects)
        if (object.shape.type == module.name) instances.push_back(object.shape);
    for (const scene::Texture& texture : description->textures)
        if (texture.instance.type == module.name) instances.push_back(texture.instance);
    return instances;
}

} // namespace

int checkPlugin(const PluginsOptions& options, Console& console) {
    const std::filesystem::path file(options.check);
    const std::string stem = file.filename().string();
    if (!stem.ends_with(kSuffix))
        throw UsageError("--check: must be a plugin's file, NAME" + std::string(kSuffix) +
                         " (got " + scene::quoted(options.check) + ")");
    const std::string name = stem.substr(0, stem.size() - kSuffix.size());
    // Its folder comes first, and the folders of others are left out where they have the same type.
    plugin_host::Catalog catalog({std::filesystem::absolute(file).parent_path()});
    std::vector<scene::Instance> examples;
    scene::Diagnostics diagnostics;
    const plugin_host::ModuleInfo info = catalog.open(name);
    if (info.module && !info.module->loader)
        examples = examplesOf(*info.module, catalog, diagnostics);
    console.report(diagnostics);
    const auto report = plugin_host::checkModule(catalog, name, examples);
    std::string text;
    for (const std::string& line : report.checked) text += "checked  " + line + "\n";
    for (const std::string& line : report.skipped) text += "skipped  " + line + "\n";
    console.result(text);
    for (const std::string& fault : report.faults) console.fail("plugins", kExitPlugin, fault, "");
    return report.passed() && !diagnostics.failed() ? kExitOk : kExitPlugin;
}

} // namespace rt::cli
