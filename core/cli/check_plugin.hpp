// rt plugins --check: a module held against the rules, with the example of its own documentation.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/cli/console.hpp>

namespace rt::cli {

/// What was checked on stdout, faults on stderr; exit code 5 when there are any.
int checkPlugin(const PluginsOptions& options, Console& console);

} // namespace rt::cli
