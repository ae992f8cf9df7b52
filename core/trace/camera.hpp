// The pinhole camera: which ray goes through a point of the picture.
#pragma once
#include <core/geometry/ray.hpp>
#include <core/scene/description.hpp>

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
    Ray through(double column, double row) const {
        Ray ray;
        through(column, row, ray);
        return ray;
    }
    /// In place: sets origin and direction.
    void through(double column, double row, Ray& ray) const;

    const Vec3& eye() const { return eye_; }

private:
    Vec3 eye_;
    Vec3 toScreen_;                   // eye to the middle of the screen
    Vec3 up_, left_;                  // unit
    double pixelHeight_, pixelWidth_; // on the screen
    double halfRows_, halfColumns_;   // rows and columns from the corner to the middle
    bool startsOnScreen_;
};

} // namespace rt::trace
