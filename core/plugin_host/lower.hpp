// A validated description to a world of primitives, materials and textures, through the plugins'
// own code.
#pragma once
#include <core/plugin_host/catalog.hpp>
#include <core/scene/description.hpp>
#include <core/scene/limits.hpp>
#include <core/world/world.hpp>

#include <optional>
#include <set>
#include <string>

namespace rt::plugin_host {

struct LowerOptions {
    bool allowMissing = false; // objects whose file is missing are left out, with a warning
    /// Gains the files that values and materials name, once each; not what a loader's file names in its turn, but images.
    std::set<std::string>* files = nullptr;
    scene::Limits limits;
    int threads = 0; // that files may be loaded on; 0: all that the process may use
};

/// The world, or nothing when `diagnostics` has gained an error (E04xx files, E05xx plugins, E07xx
/// limits).
std::optional<world::World> lower(const scene::Description& description, Catalog& catalog,
                                  scene::Diagnostics& diagnostics,
                                  const LowerOptions& options = {});

} // namespace rt::plugin_host
