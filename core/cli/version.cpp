// rt version: the build, and what this machine makes of it.
#include <core/cli/build_facts.hpp>
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/octree/octree.hpp>
#include <core/parallel/parallel.hpp>
#include <core/plugin_host/catalog.hpp>

namespace rt::cli {

int version(const VersionOptions&, Console& console) {
    std::string text = "rt " + std::string(kVersion) + "\n";
    const auto line = [&](std::string name, const std::string& value) {
        name.resize(12, ' ');
        text += name + value + "\n";
    };
    line("commit", std::string(kCommit));
    line("build", std::string(kBuildType));
    line("compiler", std::string(kCompiler));
    line("libraries", std::string(kLibraries));
    line("plugin ABI", std::to_string(RT_ABI_MAJOR) + "." + std::to_string(RT_ABI_MINOR));
    line("SIMD", std::string(octree::Octree::simdLevel()));
    line("threads", std::to_string(parallel::availableThreads()));
    std::string path;
    for (const auto& folder : plugin_host::searchPath({}))
        path += (path.empty() ? "" : ":") + folder.string();
    line("plugins", path);
    console.result(text);
    return kExitOk;
}

} // namespace rt::cli
