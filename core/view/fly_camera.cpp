#include <core/view/fly_camera.hpp>

#include <core/numeric/transform.hpp>

#include <charconv>

namespace rt::view {

using numeric::cross;
using numeric::dot;
using numeric::normalize;
using numeric::Radians;
using numeric::Vec3;

namespace {

Vec3 rotated(const Vec3& v, const Vec3& axis, Radians angle) {
    return numeric::rotation(axis, angle).direction(v);
}

std::string number(double x) {
    char buffer[32];
    return {buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr};
}

std::string vector(const Vec3& v) {
    return "[" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + "]";
}

} // namespace

FlyCamera::FlyCamera(const scene::Camera& camera) : camera_(camera) {
    camera_.forward = normalize(camera_.forward);
    camera_.up = normalize(camera_.up - camera_.forward * dot(camera_.up, camera_.forward));
}

void FlyCamera::move(double right, double forward, double up) {
    camera_.position +=
        cross(camera_.forward, camera_.up) * right + camera_.forward * forward + camera_.up * up;
}

void FlyCamera::turn(Radians yaw, Radians pitch, Radians roll) {
    const Vec3 right = cross(camera_.forward, camera_.up);
    Vec3 forward = rotated(camera_.forward, camera_.up, yaw);
    Vec3 up = camera_.up;
    forward = rotated(forward, right, pitch);
    up = rotated(up, right, pitch);
    up = rotated(up, forward, roll);
    camera_.forward = normalize(forward);
    camera_.up = normalize(up - camera_.forward * dot(up, camera_.forward));
}

std::string FlyCamera::yaml() const {
    return "camera:\n  position: " + vector(camera_.position) +
           "\n  forward: " + vector(camera_.forward) + "\n  up: " + vector(camera_.up) +
           "\n  screen: {width: " + number(camera_.screenWidth) +
           ", height: " + number(camera_.screenHeight) +
           ", distance: " + number(camera_.screenDistance) + "}\n";
}

} // namespace rt::view
