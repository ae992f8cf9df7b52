#include <core/trace/coincident.hpp>

#include <core/geometry/intersect.hpp>
#include <core/numeric/rounding.hpp>

#include <algorithm>
#include <cmath>

namespace rt::trace {

using geometry::Crossing;
using geometry::Hit;
using geometry::Kind;
using geometry::ObjectId;
using geometry::PrimitiveId;
using geometry::Ray;
using geometry::Surface;

LinearRgb colorAt(const world::World& world, const material::Material& material,
                  const Surface& surface) {
    if (!material.colorTexture) return material.color;
    const Vec3 object = world.objectPoint(surface.object, surface.position);
    const Vec3& at = surface.position;
    const Vec2 uv = geometry::uvOf(surface);
    const rt_surface_point point{{uv.x, uv.y}, {object.x, object.y, object.z}, {at.x, at.y, at.z}};
    double rgb[3] = {0, 0, 0};
    material.colorTexture->type->evaluate(material.colorTexture->state, &point, 1, rgb);
    return material.color * LinearRgb{rgb[0], rgb[1], rgb[2]};
}

Hit hitOn(const geometry::Primitives& primitives, const Ray& ray, PrimitiveId id) {
    const geometry::Segment& segment = primitives.segmentOf(id);
    const std::uint32_t index =
        segment.index + static_cast<std::uint32_t>(id) - static_cast<std::uint32_t>(segment.first);
    const geometry::RayFrame frame = geometry::frameOf(ray);
    Hit hit;
    bool found = false;
    switch (segment.kind) {
    case Kind::triangle: {
        const auto& corners = primitives.triangles.indices[index];
        const auto& p = primitives.triangles.positions;
        found = geometry::intersectTriangle(frame, p[corners[0]], p[corners[1]], p[corners[2]],
                                            ray.tMax, hit);
        break;
    }
    case Kind::sphere:
        found = geometry::intersectSphere(frame, primitives.spheres[index], ray.tMax, hit);
        break;
    case Kind::parallelogram:
        found = geometry::intersectParallelogram(
            frame, geometry::cornersOf(primitives.parallelograms[index]), ray.tMax, hit);
        break;
    case Kind::custom: {
        const auto& custom = primitives.customs.primitives[index];
        std::uint32_t primitive = custom.primitive;
        found = geometry::intersectCustom(*primitives.customs.shapes[custom.shape], &primitive, 1,
                                          ray, ray.tMax, hit.t, primitive);
        break;
    }
    }
    if (!found) return {};
    hit.id = id;
    return hit;
}

void findCoincident(const Stage& stage, const Ray& ray, const Hit& hit, const Surface& surface,
                    std::vector<Crossing>& scratch, Coincident& found, octree::Visits* visits) {
    const geometry::Primitives& primitives = stage.world.primitives;
    found.indexRatio = 1, found.filter = {1, 1, 1}, found.error = surface.error;
    found.opaque.reset(), found.entered.clear(), found.left.clear();
    found.enteredSolids.clear(), found.leftSolids.clear();

    // Nothing is nearer than the hit, so a query that ends just behind it answers with what lies on
    // it. Along a ray that grazes, "just behind" is long: what is met there is then held against the
    // distance of the surfaces, not that of the crossings.
    const double cosine = std::fabs(numeric::dot(ray.direction, surface.geometricNormal));
    if (cosine == 0) return;
    Ray upTo = ray;
    upTo.tMax = numeric::nextUp(hit.t + 4 * surface.error / cosine);
    scratch.clear();
    stage.octree.crossings(upTo, stage.nothing, scratch, visits);
    std::sort(scratch.begin(), scratch.end(),
              [](const Crossing& a, const Crossing& b) { return a.id < b.id; });
    for (const Crossing& crossing : scratch) {
        const Hit other = hitOn(primitives, upTo, crossing.id);
        if (!other) continue; // the far side of a sphere whose near side is elsewhere
        const Surface there = geometry::surfaceAt(primitives, upTo, other);
        if (there.object == surface.object) continue;
        if (!(std::fabs(crossing.t - hit.t) * cosine <= surface.error + there.error)) continue;
        found.error = std::max(found.error, there.error);
        const auto material = static_cast<std::uint32_t>(there.material);
        if (stage.opaque[material]) {
            if (!found.opaque) found.opaque = there, found.opaqueHit = other;
            continue;
        }
        const bool leaves = numeric::dot(ray.direction, there.geometricNormal) > 0;
        auto& list = leaves ? found.left : found.entered;
        if (std::find(list.begin(), list.end(), there.object) != list.end()) continue;
        list.push_back(there.object);
        const material::Material& m = stage.world.materials[material];
        found.filter *= colorAt(stage.world, m, there) * m.transmission;
        if (!there.solid) continue;
        (leaves ? found.leftSolids : found.enteredSolids).push_back(there.object);
        found.indexRatio *= leaves ? m.ior : 1 / m.ior;
    }
}

} // namespace rt::trace
