#include <core/trace/camera.hpp>

#include <core/trace/direction.hpp>
#include <core/trace/wave.hpp>

namespace rt::trace {

Camera::Camera(const scene::Camera& camera, std::uint32_t width, std::uint32_t height,
               scene::NearPlane nearPlane) {
    const Vec3 forward = unit(camera.forward);
    pinhole_.eye = camera.position;
    pinhole_.toScreen = forward * camera.screenDistance;
    pinhole_.left = unit(cross(unit(camera.up), forward));
    pinhole_.up = unit(cross(forward, pinhole_.left));
    pinhole_.pixelHeight = camera.screenHeight / height;
    pinhole_.pixelWidth = camera.screenWidth / width;
    pinhole_.halfRows = height / 2.0;
    pinhole_.halfColumns = width / 2.0;
    pinhole_.startsOnScreen = nearPlane == scene::NearPlane::screen;
}

Ray Camera::through(double column, double row) const {
    const Pinhole& p = pinhole_;
    // Factors before products: at twice the size all of them scale by exactly 2, so a sample has the
    // same bits whether it is a pixel of the large picture or a subpixel of the small one.
    const Vec3 toSample = p.toScreen + p.up * (p.pixelHeight * (p.halfRows - row)) +
                          p.left * (p.pixelWidth * (p.halfColumns - column));
    Ray ray;
    ray.origin = p.startsOnScreen ? p.eye + toSample : p.eye;
    ray.direction = unit(toSample);
    return ray;
}

void Camera::through(std::span<const PicturePoint> points, std::span<Ray> rays) const {
    if (waveKernel().through(pinhole_, points.data(), points.size(), rays.data())) return;
    for (std::size_t i = 0; i < points.size(); ++i)
        rays[i] = through(points[i].column, points[i].row);
}

} // namespace rt::trace
