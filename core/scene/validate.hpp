// Nodes to a description: types, ranges, names, units, all errors at once.
#pragma once
#include <core/scene/description.hpp>
#include <core/scene/node.hpp>
#include <core/scene/type_catalog.hpp>

#include <optional>

namespace rt::scene {

/// The description, or nothing when `diagnostics` has gained an error. Paths in the scene are relative to the folder
/// of the file that names them.
std::optional<Description> validate(const Node& root, TypeCatalog& catalog, Diagnostics& diagnostics);

/// JSON Schema (draft-07) of the scene language with every type that `catalog` can open, from the rows that validate.
std::string jsonSchema(TypeCatalog& catalog);

} // namespace rt::scene
