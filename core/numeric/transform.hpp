// Affine maps, named destination-from-source. Points, directions and normals are three verbs.
#pragma once
#include <core/numeric/vec.hpp>

namespace rt::numeric {

struct AffineTransform {
    Mat3 linear{1.0};
    Vec3 translation{0.0};

    Vec3 point(const Vec3& p) const { return linear * p + translation; }
    Vec3 direction(const Vec3& d) const { return linear * d; }
    bool isIdentity() const { return linear == Mat3(1.0) && translation == Vec3(0.0); }
};

inline AffineTransform operator*(const AffineTransform& a, const AffineTransform& b) {
    return {a.linear * b.linear, a.linear * b.translation + a.translation};
}

} // namespace rt::numeric
