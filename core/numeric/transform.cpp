#include <core/numeric/elementary.hpp>
#include <core/numeric/transform.hpp>

namespace rt::numeric {

/// Rodrigues' formula with 1 - cos a = 2 sin^2(a / 2), which keeps small angles exact to rounding.
AffineTransform rotation(const Vec3& axis, Radians angle) {
    const Vec3 a = normalize(axis / maxComponent(abs(axis))); // no square leaves the range of f64
    const double sine = sin(angle.value), cosine = cos(angle.value), half = sin(angle.value / 2);
    const Vec3 b = a * (2 * half * half);
    return {Mat3(Vec3(b.x * a.x + cosine, b.x * a.y + a.z * sine, b.x * a.z - a.y * sine),
                 Vec3(b.y * a.x - a.z * sine, b.y * a.y + cosine, b.y * a.z + a.x * sine),
                 Vec3(b.z * a.x + a.y * sine, b.z * a.y - a.x * sine, b.z * a.z + cosine)),
            Vec3(0.0)};
}

} // namespace rt::numeric
