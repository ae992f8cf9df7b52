// Finds, checks and opens plugin modules; remembers what it refused and why.
#pragma once
#include <core/scene/type_catalog.hpp>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace rt::plugin_host {

struct ModuleInfo {
    std::string name; // stem of the file
    std::filesystem::path path;
    const rt_module* module = nullptr; // none: refused
    std::string refusal;               // a sentence
};

class Catalog final : public scene::TypeCatalog {
public:
    /// Folders are searched in this order; a name that two of them claim is an error that names
    /// both files.
    explicit Catalog(std::vector<std::filesystem::path> folders);
    ~Catalog() override;
    Catalog(Catalog&&) noexcept;
    Catalog& operator=(Catalog&&) noexcept;

    std::variant<scene::TypeRows, scene::TypeRefusal> find(scene::TypeKind kind,
                                                           std::string_view name) override;
    std::vector<std::string> names(scene::TypeKind kind) override;
    std::string loaderFor(std::string_view lowerCaseSuffix) override;

    /// Opens `name` if it is not open yet.
    ModuleInfo open(std::string_view name);
    /// Opens everything on the path, broken modules included: `rt plugins`.
    std::vector<ModuleInfo> openAll();
    /// Where it looks, as given.
    const std::vector<std::filesystem::path>& folders() const;
    /// What has been opened so far, in order: `rt info`.
    std::vector<ModuleInfo> opened() const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

/// --plugin-dir folders, then RT_PLUGIN_PATH (ignored when setuid), then <exe>/../lib/rt/plugins.
std::vector<std::filesystem::path> searchPath(const std::vector<std::filesystem::path>& pluginDirs);

} // namespace rt::plugin_host
