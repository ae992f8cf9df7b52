// Axis-aligned boxes. f64 boxes bound shapes; f32 boxes only prune, and are made by rounding
// outward.
#pragma once
#include <core/numeric/rounding.hpp>
#include <core/numeric/vec.hpp>

#include <array>

namespace rt::numeric {

struct Box3d {
    Vec3 min{kInfinity}, max{-kInfinity}; // empty until something is added

    void add(const Vec3& p) { min = componentMin(min, p), max = componentMax(max, p); }
    void add(const Box3d& b) { min = componentMin(min, b.min), max = componentMax(max, b.max); }
    bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    Vec3 diagonal() const { return max - min; }
    Vec3 centre() const { return min + (max - min) * 0.5; }
};

struct Box3f {
    std::array<float, 3> min, max;
};

/// The smallest f32 box that holds `b`.
inline Box3f roundOutward(const Box3d& b) {
    return {{roundDown(b.min.x), roundDown(b.min.y), roundDown(b.min.z)},
            {roundUp(b.max.x), roundUp(b.max.y), roundUp(b.max.z)}};
}

} // namespace rt::numeric
