// --stats: what a render cost, as a table or as JSON.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/cli/console.hpp>
#include <core/cli/draw_frame.hpp>
#include <core/octree/octree.hpp>
#include <core/scene/description.hpp>
#include <core/trace/render.hpp>
#include <core/world/world.hpp>

#include <chrono>
#include <string>
#include <vector>

namespace rt::cli {

/// Wall and CPU time of each part of a run; CPU time is that of all threads.
class Phases {
public:
    struct Phase {
        std::string name;
        double wallSeconds = 0, cpuSeconds = 0;
    };
    /// Ends the phase before.
    void begin(const std::string& name);
    void end();
    const std::vector<Phase>& all() const { return phases_; }

private:
    std::vector<Phase> phases_;
    bool running_ = false;
    std::chrono::steady_clock::time_point wall_;
    double cpu_ = 0;
};

struct Statistics {
    const Phases& phases;
    const RenderOptions& options;
    const scene::Description& description;
    const world::World& world;
    octree::Statistics tree;
    const trace::Result& result;
    int threads;
};

/// To stderr, or to the file that the options name.
void reportStatistics(const Statistics& statistics, const Console& console,
                      scene::Diagnostics& diagnostics);

/// Of a film: what its frames took, and how the octree followed the motion and why so.
void reportStatistics(const FilmStatistics& statistics, const RenderOptions& options,
                      const Console& console, scene::Diagnostics& diagnostics);
/// The latter in a sentence.
std::string octreeSummary(const FilmStatistics& statistics);

} // namespace rt::cli
