#include <core/plugin_host/catalog.hpp>

#include <core/plugin_host/module.hpp>
#include <core/scene/diagnostic.hpp>
#include <core/scene/input_file.hpp>

#include <algorithm>
#include <map>
#include <new>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;

const char* kindName(scene::TypeKind kind) {
    switch (kind) {
    case scene::TypeKind::shape:
        return "shape";
    case scene::TypeKind::texture:
        return "texture";
    case scene::TypeKind::loader:
        return "loader";
    }
    return "type";
}

scene::TypeKind kindOf(const rt_module& module) {
    if (module.shape != nullptr) return scene::TypeKind::shape;
    return module.texture != nullptr ? scene::TypeKind::texture : scene::TypeKind::loader;
}

std::span<const rt_param> rowsOf(const rt_module& module) {
    if (module.shape != nullptr) return {module.shape->params, module.shape->param_count};
    if (module.texture != nullptr) return {module.texture->params, module.texture->param_count};
    return {module.loader->params, module.loader->param_count};
}

} // namespace

struct Catalog::Impl {
    std::vector<fs::path> folders; // as they were given
    std::vector<fs::path> trusted; // those that exist, canonical, each once
    std::map<std::string, std::vector<fs::path>, std::less<>> files; // by stem, in search order
    std::map<std::string, ModuleInfo, std::less<>> modules;          // what was opened or refused
    std::vector<std::string> openingOrder;

    explicit Impl(std::vector<fs::path> given) : folders(std::move(given)) {
        for (const fs::path& folder : folders) {
            std::error_code error;
            const fs::path real = fs::canonical(folder, error);
            if (error == std::errc::not_enough_memory) throw std::bad_alloc();
            if (error || std::find(trusted.begin(), trusted.end(), real) != trusted.end()) continue;
            trusted.push_back(real);
            for (const std::string& name : scene::namesIn(real.string()))
                if (const std::string_view stem = stemOf(name); !stem.empty())
                    files[std::string(stem)].push_back(real / name);
        }
    }

    std::string searched() const {
        if (folders.empty()) return "no plugin folder was searched";
        std::string list = "searched ";
        for (const fs::path& folder : folders) {
            if (&folder != &folders.front()) list += ", ";
            std::error_code ignored;
            list +=
                folder.string() + (fs::is_directory(folder, ignored) ? "" : " (no such folder)");
        }
        return list;
    }

    const ModuleInfo& open(std::string_view name) {
        if (const auto known = modules.find(name); known != modules.end()) return known->second;
        ModuleInfo info;
        info.name = name;
        if (const auto found = files.find(name); found == files.end()) {
            info.refusal = "there is no plugin " + scene::quoted(name);
        } else if (const std::vector<fs::path>& paths = found->second; paths.size() > 1) {
            info.path = paths[0];
            info.refusal = "two modules claim the name '" + info.name + "': " + paths[0].string() +
                           " and " + paths[1].string() + "; remove one";
        } else {
            info.path = paths[0];
            const auto result = openModule(info.path, trusted);
            if (const auto* why = std::get_if<std::string>(&result))
                info.refusal = info.path.string() + " was refused: " + *why;
            else
                info.module = std::get<const rt_module*>(result), openingOrder.push_back(info.name);
        }
        return modules.emplace(info.name, std::move(info)).first->second;
    }
};

Catalog::Catalog(std::vector<fs::path> folders)
    : impl_(std::make_unique<Impl>(std::move(folders))) {}
Catalog::~Catalog() = default;
Catalog::Catalog(Catalog&&) noexcept = default;
Catalog& Catalog::operator=(Catalog&&) noexcept = default;

std::variant<scene::TypeRows, scene::TypeRefusal> Catalog::find(scene::TypeKind kind,
                                                                std::string_view name) {
    const std::string wanted = std::string(kindName(kind)) + " " + scene::quoted(name);
    if (!isTypeName(name))
        return scene::TypeRefusal{
            wanted + " cannot exist: the name of a type is [a-z][a-z0-9_]*, at most 64 characters"};
    if (!impl_->files.contains(name))
        return scene::TypeRefusal{"there is no " + wanted + " (" + impl_->searched() + ")"};
    const ModuleInfo& info = impl_->open(name);
    if (info.module == nullptr)
        return scene::TypeRefusal{wanted + " cannot be used: " + info.refusal + " (" +
                                  impl_->searched() + ")"};
    if (kindOf(*info.module) != kind)
        return scene::TypeRefusal{"there is no " + wanted + ": '" + info.name + "' is a " +
                                  kindName(kindOf(*info.module)) + " (" + info.path.string() + ")"};
    return scene::TypeRows{info.module->name, rowsOf(*info.module)};
}

std::vector<std::string> Catalog::names(scene::TypeKind kind) {
    std::vector<std::string> names;
    for (const auto& [name, paths] : impl_->files) {
        const auto known = impl_->modules.find(name);
        const rt_module* module = known == impl_->modules.end() ? nullptr : known->second.module;
        if (isTypeName(name) && (module == nullptr || kindOf(*module) == kind))
            names.push_back(name);
    }
    return names;
}

std::string Catalog::loaderFor(std::string_view lowerCaseSuffix) {
    return lowerCaseSuffix == "obj" || lowerCaseSuffix == "ply" ? "openmesh" : "";
}

ModuleInfo Catalog::open(std::string_view name) { return impl_->open(name); }

std::vector<ModuleInfo> Catalog::openAll() {
    std::vector<ModuleInfo> all;
    for (const auto& [name, paths] : impl_->files) all.push_back(impl_->open(name));
    return all;
}

const std::vector<fs::path>& Catalog::folders() const { return impl_->folders; }

std::vector<ModuleInfo> Catalog::opened() const {
    std::vector<ModuleInfo> opened;
    for (const std::string& name : impl_->openingOrder)
        opened.push_back(impl_->modules.find(name)->second);
    return opened;
}

} // namespace rt::plugin_host
