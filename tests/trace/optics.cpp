#include <core/numeric/angle.hpp>
#include <core/trace/direction.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rt::trace {
namespace {

TEST(Refraction, bendsBySnell) {
    const Vec3 normal{0, 0, 1};
    for (double degrees = 0; degrees < 90; degrees += 0.25) {
        const double angle = degrees * numeric::kRadiansPerDegree;
        const auto bent = refracted({std::sin(angle), 0, -std::cos(angle)}, normal, 1 / 1.5);
        ASSERT_TRUE(bent);
        EXPECT_NEAR(bent->x, std::sin(angle) / 1.5, tolerance::roundings(8));
        EXPECT_LT(bent->z, 0);
        EXPECT_LE(std::fabs(dot(*bent, *bent) - 1), tolerance::roundings(8));
    }
}

// STABILITY.md R1: the decision is right for every angle further than 1e-12 from the critical one.
TEST(Refraction, decidesTotalReflectionNextToTheCriticalAngle) {
    const Vec3 normal = unit({0.3, -0.2, 1});
    const Vec3 tangent = unit(cross(normal, Vec3{0, 1, 0}));
    const long double critical = std::asin(1 / 1.5L);
    for (double delta = tolerance::kCriticalAngle; delta < 0.5; delta *= 3)
        for (const double sign : {-1.0, 1.0}) {
            const long double angle = critical + sign * delta;
            const Vec3 direction = tangent * static_cast<double>(std::sin(angle)) -
                                   normal * static_cast<double>(std::cos(angle));
            EXPECT_EQ(refracted(direction, normal, 1.5).has_value(), sign < 0) << delta;
        }
}

TEST(Refraction, outAgainIsTheWayIn) { // STABILITY.md R2: 1000 parallel slabs
    const Vec3 normal = unit({0.1, 0.2, 1});
    const Vec3 in = unit({0.7, -0.2, -0.6});
    Vec3 d = in;
    for (int slab = 0; slab < 1000; ++slab)
        d = *refracted(*refracted(d, normal, 1 / 1.5), normal, 1.5);
    EXPECT_LE(length(cross(in, d)), tolerance::kSlabChain);
    EXPECT_LE(std::fabs(length(d) - 1), tolerance::roundings(4));
}

TEST(Reflection, staysUnitAndMirrors) {
    const Vec3 normal = unit({1, 2, 3});
    Vec3 d = unit({0.5, -0.25, -0.5});
    const Vec3 r = reflected(d, normal);
    EXPECT_NEAR(dot(r, normal), -dot(d, normal), tolerance::roundings(8));
    EXPECT_LE(length(cross(r - d, normal)), tolerance::roundings(16));
}

TEST(Hemisphere, keepsWhatIsInsideAndMirrorsTheRest) {
    const Vec3 normal{0, 0, 1};
    const Vec3 above = unit({1, 0, 0.25}), below = unit({1, 0, -0.25});
    EXPECT_EQ(intoHemisphere(above, normal), above);
    EXPECT_EQ(intoHemisphere(below, normal), above);
}

TEST(Unit, survivesTheEndsOfTheRange) {
    for (const double scale : {1 / 1e300, 1 / 1e160, 1.0, 1e160, 1e300}) {
        const Vec3 u = unit(Vec3{3, 4, 12} * scale);
        EXPECT_LE(length(u - Vec3{3, 4, 12} / 13.0), tolerance::roundings(8)) << scale;
    }
}

} // namespace
} // namespace rt::trace
