// Unit directions at a surface: normalising, mirroring, refracting. World space.
#pragma once
#include <core/numeric/rounding.hpp>
#include <core/numeric/vec.hpp>

#include <cmath>
#include <limits>
#include <optional>

namespace rt::trace {

using numeric::cross;
using numeric::dot;
using numeric::Vec3;

/// v at unit length within 4 units of roundoff, whatever its own length above 0.
inline Vec3 unit(const Vec3& v) {
    const double squared = dot(v, v);
    constexpr double kFullPrecision = // of v·v: no term that matters is subnormal
        std::numeric_limits<double>::min() / std::numeric_limits<double>::epsilon();
    if (squared > kFullPrecision && squared < numeric::kInfinity) return v / std::sqrt(squared);
    const Vec3 scaled = v * std::ldexp(1.0, -std::ilogb(numeric::maxComponent(numeric::abs(v))));
    return scaled / std::sqrt(dot(scaled, scaled));
}

/// Mirror image of `direction` in the plane of `normal`, both unit.
inline Vec3 reflected(const Vec3& direction, const Vec3& normal) {
    return unit(direction - normal * (2 * dot(direction, normal)));
}

/// Snell's law for unit `direction` against unit `normal` (direction · normal <= 0), `ratio` = index
/// in front over index behind. Nothing on total reflection.
///
/// sin² comes from the tangential part of the direction, not from 1 − cos²: relative, not absolute
/// rounding, so the decision is right to a few units of roundoff in the angle.
inline std::optional<Vec3> refracted(const Vec3& direction, const Vec3& normal, double ratio) {
    const Vec3 tangential = (direction - normal * dot(direction, normal)) * ratio;
    const double sineSquared = dot(tangential, tangential);
    if (!(sineSquared < 1)) return std::nullopt;
    return unit(tangential - normal * std::sqrt(1 - sineSquared));
}

/// `direction` if it lies on the side of `normal`, else its mirror image there: the geometric
/// hemisphere that an interpolated normal may have left.
inline Vec3 intoHemisphere(const Vec3& direction, const Vec3& normal) {
    const double height = dot(direction, normal);
    return height < 0 ? direction - normal * (2 * height) : direction;
}

} // namespace rt::trace
