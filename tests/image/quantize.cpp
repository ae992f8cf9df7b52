#include <core/image/quantize.hpp>
#include <core/numeric/colour.hpp>
#include <core/numeric/rounding.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace {

using namespace rt::image;
using rt::numeric::linearFromSrgb;
using rt::numeric::nextDown;
using rt::numeric::nextUp;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(Quantize, OutsideAndNonFinite) {
    for (const double low : {-0.0, -1.0, -kInf, kNaN, -kNaN}) {
        EXPECT_EQ(srgb8(low), 0);
        EXPECT_EQ(linear8(low), 0);
        EXPECT_EQ(srgb16(low), 0);
        EXPECT_EQ(linear16(low), 0);
    }
    for (const double high : {1.0, 1.5, 1e300, kInf}) {
        EXPECT_EQ(srgb8(high), 255);
        EXPECT_EQ(linear8(high), 255);
        EXPECT_EQ(srgb16(high), 65535);
        EXPECT_EQ(linear16(high), 65535);
    }
}

TEST(Quantize, LinearHalvesGoToEven) {
    EXPECT_EQ(linear8(0.5 / 255), 0);
    EXPECT_EQ(linear8(1.5 / 255), 2);
    EXPECT_EQ(linear8(0.5), 128);    // 127.5
    EXPECT_EQ(linear16(0.5), 32768); // 32767.5
    EXPECT_EQ(linear8(nextDown(0.5)), 127);
}

TEST(Quantize, EveryCodeComesBack) {
    for (unsigned k = 0; k < 256; ++k) {
        EXPECT_EQ(srgb8(linearFromSrgb8(static_cast<std::uint8_t>(k))), k);
        EXPECT_EQ(linear8(k / 255.0), k);
    }
    for (unsigned k = 0; k < 65536; ++k) {
        EXPECT_EQ(srgb16(linearFromSrgb(k / 65535.0)), k);
        EXPECT_EQ(linear16(k / 65535.0), k);
    }
}

TEST(Quantize, Srgb8ChangesAtItsLimits) {
    for (unsigned k = 0; k < 255; ++k) {
        const double limit = linearFromSrgb((k + 0.5) / 255);
        EXPECT_EQ(srgb8(nextDown(limit)), k);
        EXPECT_EQ(srgb8(limit), k % 2 ? k + 1 : k);
        EXPECT_EQ(srgb8(nextUp(limit)), k + 1);
    }
}

/// The table against the definition by search, over a fine grid that does not share its cells.
TEST(Quantize, Srgb8IsTheNearestCode) {
    unsigned code = 0;
    for (int i = 0; i <= 1000003; ++i) {
        const double c = i / 1000003.0;
        while (code < 255 && c > linearFromSrgb((code + 0.5) / 255)) ++code;
        ASSERT_EQ(srgb8(c), code) << c;
    }
}

} // namespace
