#include <core/plugin_host/object_sphere.hpp>

#include <core/numeric/elementary.hpp>
#include <core/numeric/rounding.hpp>
#include <core/numeric/vec.hpp>

#include <cmath>
#include <numbers>
#include <vector>

namespace rt::plugin_host {
namespace {

using numeric::Vec3;
using Spheres = std::vector<rt_sphere>;

struct Roots {
    double first, second;
};

/// [Haines, Günther, Akenine-Möller 2019]: the discriminant from the distance between line and centre, and no
/// difference of nearly equal numbers in either root. False: a miss, or a NaN.
bool solve(const rt_sphere& sphere, const rt_ray& ray, Roots& roots) {
    const Vec3 d(ray.direction[0], ray.direction[1], ray.direction[2]);
    const Vec3 f = Vec3(sphere.center[0], sphere.center[1], sphere.center[2]) -
                   Vec3(ray.origin[0], ray.origin[1], ray.origin[2]);
    const double a = dot(d, d), b = dot(f, d), r2 = sphere.radius * sphere.radius;
    const Vec3 offset = f - (b / a) * d;
    const double discriminant = r2 - dot(offset, offset);
    const double c = dot(f, f) - r2;
    const bool inside = c < 0;
    if (!(inside || discriminant >= 0)) return false;
    const double root = std::sqrt(inside ? b * b - a * c : a * discriminant);
    const double q = b < 0 ? b - root : b + root;
    const double s = c / q, t = q / a;
    roots = s < t ? Roots{s, t} : Roots{t, s};
    return true;
}

bool within(const rt_ray& ray, double t) { return t > ray.t_min && t < ray.t_max; }

bool intersect(const rt_sphere& sphere, const rt_ray& ray, rt_hit& hit) {
    Roots roots;
    if (!solve(sphere, ray, roots)) return false;
    const double t = within(ray, roots.first) ? roots.first : roots.second;
    if (!within(ray, t)) return false;
    const Vec3 center(sphere.center[0], sphere.center[1], sphere.center[2]);
    const Vec3 met = Vec3(ray.origin[0], ray.origin[1], ray.origin[2]) +
                     t * Vec3(ray.direction[0], ray.direction[1], ray.direction[2]);
    const Vec3 normal = normalize(met - center);
    const Vec3 position = center + sphere.radius * normal;
    hit.t = t;
    // Re-projected: along the normal there remain the rounding of the unit normal's length (difference, square,
    // sum, root, quotient), of its product with the radius and of the sum with the centre.
    hit.position_error = numeric::gamma(10) * (sphere.radius + std::fabs(center.x) +
                                               std::fabs(center.y) + std::fabs(center.z));
    for (int i = 0; i < 3; ++i) {
        hit.position[i] = (&position.x)[i];
        hit.normal[i] = (&normal.x)[i];
    }
    const double longitude = numeric::atan2(normal.y, normal.x) / (2 * std::numbers::pi);
    hit.uv[0] = longitude < 0 ? longitude + 1 : longitude;
    hit.uv[1] = 1 - numeric::atan2(std::sqrt(normal.x * normal.x + normal.y * normal.y), normal.z) /
                        std::numbers::pi;
    return true;
}

const rt_sphere& at(const void* data, std::uint32_t primitive) {
    return (*static_cast<const Spheres*>(data))[primitive];
}

void bounds(const void* data, std::uint32_t primitive, double lower[3], double upper[3]) {
    const rt_sphere& sphere = at(data, primitive);
    for (int i = 0; i < 3; ++i) {
        lower[i] = numeric::nextDown(sphere.center[i] - sphere.radius);
        upper[i] = numeric::nextUp(sphere.center[i] + sphere.radius);
    }
}

std::int32_t intersectAny(const void* data, const std::uint32_t* primitives, std::uint32_t count,
                          const rt_ray* ray, rt_hit* hit) {
    bool found = false;
    rt_ray shrinking = *ray;
    for (std::uint32_t k = 0; k < count; ++k) {
        rt_hit candidate;
        if (!intersect(at(data, primitives[k]), shrinking, candidate)) continue;
        if (found && candidate.t == hit->t && primitives[k] > hit->primitive) continue;
        *hit = candidate;
        hit->primitive = primitives[k];
        hit->reserved = 0;
        found = true;
        shrinking.t_max = std::fmin(numeric::nextUp(hit->t),
                                    ray->t_max); // an equal t of a lower primitive still wins
    }
    return found;
}

std::uint32_t crossings(const void* data, std::uint32_t primitive, const rt_ray* ray, double* t,
                        std::uint32_t capacity) {
    Roots roots;
    if (!solve(at(data, primitive), *ray, roots)) return 0;
    std::uint32_t found = 0;
    for (double root : {roots.first, roots.second})
        if (within(*ray, root) && found < capacity) t[found++] = root;
    return found;
}

} // namespace

rt_custom objectSpheres(std::span<const rt_sphere> spheres) {
    rt_custom custom{};
    custom.struct_size = sizeof custom;
    custom.kind = RT_SOLID;
    custom.primitive_count = static_cast<std::uint32_t>(spheres.size());
    custom.data = new Spheres(spheres.begin(), spheres.end());
    custom.bounds = bounds;
    custom.intersect = intersectAny;
    custom.crossings = crossings;
    custom.release = [](void* data) { delete static_cast<Spheres*>(data); };
    return custom;
}

} // namespace rt::plugin_host
