// Whitted rendering of one frame: tiles over threads, the same bytes for any number of them.
#pragma once
#include <core/image/framebuffer.hpp>
#include <core/octree/octree.hpp>
#include <core/scene/description.hpp>
#include <core/trace/counts.hpp>
#include <core/world/world.hpp>

#include <array>
#include <atomic>
#include <functional>
#include <optional>

namespace rt::trace {

/// full: the picture. Otherwise one untoned sample per pixel, black where nothing is hit: normals
/// (n + 1) / 2 of the outward shading normal; depth, the distance from the eye; id, a color per
/// object; cost, the nodes and primitives that all rays of the pixel visited.
enum class Shade : std::uint8_t { full, normals, depth, id, cost };

struct Options {
    int threads = 0; // 0: all that the process may use
    Shade shade = Shade::full;
    /// x0, y0, x1, y1 in pixels, x1 and y1 exclusive; only these are traced, with the same bytes as
    /// in the whole picture (max_error excepted, which is a promise about what is traced).
    std::optional<std::array<std::uint32_t, 4>> crop;
    const std::atomic<bool>* stop = nullptr;    // polled between tiles and rows of tiles
    std::function<void(double share)> progress; // one thread at a time, share in [0, 1]
    bool count = false;                         // fill the visit counters
    bool markNotFinite = false; // samples that are no finite number are magenta instead of black
    /// Seconds for antialias: {max_error}, whose own bound then is the least that is tried for.
    std::optional<double> timeBudget;
};

struct Result {
    image::Framebuffer frame; // linear, after tone and smooth as the scene asks
    bool complete = true;     // false: stopped; pixels not reached are black
    RayCounts counts;
    /// antialias: {max_error} only. The estimated RMSE over the traced pixels and channels, before
    /// smooth. With this very value as max_error the frame has the same bytes.
    std::optional<double> estimatedError;
};

Result render(const octree::Octree& octree, const world::World& world,
              const scene::Description& description, const Options& options);

/// depth and cost scaled to a largest value of 1, for encodings that end there; others unchanged.
void scaleForDisplay(image::Framebuffer& frame, Shade shade);

} // namespace rt::trace
