// What a ray is traced for.
#pragma once
#include <core/numeric/colour.hpp>

#include <cstdint>

namespace rt::trace {

/// And how much of what it sees reaches the picture.
struct Work {
    numeric::LinearRgb weight{1, 1, 1};
    std::uint32_t depth = 0; // bounces so far
    std::uint32_t term = 0;  // a PathSums::Term: to which it contributes
    std::uint32_t node = 0;  // the observer's number for this ray
};

} // namespace rt::trace
