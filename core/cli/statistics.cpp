#include <core/cli/statistics.hpp>

#include <core/cli/build_facts.hpp>
#include <core/cli/output.hpp>

#include <nlohmann/json.hpp>

#include <charconv>
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
    const std::string text = asJson(statistics).dump(2) + "\n";
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    writeOutput(statistics.options.statisticsFile, bytes, console, diagnostics);
}

} // namespace rt::cli
