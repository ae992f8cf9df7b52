// Numeric parameters of a description by path, for keyframes: found once, set in every frame.
#pragma once
#include <core/scene/description.hpp>
#include <core/scene/values.hpp>

#include <span>
#include <string_view>

namespace rt::scene {

/// camera.KEY, camera.screen.KEY, background.KEY, lights.NAME.KEY, materials.NAME.KEY, textures.NAME.KEY, objects.NAME.KEY
/// or NAME.KEY (an object's own, its shape's or its loader's key), NAME.rotate.angle. A fault stands at `location`.
Parsed<Parameter> findParameter(const Description& description, std::string_view path,
                                const Location& location);

/// Sets the parameter and what follows from it: the camera's forward and screen, the object's transform.
/// values: `components` numbers, angles in radians, integers whole.
void setParameter(Description& description, const Parameter& parameter,
                  std::span<const double> values);

/// What the description has now; `components` numbers.
std::vector<double> parameterValue(const Description& description, const Parameter& parameter);

} // namespace rt::scene
