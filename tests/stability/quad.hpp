// binary128 vectors: what the suite holds f64 against. Doubles enter exactly.
#pragma once
#include <core/geometry/ray.hpp>

#include <cmath>

namespace rt::stability {

using numeric::Vec3;
using Quad = __float128;

struct QVec {
    Quad x, y, z;

    QVec(Quad x_, Quad y_, Quad z_) : x(x_), y(y_), z(z_) {}
    QVec(const Vec3& v) : x(v.x), y(v.y), z(v.z) {}
};

inline QVec operator+(const QVec& a, const QVec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline QVec operator-(const QVec& a, const QVec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline QVec operator*(const QVec& a, Quad s) { return {a.x * s, a.y * s, a.z * s}; }
inline Quad dot(const QVec& a, const QVec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline QVec cross(const QVec& a, const QVec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// For values that f64 can hold: Newton's steps double the 53 bits of the start.
inline Quad squareRoot(Quad a) {
    if (!(a > 0)) return 0;
    Quad root = std::sqrt(static_cast<double>(a));
    if (root == 0) return 0;
    for (int i = 0; i < 2; ++i) root = (root + a / root) / 2;
    return root;
}

inline double magnitude(Quad a) { return std::fabs(static_cast<double>(a)); }

} // namespace rt::stability
