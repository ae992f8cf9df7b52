// Three- and two-component f64 vectors. The only file that includes GLM; `numeric` re-exports what
// the program uses.
#pragma once
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include <cmath>

namespace rt::numeric {

using Vec2 = glm::dvec2;
using Vec3 = glm::dvec3;
using Mat3 = glm::dmat3; // column-major: m[c] is the image of axis c

using glm::cross;
using glm::dot;
using glm::length;
using glm::normalize;

inline double lengthSquared(const Vec3& v) { return dot(v, v); }
inline Vec3 abs(const Vec3& v) { return {std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}; }
inline double maxComponent(const Vec3& v) { return std::fmax(v.x, std::fmax(v.y, v.z)); }
inline Vec3 componentMin(const Vec3& a, const Vec3& b) {
    return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
inline Vec3 componentMax(const Vec3& a, const Vec3& b) {
    return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
inline bool isFinite(const Vec3& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// Every component rounded to the nearest f32; infinite beyond its range.
inline Vec3 roundedToF32(const Vec3& v) {
    return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}
/// Does f32 hold it exactly? NaN: no.
inline bool fitsF32(const Vec3& v) {
    const Vec3 r = roundedToF32(v);
    return r.x == v.x && r.y == v.y && r.z == v.z;
}

} // namespace rt::numeric
