// Three components in any arithmetic, for the tracers of the report.
#pragma once
#include <core/numeric/rounding.hpp>
#include <core/numeric/vec.hpp>

#include <cmath>
#include <limits>
#include <type_traits>

namespace rt::report {

using Quad = __float128;

template <class Real> struct Vector {
    Real x{}, y{}, z{};

    Vector() = default;
    Vector(Real x_, Real y_, Real z_) : x(x_), y(y_), z(z_) {}
    explicit Vector(const numeric::Vec3& v)
        : x(static_cast<Real>(v.x)), y(static_cast<Real>(v.y)), z(static_cast<Real>(v.z)) {}
    explicit operator numeric::Vec3() const {
        return {static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
    }
    Real& operator[](int i) { return (&x)[i]; }
    const Real& operator[](int i) const { return (&x)[i]; }

    friend Vector operator+(const Vector& a, const Vector& b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend Vector operator-(const Vector& a, const Vector& b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    friend Vector operator-(const Vector& a) { return {-a.x, -a.y, -a.z}; }
    friend Vector operator*(const Vector& a, Real s) { return {a.x * s, a.y * s, a.z * s}; }
    friend bool operator==(const Vector&, const Vector&) = default;
};

template <class Real> Real dot(const Vector<Real>& a, const Vector<Real>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real> Vector<Real> cross(const Vector<Real>& a, const Vector<Real>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class Real> Real magnitude(Real a) { return a < 0 ? -a : a; }
template <class Real> Vector<Real> magnitudes(const Vector<Real>& a) {
    return {magnitude(a.x), magnitude(a.y), magnitude(a.z)};
}
template <class Real> Real largest(const Vector<Real>& a) {
    const Real xy = a.x > a.y ? a.x : a.y;
    return xy > a.z ? xy : a.z;
}

inline float squareRoot(float a) { return std::sqrt(a); }
inline double squareRoot(double a) { return std::sqrt(a); }
/// For values that f64 can hold: Newton's steps double the 53 bits of the start.
inline Quad squareRoot(Quad a) {
    Quad root = std::sqrt(static_cast<double>(a));
    if (!(root > 0)) return 0;
    for (int i = 0; i < 2; ++i) root = (root + a / root) / 2;
    return root;
}

template <class Real> Vector<Real> unit(const Vector<Real>& v) {
    return v * (1 / squareRoot(dot(v, v)));
}

/// Unit roundoff of the arithmetic, and that of the data it works on, which is f64 at best.
template <class Real> constexpr double roundoffOf() {
    if constexpr (std::is_same_v<Real, float>)
        return numeric::kUnitRoundoffF32;
    else if constexpr (std::is_same_v<Real, double>)
        return numeric::kUnitRoundoff;
    else
        return numeric::kUnitRoundoff * numeric::kUnitRoundoff;
}
template <class Real> constexpr double dataRoundoffOf() {
    return std::is_same_v<Real, float> ? double(numeric::kUnitRoundoffF32) : numeric::kUnitRoundoff;
}

} // namespace rt::report
