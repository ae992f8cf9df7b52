#include <core/numeric/transform.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <random>

namespace {

using namespace rt::numeric;

Vec3 randomVector(std::mt19937_64& random) {
    const auto draw = [&] { return static_cast<double>(random() >> 11) / 0x1p52 - 1; };
    const double x = draw(), y = draw(), z = draw();
    return {x, y, z};
}

void expectNear(const Vec3& a, const Vec3& b, double bound) {
    EXPECT_LE(maxComponent(abs(a - b)), bound);
}

const AffineTransform kShear{Mat3(Vec3(1, 0, 0), Vec3(0.5, 1, 0), Vec3(0, -2, 3)), Vec3(1, 2, 3)};

TEST(Transform, NormalStaysPerpendicularToMappedTangents) {
    std::mt19937_64 random(1);
    for (int i = 0; i < 1000; ++i) {
        const AffineTransform t{
            Mat3(randomVector(random), randomVector(random), randomVector(random)), Vec3(0)};
        const Vec3 u = randomVector(random), v = randomVector(random), n = cross(u, v);
        const Vec3 mapped = t.normal(n), mappedU = t.direction(u);
        // 3 roundings in n, 3 in a cofactor, 3 in the product with it, 3 in u, 3 in the last dot.
        const double columns = length(t.linear[0]) + length(t.linear[1]) + length(t.linear[2]);
        const double terms = columns * columns * columns * lengthSquared(u) * length(v);
        EXPECT_LE(std::fabs(dot(mapped, mappedU)), rt::tolerance::roundings(16) * terms);
    }
}

/// n . (p - q) > 0 outside must stay so: cofactors alone would turn the normal round under a
/// mirror.
TEST(Transform, NormalOfAMirrorKeepsItsSide) {
    const AffineTransform mirror{Mat3(Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)), Vec3(0)};
    EXPECT_EQ(mirror.normal({1, 0, 0}), Vec3(-1, 0, 0));
    EXPECT_EQ(mirror.normal({0, 1, 0}), Vec3(0, 1, 0));
}

TEST(Transform, NormalOfAFlattenedSurface) {
    const AffineTransform flat{Mat3(Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 0)), Vec3(0)};
    EXPECT_EQ(flat.normal({1, 2, 1}), Vec3(0, 0, 1));
}

TEST(Transform, InverseGivesBackPoints) {
    const AffineTransform back = kShear.inverse();
    std::mt19937_64 random(2);
    for (int i = 0; i < 100; ++i) {
        const Vec3 p = randomVector(random);
        // the condition of kShear is under 16
        expectNear(back.point(kShear.point(p)), p, rt::tolerance::roundings(16) * 16);
    }
}

std::optional<double> scaleOf(const Vec3& x, const Vec3& y, const Vec3& z) {
    return AffineTransform{Mat3(x, y, z), Vec3(9)}.similarityScale();
}

TEST(Transform, SimilarityScale) {
    AffineTransform chain;
    std::mt19937_64 random(3);
    for (int i = 0; i < 4; ++i) {
        chain = rotation(randomVector(random), {i * 1.7}) * chain;
        chain = AffineTransform{Mat3(i + 0.3), Vec3(i)} * chain;
        EXPECT_TRUE(chain.similarityScale()) << i;
    }
    EXPECT_EQ(scaleOf({-2, 0, 0}, {0, 2, 0}, {0, 0, 2}), 2);
    EXPECT_EQ(scaleOf({3, 0, 0}, {0, 3, 0}, {0, 0, 3}), 3);
    EXPECT_FALSE(kShear.similarityScale());
    EXPECT_FALSE(scaleOf({1, 0, 0}, {0, 1, 0}, {0, 0, 1 + 1 / 0x1p40}));
    EXPECT_FALSE(scaleOf(Vec3(0), Vec3(0), Vec3(0)));
    EXPECT_FALSE(scaleOf(Vec3(kInfinity), Vec3(0), Vec3(0)));
}

TEST(Transform, RotationTurnsRightHanded) {
    const double quarter = std::numbers::pi / 2;
    const auto bound = rt::tolerance::roundings(8);
    expectNear(rotation({0, 0, 2}, {quarter}).point({1, 0, 0}), {0, 1, 0}, bound);
    expectNear(rotation({1, 0, 0}, {quarter}).point({0, 1, 0}), {0, 0, 1}, bound);
    expectNear(rotation({0, 1, 0}, {quarter}).point({0, 0, 1}), {1, 0, 0}, bound);
    expectNear(rotation({1, 1, 1}, {2 * quarter * 2 / 3}).point({1, 0, 0}), {0, 1, 0}, bound);
    EXPECT_TRUE(rotation({3, 1, 2}, {0}).isIdentity());
    for (const double size : {1 / 0x1p600, 0x1p600}) // squares would leave the range
        EXPECT_EQ(rotation(Vec3(1, 2, 2) * size, {1}).linear, rotation({1, 2, 2}, {1}).linear);
}

} // namespace
