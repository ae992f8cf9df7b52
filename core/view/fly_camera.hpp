// A camera that flies: moves along its own axes, turns about them. World space.
#pragma once
#include <core/numeric/angle.hpp>
#include <core/scene/description.hpp>

#include <string>

namespace rt::view {

class FlyCamera {
public:
    explicit FlyCamera(const scene::Camera& camera);

    /// Distances along right, forward and up, world units.
    void move(double right, double forward, double up);
    /// About the camera's own axes: yaw to the left, pitch upward, roll clockwise as seen through the camera.
    void turn(numeric::Radians yaw, numeric::Radians pitch, numeric::Radians roll);

    const scene::Camera& camera() const { return camera_; }
    /// `camera: {…}` as the scene language writes it, numbers in shortest round-trip form.
    std::string yaml() const;

private:
    scene::Camera camera_; // forward and up are kept unit and perpendicular
};

} // namespace rt::view
