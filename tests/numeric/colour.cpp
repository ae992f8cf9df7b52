#include <core/numeric/colour.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace rt::numeric;

TEST(Colour, EndsAndKneesOfTheSrgbCurve) {
    EXPECT_EQ(linearFromSrgb(0), 0);
    EXPECT_EQ(linearFromSrgb(1), 1);
    EXPECT_EQ(srgbFromLinear(0), 0);
    EXPECT_EQ(srgbFromLinear(1), 1);
    EXPECT_EQ(linearFromSrgb(0.04045), 0.04045 / 12.92);
    EXPECT_EQ(srgbFromLinear(0.0031308), 0.0031308 * 12.92);
}

TEST(Colour, RoundTripIsMonotone) {
    double before = -1;
    for (int code = 0; code <= 65535; ++code) {
        const double encoded = code / 65535.0, linear = linearFromSrgb(encoded);
        EXPECT_GT(linear, before);
        before = linear;
        // 2.4 and 1/2.4 each enlarge relative errors at most 2.4 times; the standard's two branches
        // overlap by 3e-8.
        EXPECT_NEAR(srgbFromLinear(linear), encoded, rt::tolerance::kSrgbBranchGap);
    }
}

} // namespace
