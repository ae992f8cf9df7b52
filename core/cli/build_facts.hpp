// What this binary was built from; the values are in build_facts.cpp, which the build writes (build_facts.cmake).
#pragma once
#include <string_view>

namespace rt::cli {

extern const std::string_view kVersion, kCommit, kBuildType, kCompiler, kLibraries;

} // namespace rt::cli
