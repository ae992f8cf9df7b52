// Angles have a type; degrees exist only in readers and writers.
#pragma once
#include <numbers>

namespace rt::numeric {

struct Radians {
    double value = 0;
};

inline constexpr double kRadiansPerDegree = std::numbers::pi / 180;

} // namespace rt::numeric
