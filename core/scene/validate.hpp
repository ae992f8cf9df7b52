// Nodes to a description: types, ranges, names, units, all errors at once.
#pragma once
#include <core/scene/description.hpp>
#include <core/scene/limits.hpp>
#include <core/scene/node.hpp>
#include <core/scene/type_catalog.hpp>

#include <cstdint>
#include <optional>
#include <variant>

namespace rt::scene {

/// The description, or nothing when `diagnostics` has gained an error. Paths in the scene are relative to the folder
/// of the file that names them.
std::optional<Description> validate(const Node& root, TypeCatalog& catalog,
                                    Diagnostics& diagnostics, const Limits& limits = {});

/// What a row's fallback stands for, without a location: the value, or a clause that says why it is none ("needs a
/// value", "must be > 0 (got -1)"). core/plugin_host refuses modules with a fallback that is neither required nor valid.
std::variant<Value, std::string> defaultValue(const rt_param& row);

/// JSON Schema (draft-07) of the scene language with every type that `catalog` can open, from the rows that validate.
std::string jsonSchema(TypeCatalog& catalog);

} // namespace rt::scene
