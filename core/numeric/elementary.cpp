// Method: reduce the argument exactly or in double-double, look up a table that a constexpr
// double-double series fills, add a short Taylor series in f64 whose value is small beside the
// table's, round once. u = 2^-53; a bound "e u" below is the error before that last rounding,
// relative to the result, so the result is within 1/2 + e ulp at most.
#include <core/numeric/double2.hpp>
#include <core/numeric/elementary.hpp>
#include <core/numeric/elementary_tables.hpp>

#include <array>
#include <bit>
#include <cstdint>
#include <limits>

namespace rt::numeric {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kRoundShift =
    0x1.8p52; // x + kRoundShift - kRoundShift is x rounded to an integer, |x| < 2^51

constexpr Double2 kPi{0x1.921fb54442d18p+1, 0x1.1a62633145c07p-53};
constexpr Double2 kHalfPi{0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54};
constexpr Double2 kLn2{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};

constexpr Double2 fraction(double numerator, double denominator) {
    return Double2{numerator} / Double2{denominator};
}
bool isNaN(double x) { return x != x; }
double magnitude(double x) { return std::fabs(x); }
double withSignOf(double x, double sign) { return std::copysign(x, sign); }

/// x 2^n, rounded once; |n| <= 2200.
double scaleByPowerOfTwo(double x, int n) {
    const auto power = [](int e) { return std::bit_cast<double>(std::uint64_t(e + 1023) << 52); };
    if (n >= -1022 && n <= 1023) return x * power(n);
    const int half = n / 2;
    return x * power(half) * power(n - half);
}

} // namespace

// exp
// ------------------------------------------------------------------------------------------------------------

// Of 128 steps |r| <= ln 2 / 256: five Taylor terms leave r^6 / 720 < 2^-60
constexpr ExpTable kExp = [] {
    ExpTable table{0x1.62e42fef8p-8, 0x1.1cf79abc9e3b4p-43, {}};
    for (int j = 0; j < kExpSteps; ++j) {
        const Double2 r = kLn2 * Double2{double(j) / kExpSteps};
        Double2 sum{1};
        for (int k = 28; k > 0; --k) sum = Double2{1} + r * sum / Double2{double(k)};
        table.at[j] = {sum.hi, sum.lo};
    }
    return table;
}();

namespace {

/// e^x for an unevaluated sum. e = 0.01 u: r carries u |r|, the polynomial p = e^r - 1 a few u |p|,
/// |p| < 0.0028.
double exponential(Double2 x) {
    if (!(x.hi < 710)) return kInf; // e^709.79 overflows
    if (!(x.hi > -746)) return 0;   // e^-745.14 is under half the least subnormal
    const double n = (x.hi * 0x1.71547652b82fep+7 + kRoundShift) - kRoundShift;
    const double r = ((x.hi - n * kExp.stepHi) - n * kExp.stepLo) +
                     x.lo; // n has 18 bits: first product and difference exact
    const double p = r + r * r * (0.5 + r * (1.0 / 6 + r * (1.0 / 24 + r * (1.0 / 120))));
    const int steps = static_cast<int>(n);
    const ExpTable::Step& base = kExp.at[steps & (kExpSteps - 1)];
    return scaleByPowerOfTwo(base.hi + (base.lo + base.hi * p), steps >> 7);
}

// log
// ------------------------------------------------------------------------------------------------------------

} // namespace

constexpr LogTable kLog = [] {
    LogTable table{0x1.62e42fefa3p-1, 0x1.3de6af278ece6p-42, {}};
    for (std::uint64_t i = 0; i < 128; ++i) {
        const double first = std::bit_cast<double>(kLogStart + (i << 45));
        const double last = std::bit_cast<double>(kLogStart + ((i + 1) << 45));
        // The steps on either side of 1 use 1 itself, so that log keeps its relative accuracy
        // there.
        const double inverse =
            first == 1 || last == 1 ? 1 : double(int(1024 / (first + last) + 0.5)) / 512;
        // log c = 2 artanh z, z = (c - 1) / (c + 1), |z| < 0.19: 30 terms reach 2^-140
        const Double2 z = fraction(1 - inverse, 1 + inverse), zz = z * z;
        Double2 sum;
        for (int k = 59; k > 0; k -= 2) sum = fraction(2, k) + zz * sum;
        const Double2 value = z * sum;
        const double hi = (value.hi + 0x1.8p11) - 0x1.8p11;
        table.at[i] = {inverse, hi, (value.hi - hi) + value.lo};
    }
    return table;
}();

namespace {

/// log x for finite x > 0, relative error at most 2^-66: with m = 2^-k x in [0.6875, 1.375) and r =
/// m inverse - 1 exact, |r| < 2^-7, the terms from r^3 on are rounded in f64 (at most 4 u r^3 / 3
/// against |log x| >= |r| (1 - 2^-7) next to 1 and >= 2^-8.1 elsewhere, where |r| < 2^-7.5); r -
/// r^2 / 2 and the table are double-double.
Double2 logarithm(double x) {
    int k = 0;
    if (x < 0x1p-1022) x *= 0x1p54, k = -54;
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(x), above = bits - kLogStart;
    k += static_cast<int>(static_cast<std::int64_t>(above) >> 52);
    const LogTable::Step& step = kLog.at[(above >> 45) & 127];
    const double m = std::bit_cast<double>(bits - (above & (std::uint64_t(0xfff) << 52)));
    const double mHi =
        std::bit_cast<double>(std::bit_cast<std::uint64_t>(m) & ~std::uint64_t(0x7ffffff));
    const Double2 r = twoSum(mHi * step.inverse - 1, (m - mHi) * step.inverse);

    const Double2 square = twoProduct(r.hi, r.hi);
    const Double2 quadratic = quickTwoSum(r.hi, -0.5 * square.hi);
    const double t = r.hi, tt = square.hi;
    const double tail = (1.0 / 3 - t * (1.0 / 4)) +
                        tt * ((1.0 / 5 - t * (1.0 / 6)) +
                              tt * ((1.0 / 7 - t * (1.0 / 8)) + tt * (1.0 / 9 - t * (1.0 / 10))));
    const double low = quadratic.lo + ((r.lo - 0.5 * square.lo - t * r.lo) + t * tt * tail);

    const Double2 sum = twoSum(k * kLog.ln2Hi + step.hi, quadratic.hi);
    return quickTwoSum(sum.hi, sum.lo + (low + (step.lo + k * kLog.ln2Lo)));
}

// sin, cos, tan
// --------------------------------------------------------------------------------------------------

__extension__ using Uint128 = unsigned __int128;

struct Reduced {
    Double2 r;             // |r| <= pi/4 (1 + 2^-20), relative error below 2^-65
    unsigned quadrant = 0; // x = r + quadrant pi/2 (mod 2 pi)
};

/// Payne and Hanek 1983: the product of x's integer significand and the 192 bits of 2/pi that
/// matter for it, modulo 4. No f64 is closer than 2^-62 pi/2 to a multiple of pi/2 in relative
/// terms, so 126 bits of fraction keep 64. [Muller 2016, table 11.1]
Reduced reduceByTable(double x) {
    static constexpr std::uint64_t kTwoOverPi[] = {// 64 zero bits, then the fraction of 2/pi
                                                   0,
                                                   0xa2f9836e4e441529,
                                                   0xfc2757d1f534ddc0,
                                                   0xdb6295993c439041,
                                                   0xfe5163abdebbc561,
                                                   0xb7246e3a424dd2e0,
                                                   0x06492eea09d1921c,
                                                   0xfe1deb1cb129a73e,
                                                   0xe88235f52ebb4484,
                                                   0xe99c7026b45f7e41,
                                                   0x3991d639835339f4,
                                                   0x9c845f8bbdf9283b,
                                                   0x1ff897ffde05980f,
                                                   0xef2f118b5a0a6d1f,
                                                   0x6d367ecf27cb09b7,
                                                   0x4f463f669e5fea2d,
                                                   0x7527bac7ebe5f17b,
                                                   0x3d0739f78a5292ea,
                                                   0x6bfb5fb11f8d5d08,
                                                   0x56033046fc7b6bab,
                                                   0xf0cfbc209af4361d};
    const std::uint64_t bits = std::bit_cast<std::uint64_t>(magnitude(x));
    const int exponent =
        static_cast<int>(bits >> 52) - 1075; // |x| = significand 2^exponent, exponent >= -53
    const std::uint64_t significand = (bits & 0xfffffffffffff) | 0x10000000000000;

    const unsigned first =
        static_cast<unsigned>(exponent - 2 + 64); // bits before it contribute multiples of 4
    const unsigned word = first / 64, shift = first % 64;
    const auto window = [&](unsigned i) {
        const std::uint64_t* w = kTwoOverPi + word + i;
        return shift ? w[0] << shift | w[1] >> (64 - shift) : w[0];
    };
    const Uint128 low = Uint128(significand) * window(2);
    const Uint128 middle = Uint128(significand) * window(1) + std::uint64_t(low >> 64);
    const std::uint64_t high = significand * window(0) + std::uint64_t(middle >> 64);

    unsigned quadrant = static_cast<unsigned>(high >> 62);
    const Uint128 fractionBits =
        (Uint128(high) << 64 | std::uint64_t(middle)) << 2 | std::uint64_t(low) >> 62;
    const bool roundUp = fractionBits >> 127;
    quadrant += roundUp;
    const Uint128 distance =
        roundUp ? -fractionBits : fractionBits; // in units of 2^-128 quadrants, at most 2^127
    const double hi = static_cast<double>(distance);
    const Uint128 rest = distance - static_cast<Uint128>(hi); // signed, wraps
    const double lo = rest >> 127 ? -static_cast<double>(-rest) : static_cast<double>(rest);
    Double2 r = Double2{hi * 0x1p-128, lo * 0x1p-128} * kHalfPi;
    if (roundUp != (x < 0)) r = -r;
    return {r, x < 0 ? -quadrant : quadrant};
}

/// Finite x. Below 2^20 pi/2 three parts of pi/2 [Cody and Waite 1980], of which two multiply
/// exactly: absolute error below 2^-97, enough for |r| >= 2^-20.
Reduced reduce(double x) {
    if (magnitude(x) <= 0x1.921fb54442d18p-1) return {{x, 0}, 0};
    if (magnitude(x) < 1647099) {
        const double n = (x * 0x1.45f306dc9c883p-1 + kRoundShift) - kRoundShift;
        const double first = x - n * 0x1.921fb544p+0; // 33 bits of pi/2 by 20 bits
        const Double2 second = twoSum(first, -(n * 0x1.0b4611a6p-34));
        const Double2 r = quickTwoSum(second.hi, second.lo - n * 0x1.3198a2e037073p-69);
        if (magnitude(r.hi) >= 0x1p-20) return {r, static_cast<unsigned>(static_cast<int>(n))};
    }
    return reduceByTable(x);
}

/// sin r before its last rounding, |r| <= pi/4: r - (r^2/6 - ...) r, where the bracket is under
/// 0.103 and suffers 3.3 roundings (r^2 itself is exact): e = 0.35 u.
Double2 sine(Double2 r) {
    const Double2 z = twoProduct(r.hi, r.hi);
    const double zz = z.hi * z.hi;
    const double tail =
        (1.0 / 120 - z.hi * (1.0 / 5040)) +
        zz *
            ((1.0 / 362880 - z.hi * (1.0 / 39916800)) +
             zz * (1.0 / 6227020800 - z.hi * (1.0 / 1307674368000) + zz * (1.0 / 355687428096000)));
    const double cubic = (r.hi * z.hi) * (z.hi * tail - 1.0 / 6) - r.hi * z.lo * (1.0 / 6);
    return {r.hi, cubic + r.lo * (1 - 0.5 * z.hi)};
}

/// cos r before its last rounding: 1 - r^2/2 is exact in two parts, r^4/24 - ... is under 0.0159: e
/// = 0.1 u.
Double2 cosine(Double2 r) {
    const Double2 z = twoProduct(r.hi, r.hi);
    const double zz = z.hi * z.hi;
    const double tail =
        (1.0 / 24 - z.hi * (1.0 / 720)) +
        zz * ((1.0 / 40320 - z.hi * (1.0 / 3628800)) +
              zz * (1.0 / 479001600 - z.hi * (1.0 / 87178291200) + zz * (1.0 / 20922789888000)));
    const Double2 quadratic = quickTwoSum(1, -0.5 * z.hi);
    return {quadratic.hi, quadratic.lo + (zz * tail - (0.5 * z.lo + r.hi * r.lo))};
}

// atan
// -----------------------------------------------------------------------------------------------------------

constexpr int kAtanSteps = 64;

constexpr auto kAtan = [] { // atan(j / kAtanSteps), each from the one before: atan a - atan b =
                            // atan((a - b) / (1 + a b))
    std::array<Double2, kAtanSteps + 1> table;
    for (int j = 1; j <= kAtanSteps; ++j) {
        const Double2 d = fraction(kAtanSteps, kAtanSteps * kAtanSteps + j * (j - 1)), dd = d * d;
        Double2 sum;
        for (int k = 21; k > 0; k -= 2) sum = fraction(k % 4 == 1 ? 1 : -1, k) + dd * sum;
        table[j] = table[j - 1] + d * sum;
    }
    return table;
}();

/// atan(y / x) before its last rounding, 0 <= y <= x (1 + 2^-50), x in [2^-600, 2^500], y / x >=
/// 2^-80: with a = j/64 next to y / x, atan(y / x) = atan a + d - d^3/3 + ..., d = (y - a x) / (x +
/// a y), |d| < 2^-7. From j = 8 on the sum is at least 15 |d|, and d may carry the four roundings
/// of f64: e = 0.27 u. Below, d is double-double: e < 2^-12 u.
Double2 arctangent(Double2 y, Double2 x) {
    const int j = static_cast<int>(y.hi / x.hi * kAtanSteps + 0.5);
    const double a = double(j) / kAtanSteps;
    Double2 d;
    if (j >= 8) {
        const Double2 part =
            split(x.hi); // a has 7 bits: both products and the first difference are exact
        const double numerator = ((y.hi - a * part.hi) - a * part.lo) + (y.lo - a * x.lo);
        d.hi = numerator / (x.hi + a * y.hi);
    } else if (j > 0) {
        d = (y - Double2{a} * x) / (x + Double2{a} * y);
    } else {
        d = y / x;
    }
    const double dd = d.hi * d.hi;
    const double tail = dd * (-1.0 / 3 + dd * (1.0 / 5 + dd * (-1.0 / 7 + dd * (1.0 / 9))));
    const Double2 sum = twoSum(kAtan[j].hi, d.hi);
    return quickTwoSum(sum.hi, sum.lo + (d.hi * tail + (d.lo + kAtan[j].lo)));
}

/// Angle of (x, y) for y >= 0, neither both zero; both of magnitude in [2^-400, 2^400] or one
/// exactly zero.
double angle(Double2 y, Double2 x) {
    const bool left = x.hi < 0;
    if (left) x = -x;
    Double2 a = y.hi > x.hi ? kHalfPi - arctangent(x, y) : arctangent(y, x);
    if (left) a = kPi - a;
    return a.hi + a.lo;
}

/// sqrt(1 - x^2), |x| <= 1: the square is exact, and so is what is left of 1.
Double2 otherLeg(double x) {
    const Double2 square = twoProduct(x, x);
    const Double2 rest = twoSum(1, -square.hi);
    return sqrt(quickTwoSum(rest.hi, rest.lo - square.lo));
}

} // namespace

double exp(double x) { return isNaN(x) ? kNaN : exponential({x, 0}); }

double log(double x) {
    if (!(x > 0)) return x == 0 ? -kInf : kNaN;
    if (x == kInf) return kInf;
    return logarithm(x).hi;
}

double pow(double x, double y) {
    if (y == 0 || x == 1) return 1;
    if (isNaN(x) || isNaN(y)) return kNaN;
    const double ax = magnitude(x), ay = magnitude(y);
    double sign = 1;
    if (!(x > 0 && x < kInf)) {
        const bool integer = ay >= 0x1p53 || static_cast<double>(static_cast<std::int64_t>(y)) == y;
        const bool odd = ay < 0x1p53 && integer && (static_cast<std::int64_t>(y) & 1);
        if (odd && std::signbit(x)) sign = -1;
        if (ax == 1 && (integer || ay == kInf)) return sign;
        if (ax == 0 || ax == kInf) return sign * ((ax == 0) == (y < 0) ? kInf : 0.0);
        if (!integer) return kNaN;
    }
    if (ay > 0x1p64) return (ax > 1) == (y > 0) ? kInf : 0; // |log x| >= u / 2, so |y log x| > 2^10
    // |y log x| < 746 with relative error 2^-65.9 is an absolute error of 2^-56.3: e = 0.1 u in all
    const Double2 logX = logarithm(ax);
    Double2 product = twoProduct(logX.hi, y);
    product.lo += logX.lo * y;
    return sign * exponential(product);
}

double sin(double x) {
    if (!(magnitude(x) < kInf)) return kNaN;
    if (magnitude(x) < 0x1p-27)
        return x; // x^3 / 6 is under half an ulp, and keeps -0 and subnormals
    const Reduced a = reduce(x);
    const Double2 s = a.quadrant & 1 ? cosine(a.r) : sine(a.r);
    return a.quadrant & 2 ? -(s.hi + s.lo) : s.hi + s.lo;
}

double cos(double x) {
    if (!(magnitude(x) < kInf)) return kNaN;
    const Reduced a = reduce(x);
    const Double2 c = a.quadrant & 1 ? sine(a.r) : cosine(a.r);
    return (a.quadrant + 1) & 2 ? -(c.hi + c.lo) : c.hi + c.lo;
}

/// e = 0.45 u: the errors of sine and cosine, and nothing from the double-double quotient.
double tan(double x) {
    if (!(magnitude(x) < kInf)) return kNaN;
    if (magnitude(x) < 0x1p-27) return x;
    const Reduced a = reduce(x);
    const Double2 s = sine(a.r), c = cosine(a.r);
    const Double2 sn = quickTwoSum(s.hi, s.lo), cn = quickTwoSum(c.hi, c.lo);
    const Double2 t = a.quadrant & 1 ? -(cn / sn) : sn / cn;
    return t.hi + t.lo;
}

double asin(double x) {
    if (!(magnitude(x) <= 1)) return kNaN;
    if (magnitude(x) < 0x1p-27) return x;
    return withSignOf(angle({magnitude(x), 0}, otherLeg(x)), x);
}

double acos(double x) {
    if (!(magnitude(x) <= 1)) return kNaN;
    if (magnitude(x) < 0x1p-60) return kHalfPi.hi;
    return angle(otherLeg(x), {x, 0});
}

double atan2(double y, double x) {
    if (isNaN(x) || isNaN(y)) return kNaN;
    const bool left = std::signbit(x);
    double ax = magnitude(x), ay = magnitude(y);
    if (ay == 0) return withSignOf(left ? kPi.hi : 0, y);
    if (ax == 0) return withSignOf(kHalfPi.hi, y);
    if (ax == kInf || ay == kInf) {
        if (ax != ay) return withSignOf(ay == kInf ? kHalfPi.hi : left ? kPi.hi : 0, y);
        ax = ay = 1;
    }
    if (ay > 0x1p500 || ax > 0x1p500)
        ax *= 0x1p-600, ay *= 0x1p-600; // what underflows is below 2^-70 of the other
    else if (ay < 0x1p-500 || ax < 0x1p-500)
        ax *= 0x1p500, ay *= 0x1p500;
    // Past 2^70 the angle is its limit to within 2^-17 u, or y / x, where one division rounds once.
    if (ay >= ax * 0x1p70) return withSignOf(kHalfPi.hi, y);
    if (ax >= ay * 0x1p70) return left ? withSignOf(kPi.hi, y) : y / x;
    return withSignOf(angle({ay, 0}, {left ? -ax : ax, 0}), y);
}

} // namespace rt::numeric
