// A mesh file as its loader repairs it, without a scene: `rt mesh repair`, `rt info MESH`.
#pragma once
#include <core/plugin_host/catalog.hpp>
#include <core/scene/diagnostic.hpp>

#include <optional>
#include <string>

namespace rt::plugin_host {

struct RepairRequest {
    std::string path;
    std::string level;      // of the loader's parameter `repair`; empty: its default
    bool mesh = false;      // is the repaired mesh wanted?
    bool everyFace = false; // does the report list the faces?
};

struct RepairedFile {
    std::string mesh;   // OBJ text
    std::string report; // a JSON object
};

/// The loader that reads files of this name, by the suffix before `.gz`, or "".
std::string loaderOf(const std::string& path, Catalog& catalog);

/// Nothing when `diagnostics` has gained an error: E0401 and E0402 the file, E0324 no loader reads such files, E0420 the
/// loader cannot use it, E0501 and E0530 the plugin.
std::optional<RepairedFile> repairFile(const RepairRequest& request, Catalog& catalog,
                                       scene::Diagnostics& diagnostics);

} // namespace rt::plugin_host
