// A description back to nodes with every default filled in: `rt info --full`.
#pragma once
#include <core/scene/description.hpp>
#include <core/scene/node.hpp>

namespace rt::scene {

/// A scene that validates to the same description. Files are absolute, angles in the unit that keeps every bit.
Node fullScene(const Description& description);

} // namespace rt::scene
