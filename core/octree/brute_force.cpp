// The queries by their definition: every primitive, one after the other.
#include <core/octree/octree.hpp>

#include <core/geometry/intersect.hpp>

#include <algorithm>

namespace rt::octree {
namespace {

using geometry::Kind;
using geometry::PrimitiveId;

/// Calls visit(id, kind, index) for every primitive by rising id until it returns false.
template <class Visit> void overAll(const Primitives& primitives, const Visit& visit) {
    for (const auto& segment : primitives.segments)
        for (std::uint32_t i = 0; i < segment.count; ++i)
            if (!visit(PrimitiveId{static_cast<std::uint32_t>(segment.first) + i}, segment.kind,
                       segment.index + i))
                return;
}

bool intersect(const Primitives& primitives, Kind kind, std::uint32_t index, const Ray& ray,
               const geometry::RayFrame& frame, double tMax, Hit& hit) {
    switch (kind) {
    case Kind::triangle: {
        const auto& c = primitives.triangles.indices[index];
        const auto& p = primitives.triangles.positions;
        return geometry::intersectTriangle(frame, p[c[0]], p[c[1]], p[c[2]], tMax, hit);
    }
    case Kind::sphere:
        return geometry::intersectSphere(frame, primitives.spheres[index], tMax, hit);
    case Kind::parallelogram:
        return geometry::intersectParallelogram(
            frame, geometry::cornersOf(primitives.parallelograms[index]), tMax, hit);
    case Kind::custom: {
        const auto& custom = primitives.customs.primitives[index];
        std::uint32_t primitive;
        if (!geometry::intersectCustom(*primitives.customs.shapes[custom.shape], &custom.primitive,
                                       1, ray, tMax, hit.t, primitive))
            return false;
        hit.u = hit.v = 0;
        return true;
    }
    }
    return false;
}

bool isPlanar(Kind kind) { return kind == Kind::triangle || kind == Kind::parallelogram; }

} // namespace

Hit closestBruteForce(const Primitives& primitives, const Ray& ray) {
    const geometry::RayFrame frame = geometry::frameOf(ray);
    Hit best;
    best.t = ray.tMax;
    overAll(primitives, [&](PrimitiveId id, Kind kind, std::uint32_t index) {
        if (isPlanar(kind) && id == ray.exclude) return true;
        // Rising ids: a later primitive wins only by a smaller t.
        if (intersect(primitives, kind, index, ray, frame, best.t, best)) best.id = id;
        return true;
    });
    return best ? best : Hit();
}

bool occludedBruteForce(const Primitives& primitives, const Ray& ray) {
    const geometry::RayFrame frame = geometry::frameOf(ray);
    bool any = false;
    overAll(primitives, [&](PrimitiveId id, Kind kind, std::uint32_t index) {
        Hit hit;
        any = !(isPlanar(kind) && id == ray.exclude) &&
              intersect(primitives, kind, index, ray, frame, ray.tMax, hit);
        return !any;
    });
    return any;
}

std::vector<Crossing> crossingsBruteForce(const Primitives& primitives, const Ray& ray) {
    const geometry::RayFrame frame = geometry::frameOf(ray);
    std::vector<Crossing> out;
    overAll(primitives, [&](PrimitiveId id, Kind kind, std::uint32_t index) {
        if (isPlanar(kind) && id == ray.exclude) return true;
        double t[2];
        switch (kind) {
        case Kind::triangle: {
            const auto& c = primitives.triangles.indices[index];
            const auto& p = primitives.triangles.positions;
            if (geometry::crossTriangle(frame, p[c[0]], p[c[1]], p[c[2]], ray.tMax, t[0]))
                out.push_back({t[0], id});
            break;
        }
        case Kind::parallelogram:
            if (geometry::crossParallelogram(
                    frame, geometry::cornersOf(primitives.parallelograms[index]), ray.tMax, t[0]))
                out.push_back({t[0], id});
            break;
        case Kind::sphere:
            if (geometry::intersectSphereLine(frame, primitives.spheres[index], t))
                for (const double s : t)
                    if (s > 0 && s < ray.tMax) out.push_back({s, id});
            break;
        case Kind::custom: {
            const auto& custom = primitives.customs.primitives[index];
            geometry::crossCustom(*primitives.customs.shapes[custom.shape], custom.primitive, id,
                                  ray, out);
            break;
        }
        }
        return true;
    });
    std::sort(out.begin(), out.end(), [](const Crossing& a, const Crossing& b) {
        return a.t != b.t ? a.t < b.t : a.id < b.id;
    });
    return out;
}

} // namespace rt::octree
