// A sphere in object space as a custom shape: what a sphere becomes under a map that is no similarity. Exact: the ray is
// taken to object space, where the sphere is one.
#pragma once
#include <rt/plugin.h>

#include <span>

namespace rt::plugin_host {

/// One primitive per sphere; copies them. The caller gives `data` to `release` once.
rt_custom objectSpheres(std::span<const rt_sphere> spheres);

} // namespace rt::plugin_host
