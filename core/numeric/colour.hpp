// Linear-light colour. Arithmetic exists for LinearRgb only; encoded values must be decoded first.
#pragma once
#include <cstdint>

namespace rt::numeric {

/// Linear Rec. 709, unbounded; 1 is display white.
struct LinearRgb {
    double r = 0, g = 0, b = 0;

    static constexpr LinearRgb grey(double v) { return {v, v, v}; }
    constexpr LinearRgb& operator+=(const LinearRgb& o) {
        return r += o.r, g += o.g, b += o.b, *this;
    }
    constexpr LinearRgb& operator*=(const LinearRgb& o) {
        return r *= o.r, g *= o.g, b *= o.b, *this;
    }
    constexpr LinearRgb& operator*=(double s) { return r *= s, g *= s, b *= s, *this; }
    friend constexpr LinearRgb operator+(LinearRgb a, const LinearRgb& b) { return a += b; }
    friend constexpr LinearRgb operator*(LinearRgb a, const LinearRgb& b) { return a *= b; }
    friend constexpr LinearRgb operator*(LinearRgb a, double s) { return a *= s; }
    friend constexpr LinearRgb operator*(double s, LinearRgb a) { return a *= s; }
    friend constexpr bool operator==(const LinearRgb&, const LinearRgb&) = default;
    constexpr bool isBlack() const { return r == 0 && g == 0 && b == 0; }
    constexpr double maxComponent() const {
        const double larger = r > g ? r : g;
        return larger > b ? larger : b;
    }
};

/// IEC 61966-2-1 transfer functions on one channel in [0, 1]; same bits on every CPU.
double linearFromSrgb(double encoded);
double srgbFromLinear(double linear);

} // namespace rt::numeric
