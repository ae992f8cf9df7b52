#include "bench_rays.hpp"

#include <core/geometry/surface.hpp>
#include <core/numeric/box.hpp>

#include <cmath>
#include <random>

namespace rt::bench {
namespace {

Vec3 narrowed(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

} // namespace

Rays makeRays(const octree::Octree& tree, const geometry::Primitives& primitives, const Vec3& eye,
              const Vec3& target, const Vec3& light, double fieldOfView) {
    using numeric::cross;
    using numeric::dot;
    using numeric::normalize;
    constexpr int kSize = 1024, kTile = 16, kKeep = 3;
    Rays rays;
    const Vec3 forward = normalize(target - eye), right = normalize(cross(forward, Vec3(0, 1, 0))),
               up = cross(right, forward);
    const double half = std::tan(fieldOfView / 2);
    for (int ty = 0; ty < kSize; ty += kTile)
        for (int tx = 0; tx < kSize; tx += kTile) {
            if ((tx / kTile + ty / kTile) % kKeep != 0) continue;
            for (int i = 0; i < kTile * kTile; ++i) {
                const int bx = (i >> 4 & 1) | (i >> 6 & 1) << 1, by = (i >> 5 & 1) | (i >> 7 & 1)
                                                                                         << 1;
                const int x = tx + bx * 4 + (i & 3), y = ty + by * 4 + (i >> 2 & 3);
                const double a = (2 * (x + 0.5) / kSize - 1) * half,
                             b = (1 - 2 * (y + 0.5) / kSize) * half;
                geometry::Ray ray;
                ray.origin = narrowed(eye);
                ray.direction = narrowed(normalize(forward + right * a + up * b));
                rays.of[kPrimary].push_back(ray);
            }
        }
    numeric::Box3d box;
    for (const Vec3& p : primitives.triangles.positions) box.add(p);
    for (const auto& s : primitives.spheres) box.add({s.center - s.radius, s.center + s.radius});
    const double size = numeric::length(box.diagonal());
    for (const auto& ray : rays.of[kPrimary]) {
        const auto hit = tree.closest(ray);
        if (!hit) continue;
        const auto surface = geometry::surfaceAt(primitives, ray, hit);
        Vec3 n = surface.geometricNormal;
        if (dot(n, ray.direction) > 0) n = -n;
        // Well off the surface: what f32 would need.
        const Vec3 p = narrowed(surface.position + n * (0.00002 * std::fmin(size, 5)));
        geometry::Ray shadow, mirror;
        shadow.origin = mirror.origin = p;
        shadow.direction = narrowed(light - p);
        shadow.tMax = 0.9999f;
        mirror.direction = narrowed(normalize(ray.direction - n * (2 * dot(n, ray.direction))));
        rays.of[kShadow].push_back(shadow);
        rays.of[kMirror].push_back(mirror);
    }
    std::mt19937 bits(3);
    const auto u = [&] { return (bits() + 0.5) / 4294967296.0; };
    for (int i = 0; i < 300000; ++i) {
        geometry::Ray ray;
        ray.origin = narrowed(box.min + box.diagonal() * Vec3(u(), u(), u()));
        const double z = 2 * u() - 1, phi = 2 * M_PI * u(), s = std::sqrt(1 - z * z);
        ray.direction = narrowed({s * std::cos(phi), s * std::sin(phi), z});
        rays.of[kRandom].push_back(ray);
    }
    for (auto& list : rays.of) list.resize(list.size() / 16 * 16);
    return rays;
}

} // namespace rt::bench
