// rt convert: .inf scenes to YAML.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/output.hpp>
#include <core/plugin_host/catalog.hpp>
#include <core/scene/validate.hpp>
#include <formats/yaml_reader.hpp>
#include <formats/yaml_writer.hpp>

#include <cstring>
#include <filesystem>

namespace rt::cli {

namespace {

namespace fs = std::filesystem;

constexpr scene::Code kWouldReplace{607};

int convertOne(const std::string& path, const ConvertOptions& options,
               plugin_host::Catalog& catalog, Console& console) {
    scene::Diagnostics diagnostics;
    const bool given = !options.output.empty();
    const std::string output =
        given ? options.output : fs::path(path).replace_extension(".yaml").string();
    std::optional<std::string> text;
    converters::InfOptions inf{.lenient = options.lenient,
                               .windowOrder = options.windowOrder,
                               .moviePath = options.movie,
                               .outputFolder = {}};
    if (given && output != "-") inf.outputFolder = fs::absolute(output).parent_path().string();
    if (const auto root = converters::convertInf(path, inf, diagnostics))
        text = formats::writeYaml(*root);
    if (options.jsonNotes)
        for (const scene::Diagnostic& diagnostic : diagnostics.all())
            if (diagnostic.severity != scene::Severity::error)
                console.result(scene::formatJson(diagnostic) + "\n");
    if (text && options.check) {
        // What would be written, under the name it would have, so that its relative paths mean the same.
        const auto source = std::make_shared<scene::Source>(
            scene::Source{output == "-" ? "scene.yaml" : output, *text});
        if (const auto root = formats::parseYaml(source, diagnostics))
            scene::validate(*root, catalog, diagnostics);
    } else if (text) {
        if (!given && fs::exists(output))
            diagnostics.error(
                kWouldReplace, {std::make_shared<scene::Source>(scene::Source{output, {}}), 0, 0},
                "exists already and may have been edited", "to replace it: -o " + output);
        if (output != "-" && !diagnostics.failed()) checkWritable(output, diagnostics);
        if (!diagnostics.failed()) {
            std::vector<std::byte> bytes(text->size());
            std::memcpy(bytes.data(), text->data(), text->size());
            if (writeOutput(output, bytes, console, diagnostics) && output != "-")
                console.result(output + "\n");
        }
    }
    console.report(diagnostics);
    if (options.check && !diagnostics.failed() && !console.quiet())
        console.result(path + ": no errors\n");
    return diagnostics.exitCode();
}

} // namespace

int convert(const ConvertOptions& options, Console& console) {
    if (options.files.size() > 1 && !options.output.empty())
        throw UsageError("--output is for one FILE only");
    if (options.files.size() > 1 && !options.movie.empty())
        throw UsageError("--movie is for one FILE only");
    if (options.jsonNotes && options.output == "-")
        throw UsageError("--json-notes and -o - both want stdout");
    plugin_host::Catalog catalog(plugin_host::searchPath(options.pluginDirs));
    int exitCode = kExitOk;
    for (const std::string& path : options.files) {
        const int code = convertOne(path, options, catalog, console);
        if (exitCode == kExitOk) exitCode = code;
    }
    return exitCode;
}

} // namespace rt::cli
