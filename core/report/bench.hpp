// Speed against error of one scene: in other arithmetics (A), with other sampling (B), with and without its features (C).
#pragma once
#include <core/image/metrics.hpp>
#include <core/report/timing.hpp>
#include <core/trace/counts.hpp>
#include <core/world/world.hpp>

#include <core/scene/description.hpp>

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rt::report {

struct Plan {
    std::string panels = "ABC";
    int rounds = 11;
    int threads = 0;              // of B and C; A is measured on one
    std::uint32_t reference = 16; // of B: two grids, n x n and (n + 1) x (n + 1), and their mean
    std::vector<double> scales{1.0 / 1'000'000, 1.0 / 1000, 1, 1000, 1'000'000}; // of A
    std::function<void(const std::string& what)> progress;
    const std::atomic<bool>* stop = nullptr; // polled between renders
};

/// One configuration of one scene.
struct Row {
    std::string scene;
    char panel = 'A';
    std::string name;  // f64-robust, grid 4, depth 2
    std::string flags; // of rt render, to paste; empty: none would do it
    double scale = 1;  // of the scene, panel A
    bool isDefault = false;

    std::vector<double> wallSeconds, cpuSeconds; // by round
    Spread wall, cpu;
    Interval ratio; // of the CPU time to the default's
    bool noisy = false;

    std::uint64_t rays = 0;
    octree::Visits visits;
    std::uint64_t bytes = 0; // of the octree

    std::optional<image::Difference> error; // against the panel's reference; over: wrong pixels
    bool onFront = false;                   // nothing else is as fast and as right

    std::uint64_t tests() const {
        return visits.triangles + visits.spheres + visits.parallelograms + visits.customs;
    }
    /// CPU.
    double nanosecondsPerRay() const {
        return rays ? cpu.median * 1'000'000'000 / static_cast<double>(rays) : 0;
    }
};

struct SceneReport {
    std::string scene;
    std::uint32_t width = 0, height = 0, primitives = 0;
    std::vector<Row> rows;
    double referenceSigma =
        0;              // of B: RMSE of the mean of the two halves, estimated from their difference
    std::string remark; // why a panel is missing
    bool complete = true;
};

/// Panel A: the product, and the same with an octree of octree::Precision::f32.
inline constexpr const char *kProduct = "f64-robust", *kProductInF32 = "f32-naive";

/// A pixel is wrong when a channel is off by more than this in linear light, or not a number.
inline constexpr double kWrong = 1.0 / 255;

/// Throws std::logic_error when the picture depends on the threads or on the octree.
SceneReport bench(const std::string& name, const world::World& world,
                  const scene::Description& description, const Plan& plan);

/// Median over the scenes of the CPU time of kProduct over that of kProductInF32, at scale 1; none without panel A.
std::optional<double> priceOfRobustness(const std::vector<SceneReport>& reports);

struct Wanted {
    double maxRmse = 1;
    std::uint64_t maxWrong = 0;          // of f64-robust, panel A
    double seconds = numeric::kInfinity; // per frame, median wall time
};
/// The fastest configuration of panel B that does for every scene; a sentence, and the flags for rt render.
struct Choice {
    std::string flags, sentence;
    bool found = false;
};
Choice choose(const std::vector<SceneReport>& reports, const Wanted& wanted);

} // namespace rt::report
