// Whitted rendering of one frame: tiles over threads, the same bytes for any number of them.
#pragma once
#include <core/image/framebuffer.hpp>
#include <core/octree/octree.hpp>
#include <core/scene/description.hpp>
#include <core/world/world.hpp>

#include <array>
#include <atomic>
#include <functional>
#include <optional>

namespace rt::trace {

enum class Shade : std::uint8_t { full, normals, depth, id, cost };

struct Options {
    int threads = 0;                                   // 0: all that the process may use
    Shade shade = Shade::full;
    std::optional<std::array<std::uint32_t, 4>> crop;  // x0, y0, x1, y1 in pixels; only these are traced
    const std::atomic<bool>* stop = nullptr;           // polled between tiles
    std::function<void(double share)> progress;        // called from one thread at a time, share in [0, 1]
    bool count = false;                                // fill the visit counters
};

struct RayCounts {
    std::uint64_t primary = 0, reflected = 0, refracted = 0, shadow = 0;
    std::uint64_t cutByDepth = 0, cutByContribution = 0, notFinite = 0;
    std::uint32_t deepest = 0; // recursion depth reached
    octree::Visits visits;
};

struct Result {
    image::Framebuffer frame; // linear, after tone and smooth as the scene asks
    bool complete = true;     // false: stopped; pixels not reached are black
    RayCounts counts;
};

Result render(const octree::Octree& octree, const world::World& world, const scene::Description& description,
              const Options& options);

} // namespace rt::trace
