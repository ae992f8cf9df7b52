// rt new: the project of a plugin.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/plugin_host/new_project.hpp>

namespace rt::cli {

int newPlugin(const NewOptions& options, Console& console) {
    const scene::TypeKind kind = options.kind == "shape"     ? scene::TypeKind::shape
                                 : options.kind == "texture" ? scene::TypeKind::texture
                                                             : scene::TypeKind::loader;
    const auto written = plugin_host::writeNewProject(
        kind, options.name, options.folder.empty() ? options.name : options.folder);
    if (const auto* const reason = std::get_if<std::string>(&written)) {
        console.fail("new", kExitOutput, *reason, "");
        return kExitOutput;
    }
    for (const auto& file : std::get<std::vector<std::filesystem::path>>(written))
        console.result(file.string() + "\n");
    return kExitOk;
}

} // namespace rt::cli
