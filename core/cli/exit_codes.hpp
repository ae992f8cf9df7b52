// How `rt` ends. The one table; `rt --help` prints it.
#pragma once
#include <string_view>

namespace rt::cli {

enum ExitCode : int {
    kExitOk = 0,
    kExitDifferent = 1,
    kExitUsage = 2,
    kExitScene = 3,
    kExitInput = 4,
    kExitPlugin = 5,
    kExitOutput = 6,
    kExitLimit = 7,
    kExitNoDisplay = 8,
    kExitInternal = 70,
    kExitTransient = 75,
    kExitInterrupted = 130, // 128 + SIGINT; 143 is 128 + SIGTERM
};

inline constexpr std::string_view kExitCodeTable =
    "  0  done                              6  an output cannot be written\n"
    "  1  the pictures differ (compare)     7  a limit or the memory is exceeded\n"
    "  2  wrong command line                8  there is no display\n"
    "  3  the scene has errors             70  internal error: please report it\n"
    "  4  an input file is missing,        75  try again later\n"
    "     unreadable or malformed         130  interrupted (Ctrl-C)\n"
    "  5  a plugin is missing or broken   143  terminated\n";

} // namespace rt::cli
