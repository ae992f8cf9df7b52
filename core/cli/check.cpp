// rt check: everything that rendering would complain of, files and plugins included, without rendering.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/load_scene.hpp>
#include <core/plugin_host/lower.hpp>

namespace rt::cli {

int check(const CheckOptions& options, Console& console) {
    plugin_host::Catalog catalog(plugin_host::searchPath(options.pluginDirs));
    int exitCode = kExitOk;
    for (const std::string& path : options.scenes) {
        scene::Diagnostics diagnostics;
        if (const auto loaded = loadScene(path, options, catalog, diagnostics))
            plugin_host::lower(loaded->description, catalog, diagnostics,
                               {.allowMissing = options.allowMissing, .limits = options.limits});
        console.report(diagnostics);
        if (!diagnostics.failed() && !console.quiet()) console.result(path + ": no errors\n");
        if (exitCode == kExitOk) exitCode = diagnostics.exitCode();
    }
    return exitCode;
}

} // namespace rt::cli
