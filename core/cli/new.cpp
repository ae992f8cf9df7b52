// rt new: a first scene, or the project of a plugin.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/first_scene.hpp>
#include <core/plugin_host/new_project.hpp>
#include <formats/atomic_file.hpp>

#include <span>
#include <system_error>
#include <variant>

namespace rt::cli {
namespace {

namespace fs = std::filesystem;
using Written = std::variant<std::vector<fs::path>, std::string>; // or why nothing was

Written writeFirstScene(const NewOptions& options) {
    if (options.name.find('/') != std::string::npos)
        return "the name of a scene has no '/': --folder tells where it goes";
    fs::path file = fs::path(options.folder) / options.name;
    if (file.extension() != ".yaml") file += ".yaml";
    if (fs::exists(fs::symlink_status(file))) return "'" + file.string() + "' exists already";
    std::string text(kFirstScene);
    constexpr std::string_view kName = "NAME";
    for (std::size_t at = 0; (at = text.find(kName, at)) != std::string::npos;)
        text.replace(at, kName.size(), file.stem().string());
    try {
        if (!options.folder.empty()) fs::create_directories(options.folder);
        formats::writeFileAtomically(file.string(), std::as_bytes(std::span(text)));
    } catch (const std::system_error& error) {
        return error.what();
    }
    return std::vector{file};
}

Written writePlugin(const NewOptions& options) {
    const scene::TypeKind kind = options.kind == "shape"     ? scene::TypeKind::shape
                                 : options.kind == "texture" ? scene::TypeKind::texture
                                                             : scene::TypeKind::loader;
    return plugin_host::writeNewProject(kind, options.name,
                                        options.folder.empty() ? options.name : options.folder);
}

} // namespace

int newFiles(const NewOptions& options, Console& console) {
    const Written written =
        options.kind == "scene" ? writeFirstScene(options) : writePlugin(options);
    if (const auto* const reason = std::get_if<std::string>(&written)) {
        console.fail("new", kExitOutput, *reason, "");
        return kExitOutput;
    }
    for (const fs::path& file : std::get<std::vector<fs::path>>(written))
        console.result(file.string() + "\n");
    return kExitOk;
}

} // namespace rt::cli
