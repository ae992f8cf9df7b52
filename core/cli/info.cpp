// rt info: what a scene holds, what it loads and why, and what it costs.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/load_scene.hpp>
#include <core/cli/mesh_summary.hpp>
#include <core/cli/output.hpp>
#include <core/geometry/bounds.hpp>
#include <core/octree/octree.hpp>
#include <core/parallel/parallel.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/plugin_host/repair_file.hpp>
#include <core/scene/full.hpp>
#include <formats/yaml_writer.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <charconv>
#include <map>

namespace rt::cli {

namespace {

using Json = nlohmann::ordered_json;

template <class T> std::uint64_t bytesOf(const std::vector<T>& items) {
    return items.size() * sizeof(T);
}

std::uint64_t bytesOf(const geometry::Primitives& p) {
    const geometry::Triangles& t = p.triangles;
    return bytesOf(t.positions) + bytesOf(t.indices) + bytesOf(t.normals) +
           bytesOf(t.normalIndices) + bytesOf(t.uvs) + bytesOf(t.uvIndices) + bytesOf(t.materials) +
           bytesOf(t.sourceFaces) + bytesOf(p.spheres) + bytesOf(p.parallelograms) +
           bytesOf(p.customs.primitives) + bytesOf(p.segments);
}

/// Which keys of the scene name a module, by the module's name.
std::map<std::string, std::vector<std::string>> namersOf(const scene::Description& description) {
    std::map<std::string, std::vector<std::string>> namers;
    for (const scene::Object& object : description.objects) {
        namers[object.shape.type].push_back("objects." + object.name);
        if (object.loader) namers[object.loader->type].push_back("objects." + object.name);
    }
    for (const scene::Texture& texture : description.textures)
        namers[texture.instance.type].push_back("textures." + texture.name);
    return namers;
}

/// Why there is a codec, or none.
std::string codecReason(const Output& output) {
    return output.format == formats::ImageFormat::pfm
               ? "none: rt writes PFM itself"
               : "opened while the picture is traced, because of " + output.path;
}

std::string spelled(double value) {
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string spelled(const numeric::Vec3& v) {
    return "[" + spelled(v.x) + ", " + spelled(v.y) + ", " + spelled(v.z) + "]";
}

std::string antialiasName(const scene::Antialias& antialias) {
    if (std::holds_alternative<scene::AntialiasFsaa4>(antialias)) return "fsaa4";
    if (const auto* const grid = std::get_if<scene::AntialiasGrid>(&antialias))
        return "grid " + std::to_string(grid->n) + "x" + std::to_string(grid->n);
    if (const auto* const error = std::get_if<scene::AntialiasMaxError>(&antialias))
        return "max_error " + spelled(error->rmse);
    return "none";
}

std::string counted(std::size_t count, const std::string& noun) {
    return std::to_string(count) + " " + noun + (count == 1 ? "" : "s");
}

std::string megabytes(std::uint64_t bytes) {
    const std::uint64_t tenths = (bytes * 10 + 500'000) / 1'000'000;
    return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10) + " MB";
}

/// "objects.a, objects.b and 7 more"
std::string listedSome(const std::vector<std::string>& names) {
    constexpr std::size_t kMost = 3;
    std::string text;
    for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i)
        text += (i ? ", " : "") + names[i];
    return names.size() > kMost ? text + " and " + std::to_string(names.size() - kMost) + " more"
                                : text;
}

Json vector(const numeric::Vec3& v) { return Json::array({v.x, v.y, v.z}); }

struct Facts {
    const InfoOptions& options;
    const scene::Description& description;
    const world::World& world;
    const octree::Statistics tree;
    const std::vector<plugin_host::ModuleInfo> modules;
    const std::vector<Output> outputs;

    std::size_t transmissive() const {
        std::size_t count = 0;
        for (const material::Material& material : world.materials) count += !material.isOpaque();
        return count;
    }
    std::uint64_t pictureBytes() const {
        return std::uint64_t(description.image.width) * description.image.height *
               sizeof(numeric::LinearRgb);
    }
};

std::string asText(const Facts& f) {
    const scene::Description& d = f.description;
    const geometry::Primitives& p = f.world.primitives;
    std::string text;
    const auto line = [&](std::string name, const std::string& value) {
        name.resize(13, ' ');
        text += name + value + "\n";
    };
    line("scene", f.options.scene);
    std::string files;
    for (const Output& output : f.outputs) files += (files.empty() ? "" : ", ") + output.path;
    line("picture", std::to_string(d.image.width) + "x" + std::to_string(d.image.height) +
                        (d.image.encoding == scene::Encoding::srgb ? ", sRGB" : ", linear") +
                        " -> " + files);
    line("camera", "at " + spelled(d.camera.position) + " toward " + spelled(d.camera.forward));
    line("render", "depth " + std::to_string(d.render.depth) + ", antialias " +
                       antialiasName(d.render.antialias) + (d.render.smooth ? ", smooth" : ""));
    line("lights", std::to_string(d.lights.size()));
    line("materials", counted(f.world.materials.size(), "material") + ", " +
                          std::to_string(f.transmissive()) + " let light through" +
                          (f.transmissive() ? "" : ": shadow rays stop at the first hit"));
    line("textures", std::to_string(d.textures.size()));
    line("objects", std::to_string(d.objects.size()));
    line("primitives", std::to_string(p.count()) + ": " +
                           counted(p.triangles.indices.size(), "triangle") + ", " +
                           counted(p.spheres.size(), "sphere") + ", " +
                           counted(p.parallelograms.size(), "parallelogram") + ", " +
                           counted(p.customs.primitives.size(), "custom"));
    if (const numeric::Box3d bounds = geometry::boundsOf(p); !bounds.empty())
        line("bounds", spelled(bounds.min) + " to " + spelled(bounds.max));
    if (d.animation)
        line("animation", counted(d.animation->frames, "frame") + ", " + spelled(d.animation->fps) +
                              " per second");
    line("octree", "depth " + std::to_string(f.tree.depth) + ", " + counted(f.tree.nodes, "node") +
                       ", " +
                       (f.tree.leaves == 1 ? "1 leaf" : std::to_string(f.tree.leaves) + " leaves") +
                       ", " + std::string(octree::Octree::simdLevel()) + " kernels");
    const auto namers = namersOf(d);
    for (const plugin_host::ModuleInfo& module : f.modules) {
        const auto named = namers.find(module.name);
        line("plugin", module.name + ", because of " +
                           (named == namers.end() ? "validation" : listedSome(named->second)) +
                           "\n             " + module.path.string());
    }
    for (const Output& output : f.outputs) line("codec", codecReason(output));
    line("memory", "geometry " + megabytes(bytesOf(p)) + ", octree " + megabytes(f.tree.bytes) +
                       ", picture " + megabytes(f.pictureBytes()));
    return text;
}

Json asJson(const Facts& f) {
    const scene::Description& d = f.description;
    const geometry::Primitives& p = f.world.primitives;
    Json json{{"scene", f.options.scene},
              {"width", d.image.width},
              {"height", d.image.height},
              {"depth", d.render.depth},
              {"antialias", antialiasName(d.render.antialias)}};
    json["outputs"] = Json::array();
    for (const Output& output : f.outputs)
        json["outputs"].push_back({{"file", output.path}, {"codec", codecReason(output)}});
    json["objects"] = d.objects.size();
    json["lights"] = d.lights.size();
    json["materials"] = f.world.materials.size();
    json["textures"] = d.textures.size();
    json["primitives"] = {{"triangles", p.triangles.indices.size()},
                          {"spheres", p.spheres.size()},
                          {"parallelograms", p.parallelograms.size()},
                          {"customs", p.customs.primitives.size()}};
    if (const numeric::Box3d bounds = geometry::boundsOf(p); !bounds.empty())
        json["bounds"] = {{"min", vector(bounds.min)}, {"max", vector(bounds.max)}};
    json["octree"] = {{"depth", f.tree.depth}, {"nodes", f.tree.nodes}, {"leaves", f.tree.leaves}};
    const auto namers = namersOf(d);
    json["plugins"] = Json::array();
    for (const plugin_host::ModuleInfo& module : f.modules) {
        const auto named = namers.find(module.name);
        json["plugins"].push_back(
            {{"name", module.name},
             {"file", module.path.string()},
             {"because_of", named == namers.end() ? std::vector<std::string>() : named->second}});
    }
    json["bytes"] = {
        {"geometry", bytesOf(p)}, {"octree", f.tree.bytes}, {"picture", f.pictureBytes()}};
    return json;
}

/// `rt info MESH`: what an import has to repair.
int infoOfMesh(const InfoOptions& options, plugin_host::Catalog& catalog, Console& console) {
    if (options.full || !options.overrides.empty() || options.allowMissing)
        throw UsageError(std::string(options.full           ? "--full"
                                     : options.allowMissing ? "--allow-missing"
                                                            : "--set") +
                         " is for scenes, and " + scene::quoted(options.scene) + " is a mesh");
    confine(options.scene, options);
    scene::Diagnostics diagnostics;
    const auto repaired =
        plugin_host::repairFile({.path = options.scene, .level = {}}, catalog, diagnostics);
    if (repaired && !options.json) noteRepairs(options.scene, repaired->report, diagnostics);
    console.report(diagnostics);
    if (repaired) console.result(options.json ? repaired->report : meshSummary(repaired->report));
    return diagnostics.exitCode();
}

} // namespace

int info(const InfoOptions& options, Console& console) {
    if (options.full && options.json)
        throw UsageError("--full prints YAML and --json JSON: choose one");
    scene::Diagnostics diagnostics;
    plugin_host::Catalog catalog(plugin_host::searchPath(options.pluginDirs));
    if (!plugin_host::loaderOf(options.scene, catalog).empty())
        return infoOfMesh(options, catalog, console);
    const auto loaded = loadScene(options.scene, options, catalog, diagnostics);
    if (!loaded) return console.report(diagnostics), diagnostics.exitCode();
    if (options.full) {
        console.report(diagnostics);
        console.result(formats::writeYaml(scene::fullScene(loaded->description)));
        return kExitOk;
    }
    const auto world =
        plugin_host::lower(loaded->description, catalog, diagnostics,
                           {.allowMissing = options.allowMissing, .limits = options.limits});
    console.report(diagnostics);
    if (!world) return diagnostics.exitCode();
    const auto tree = octree::Octree::build(
        world->primitives, {.maxObjects = loaded->description.render.octreeMaxObjects,
                            .minSize = loaded->description.render.octreeMinSize});
    RenderOptions asRendered; // where a plain `rt render` would write
    asRendered.scene = options.scene;
    scene::Diagnostics notAsked;
    const Facts facts{options,          loaded->description,
                      *world,           tree.statistics(),
                      catalog.opened(), planOutputs(asRendered, loaded->description, notAsked)};
    console.result(options.json ? asJson(facts).dump(2) + "\n" : asText(facts));
    return kExitOk;
}

} // namespace rt::cli
