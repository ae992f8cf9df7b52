// The compile flags that the numerics rely on, observed: no contraction, no lost rounding, no fast
// math.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <limits>

#ifdef __FAST_MATH__
#error "-ffast-math removes NaN, infinities and rounding, which the kernels rely on"
#endif

namespace {

// Out of line and on run-time values, so that the compiler cannot evaluate them at compile time.
[[gnu::noinline]] double productMinus(double a, double b, double c) { return a * b - c; }
[[gnu::noinline]] double determinant(double a, double b, double c, double d) {
    return a * b - c * d;
}

TEST(Flags, NoContraction) {
    volatile double a = 1 + 1 / 0x1p30,
                    b = 1 - 1 / 0x1p30; // a b = 1 - 2^-60 rounds to 1; an FMA would keep -2^-60
    EXPECT_EQ(productMinus(a, b, 1), 0);
    volatile double c = 1.0 / 3;
    EXPECT_EQ(determinant(c, c, c, c), 0); // an FMA leaves the rounding error of the product
}

template <std::size_t n> [[gnu::noinline]] void throughFloat(const double* in, double* out) {
    float narrow[n];
    for (std::size_t i = 0; i < n; ++i) narrow[i] = static_cast<float>(in[i]);
    for (std::size_t i = 0; i < n; ++i) out[i] = narrow[i];
}

struct Narrow3 {
    float x, y, z;
};
struct Wide3 {
    double x, y, z;
};
[[gnu::noinline]] Wide3 throughFloat(Wide3 p) {
    const Narrow3 q{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    return {q.x, q.y, q.z};
}
[[gnu::noinline]] void pairThroughFloat(const double* in, double* out) {
    const float first = static_cast<float>(in[0]), second = static_cast<float>(in[1]);
    out[0] = first, out[1] = second;
}

template <std::size_t n> void expectRounded() {
    double in[n], out[n];
    for (std::size_t i = 0; i < n; ++i) in[i] = 0.1 * static_cast<double>(i + 1);
    throughFloat<n>(in, out);
    for (std::size_t i = 0; i < n; ++i) {
        volatile float rounded = static_cast<float>(in[i]);
        EXPECT_EQ(out[i], static_cast<double>(rounded)) << i << " of " << n;
    }
}

/// g++ 12's SLP vectoriser compiles (double)(float)x of neighbouring lanes to nothing.
TEST(Flags, NarrowingRounds) {
    expectRounded<2>();
    expectRounded<3>();
    expectRounded<4>();
    const Wide3 p = throughFloat(Wide3{0.1, 0.2, 0.3});
    const double in[2] = {0.1, 0.2};
    double out[2];
    pairThroughFloat(in, out);
    volatile float x = 0.1f, y = 0.2f, z = 0.3f;
    EXPECT_EQ(p.x, static_cast<double>(x));
    EXPECT_EQ(p.y, static_cast<double>(y));
    EXPECT_EQ(p.z, static_cast<double>(z));
    EXPECT_EQ(out[0], static_cast<double>(x));
    EXPECT_EQ(out[1], static_cast<double>(y));
}

TEST(Flags, NanAndInfinityAreKept) {
    volatile double nan = std::numeric_limits<double>::quiet_NaN(), zero = 0;
    EXPECT_FALSE(nan == nan);
    EXPECT_TRUE(std::isnan(nan));
    EXPECT_TRUE(std::isinf(1 / zero));
    EXPECT_TRUE(std::signbit(-zero));
}

} // namespace
