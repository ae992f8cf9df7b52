#include <core/trace/scene_box.hpp>

#include <core/numeric/rounding.hpp>

#include <algorithm>

namespace rt::trace {

using numeric::kInfinity;
using numeric::Vec3;

SceneBox::SceneBox(const std::optional<numeric::Box3d>& bounds) : bounds_(bounds) {
    if (bounds_)
        magnitude_ = std::max(numeric::maxComponent(numeric::abs(bounds_->min)),
                              numeric::maxComponent(numeric::abs(bounds_->max)));
}

SceneBox::Span SceneBox::span(const geometry::Ray& ray) const {
    // A hit on a face is off its plane by the error of the hit (γ12 of its coordinates at most, see
    // geometry::surfaceAt) and the plane's t by 2 roundings; γ32 covers both, for origins too.
    const double slack =
        numeric::gamma(32) * (magnitude_ + numeric::maxComponent(numeric::abs(ray.origin)));
    Span span{-kInfinity, kInfinity};
    for (int axis = 0; axis < 3; ++axis) {
        const double low = bounds_->min[axis] - slack - ray.origin[axis];
        const double high = bounds_->max[axis] + slack - ray.origin[axis];
        const double direction = ray.direction[axis];
        if (direction == 0) {
            if (low > 0 || high < 0) return {kInfinity, -kInfinity};
            continue;
        }
        const double a = low / direction, b = high / direction;
        span.enter = std::max(span.enter, std::min(a, b));
        span.leave = std::min(span.leave, std::max(a, b));
    }
    return span;
}

bool SceneBox::clipStartAndEnd(geometry::Ray& ray) const {
    const Span inside = span(ray);
    if (!(inside.enter <= inside.leave && inside.leave > 0)) return false;
    const double start = std::max(inside.enter, 0.0);
    ray.origin += ray.direction * start;
    ray.tMax = std::min(ray.tMax, inside.leave) - start;
    return ray.tMax > 0;
}

void SceneBox::clipEndOnly(geometry::Ray& ray) const {
    ray.tMax = std::min(ray.tMax, std::max(span(ray).leave, 0.0));
}

} // namespace rt::trace
