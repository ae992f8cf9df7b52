// What a loader's report on a mesh says, for people.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <string>

namespace rt::cli {

/// Its counts, a line for each thing counted. `report`: the JSON of a loader's repair.
std::string meshSummary(const std::string& report);

/// Its sentences, as notes on the file.
void noteRepairs(const std::string& file, const std::string& report,
                 scene::Diagnostics& diagnostics);

} // namespace rt::cli
