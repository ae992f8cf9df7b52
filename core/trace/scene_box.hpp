// The box outside of which a scene with `bounds` shows nothing.
#pragma once
#include <core/geometry/ray.hpp>
#include <core/numeric/box.hpp>

#include <optional>

namespace rt::trace {

/// Planes count as inside: a floor that lies in the lowest face is seen. To that end the box is
/// widened by what rounding can do to a point on its faces.
class SceneBox {
public:
    SceneBox() = default;
    explicit SceneBox(const std::optional<numeric::Box3d>& bounds);

    bool unbounded() const { return !bounds_; }

    /// Slides a start outside the box to where the ray enters it and ends the ray where it leaves.
    /// False when the ray never enters.
    bool clip(geometry::Ray& ray) const { return !bounds_ || clipStartAndEnd(ray); }

    /// Ends a ray that starts inside where it leaves the box.
    void clipEnd(geometry::Ray& ray) const {
        if (bounds_) clipEndOnly(ray);
    }

private:
    double slack(const geometry::Ray& ray) const;
    /// Parameters of the ray's line. Leaves at -infinity where it runs beside the box along its faces.
    double enter(const geometry::Ray& ray) const;
    double leave(const geometry::Ray& ray) const;
    bool clipStartAndEnd(geometry::Ray& ray) const;
    void clipEndOnly(geometry::Ray& ray) const;

    std::optional<numeric::Box3d> bounds_;
    double magnitude_ = 0; // largest coordinate of the box
};

} // namespace rt::trace
