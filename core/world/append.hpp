// Worlds that were made side by side become one.
#pragma once
#include <core/world/world.hpp>

#include <cstddef>
#include <optional>
#include <string>

namespace rt::world {

/// Appends the primitives of `from`, and its materials from `sharedMaterials` on: those before are the first of `to`, too.
/// The result is as if one world had taken everything in this order. Returns why it cannot be, with `to` untouched.
std::optional<std::string> append(World& to, World&& from, std::size_t sharedMaterials,
                                  std::uint64_t maxPrimitives);

} // namespace rt::world
