#include <core/trace/camera.hpp>
#include <core/trace/direction.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

namespace rt::trace {
namespace {

scene::Camera legacyCamera() { // legacy/cases/chk_bg.inf: neither axis-parallel nor perpendicular
    scene::Camera camera;
    camera.position = {62, 30, 41};
    camera.forward = {-0.4, 0.8, 0.3};
    camera.up = {0.1, 0, 1};
    camera.screenWidth = 30, camera.screenHeight = 22, camera.screenDistance = 9;
    return camera;
}

TEST(Camera, looksAlongPlusYWithPlusXToTheRightAndPlusZUp) {
    const Camera camera({}, 64, 48, scene::NearPlane::none);
    EXPECT_EQ(camera.through(32, 24).direction, Vec3(0, 1, 0));
    EXPECT_GT(camera.through(63, 24).direction.x, 0);
    EXPECT_GT(camera.through(32, 1).direction.z, 0);
}

TEST(Camera, screenPointsFollowTheFormula) {
    const scene::Camera c = legacyCamera();
    const Camera camera(c, 64, 48, scene::NearPlane::screen);
    const Vec3 forward = normalize(c.forward);
    const Vec3 left = normalize(cross(normalize(c.up), forward)), up = cross(forward, left);
    for (const auto& [i, j] : {std::pair{0.0, 0.0}, {24.0, 32.0}, {47.5, 63.5}, {10.25, 3.75}}) {
        const Vec3 expected = c.position + forward * c.screenDistance +
                              up * (c.screenHeight / 48 * (24 - i)) +
                              left * (c.screenWidth / 64 * (32 - j));
        const Ray ray = camera.through(j, i);
        const double size = 100; // coordinates of the scene
        EXPECT_LE(length(ray.origin - expected), size * tolerance::roundings(16));
        EXPECT_LE(length(ray.direction - normalize(expected - c.position)),
                  size * tolerance::roundings(32));
        EXPECT_LE(std::fabs(dot(ray.direction, ray.direction) - 1), tolerance::roundings(8));
    }
}

TEST(Camera, startsAtTheEyeWithoutANearPlane) {
    const Camera camera(legacyCamera(), 64, 48, scene::NearPlane::none);
    EXPECT_EQ(camera.through(3, 4).origin, Vec3(62, 30, 41));
}

TEST(Camera, samplesOfTwiceTheSizeAreTheSameBits) {
    const Camera small(legacyCamera(), 33, 17, scene::NearPlane::screen);
    const Camera large(legacyCamera(), 66, 34, scene::NearPlane::screen);
    for (int row = 0; row < 34; ++row)
        for (int column = 0; column < 66; ++column) {
            const Ray a = small.through(column / 2.0, row / 2.0), b = large.through(column, row);
            ASSERT_EQ(a.origin, b.origin);
            ASSERT_EQ(a.direction, b.direction);
        }
}

TEST(Camera, directionDoesNotDependOnWhereTheCameraStands) {
    scene::Camera far = legacyCamera();
    far.position = {1e6, -1e6, 3e5};
    const Ray here = Camera(legacyCamera(), 64, 48, scene::NearPlane::none).through(5, 6);
    EXPECT_EQ(Camera(far, 64, 48, scene::NearPlane::none).through(5, 6).direction, here.direction);
}

} // namespace
} // namespace rt::trace
