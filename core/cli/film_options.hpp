// The options of films.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/cli/option_rows.hpp>

namespace rt::cli {

/// Of `rt render`.
void addFilmOptions(OptionRows& rows, RenderOptions& options);
/// All of `rt encode`.
void addEncodeOptions(OptionRows& rows, EncodeOptions& options);

} // namespace rt::cli
