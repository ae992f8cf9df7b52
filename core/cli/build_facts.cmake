# Writes ${OUTPUT}, only when it changes. The commit is looked up at each build, since configuring is not repeated for it.
find_package(Git QUIET)
set(commit "unknown")
if(GIT_FOUND)
  execute_process(COMMAND ${GIT_EXECUTABLE} -C ${SOURCE_DIR} describe --always --dirty --abbrev=12
                  OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(commit ${described})
  endif()
endif()
file(CONFIGURE OUTPUT ${OUTPUT} CONTENT [[
#include <core/cli/build_facts.hpp>

namespace rt::cli {

const std::string_view kVersion = "@VERSION@", kCommit = "@commit@", kBuildType = "@BUILD_TYPE@", kCompiler = "@COMPILER@",
                       kLibraries = "@LIBRARIES@";

} // namespace rt::cli
]] @ONLY)
