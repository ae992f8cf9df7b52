// Rounding of binary64 and binary32: units, error bounds, directed neighbours. Every tolerance of
// the program is here.
#pragma once
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

namespace rt::numeric {

inline constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;  // u = 2^-53
inline constexpr float kUnitRoundoffF32 = std::numeric_limits<float>::epsilon() / 2; // 2^-24
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Exact for exponents from -1074 to 1023.
constexpr double powerOfTwo(int exponent) {
    double x = 1;
    for (; exponent > 0; --exponent) x *= 2;
    for (; exponent < 0; ++exponent) x /= 2;
    return x;
}

/// Bound on the relative error of n rounded operations in a row: n·u / (1 − n·u) [Higham 2002,
/// lemma 3.1].
constexpr double gamma(int n) { return n * kUnitRoundoff / (1 - n * kUnitRoundoff); }

/// A rotation's entries carry at most 8 roundings (axis normalised, sine and cosine within 1 ulp,
/// two products, a sum); their Gram matrix doubles that. Four such factors in a row are still a
/// rotation to us.
inline constexpr double kSimilarityError = gamma(64);

inline double nextUp(double x) { return std::nextafter(x, kInfinity); }
inline double nextDown(double x) { return std::nextafter(x, -kInfinity); }

/// Largest f32 that is <= x, and smallest that is >= x; infinities beyond the range of f32.
inline float roundDown(double x) {
    const float f = static_cast<float>(x);
    return static_cast<double>(f) > x ? std::nextafter(f, -std::numeric_limits<float>::infinity())
                                      : f;
}
inline float roundUp(double x) {
    const float f = static_cast<float>(x);
    return static_cast<double>(f) < x ? std::nextafter(f, std::numeric_limits<float>::infinity())
                                      : f;
}

} // namespace rt::numeric
