#include <core/image/metrics.hpp>
#include <core/image/ssim.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace {

using namespace rt::image;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

Framebuffer grey(std::uint32_t width, std::uint32_t height, double value) {
    Framebuffer frame(width, height);
    for (auto& p : frame.pixels) p = LinearRgb::grey(value);
    return frame;
}

Framebuffer pattern(std::uint32_t width, std::uint32_t height, unsigned seed) {
    Framebuffer frame(width, height);
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x)
            frame.at(x, y) = {((x * 7 + y * 3 + seed) % 64) / 63.0, ((x + y * 5) % 32) / 31.0,
                              ((x * y + seed) % 16) / 15.0};
    return frame;
}

TEST(Difference, EqualPictures) {
    const Framebuffer a = pattern(9, 7, 0);
    const Difference d = difference(a, a);
    EXPECT_EQ(d.pixels, 63u);
    EXPECT_EQ(d.rmse, 0);
    EXPECT_EQ(d.max, 0);
    EXPECT_EQ(d.over, 0u);
    EXPECT_EQ(d.energyError, 0);
    EXPECT_EQ(d.psnr(), kInf);
    EXPECT_EQ(ssimBlocks(a, a), std::nullopt); // 7 rows hold no window
    EXPECT_NEAR(*ssimBlocks(pattern(16, 16, 0), pattern(16, 16, 0)), 1,
                rt::tolerance::roundings(64));
    EXPECT_NEAR(*ssimGaussian(pattern(16, 16, 0), pattern(16, 16, 0)), 1,
                rt::tolerance::roundings(64));
}

TEST(Difference, KnownSums) {
    Framebuffer a = grey(4, 3, 0.5);
    const Framebuffer b = grey(4, 3, 0.5);
    a.at(2, 1) = {0.5, 0.75, 0.5};
    a.at(3, 2) = {0.25, 0.5, 0.5}; // as large, but later
    const Difference d = difference(a, b, {std::nullopt, nullptr, 0.25});
    EXPECT_EQ(d.max, 0.25);
    EXPECT_EQ(d.maxX, 2u);
    EXPECT_EQ(d.maxY, 1u);
    EXPECT_EQ(d.over, 0u); // not by more than the tolerance
    EXPECT_EQ(d.meanAbsolute, 0.5 / 36);
    EXPECT_EQ(d.rmse, std::sqrt(0.125 / 36));
    EXPECT_EQ(d.rmseOfRest, d.rmse); // none is over
    a.at(0, 0).r = 0.625;
    const Difference cut = difference(a, b, {std::nullopt, nullptr, 0.125});
    EXPECT_EQ(cut.over, 2u);
    EXPECT_EQ(cut.rmseOfRest, std::sqrt(0.125 * 0.125 / 30));
    a.at(0, 0).r = 0.5;
    EXPECT_EQ(d.meanRelativeSquare, 2 * (0.0625 / 0.26) / 36);
    EXPECT_EQ(d.energyError, 0);
    EXPECT_EQ(difference(a, b, {std::nullopt, nullptr, 0.2}).over, 2u);
    EXPECT_EQ(difference(a, b, {std::nullopt, nullptr, 0.2}).overShare(), 2.0 / 12);
    EXPECT_NEAR(difference(grey(2, 2, 0.6), grey(2, 2, 0.5)).psnr(), 20,
                rt::tolerance::roundings(16) * 20);
    EXPECT_EQ(difference(grey(2, 2, 0.75), grey(2, 2, 0.5)).energyError, 0.5);
    EXPECT_EQ(difference(grey(2, 2, 0.75), grey(2, 2, 0)).energyError, kInf);
}

TEST(Difference, NonFinitePixelsAreCountedApart) {
    Framebuffer a = grey(3, 3, 0.5), b = grey(3, 3, 0.5);
    a.at(0, 0).g = kNaN;
    b.at(1, 0).r = kInf;
    b.at(2, 0) = {kInf, kNaN, 0};
    a.at(0, 1).r = kInf, b.at(0, 1).r = kInf; // equal infinities are not compared either
    const Difference d = difference(a, b);
    EXPECT_EQ(d.nan, 2u);
    EXPECT_EQ(d.infinite, 2u);
    EXPECT_EQ(d.over, 4u);
    EXPECT_EQ(d.pixels, 9u);
    EXPECT_EQ(d.rmse, 0);
    EXPECT_EQ(d.max, 0);
    const Difference none = difference(grey(1, 1, kNaN), grey(1, 1, kNaN));
    EXPECT_EQ(none.nan, 1u);
    EXPECT_EQ(none.rmse, 0);
    EXPECT_EQ(differencePicture(a, b, 1).at(0, 0), LinearRgb::grey(1));
}

TEST(Difference, CropAndMask) {
    Framebuffer a = grey(4, 4, 0);
    const Framebuffer b = grey(4, 4, 0);
    a.at(0, 0).r = 1;
    a.at(3, 3).b = 0.5;
    EXPECT_EQ(difference(a, b, {Region{1, 1, 4, 4}, nullptr, 0}).max, 0.5);
    EXPECT_EQ(difference(a, b, {Region{1, 1, 4, 4}, nullptr, 0}).pixels, 9u);
    EXPECT_EQ(difference(a, b, {Region{1, 1, 3, 3}, nullptr, 0}).max, 0);
    Framebuffer mask = grey(4, 4, 0);
    mask.at(0, 0) = LinearRgb::grey(1);
    mask.at(1, 0) = LinearRgb::grey(0.5); // not over a half
    const Difference d = difference(a, b, {std::nullopt, &mask, 0});
    EXPECT_EQ(d.pixels, 1u);
    EXPECT_EQ(d.max, 1);
    const Framebuffer none = grey(16, 16, 0);
    EXPECT_EQ(ssimBlocks(pattern(16, 16, 1), pattern(16, 16, 2), {std::nullopt, &none, 0}),
              std::nullopt);
}

TEST(Difference, Refusals) {
    const Framebuffer a = grey(4, 4, 0), b = grey(4, 5, 0);
    EXPECT_THROW(difference(a, b), std::invalid_argument);
    EXPECT_THROW(difference(a, a, {std::nullopt, &b, 0}), std::invalid_argument);
    EXPECT_THROW(difference(a, a, {Region{0, 0, 5, 4}, nullptr, 0}), std::invalid_argument);
    EXPECT_THROW(difference(a, a, {Region{2, 0, 2, 4}, nullptr, 0}), std::invalid_argument);
    EXPECT_THROW(ssimBlocks(a, b), std::invalid_argument);
    EXPECT_THROW(differencePicture(a, b, 1), std::invalid_argument);
}

TEST(Difference, PictureOfIt) {
    Framebuffer a = grey(1, 1, 0), b = grey(1, 1, 0);
    a.at(0, 0) = {0.5, 0.25, 0};
    b.at(0, 0) = {0.25, 0.5, 0};
    EXPECT_EQ(differencePicture(a, b, 2).at(0, 0), (LinearRgb{0.5, 0.5, 0}));
}

/// Constant pictures: variances vanish, and the formula is its first factor.
TEST(Ssim, ConstantPictures) {
    const Framebuffer black = grey(16, 16, 0), white = grey(16, 16, 1);
    const double c1 = 2.55 * 2.55;
    EXPECT_NEAR(*ssimGaussian(black, white), c1 / (255.0 * 255.0 + c1),
                rt::tolerance::roundings(64));
    EXPECT_NEAR(*ssimBlocks(black, white), c1 / 64 / (255.0 * 255.0 + c1 / 64),
                rt::tolerance::roundings(64));
}

TEST(Ssim, GaussianSeesStructure) {
    const Framebuffer a = pattern(32, 32, 0);
    Framebuffer brighter = a;
    for (auto& p : brighter.pixels) p *= 0.9;
    const double offset = *ssimGaussian(a, brighter), other = *ssimGaussian(a, pattern(32, 32, 31));
    EXPECT_GT(offset, 0.9);
    EXPECT_LT(other, offset);
    EXPECT_EQ(ssimGaussian(grey(10, 40, 0), grey(10, 40, 0)), std::nullopt);
}

} // namespace
