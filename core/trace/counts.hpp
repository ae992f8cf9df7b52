// What a render counted; sums over tiles in tile order, so the same for any number of threads.
#pragma once
#include <core/octree/octree.hpp>

#include <array>
#include <cstdint>

namespace rt::trace {

struct RayCounts {
    std::uint64_t primary = 0, reflected = 0, refracted = 0, shadow = 0;
    std::uint64_t cutByDepth = 0, cutByContribution = 0;
    std::uint64_t notFinite = 0; // samples that were not a number or infinite, drawn black
    double lostByDepth = 0;      // sum over samples of the largest weight of each ray cut by depth
    std::uint32_t deepest = 0;   // bounces
    /// Filled with the visits. Nearest hits of all but shadow rays, by kind of primitive.
    std::array<std::uint64_t, 4> hits{}; // [geometry::Kind]
    std::uint64_t blocked = 0;           // shadow rays that meet something, be it transparent
    octree::Visits visits;

    RayCounts& operator+=(const RayCounts& o);
};

} // namespace rt::trace
