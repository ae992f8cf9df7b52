// The neighbours and the scale of a double from its bits: what hot code asks without calling libm.
#pragma once
#include <core/numeric/rounding.hpp>
#include <core/numeric/vec.hpp>

namespace rt::numeric::bits {

/// numeric::nextUp and nextDown.
constexpr double nextUp(double x) {
    if (!(x < kInfinity)) return x; // or NaN
    if (x == 0) return std::numeric_limits<double>::denorm_min();
    const auto b = std::bit_cast<std::uint64_t>(x);
    return std::bit_cast<double>(x > 0 ? b + 1 : b - 1);
}
constexpr double nextDown(double x) { return -nextUp(-x); }

/// 2^-floor(log2 x), exact, of a positive x.
inline double reciprocalPowerOfTwo(double x) {
    const std::uint64_t exponent = std::bit_cast<std::uint64_t>(x) >> 52;
    if (exponent - 1 < 2045) return std::bit_cast<double>((2046 - exponent) << 52);
    return std::ldexp(1.0, -std::ilogb(x)); // subnormal, or would be
}

/// Positive, and so far from the ends of the range that its reciprocal power of two is normal, too.
inline bool isModerate(double x) {
    constexpr double kLeast = powerOfTwo(-1000), kMost = powerOfTwo(1000);
    return x > kLeast && x < kMost;
}

/// numeric::maxComponent: a NaN only if all are.
inline double larger(double a, double b) {
    const double larger = a > b ? a : b; // one instruction: which of them it is cannot be foretold
    return larger == larger ? larger : a;
}
inline double maxComponent(const Vec3& v) { return larger(v.x, larger(v.y, v.z)); }

} // namespace rt::numeric::bits
