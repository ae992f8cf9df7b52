// One plugin file: all the checks that stand between a path and a usable rt_module.
#pragma once
#include <rt/plugin.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rt::plugin_host {

inline constexpr std::string_view kModuleSuffix = ".rtplugin.so";

/// [a-z][a-z0-9_]{0,63}
bool isTypeName(std::string_view name);

/// The stem of a file called NAME.rtplugin.so, or nothing.
std::string_view stemOf(std::string_view fileName);

/// The module, open until the process ends, or a clause that continues "PATH was refused: ". Checks
/// in order: name; real path inside one of `trusted` (canonical folders); owner and mode; ELF and
/// stamp in the file; only then it opens the file, and holds what it finds against the rules of
/// plugin.h. Throws only std::bad_alloc, never prints.
std::variant<const rt_module*, std::string>
openModule(const std::filesystem::path& path, const std::vector<std::filesystem::path>& trusted);

/// Empty: the rows obey plugin.h. Otherwise such a clause.
std::string whyRowsAreWrong(const rt_param* rows, std::uint32_t count, bool mayLoad);

} // namespace rt::plugin_host
