#include <core/plugin_host/repair_file.hpp>

#include <core/plugin_host/confined.hpp>
#include <core/plugin_host/readable.hpp>
#include <core/plugin_host/run_call.hpp>
#include <core/plugin_host/values.hpp>
#include <core/scene/file_suffix.hpp>
#include <core/scene/validate.hpp>

#include <new>

namespace rt::plugin_host {
namespace {

constexpr scene::Code kNoLoader{324};

/// Takes the text of a plugin into a string.
struct TextSink {
    rt_text_sink table; // first, so that a plugin's pointer to it is a pointer to the sink
    std::string* text;

    explicit TextSink(std::string& to) : table{sizeof table, 0, &write}, text(&to) {}
    static rt_status write(rt_text_sink* self, const char* bytes, std::uint64_t size) {
        try {
            reinterpret_cast<TextSink*>(self)->text->append(bytes, size);
            return RT_OK;
        } catch (const std::exception&) {
            return RT_OUT_OF_MEMORY;
        }
    }
};

} // namespace

std::string loaderOf(const std::string& path, Catalog& catalog) {
    const std::string suffix = scene::fileSuffix(path);
    return suffix.empty() ? "" : catalog.loaderFor(suffix);
}

std::optional<RepairedFile> repairFile(const RepairRequest& request, Catalog& catalog,
                                       scene::Diagnostics& diagnostics) {
    const scene::Location place{std::make_shared<scene::Source>(scene::Source{request.path, {}}), 0,
                                0};
    if (const auto why = whyUnreadable(request.path, scene::kMaxMeshBytes)) {
        diagnostics.error(why->first, place, why->second,
                          why->first == kNoSuchFile ? suggestionFor(request.path) : "");
        return {};
    }
    const std::string name = loaderOf(request.path, catalog);
    if (name.empty()) {
        diagnostics.error(kNoLoader, place, "no loader is known for files with this suffix",
                          "meshes are .obj and .ply, also with .gz");
        return {};
    }
    const ModuleInfo info = catalog.open(name);
    if (info.module == nullptr || info.module->loader == nullptr) {
        diagnostics.error(kPluginType, place,
                          "the loader '" + name + "' cannot be had" +
                              (info.refusal.empty() ? "" : ": " + info.refusal));
        return {};
    }
    const rt_loader& loader = *info.module->loader;
    if (loader.repair == nullptr) {
        diagnostics.error(kPluginType, place, "the loader '" + name + "' repairs nothing");
        return {};
    }
    const std::span rows(loader.params, loader.param_count);
    scene::Instance instance{name, {}, place, rows};
    for (rt_param row : rows) {
        if (!request.level.empty() && std::string_view(row.name) == "repair")
            row.fallback = request.level.c_str();
        const auto value = scene::defaultValue(row);
        if (const auto* why = std::get_if<std::string>(&value)) {
            diagnostics.error(kValueRefused, place,
                              "loader '" + name + "', " + row.name + ": " + *why);
            return {};
        }
        instance.values.push_back(std::get<scene::Value>(value));
        instance.values.back().location = place;
    }
    Call call = callFor("loader", instance, rows, kMeshFile, kMeshFile, {}, diagnostics);
    const ValueArray values(rows, instance.values, {});
    RepairedFile repaired;
    TextSink mesh(repaired.mesh), report(repaired.report);
    bool done = false;
    const auto work = [&] {
        done = run(call, [&] {
            return loader.repair(&call.host, request.path.c_str(), values.data(),
                                 request.mesh ? &mesh.table : nullptr, &report.table,
                                 request.everyFace ? RT_REPORT_FACES : 0);
        });
    };
    if (!runConfined(catalog.folders(), work)) diagnostics.error(kNotConfined, {}, kNeedsLandlock);
    if (!done) return {};
    return repaired;
}

} // namespace rt::plugin_host
