// What lowering makes and tracing reads: geometry, materials, textures and the names to report them
// by.
#pragma once
#include <core/geometry/primitives.hpp>
#include <core/material/material.hpp>

#include <memory>
#include <string>
#include <vector>

namespace rt::world {

using numeric::AffineTransform;

struct World {
    geometry::Primitives primitives;
    std::vector<material::Material> materials; // indexed by MaterialId
    std::vector<std::string> materialNames;    // likewise
    std::vector<std::shared_ptr<const material::Texture>>
        textures;                         // the scene's textures first, in its order
    std::vector<std::string> objectNames; // indexed by ObjectId
    std::vector<AffineTransform>
        objectFromWorld; // likewise; for rt_surface_point and the uv of turned spheres

    geometry::Vec3 objectPoint(geometry::ObjectId object, const geometry::Vec3& worldPoint) const {
        const auto i = static_cast<std::uint32_t>(object);
        return i < objectFromWorld.size() ? objectFromWorld[i].point(worldPoint) : worldPoint;
    }
};

} // namespace rt::world
