#include <core/cli/statistics.hpp>

#include <core/cli/build_facts.hpp>
#include <core/cli/output.hpp>

#include <nlohmann/json.hpp>

#include <charconv>
#include <cstdio>
#include <cstring>

#include <sys/resource.h>
#include <time.h>

namespace rt::cli {

namespace {

using Json = nlohmann::ordered_json;

double processCpuSeconds() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) / 1'000'000'000;
}

std::uint64_t peakBytes() {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

Json asJson(const Statistics& s) {
    Json phases = Json::array();
    for (const Phases::Phase& phase : s.phases.all())
        phases.push_back({{"name", phase.name},
                          {"wall_seconds", phase.wallSeconds},
                          {"cpu_seconds", phase.cpuSeconds}});
    const trace::RayCounts& c = s.result.counts;
    return {{"rt", std::string(kVersion)},
            {"commit", std::string(kCommit)},
            {"scene", s.options.scene},
            {"width", s.result.frame.width},
            {"height", s.result.frame.height},
            {"threads", s.threads},
            {"simd", std::string(octree::Octree::simdLevel())},
            {"phases", phases},
            {"primitives", s.world.primitives.count()},
            {"rays",
             {{"primary", c.primary},
              {"reflected", c.reflected},
              {"refracted", c.refracted},
              {"shadow", c.shadow}}},
            {"tests",
             {{"nodes", c.visits.nodes},
              {"triangles", c.visits.triangles},
              {"spheres", c.visits.spheres},
              {"parallelograms", c.visits.parallelograms},
              {"customs", c.visits.customs}}},
            {"hits",
             {{"triangles", c.hits[0]},
              {"spheres", c.hits[1]},
              {"parallelograms", c.hits[2]},
              {"customs", c.hits[3]},
              {"blocked_shadow", c.blocked}}},
            {"octree",
             {{"depth", s.tree.depth},
              {"nodes", s.tree.nodes},
              {"leaves", s.tree.leaves},
              {"bytes", s.tree.bytes},
              {"leaf_histogram", s.tree.leafHistogram}}},
            {"deepest_recursion", c.deepest},
            {"cut_by_depth", c.cutByDepth},
            {"cut_by_contribution", c.cutByContribution},
            {"lost_by_depth", c.lostByDepth},
            {"not_finite", c.notFinite},
            {"estimated_error", s.result.estimatedError ? Json(*s.result.estimatedError) : Json()},
            {"peak_memory_bytes", peakBytes()}};
}

std::string grouped(std::uint64_t value) {
    std::string digits = std::to_string(value);
    for (std::size_t at = digits.size(); at > 3;) digits.insert(at -= 3, 1, ' ');
    return digits;
}

std::string milliseconds(double seconds) {
    return grouped(static_cast<std::uint64_t>(seconds * 1000 + 0.5)) + " ms";
}

std::string padded(std::string left, std::size_t width) {
    if (left.size() < width) left.insert(0, width - left.size(), ' ');
    return left;
}

std::string shortest(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

double meanOf(double sum, std::uint64_t count) {
    return count ? sum / static_cast<double>(count) : 0;
}

std::string fineMilliseconds(double seconds) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2f ms", seconds * 1000);
    return text;
}

/// Why the octree of most frames was made as it was.
std::string reasonOf(const FilmStatistics& s) {
    if (s.lowered) return "keyframes change the shapes themselves";
    if (s.foreseen > s.updated) return "updates were measured to take longer";
    if (s.gaveUp * 2 > s.updated) return "too much moved for an update to follow";
    if (s.updated) return "updates were measured to take less";
    return "there was one frame";
}

Json asJson(const FilmStatistics& s, const RenderOptions& options) {
    return {{"rt", std::string(kVersion)},
            {"commit", std::string(kCommit)},
            {"scene", options.scene},
            {"frames", s.frames},
            {"simd", std::string(octree::Octree::simdLevel())},
            {"wall_seconds",
             {{"poses", s.poseSeconds},
              {"octree", s.buildSeconds + s.updateSeconds},
              {"trace", s.traceSeconds}}},
            {"primitives", s.primitives},
            {"octree",
             {{"updated_frames", s.updated},
              {"update_seconds", meanOf(s.updateSeconds, s.updated)},
              {"built_frames", s.built},
              {"build_seconds", meanOf(s.buildSeconds, s.built)},
              {"built_for_new_shapes", s.lowered},
              {"built_for_speed", s.foreseen},
              {"updates_that_built_all", s.gaveUp},
              {"moved", s.moved},
              {"entered_elsewhere", s.entered},
              {"rebuilt", s.rebuilt},
              {"reason", reasonOf(s)}}},
            {"peak_memory_bytes", peakBytes()}};
}

void writeJson(const Json& json, const std::string& file, const Console& console,
               scene::Diagnostics& diagnostics) {
    const std::string text = json.dump(2) + "\n";
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    writeOutput(file, bytes, console, diagnostics);
}

std::string asTable(const FilmStatistics& s) {
    std::string text;
    const auto row = [&](std::string name, const std::string& value, const std::string& each = "") {
        name.resize(28, ' ');
        text += name + padded(value, 16) + (each.empty() ? "" : padded(each, 16)) + "\n";
    };
    const auto times = [&](const std::string& name, double seconds, std::uint64_t count) {
        row(name, milliseconds(seconds), fineMilliseconds(meanOf(seconds, count)));
    };
    row("frames", grouped(s.frames));
    row("", "wall", "each");
    times("  poses", s.poseSeconds, s.frames);
    times("  octree updated", s.updateSeconds, s.updated);
    times("  octree built anew", s.buildSeconds, s.built);
    times("  traced", s.traceSeconds, s.frames);
    row("primitives", grouped(s.primitives));
    const auto perUpdate = [&](const std::string& name, std::uint64_t count) {
        row(name, grouped(count), grouped(s.updated ? count / s.updated : 0));
    };
    row("octree", "all", "each update");
    row("  frames updated", grouped(s.updated));
    row("  frames built anew", grouped(s.built));
    perUpdate("  primitives moved", s.moved);
    perUpdate("  that left their place", s.entered);
    perUpdate("  rebuilt", s.rebuilt);
    row("peak memory", grouped(peakBytes() / 1024) + " kB");
    return text + octreeSummary(s) + "\n";
}

std::string asTable(const Statistics& s) {
    constexpr std::size_t kNameWidth = 24, kNumberWidth = 16;
    std::string text;
    const auto row = [&](std::string name, const std::string& value, const std::string& more = "") {
        name.resize(kNameWidth, ' ');
        text += name + padded(value, kNumberWidth) +
                (more.empty() ? "" : padded(more, kNumberWidth)) + "\n";
    };
    row("phase", "wall", "cpu");
    double wall = 0, cpu = 0;
    for (const Phases::Phase& phase : s.phases.all()) {
        row("  " + phase.name, milliseconds(phase.wallSeconds), milliseconds(phase.cpuSeconds));
        wall += phase.wallSeconds, cpu += phase.cpuSeconds;
    }
    row("  all", milliseconds(wall), milliseconds(cpu));
    const trace::RayCounts& c = s.result.counts;
    row("rays", grouped(c.primary + c.reflected + c.refracted + c.shadow));
    row("  primary", grouped(c.primary));
    row("  reflected", grouped(c.reflected));
    row("  refracted", grouped(c.refracted));
    row("  shadow", grouped(c.shadow));
    row("    that meet something", grouped(c.blocked));
    row("", "tests", "nearest hits");
    row("  octree nodes", grouped(c.visits.nodes));
    row("  triangles", grouped(c.visits.triangles), grouped(c.hits[0]));
    row("  spheres", grouped(c.visits.spheres), grouped(c.hits[1]));
    row("  parallelograms", grouped(c.visits.parallelograms), grouped(c.hits[2]));
    row("  customs", grouped(c.visits.customs), grouped(c.hits[3]));
    row("deepest recursion", grouped(c.deepest));
    row("cut by depth", grouped(c.cutByDepth));
    row("cut by contribution", grouped(c.cutByContribution));
    row("not finite", grouped(c.notFinite));
    if (s.result.estimatedError) row("estimated error", shortest(*s.result.estimatedError));
    row("primitives", grouped(s.world.primitives.count()));
    row("octree depth", grouped(s.tree.depth));
    row("  nodes", grouped(s.tree.nodes));
    row("  leaves", grouped(s.tree.leaves));
    row("  bytes", grouped(s.tree.bytes));
    for (std::size_t n = 0; n < s.tree.leafHistogram.size(); ++n)
        if (s.tree.leafHistogram[n])
            row("  leaves of " + std::to_string(n), grouped(s.tree.leafHistogram[n]));
    row("peak memory", grouped(peakBytes() / 1024) + " kB");
    return text;
}

} // namespace

void Phases::begin(const std::string& name) {
    end();
    phases_.push_back({name});
    running_ = true;
    wall_ = std::chrono::steady_clock::now();
    cpu_ = processCpuSeconds();
}

void Phases::end() {
    if (!running_) return;
    running_ = false;
    phases_.back().wallSeconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_).count();
    phases_.back().cpuSeconds = processCpuSeconds() - cpu_;
}

void reportStatistics(const Statistics& statistics, const Console& console,
                      scene::Diagnostics& diagnostics) {
    if (statistics.options.statisticsFile.empty()) return console.table(asTable(statistics));
    writeJson(asJson(statistics), statistics.options.statisticsFile, console, diagnostics);
}

void reportStatistics(const FilmStatistics& statistics, const RenderOptions& options,
                      const Console& console, scene::Diagnostics& diagnostics) {
    if (options.statisticsFile.empty()) return console.table(asTable(statistics));
    writeJson(asJson(statistics, options), options.statisticsFile, console, diagnostics);
}

std::string octreeSummary(const FilmStatistics& s) {
    std::string text = "octree: updated in " + grouped(s.updated) + " of " +
                       grouped(s.built + s.updated) + " frames";
    if (s.updated)
        text += ", " + fineMilliseconds(meanOf(s.updateSeconds, s.updated)) + " each for " +
                grouped(s.moved / s.updated) + " of " + grouped(s.primitives) + " primitives moved";
    if (s.built)
        text += "; built anew in " + grouped(s.built) + ", " +
                fineMilliseconds(meanOf(s.buildSeconds, s.built)) + " each";
    return text + ": " + reasonOf(s);
}

} // namespace rt::cli
