#include <core/cli/film_settings.hpp>

#include <core/cli/build_facts.hpp>
#include <core/scene/full.hpp>
#include <formats/checksum.hpp>

#include <filesystem>

namespace rt::cli {
namespace {

using scene::Node;

class Flattening {
public:
    Flattening(std::string folder, formats::Settings& settings)
        : folder_(std::move(folder)), settings_(settings) {}

    void add(const std::string& path, const Node& node) {
        if (node.kind == Node::Kind::map) {
            for (const Node::Member& member : node.members)
                add(path.empty() ? member.key : path + "." + member.key, member.value);
        } else if (node.kind == Node::Kind::sequence && holdsMaps(node)) {
            for (std::size_t i = 0; i < node.items.size(); ++i) addItem(path, i, node.items[i]);
        } else {
            settings_.emplace_back(path, textOf(node));
        }
    }

    /// Without the scene's folder, so that a film may move with its scene.
    std::string relative(const std::string& text) const {
        return text.starts_with(folder_) ? text.substr(folder_.size()) : text;
    }

private:
    static bool holdsMaps(const Node& sequence) {
        return !sequence.items.empty() && sequence.items[0].kind == Node::Kind::map;
    }

    /// `- sphere: {name: moon, …}` is objects.moon, of the type sphere.
    void addItem(const std::string& path, std::size_t index, const Node& item) {
        const bool typed =
            item.members.size() == 1 && item.members[0].value.kind == Node::Kind::map;
        const Node& body = typed ? item.members[0].value : item;
        const Node* name = body.find("name");
        const std::string itemPath = path + "." + (name ? name->text : std::to_string(index));
        if (typed) settings_.emplace_back(itemPath, item.members[0].key);
        add(itemPath, body);
    }

    std::string textOf(const Node& node) const {
        std::string text;
        switch (node.kind) {
        case Node::Kind::null:
            return "null";
        case Node::Kind::scalar:
            for (const char c : relative(node.text)) text += c == '\t' || c == '\n' ? ' ' : c;
            return text;
        case Node::Kind::sequence:
            for (const Node& item : node.items) text += (text.empty() ? "[" : ", ") + textOf(item);
            return text.empty() ? "[]" : text + "]";
        case Node::Kind::map:
            for (const Node::Member& member : node.members)
                text += (text.empty() ? "{" : ", ") + member.key + ": " + textOf(member.value);
            return text.empty() ? "{}" : text + "}";
        }
        return text;
    }

    std::string folder_; // with a slash at the end
    formats::Settings& settings_;
};

/// Materials that the scene does not have itself: a mesh's material file may have changed them.
std::string importedMaterials(const scene::Description& description, const world::World& world) {
    std::string bytes;
    const auto add = [&](double value) {
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
    };
    for (std::size_t i = description.materials.size(); i < world.materials.size(); ++i) {
        const material::Material& m = world.materials[i];
        for (const numeric::LinearRgb& rgb :
             {m.color, m.diffuse, m.specular, m.transmission, m.environment})
            add(rgb.r), add(rgb.g), add(rgb.b);
        add(m.shininess), add(m.ior), add(m.colorTexture ? 1 : 0);
    }
    return formats::checksum(bytes);
}

std::string numbers(const std::array<std::uint32_t, 4>& values) {
    std::string text;
    for (const std::uint32_t value : values)
        text += (text.empty() ? "" : ",") + std::to_string(value);
    return text;
}

} // namespace

formats::Settings filmSettings(const RenderOptions& options, const scene::Description& description,
                               const world::World& world, const std::set<std::string>& files,
                               const plugin_host::Catalog& catalog) {
    namespace fs = std::filesystem;
    formats::Settings settings{{"the version of rt", std::string(kVersion)}};
    const fs::path folder = fs::absolute(description.path).lexically_normal().parent_path();
    Flattening flattening(folder.string() + "/", settings);
    Node scene = scene::fullScene(description);
    for (Node::Member& section : scene.members) // where a picture goes does not change it
        if (section.key == "image")
            std::erase_if(section.value.members, [](const auto& m) { return m.key == "file"; });
    flattening.add("", scene);

    for (const std::string& file : files)
        settings.emplace_back("the content of " + flattening.relative(file),
                              formats::checksumOfFile(file).value_or("missing"));
    settings.emplace_back("materials of meshes", importedMaterials(description, world));
    for (const plugin_host::ModuleInfo& module : catalog.opened())
        settings.emplace_back("plugin " + module.name,
                              formats::checksumOfFile(module.path.string()).value_or("missing"));

    constexpr const char* kShades[] = {"full", "normals", "depth", "id", "cost"};
    settings.emplace_back("--shade", kShades[static_cast<std::size_t>(options.shade)]);
    settings.emplace_back("--crop", options.crop ? numbers(*options.crop) : "none");
    return settings;
}

} // namespace rt::cli
