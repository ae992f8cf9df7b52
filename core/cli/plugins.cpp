// rt plugins: what is installed, what each offers, and what is broken and why.
#include <core/cli/check_plugin.hpp>
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/plugin_host/catalog.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <limits>
#include <span>

namespace rt::cli {

namespace {

using Json = nlohmann::ordered_json;
using plugin_host::ModuleInfo;

std::span<const rt_param> parametersOf(const rt_module& module) {
    if (module.shape) return {module.shape->params, module.shape->param_count};
    if (module.texture) return {module.texture->params, module.texture->param_count};
    return {module.loader->params, module.loader->param_count};
}

const char* kindOf(const rt_module& module) {
    return module.shape ? "shape" : module.texture ? "texture" : "loader";
}

std::string spelled(double value) {
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string typeOf(const rt_param& p) {
    switch (p.type) {
    case RT_BOOL:
        return "true or false";
    case RT_INTEGER:
        return "whole number";
    case RT_REAL:
        return p.unit == RT_UNIT_ANGLE ? "angle" : "number";
    case RT_VECTOR3:
        return "[x, y, z]";
    case RT_COLOR:
        return "colour";
    case RT_TEXT:
        return "text";
    case RT_CHOICE:
        return p.choices;
    case RT_FILE:
        return "file";
    case RT_TEXTURE:
        return "texture";
    case RT_VECTOR3_LIST:
        return "list of [x, y, z]";
    case RT_INTEGER_LISTS:
        return "list of lists of whole numbers";
    default:
        return "?";
    }
}

const char* unitOf(const rt_param& p) {
    switch (p.unit) {
    case RT_UNIT_LENGTH:
        return "scene units";
    case RT_UNIT_ANGLE:
        return "deg or rad";
    case RT_UNIT_COUNT:
        return "count";
    case RT_UNIT_RATIO:
        return "ratio";
    case RT_UNIT_LINEAR_RGB:
        return "linear RGB";
    default:
        return "";
    }
}

bool isNumeric(const rt_param& p) {
    return p.type == RT_INTEGER || p.type == RT_REAL || p.type == RT_VECTOR3 ||
           p.type == RT_COLOR || p.type == RT_VECTOR3_LIST || p.type == RT_INTEGER_LISTS;
}

std::string limitsOf(const rt_param& p) {
    constexpr double kUnlimited = std::numeric_limits<double>::max();
    if (!isNumeric(p)) return "";
    std::string text;
    if (p.min > -kUnlimited)
        text += std::string(p.flags & RT_MIN_EXCLUSIVE ? "> " : ">= ") + spelled(p.min);
    if (p.max < kUnlimited)
        text += (text.empty() ? "" : ", ") +
                std::string(p.flags & RT_MAX_EXCLUSIVE ? "< " : "<= ") + spelled(p.max);
    return text;
}

std::string defaultOf(const rt_param& p) {
    if (!p.fallback) return "required";
    return *p.fallback ? "default " + std::string(p.fallback) : "optional";
}

Json asJson(const ModuleInfo& info) {
    Json json{{"name", info.name}, {"file", info.path.string()}};
    if (!info.module) return json["refused"] = info.refusal, json;
    const rt_module& module = *info.module;
    json["kind"] = kindOf(module);
    json["version"] = module.version;
    json["abi"] = std::to_string(module.abi_major) + "." + std::to_string(module.abi_minor);
    json["doc"] = module.doc;
    if (module.loader) json["extensions"] = module.loader->extensions;
    json["parameters"] = Json::array();
    for (const rt_param& p : parametersOf(module)) {
        Json row{{"name", p.name}, {"type", typeOf(p)}};
        if (*unitOf(p)) row["unit"] = unitOf(p);
        row["required"] = p.fallback == nullptr;
        if (p.fallback) row["default"] = p.fallback;
        if (const std::string limits = limitsOf(p); !limits.empty()) row["limits"] = limits;
        row["doc"] = p.doc;
        json["parameters"].push_back(row);
    }
    json["example"] = module.example;
    return json;
}

std::string asList(const std::vector<ModuleInfo>& modules) {
    std::size_t nameWidth = 4, versionWidth = 7;
    for (const ModuleInfo& info : modules) {
        nameWidth = std::max(nameWidth, info.name.size());
        if (info.module)
            versionWidth = std::max(versionWidth, std::string_view(info.module->version).size());
    }
    const auto column = [](std::string text, std::size_t width) {
        text.resize(width + 2, ' ');
        return text;
    };
    std::string text;
    for (const char* const kind : {"shape", "texture", "loader"}) {
        bool headed = false;
        for (const ModuleInfo& info : modules) {
            if (!info.module || std::string_view(kindOf(*info.module)) != kind) continue;
            if (!std::exchange(headed, true))
                text += (text.empty() ? "" : "\n") + std::string(kind) + "s\n";
            text += "  " + column(info.name, nameWidth) +
                    column(info.module->version, versionWidth) + info.module->doc + "\n";
            text += "  " + column("", nameWidth) + info.path.string() + "\n";
        }
    }
    bool headed = false;
    for (const ModuleInfo& info : modules) {
        if (info.module) continue;
        if (!std::exchange(headed, true))
            text += (text.empty() ? "" : "\n") + std::string("refused\n");
        text += "  " + column(info.name, nameWidth) + info.refusal + "\n  " +
                column("", nameWidth) + info.path.string() + "\n";
    }
    return text;
}

std::string asPage(const ModuleInfo& info) {
    const rt_module& module = *info.module;
    std::string text = info.name + ", a " + kindOf(module) + ": " + module.doc + "\n\nversion " +
                       module.version + ", plugin ABI " + std::to_string(module.abi_major) + "." +
                       std::to_string(module.abi_minor) + "\n" + info.path.string() + "\n";
    if (module.loader) text += "files: " + std::string(module.loader->extensions) + "\n";
    text += "\nParameters:\n";
    for (const rt_param& p : parametersOf(module)) {
        std::string about =
            typeOf(p) + (*unitOf(p) ? std::string(", ") + unitOf(p) : "") + ", " + defaultOf(p);
        if (const std::string limits = limitsOf(p); !limits.empty()) about += ", " + limits;
        text += "  " + std::string(p.name) + ": " + about + "\n      " + p.doc + "\n";
    }
    text += "\nExample:\n";
    const std::string example = module.example;
    for (std::size_t from = 0; from < example.size();) {
        const std::size_t to = std::min(example.find('\n', from), example.size());
        text += "  " + example.substr(from, to - from) + "\n";
        from = to + 1;
    }
    return text;
}

int showOne(const std::string& name, plugin_host::Catalog& catalog, const PluginsOptions& options,
            Console& console) {
    std::vector<std::string> known;
    for (const auto kind :
         {scene::TypeKind::shape, scene::TypeKind::texture, scene::TypeKind::loader})
        for (const std::string& other : catalog.names(kind)) known.push_back(other);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
        const std::string near = scene::nearest(name, known);
        console.fail("plugins", kExitPlugin, "there is no plugin " + scene::quoted(name),
                     near.empty() ? "rt plugins lists them" : "did you mean '" + near + "'?");
        return kExitPlugin;
    }
    const ModuleInfo info = catalog.open(name);
    if (options.json)
        console.result(asJson(info).dump(2) + "\n");
    else if (info.module)
        console.result(asPage(info));
    if (info.module) return kExitOk;
    console.fail("plugins", kExitPlugin, info.refusal, "");
    return kExitPlugin;
}

} // namespace

int plugins(const PluginsOptions& options, Console& console) {
    if (!options.check.empty()) return checkPlugin(options, console);
    plugin_host::Catalog catalog(plugin_host::searchPath(options.pluginDirs));
    if (!options.name.empty()) return showOne(options.name, catalog, options, console);
    const auto modules = catalog.openAll();
    if (options.json) {
        Json all = Json::array();
        for (const ModuleInfo& info : modules) all.push_back(asJson(info));
        console.result(all.dump(2) + "\n");
    } else {
        console.result(asList(modules));
    }
    return kExitOk;
}

} // namespace rt::cli
