#include <core/trace/scene_box.hpp>

#include <core/numeric/bits.hpp>

#include <algorithm>

namespace rt::trace {

using numeric::kInfinity;
using numeric::Vec3;

SceneBox::SceneBox(const std::optional<numeric::Box3d>& bounds) : bounds_(bounds) {
    if (bounds_)
        magnitude_ = std::max(numeric::maxComponent(numeric::abs(bounds_->min)),
                              numeric::maxComponent(numeric::abs(bounds_->max)));
}

double SceneBox::slack(const geometry::Ray& ray) const {
    // A hit on a face is off its plane by the error of the hit (γ12 of its coordinates at most, see
    // geometry::surfaceAt) and the plane's t by 2 roundings; γ32 covers both, for origins too.
    return numeric::gamma(32) *
           (magnitude_ + numeric::bits::maxComponent(numeric::abs(ray.origin)));
}

double SceneBox::enter(const geometry::Ray& ray) const {
    const double margin = slack(ray);
    double last = -kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
        const double direction = ray.direction[axis];
        if (direction == 0) continue; // `leave` tells whether it lies between the planes
        const double plane =
            direction > 0 ? bounds_->min[axis] - margin : bounds_->max[axis] + margin;
        last = std::max(last, (plane - ray.origin[axis]) / direction);
    }
    return last;
}

double SceneBox::leave(const geometry::Ray& ray) const {
    const double margin = slack(ray);
    double first = kInfinity;
    for (int axis = 0; axis < 3; ++axis) {
        const double direction = ray.direction[axis], origin = ray.origin[axis];
        const double low = bounds_->min[axis] - margin - origin;
        const double high = bounds_->max[axis] + margin - origin;
        if (direction != 0)
            first = std::min(first, (direction > 0 ? high : low) / direction);
        else if (low > 0 || high < 0)
            return -kInfinity;
    }
    return first;
}

bool SceneBox::clipStartAndEnd(geometry::Ray& ray) const {
    const double end = leave(ray), start = std::max(enter(ray), 0.0);
    if (!(start <= end && end > 0)) return false;
    ray.origin += ray.direction * start;
    ray.tMax = std::min(ray.tMax, end) - start;
    return ray.tMax > 0;
}

void SceneBox::clipEndOnly(geometry::Ray& ray) const {
    ray.tMax = std::min(ray.tMax, std::max(leave(ray), 0.0));
}

} // namespace rt::trace
