#include <core/view/fly_camera.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <numbers>

namespace rt::view {

namespace {

scene::Camera lookingNorth() {
    scene::Camera camera;
    camera.position = {1, 2, 3};
    camera.forward = {0, 2, 0};
    camera.up = {0, 0.5, 3};
    return camera;
}

void expectNear(const numeric::Vec3& a, const numeric::Vec3& b) {
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(a[k], b[k], tolerance::roundings(64)) << "component " << k;
}

constexpr numeric::Radians kQuarter{std::numbers::pi / 2};

} // namespace

TEST(FlyCamera, MovesAlongItsOwnAxes) {
    FlyCamera fly(lookingNorth());
    fly.move(1, 10, 100); // right is +x when looking along +y with +z up
    expectNear(fly.camera().position, {2, 12, 103});
}

TEST(FlyCamera, TurnsLeftUpAndClockwise) {
    FlyCamera yaw(lookingNorth()), pitch(lookingNorth()), roll(lookingNorth());
    yaw.turn(kQuarter, {}, {});
    expectNear(yaw.camera().forward, {-1, 0, 0});
    pitch.turn({}, kQuarter, {});
    expectNear(pitch.camera().forward, {0, 0, 1});
    roll.turn({}, {}, kQuarter);
    expectNear(roll.camera().up, {1, 0, 0});
}

TEST(FlyCamera, StaysOrthonormalOverManyTurns) {
    FlyCamera fly(lookingNorth());
    for (int i = 0; i < 100000; ++i) fly.turn({0.1}, {0.07}, {0.03});
    const auto& camera = fly.camera();
    EXPECT_NEAR(numeric::length(camera.forward), 1, tolerance::roundings(64));
    EXPECT_NEAR(numeric::length(camera.up), 1, tolerance::roundings(64));
    EXPECT_NEAR(numeric::dot(camera.forward, camera.up), 0, tolerance::roundings(64));
}

} // namespace rt::view
