// The pinhole camera: which ray goes through a point of the picture.
#pragma once
#include <core/geometry/ray.hpp>
#include <core/scene/description.hpp>
#include <core/trace/pinhole.hpp>

#include <span>

namespace rt::trace {

using geometry::Ray;
using geometry::Vec3;

/// The screen is a rectangle at `screenDistance` along forward, its sides along up × forward (left)
/// and up; columns and rows count pixels from its top-left corner, real numbers between.
class Camera {
public:
    Camera(const scene::Camera& camera, std::uint32_t width, std::uint32_t height,
           scene::NearPlane nearPlane);

    /// Unit direction; starts at the eye, or on the screen when that is the near plane.
    Ray through(double column, double row) const;
    /// The same rays, of as many points as rays, several at a time.
    void through(std::span<const PicturePoint> points, std::span<Ray> rays) const;

    const Vec3& eye() const { return pinhole_.eye; }

private:
    Pinhole pinhole_;
};

} // namespace rt::trace
