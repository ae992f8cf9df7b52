// rt schema
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/plugin_host/catalog.hpp>
#include <core/scene/validate.hpp>

namespace rt::cli {

int schema(const SchemaOptions& options, Console& console) {
    plugin_host::Catalog catalog(plugin_host::searchPath(options.pluginDirs));
    std::string text = scene::jsonSchema(catalog);
    if (text.empty() || text.back() != '\n') text += '\n';
    console.result(text);
    return kExitOk;
}

} // namespace rt::cli
