// rt mesh repair: a mesh file without its faults, and a report of them.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/mesh_summary.hpp>
#include <core/cli/output.hpp>
#include <core/plugin_host/repair_file.hpp>
#include <core/scene/file_suffix.hpp>

#include <cstring>
#include <filesystem>
#include <span>

namespace rt::cli {

namespace {

namespace fs = std::filesystem;

std::vector<std::byte> bytesOf(const std::string& text) {
    const auto bytes = std::as_bytes(std::span(text));
    return {bytes.begin(), bytes.end()};
}

/// Material libraries are looked for beside the mesh, so a mesh that goes elsewhere leaves them behind.
void warnOfLibraries(const std::string& mesh, const MeshOptions& options,
                     scene::Diagnostics& diagnostics) {
    if (options.output.empty()) return;
    const bool moves = options.output == "-" || fs::absolute(options.output).parent_path() !=
                                                    fs::absolute(options.file).parent_path();
    if (!moves || !mesh.starts_with("mtllib ")) return;
    diagnostics.warning({std::make_shared<scene::Source>(scene::Source{options.output, {}}), 0, 0},
                        "its material library, " +
                            scene::quoted(mesh.substr(7, mesh.find('\n') - 7)) + ", lies beside " +
                            scene::quoted(options.file) + ": copy it to where the mesh goes");
}

} // namespace

int mesh(const MeshOptions& options, Console& console) {
    if (options.output.empty() && options.report.empty())
        throw UsageError("--output or --report is missing",
                         "try: rt mesh repair " + options.file + " -o repaired.obj");
    if (options.output == "-" && options.report == "-")
        throw UsageError("--output and --report both want stdout");
    if (!options.output.empty() && options.output == options.report)
        throw UsageError("--output and --report name the same file");
    if (!options.output.empty() && options.output != "-" &&
        fs::path(options.output).extension() != ".obj")
        throw UsageError("--output: the mesh is written as OBJ, so its name ends with .obj");

    scene::Diagnostics diagnostics;
    for (const std::string* path : {&options.output, &options.report})
        if (!path->empty() && *path != "-") checkWritable(*path, diagnostics);
    plugin_host::Catalog catalog(plugin_host::searchPath(options.pluginDirs));
    std::optional<plugin_host::RepairedFile> repaired;
    if (!diagnostics.failed())
        repaired = plugin_host::repairFile({.path = options.file,
                                            .level = options.level,
                                            .mesh = !options.output.empty(),
                                            .everyFace = !options.report.empty()},
                                           catalog, diagnostics);
    if (repaired && !options.output.empty() &&
        writeOutput(options.output, bytesOf(repaired->mesh), console, diagnostics) &&
        options.output != "-")
        console.result(options.output + "\n");
    if (repaired && !options.report.empty() && !diagnostics.failed() &&
        writeOutput(options.report, bytesOf(repaired->report), console, diagnostics) &&
        options.report != "-")
        console.result(options.report + "\n");
    if (repaired && !diagnostics.failed()) {
        noteRepairs(options.file, repaired->report, diagnostics);
        warnOfLibraries(repaired->mesh, options, diagnostics);
        console.table(meshSummary(repaired->report));
    }
    console.report(diagnostics);
    return diagnostics.exitCode();
}

} // namespace rt::cli
