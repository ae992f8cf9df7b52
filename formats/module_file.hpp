// Modules that are built and installed with the program: codecs, the window, films.
#pragma once

namespace rt::formats {

/// The address of `symbol` in <exe>/../lib/rt/`file`, which stays open: OpenCV does not survive dlclose. `what` is "the
/// image codec". Throws std::runtime_error where the module is missing or damaged.
const void* openModule(const char* file, const char* symbol, const char* what);

/// Throws std::runtime_error: the module's table is of another layout than this program's.
[[noreturn]] void refuseForeignModule(const char* file, const char* what);

} // namespace rt::formats
