// Each function against libquadmath's binary128, and its bits across builds and CPUs.
#include <core/numeric/elementary.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <quadmath.h>
#include <random>
#include <string>

namespace {

namespace numeric = rt::numeric;
using Quad = __float128;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMax = std::numeric_limits<double>::max();
constexpr double kAboveOne = 1 + std::numeric_limits<double>::epsilon();
constexpr double kBelowOne = 1 - std::numeric_limits<double>::epsilon() / 2;
constexpr double kLeast = std::numeric_limits<double>::denorm_min();

/// Spacing of binary64 around `exact`.
Quad ulpAt(Quad exact) {
    int exponent = 0;
    frexpq(exact, &exponent);
    return scalbnq(1, std::max(exponent - 53, -1074));
}

double ulps(double got, Quad exact) {
    if (std::isinf(got)) return fabsq(exact) > kMax && (got > 0) == (exact > 0) ? 0 : kInf;
    if (fabsq(exact) > scalbnq(1, 1024)) return kInf;
    return static_cast<double>(fabsq(got - exact) / ulpAt(exact));
}

struct Worst {
    double ulps = 0, x = 0, y = 0;
    void add(double error, double atX, double atY = 0) {
        if (!(error <= ulps)) ulps = error, x = atX, y = atY;
    }
    void expectWithin(double bound, const char* name) const {
        std::printf("  %-6s worst %.4f ulp at %a %a\n", name, ulps, x, y);
        EXPECT_LE(ulps, bound) << name << " at " << std::hexfloat << x << ", " << y;
    }
};

using Random = std::mt19937_64;

double uniform(Random& random, double lo, double hi) {
    return lo + (hi - lo) * (static_cast<double>(random() >> 11) / 0x1p53);
}
double anyFinite(Random& random) {
    for (;;)
        if (const double x = std::bit_cast<double>(random()); std::isfinite(x)) return x;
}
/// Significand uniform, exponent uniform in [lo, hi), either sign.
double logUniform(Random& random, int lo, int hi) {
    const double m = std::ldexp(1 + static_cast<double>(random() >> 12) / 0x1p52,
                                lo + static_cast<int>(random() % static_cast<unsigned>(hi - lo)));
    return random() & 1 ? -m : m;
}

template <class F, class G, class Draw>
void sweep(const char* name, F ours, G exact, int count, Draw draw,
           double bound = rt::tolerance::kElementaryUlpsDerived) {
    Random random(20261122);
    Worst worst;
    for (int i = 0; i < count; ++i) {
        const double x = draw(random);
        worst.add(ulps(ours(x), exact(x)), x);
    }
    worst.expectWithin(bound, name);
}

constexpr int kSamples = 100000;

TEST(Elementary, Exp) {
    sweep("exp", numeric::exp, expq, kSamples, [](Random& r) { return uniform(r, -745.2, 709.8); });
    sweep("exp", numeric::exp, expq, kSamples, [](Random& r) { return uniform(r, -1, 1); });
    sweep("exp", numeric::exp, expq, kSamples, [](Random& r) { return uniform(r, -745.2, -708); });
    sweep("exp", numeric::exp, expq, kSamples, [](Random& r) { return logUniform(r, -80, 9); });
    EXPECT_EQ(numeric::exp(0), 1);
    EXPECT_EQ(numeric::exp(-0.0), 1);
    EXPECT_EQ(numeric::exp(kInf), kInf);
    EXPECT_EQ(numeric::exp(-kInf), 0);
    EXPECT_EQ(numeric::exp(710), kInf);
    EXPECT_EQ(numeric::exp(0x1.62e42fefa39fp+9), kInf); // least that overflows
    EXPECT_LT(numeric::exp(0x1.62e42fefa39efp+9), kInf);
    EXPECT_EQ(numeric::exp(-746), 0);
    EXPECT_TRUE(std::isnan(numeric::exp(kNaN)));
}

TEST(Elementary, Log) {
    sweep("log", numeric::log, logq, kSamples, [](Random& r) { return std::fabs(anyFinite(r)); });
    sweep("log", numeric::log, logq, kSamples, [](Random& r) { return uniform(r, 0.5, 2); });
    sweep("log", numeric::log, logq, kSamples,
          [](Random& r) { return 1 + logUniform(r, -53, -5); });
    sweep("log", numeric::log, logq, kSamples,
          [](Random& r) { return kLeast * static_cast<double>(r() >> 20); });
    EXPECT_EQ(numeric::log(1), 0);
    EXPECT_FALSE(std::signbit(numeric::log(1)));
    EXPECT_EQ(numeric::log(0), -kInf);
    EXPECT_EQ(numeric::log(-0.0), -kInf);
    EXPECT_EQ(numeric::log(kInf), kInf);
    EXPECT_TRUE(std::isnan(numeric::log(-1)));
    EXPECT_TRUE(std::isnan(numeric::log(kNaN)));
}

TEST(Elementary, Pow) {
    const auto pairs = [](const char* name, auto draw) {
        Random random(4);
        Worst worst;
        for (int i = 0; i < kSamples; ++i) {
            const auto [x, y] = draw(random);
            worst.add(ulps(numeric::pow(x, y), powq(x, y)), x, y);
        }
        worst.expectWithin(rt::tolerance::kElementaryUlpsDerived, name);
    };
    struct Pair {
        double x, y;
    };
    pairs("pow 0..1 ^ 0..200", [](Random& r) {
        return Pair{uniform(r, 0, 1), uniform(r, 0, 200)};
    });
    pairs("pow whole range", [](Random& r) { // y log x across the range of results
        const double x = std::fabs(anyFinite(r));
        return Pair{x, uniform(r, -746, 710) / static_cast<double>(logq(x))};
    });
    pairs("pow near 1", [](Random& r) {
        const double x = 1 + logUniform(r, -52, -3);
        return Pair{x, uniform(r, -746, 710) / static_cast<double>(logq(x))};
    });
    pairs("pow subnormal result", [](Random& r) {
        const double x = uniform(r, 0, 1);
        return Pair{x, uniform(r, -745.2, -708) / static_cast<double>(logq(x))};
    });
    pairs("pow integer", [](Random& r) {
        return Pair{uniform(r, -20, 20), std::floor(uniform(r, -60, 60))};
    });
    pairs("pow tiny exponent", [](Random& r) {
        return Pair{std::fabs(anyFinite(r)), logUniform(r, -1074, -40)};
    });
    pairs("pow any", [](Random& r) { return Pair{std::fabs(anyFinite(r)), anyFinite(r)}; });
}

/// Every pair of special values against the C library, whose special cases Annex F fixes (and 2 and
/// 3 are exact there).
TEST(Elementary, PowSpecialValues) {
    const double values[] = {
        0.0,    -0.0,       1,          -1,     2,       -2,        3,         -3,       0.5,
        -0.5,   kInf,       -kInf,      kNaN,   kLeast,  -kLeast,   kMax,      -kMax,    0x1p52,
        0x1p53, 0x1p53 - 1, 1 - 0x1p53, 0x1p64, 0x1p200, kAboveOne, kBelowOne, 1 / 1e300};
    for (const double x : values)
        for (const double y : values) {
            const double ours = numeric::pow(x, y), theirs = std::pow(x, y);
            const std::string which = std::to_string(x) + " ^ " + std::to_string(y);
            if (std::isnan(theirs))
                EXPECT_TRUE(std::isnan(ours)) << which;
            else if (theirs == 0 || std::isinf(theirs) || theirs == 1) {
                EXPECT_EQ(ours, theirs) << which;
                EXPECT_EQ(std::signbit(ours), std::signbit(theirs)) << which;
            } else
                EXPECT_LE(ulps(ours, powq(x, y)), 1) << which;
        }
    EXPECT_EQ(numeric::pow(-2, 3), -8);
    EXPECT_EQ(numeric::pow(10, 22), 1e22);
}

TEST(Elementary, SinCosTan) {
    const auto all = [](const char* range, auto draw) {
        std::printf("%s\n", range);
        sweep("sin", numeric::sin, sinq, kSamples, draw);
        sweep("cos", numeric::cos, cosq, kSamples, draw);
        sweep("tan", numeric::tan, tanq, kSamples, draw);
    };
    all("first octant",
        [](Random& r) { return uniform(r, -0.7853981633974483, 0.7853981633974483); });
    all("a few turns", [](Random& r) { return uniform(r, -100, 100); });
    all("1e6", [](Random& r) { return uniform(r, -1.7e6, 1.7e6); });
    all("any", anyFinite);
    all("small", [](Random& r) { return logUniform(r, -1074, 0); });
    all("next to multiples of pi/2", [](Random& r) {
        const auto n = static_cast<Quad>(r() % 1100000);
        const double nearest = static_cast<double>(n * asinq(1));
        return nearest + static_cast<double>(static_cast<int>(r() % 7) - 3) *
                             static_cast<double>(ulpAt(nearest));
    });
    all("powers of two",
        [](Random& r) { return std::ldexp(1, static_cast<int>(r() % 2098) - 1074); });
}

/// The f64 nearest to a multiple of pi/2 [Muller 2016, table 11.1]: cos is -4.687e-19.
TEST(Elementary, ReductionOfTheHardestArgument) {
    const double x = std::ldexp(6381956970095103.0, 797);
    EXPECT_LE(ulps(numeric::cos(x), cosq(x)), rt::tolerance::kElementaryUlps);
    EXPECT_LT(std::fabs(numeric::cos(x)), 1 / 0x1p60);
    EXPECT_LE(ulps(numeric::tan(x), tanq(x)), rt::tolerance::kElementaryUlps);
}

TEST(Elementary, SinCosTanSpecialValues) {
    for (const auto f : {numeric::sin, numeric::tan}) {
        EXPECT_TRUE(!std::signbit(f(0.0)) && f(0.0) == 0);
        EXPECT_TRUE(std::signbit(f(-0.0)) && f(-0.0) == 0);
        EXPECT_EQ(f(-kLeast), -kLeast);
    }
    EXPECT_EQ(numeric::cos(0), 1);
    EXPECT_EQ(numeric::cos(-kLeast), 1);
    for (const auto f : {numeric::sin, numeric::cos, numeric::tan})
        for (const double x : {kInf, -kInf, kNaN}) EXPECT_TRUE(std::isnan(f(x)));
}

TEST(Elementary, AsinAcos) {
    const auto all = [](auto draw) {
        sweep("asin", numeric::asin, asinq, kSamples, draw);
        sweep("acos", numeric::acos, acosq, kSamples, draw);
    };
    all([](Random& r) { return uniform(r, -1, 1); });
    all([](Random& r) {
        return std::copysign(1 - std::fabs(logUniform(r, -53, -2)), uniform(r, -1, 1));
    });
    all([](Random& r) { return logUniform(r, -1074, 0); });
    EXPECT_EQ(numeric::asin(1), M_PI_2);
    EXPECT_EQ(numeric::asin(-1), -M_PI_2);
    EXPECT_EQ(numeric::acos(1), 0);
    EXPECT_EQ(numeric::acos(-1), M_PI);
    EXPECT_EQ(numeric::acos(0), M_PI_2);
    EXPECT_TRUE(std::signbit(numeric::asin(-0.0)));
    for (const double x : {kAboveOne, -2.0, kInf, kNaN}) {
        EXPECT_TRUE(std::isnan(numeric::asin(x)));
        EXPECT_TRUE(std::isnan(numeric::acos(x)));
    }
}

TEST(Elementary, Atan2) {
    const auto pairs = [](const char* name, auto draw) {
        Random random(5);
        Worst worst;
        for (int i = 0; i < kSamples; ++i) {
            const double y = draw(random), x = draw(random);
            worst.add(ulps(numeric::atan2(y, x), atan2q(y, x)), y, x);
        }
        worst.expectWithin(rt::tolerance::kElementaryUlpsDerived, name);
    };
    pairs("unit square", [](Random& r) { return uniform(r, -1, 1); });
    pairs("ratios", [](Random& r) { return logUniform(r, -40, 40); });
    pairs("any", anyFinite);
    pairs("huge", [](Random& r) { return logUniform(r, 900, 1024); });
    pairs("subnormal", [](Random& r) { return kLeast * std::floor(uniform(r, -1e6, 1e6)); });
    const double values[] = {0.0, -0.0, 1, -1, kInf, -kInf, kNaN, kLeast, -kLeast, kMax, -kMax};
    for (const double y : values)
        for (const double x : values) {
            const double ours = numeric::atan2(y, x);
            if (std::isnan(x) || std::isnan(y)) {
                EXPECT_TRUE(std::isnan(ours));
                continue;
            }
            const double exact = static_cast<double>(atan2q(y, x));
            EXPECT_EQ(std::bit_cast<std::uint64_t>(ours), std::bit_cast<std::uint64_t>(exact))
                << y << ", " << x;
        }
}

std::string outputOf(const std::string& command) {
    FILE* pipe = popen(command.c_str(), "r");
    if (!pipe) return "";
    char buffer[256];
    std::string text;
    while (std::fgets(buffer, sizeof buffer, pipe)) text += buffer;
    return pclose(pipe) == 0 ? text : "failed: " + command;
}

/// -O0, -O2, -O3 for this CPU, and a C library that believes the CPU has neither FMA nor AVX2: one
/// checksum.
TEST(Elementary, SameBitsInEveryBuildAndWithoutFma) {
    const std::string programs = RT_CHECKSUM_PROGRAMS;
    const std::string reference = outputOf(programs + "_O2");
    ASSERT_EQ(reference.size(), 17u) << reference;
    EXPECT_EQ(outputOf(programs + "_O0"), reference);
    EXPECT_EQ(outputOf(programs + "_native"), reference);
    EXPECT_EQ(outputOf("GLIBC_TUNABLES=glibc.cpu.hwcaps=-FMA,-FMA4,-AVX2 " + programs + "_O2"),
              reference);
}

} // namespace
