// rt bench: speed against error of scenes, as a table, as JSON, CSV and a page with plots.
#include <core/cli/build_facts.hpp>
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/interrupt.hpp>
#include <core/cli/load_scene.hpp>
#include <core/cli/output.hpp>
#include <core/octree/octree.hpp>
#include <core/parallel/parallel.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/report/pages.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>

#include <stdlib.h>

namespace rt::cli {

namespace {

constexpr std::uint32_t kWidest =
    160; // binary128 takes a microsecond for what f64 does in ten nanoseconds

std::string cpuModel() {
    std::ifstream file("/proc/cpuinfo");
    for (std::string line; std::getline(file, line);)
        if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
    return "unknown";
}

std::string load() {
    double average = 0;
    if (::getloadavg(&average, 1) != 1) return "unknown";
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), average,
                                       std::chars_format::fixed, 1)
                             .ptr};
}

report::Facts factsOf(const BenchOptions& options, int threads) {
    return {{"rt", std::string(kVersion)},
            {"commit", std::string(kCommit)},
            {"build", std::string(kBuildType) + ", " + std::string(kCompiler)},
            {"CPU", cpuModel()},
            {"SIMD", std::string(octree::Octree::simdLevel())},
            {"threads", std::to_string(threads)},
            {"load before", load()},
            {"rounds", std::to_string(options.rounds)}};
}

/// Smaller, in the same proportions, unless --size is given.
std::vector<std::string> sizeOf(const BenchOptions& options, const scene::Image& image) {
    if (options.resized || image.width <= kWidest) return {};
    const double share = double(kWidest) / image.width;
    const auto height = static_cast<std::uint32_t>(std::lround(image.height * share));
    return {"image.width=" + std::to_string(kWidest),
            "image.height=" + std::to_string(std::max(1u, height))};
}

bool writeText(const std::string& path, const std::string& text, const Console& console,
               scene::Diagnostics& diagnostics) {
    std::vector<std::byte> bytes(text.size());
    std::memcpy(bytes.data(), text.data(), text.size());
    return writeOutput(path, bytes, console, diagnostics);
}

} // namespace

int bench(const BenchOptions& options, Console& console) {
    scene::Diagnostics diagnostics;
    std::error_code ignored; // what is wrong with the folder, checkWritable says
    std::filesystem::create_directories(options.folder, ignored);
    const std::string stem = options.folder + "/";
    checkWritable(stem + "report.html", diagnostics);
    console.report(diagnostics);
    if (diagnostics.failed()) return diagnostics.exitCode();

    const int threads = options.threads ? options.threads : parallel::availableThreads();
    const report::Facts facts = factsOf(options, threads);
    plugin_host::Catalog catalog(plugin_host::searchPath(options.pluginDirs));
    report::Plan plan;
    plan.panels = options.panels, plan.rounds = options.rounds, plan.threads = threads;
    plan.reference = options.reference;
    plan.progress = [&](const std::string& what) { console.detail(what); };
    plan.stop = &stopRequested();
    const Interruptible interruptible;
    std::vector<report::SceneReport> reports;
    for (const std::string& path : options.scenes) {
        diagnostics = {};
        auto loaded = loadScene(path, options, catalog, diagnostics);
        if (loaded) {
            if (const auto smaller = sizeOf(options, loaded->description.image); !smaller.empty())
                loaded = loadScene(path, options, catalog, diagnostics, smaller);
        }
        const auto world = loaded ? plugin_host::lower(loaded->description, catalog, diagnostics,
                                                       {.allowMissing = options.allowMissing})
                                  : std::nullopt;
        console.report(diagnostics);
        if (!world) return diagnostics.exitCode();
        reports.push_back(report::bench(std::filesystem::path(path).stem().string(), *world,
                                        loaded->description, plan));
        if (stopRequested()) {
            console.fail("bench", interruptExitCode(), "interrupted", "no report was written");
            return interruptExitCode();
        }
    }

    diagnostics = {};
    bool written =
        writeText(stem + "report.json", report::asJson(reports, facts), console, diagnostics) &&
        writeText(stem + "report.csv", report::asCsv(reports), console, diagnostics) &&
        writeText(stem + "report.html", report::asHtml(reports, facts), console, diagnostics);
    for (const report::SceneReport& report : reports)
        for (const char panel : options.panels)
            if (const std::string svg = report::asSvg(report, panel); written && !svg.empty())
                written = writeText(stem + report.scene + "_" + char(panel - 'A' + 'a') + ".svg",
                                    svg, console, diagnostics);
    console.report(diagnostics);
    if (!written) return diagnostics.exitCode();
    if (!options.pareto) {
        console.result(report::asTable(reports) + stem + "report.html\n");
        return kExitOk;
    }
    console.table(report::asTable(reports));
    report::Wanted wanted;
    wanted.maxWrong = options.maxWrong.value_or(wanted.maxWrong);
    wanted.maxRmse = options.maxRmse.value_or(wanted.maxRmse);
    wanted.seconds = options.budget.value_or(wanted.seconds);
    const report::Choice choice = report::choose(reports, wanted);
    if (!choice.found) {
        console.fail("bench", kExitDifferent, choice.sentence, "");
        return kExitDifferent;
    }
    console.table(choice.sentence + "\n");
    console.result(choice.flags + "\n");
    return kExitOk;
}

} // namespace rt::cli
