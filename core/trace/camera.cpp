#include <core/trace/camera.hpp>

#include <core/trace/direction.hpp>

namespace rt::trace {

Camera::Camera(const scene::Camera& camera, std::uint32_t width, std::uint32_t height,
               scene::NearPlane nearPlane)
    : eye_(camera.position), pixelHeight_(camera.screenHeight / height),
      pixelWidth_(camera.screenWidth / width), halfRows_(height / 2.0), halfColumns_(width / 2.0),
      startsOnScreen_(nearPlane == scene::NearPlane::screen) {
    const Vec3 forward = unit(camera.forward);
    left_ = unit(cross(unit(camera.up), forward));
    up_ = unit(cross(forward, left_));
    toScreen_ = forward * camera.screenDistance;
}

void Camera::through(double column, double row, Ray& ray) const {
    // Factors before products: at twice the size all of them scale by exactly 2, so a sample has the
    // same bits whether it is a pixel of the large picture or a subpixel of the small one.
    const Vec3 toSample = toScreen_ + up_ * (pixelHeight_ * (halfRows_ - row)) +
                          left_ * (pixelWidth_ * (halfColumns_ - column));
    ray.origin = startsOnScreen_ ? eye_ + toSample : eye_;
    ray.direction = unit(toSample);
}

} // namespace rt::trace
