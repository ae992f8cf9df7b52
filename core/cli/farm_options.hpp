// The options of farms.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/cli/option_rows.hpp>

namespace rt::cli {

/// All of `rt farm`.
void addFarmOptions(OptionRows& rows, FarmOptions& options);
/// All of `rt task`.
void addTaskOptions(OptionRows& rows, TaskOptions& options);

} // namespace rt::cli
