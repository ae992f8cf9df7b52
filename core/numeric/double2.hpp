// Unevaluated sums of two f64, about 106 bits from correctly rounded operations alone (no FMA).
#pragma once
#include <cfloat>
#include <cmath>

namespace rt::numeric {

static_assert(FLT_EVAL_METHOD == 0, "binary64 operations must round to binary64");

/// hi + lo, |lo| <= ulp(hi) / 2 after a normalising operation. [Dekker 1971; Joldes, Muller,
/// Popescu 2017]
struct Double2 {
    double hi = 0, lo = 0;
};

/// a + b exactly; requires |a| >= |b| or a == 0.
constexpr Double2 quickTwoSum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}

/// a + b exactly, barring overflow. [Knuth, TAOCP 2, 4.2.2]
constexpr Double2 twoSum(double a, double b) {
    const double sum = a + b;
    const double bShare = sum - a;
    return {sum, (a - (sum - bShare)) + (b - bShare)};
}

/// The upper 26 bits of a and what they leave; |a| < 2^996. [Veltkamp 1968]
constexpr Double2 split(double a) {
    const double scaled = a * 0x1p27 + a;
    const double hi = scaled - (scaled - a);
    return {hi, a - hi};
}

/// a * b exactly, while |a|, |b| and |a b| < 2^996 and |a b| >= 2^-969. [Dekker 1971]
constexpr Double2 twoProduct(double a, double b) {
    const Double2 x = split(a), y = split(b);
    const double product = a * b;
    return {product, ((x.hi * y.hi - product) + x.hi * y.lo + x.lo * y.hi) + x.lo * y.lo};
}

constexpr Double2 operator-(Double2 a) { return {-a.hi, -a.lo}; }

/// Relative error at most 3 u^2 / (1 - 4 u), also under cancellation.
constexpr Double2 operator+(Double2 a, Double2 b) {
    const Double2 s = twoSum(a.hi, b.hi), t = twoSum(a.lo, b.lo);
    const Double2 v = quickTwoSum(s.hi, s.lo + t.hi);
    return quickTwoSum(v.hi, v.lo + t.lo);
}
constexpr Double2 operator-(Double2 a, Double2 b) { return a + -b; }

/// Relative error at most 7 u^2.
constexpr Double2 operator*(Double2 a, Double2 b) {
    const Double2 p = twoProduct(a.hi, b.hi);
    return quickTwoSum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

/// Relative error at most 15 u^2.
constexpr Double2 operator/(Double2 a, Double2 b) {
    const double quotient = a.hi / b.hi;
    const Double2 p = twoProduct(quotient, b.hi);
    const double remainder = ((a.hi - p.hi) - p.lo) + (a.lo - quotient * b.lo);
    return quickTwoSum(quotient, remainder / b.hi);
}

/// a >= 0; relative error of a few u^2.
inline Double2 sqrt(Double2 a) {
    if (!(a.hi > 0)) return {a.hi, 0};
    const double root = std::sqrt(a.hi);
    const Double2 square = twoProduct(root, root);
    return quickTwoSum(root, (((a.hi - square.hi) - square.lo) + a.lo) / (root + root));
}

} // namespace rt::numeric
