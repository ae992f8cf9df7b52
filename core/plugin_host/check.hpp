// `rt plugins --check`: holds a module against the rules of plugin.h, for those who write one.
#pragma once
#include <core/plugin_host/catalog.hpp>
#include <core/scene/description.hpp>

#include <string>
#include <vector>

namespace rt::plugin_host {

struct CheckReport {
    std::vector<std::string> checked; // "100000 rays against 1 custom primitive"
    std::vector<std::string>
        skipped; // "the shape was not made from its defaults: 'minor_radius' has none"
    std::vector<std::string> faults; // sentences; none: the module is in order

    bool passed() const { return faults.empty(); }
};

/// Checks the module `name` of `catalog`: that it opens; its rows and docs; then a shape's or texture's behaviour with its
/// defaults and with each of `examples`, instances of the type (validated from the module's own example text, say).
/// `rays`: against each custom shape, and points of a texture. Deterministic: they come from a fixed seed.
CheckReport checkModule(Catalog& catalog, const std::string& name,
                        const std::vector<scene::Instance>& examples = {}, int rays = 100000);

} // namespace rt::plugin_host
