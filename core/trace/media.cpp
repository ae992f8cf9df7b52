#include <core/trace/media.hpp>

#include <core/geometry/surface.hpp>
#include <core/trace/coincident.hpp>
#include <core/trace/direction.hpp>

#include <algorithm>

namespace rt::trace {

using geometry::ObjectId;

std::vector<ObjectId> mediaAt(const Stage& stage, const Vec3& point) {
    std::vector<ObjectId> inside;
    if (!stage.transmits) return inside;
    geometry::Ray ray;
    ray.origin = point;
    // No axis, diagonal or plane of a scene is likely to lie along it.
    ray.direction = unit({0.5377, 0.7213, 0.4361});
    std::vector<geometry::Crossing> crossings;
    stage.octree.crossings(ray, stage.nothing, crossings);
    std::vector<ObjectId> seen;
    for (const geometry::Crossing& crossing : crossings) {
        geometry::Hit hit;
        hit.t = crossing.t, hit.id = crossing.id;
        const geometry::Surface surface = geometry::surfaceAt(stage.world.primitives, ray, hit);
        if (!surface.solid || stage.opaque[static_cast<std::uint32_t>(surface.material)]) continue;
        if (std::find(seen.begin(), seen.end(), surface.object) != seen.end()) continue;
        seen.push_back(surface.object);
        if (dot(ray.direction, surface.geometricNormal) > 0) inside.push_back(surface.object);
    }
    std::sort(inside.begin(), inside.end());
    return inside;
}

} // namespace rt::trace
