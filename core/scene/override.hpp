// `--set PATH=VALUE` put into a scene's nodes before they are validated.
#pragma once
#include <core/scene/diagnostic.hpp>
#include <core/scene/node.hpp>

#include <string>

namespace rt::scene {

/// "render.depth=3", "objects.moon.radius=2", "camera.position=[0, 0, 5]", "image={width: 8, height: 8}": the key is replaced,
/// or added to its map; a section that the scene lacks is added. Items of lists are named by their `name` or counted from 0.
/// VALUE is a scalar, or a list or map in flow style. Errors stand in a source named --set. False after an error.
bool applyOverride(Node& root, const std::string& assignment, Diagnostics& diagnostics);

} // namespace rt::scene
