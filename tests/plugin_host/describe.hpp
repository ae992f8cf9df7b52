// Descriptions for tests, without a scene file: instances take their values by name, the rest by default.
#pragma once
#include <core/plugin_host/catalog.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/scene/validate.hpp>

#include <map>
#include <stdexcept>

namespace rt::test {

using Data = decltype(scene::Value::data);
using Values = std::map<std::string, Data>;

inline scene::Location at(std::uint32_t line) {
    static const auto source = std::make_shared<scene::Source>(scene::Source{"scene.yaml", ""});
    return {source, line, 1};
}

/// Values are located at line 100 + their row, the type at line 10.
inline scene::Instance instance(plugin_host::Catalog& catalog, scene::TypeKind kind,
                                const std::string& type, const Values& values = {}) {
    const auto found = catalog.find(kind, type);
    if (const auto* refusal = std::get_if<scene::TypeRefusal>(&found))
        throw std::runtime_error(refusal->reason);
    scene::Instance made{type, {}, at(10), std::get<scene::TypeRows>(found).rows};
    std::uint32_t line = 100;
    for (const rt_param& row : std::get<scene::TypeRows>(found).rows) {
        scene::Value value;
        if (const auto given = values.find(row.name); given != values.end())
            value.data = given->second;
        else if (row.fallback != nullptr)
            value = std::get<scene::Value>(scene::defaultValue(row));
        value.location = at(line++);
        made.values.push_back(value);
    }
    return made;
}

struct Scene {
    explicit Scene(std::vector<std::filesystem::path> folders) : catalog(std::move(folders)) {}

    scene::Object& add(const std::string& shape, const Values& values = {}) {
        scene::Object object;
        object.name = shape + std::to_string(description.objects.size());
        object.shape = instance(catalog, scene::TypeKind::shape, shape, values);
        object.location = at(5);
        return description.objects.emplace_back(std::move(object));
    }
    std::int64_t addTexture(const std::string& name, const std::string& type,
                            const Values& values = {}) {
        description.textures.push_back(
            {name, instance(catalog, scene::TypeKind::texture, type, values)});
        return static_cast<std::int64_t>(description.textures.size()) - 1;
    }
    std::optional<world::World> lower(plugin_host::LowerOptions options = {}) {
        return plugin_host::lower(description, catalog, diagnostics, options);
    }
    /// Everything that was said, one line each: "scene.yaml:101: error[E0348]: …".
    std::string said() const {
        std::string text;
        for (const scene::Diagnostic& d : diagnostics.all()) {
            text += d.location.source
                        ? d.location.source->path + ":" + std::to_string(d.location.line) + ": "
                        : "";
            const auto code = std::to_string(static_cast<unsigned>(d.code));
            text += d.severity == scene::Severity::note      ? "note"
                    : d.severity == scene::Severity::warning ? "warning"
                                                             : "error[E0" + code + "]";
            text += ": " + d.message + (d.suggestion.empty() ? "" : "; " + d.suggestion) + "\n";
        }
        return text;
    }

    plugin_host::Catalog catalog;
    scene::Description description;
    scene::Diagnostics diagnostics;
};

} // namespace rt::test
