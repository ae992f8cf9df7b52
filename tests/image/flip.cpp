#include <core/image/flip.hpp>
#include <core/image/quantize.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <stdexcept>

namespace {

using namespace rt::image;

Framebuffer pattern(unsigned s) {
    Framebuffer frame(48, 40);
    const auto code = [](unsigned c) { return linearFromSrgb8(static_cast<std::uint8_t>(c)); };
    for (unsigned y = 0; y < 40; ++y)
        for (unsigned x = 0; x < 48; ++x)
            frame.at(x, y) = {code((x * 5 + y * 3 + s) % 256), code((x * x / 9 + y * 7) % 256),
                              code((x / 8 + y / 8) % 2 * 180 + s % 70)};
    return frame;
}

/// Expected: the steps of the authors' program (NVlabs/flip, python/flip_api.py, two-dimensional filters) run in
/// NumPy 1.24 on the same codes. Its rounded inverse colour matrix is what the tolerance leaves room for.
TEST(Flip, AgreesWithTheAuthorsProgram) {
    Framebuffer other = pattern(0);
    for (unsigned y = 0; y < 40; ++y)
        for (unsigned x = 0; x < 48; ++x) other.at(x, y).r = pattern(24).at(x, y).r;
    for (unsigned y = 10; y < 14; ++y)
        for (unsigned x = 20; x < 26; ++x) other.at(x, y).b = 1;
    EXPECT_NEAR(meanFlip(other, pattern(0)), 0.3312019985, rt::tolerance::kFlipReference);
    EXPECT_NEAR(meanFlip(pattern(63), pattern(0)), 0.7067297042, rt::tolerance::kFlipReference);
    EXPECT_NEAR(meanFlip(pattern(63), pattern(0), 20), 0.6998297076, rt::tolerance::kFlipReference);
}

TEST(Flip, Ends) {
    const Framebuffer a = pattern(5);
    EXPECT_EQ(meanFlip(a, a), 0);
    Framebuffer black(20, 20), white(20, 20);
    for (auto& p : white.pixels) p = LinearRgb::grey(1);
    EXPECT_NEAR(meanFlip(white, black), 0.9673797634, rt::tolerance::kFlipReference);
    EXPECT_EQ(meanFlip(white, black), meanFlip(black, white));
    EXPECT_THROW(meanFlip(a, black), std::invalid_argument);
}

} // namespace
