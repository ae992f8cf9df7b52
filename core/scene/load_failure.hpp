// The C library's words where a shared library cannot be loaded.
#pragma once
#include <string>

namespace rt::scene {

/// What dlerror() said after a failed dlopen, for a message. Throws std::bad_alloc where that means lack of memory, of no fault of
/// the library's; for one at `readable`, a path that could just be opened, "cannot open" means it too.
std::string loadFailure(const char* said, const std::string& readable = {});

} // namespace rt::scene
