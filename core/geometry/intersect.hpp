// The scalar intersections. They define every answer: the octree's SIMD kernels give the same bits.
//
// All of them are made of +, -, *, / and sqrt, each rounded once, in the order written in
// intersect.cpp; no operation is contracted. A NaN anywhere is a miss, and a miss writes nothing.
#pragma once
#include <core/geometry/ray.hpp>

#include <array>
#include <vector>

namespace rt::geometry {

/// What the intersections need of a ray, once per ray.
struct RayFrame {
    double origin[3], direction[3];
    // Shear that makes the ray the axis kz [Woop, Benthin, Wald 2013]: |direction[kz]| is largest.
    int kx, ky, kz;
    double shearX, shearY, shearZ;  // d[kx]/d[kz], d[ky]/d[kz], 1/d[kz]
    double squared, inverseSquared; // d·d and its reciprocal
};

RayFrame frameOf(const Ray& ray);

/// The corners origin, +u, +u+v, +v as the kernels use them. Two parallelograms, or a parallelogram
/// and a triangle, are watertight along an edge whose two corners are the same bits in both.
std::array<Vec3, 4> cornersOf(const Parallelogram& p);

/// t, u, v where the ray's line meets the triangle, if t is in (0, tMax). Watertight: the three edge
/// functions fl(a·b) − fl(c·d) never have the wrong sign, since rounding is monotone, and are exactly
/// opposite for the two triangles at an edge; zero counts as inside.
bool intersectTriangle(const RayFrame& ray, const Vec3& a, const Vec3& b, const Vec3& c,
                       double tMax, Hit& hit);

/// Two triangles that share the diagonal corner 0 – corner 2: watertight inside too.
bool intersectParallelogram(const RayFrame& ray, const std::array<Vec3, 4>& corners, double tMax,
                            Hit& hit);

/// Parameters where the line meets the sphere, t[0] <= t[1]; false when it passes by. Discriminant
/// r² − |f − (f·d)d/d·d|², f = centre − origin, roots q and c/q [Haines, Günther, Akenine-Möller
/// 2019]. From inside, where f·f < r², a line cannot miss: there (f·d)² − d·d(f·f − r²) is a sum of
/// two positive terms and cannot cancel.
bool intersectSphereLine(const RayFrame& ray, const Sphere& sphere, double t[2]);

/// First of the two that lies in (0, tMax).
bool intersectSphere(const RayFrame& ray, const Sphere& sphere, double tMax, Hit& hit);

/// Closest hit in (0, tMax) among `count` primitives of one shape, numbered within that shape, by
/// one call of the plugin. `primitive` receives the number that was hit.
bool intersectCustom(const CustomShape& shape, const std::uint32_t* primitives, std::uint32_t count,
                     const Ray& ray, double tMax, double& t, std::uint32_t& primitive);

/// Is the triangle crossed? As intersectTriangle, but a line through an edge or a corner crosses
/// exactly one of the triangles around it: it is moved, symbolically, by (ε, ε²) across itself
/// [Edelsbrunner, Mücke 1990], and edge functions that rounded to 0 get their exact sign.
bool crossTriangle(const RayFrame& ray, const Vec3& a, const Vec3& b, const Vec3& c, double tMax,
                   double& t);
bool crossParallelogram(const RayFrame& ray, const std::array<Vec3, 4>& corners, double tMax,
                        double& t);

/// Every crossing of one custom primitive in (0, tMax), appended to `out` under `id`.
void crossCustom(const CustomShape& shape, std::uint32_t primitive, PrimitiveId id, const Ray& ray,
                 std::vector<Crossing>& out);

} // namespace rt::geometry
