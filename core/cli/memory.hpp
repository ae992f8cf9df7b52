// How much memory a picture takes, and how much there is.
#pragma once
#include <core/scene/description.hpp>
#include <core/scene/diagnostic.hpp>
#include <core/scene/limits.hpp>

namespace rt::cli {

/// Bytes of memory that this process may use: the machine's, or less where its control group has less.
std::uint64_t machineMemory();

/// With --limit-memory: from now on an allocation beyond it fails, in libraries and plugins too, and the program ends with
/// exit 7 (RLIMIT_DATA).
void enforceMemoryLimit(const scene::Limits& limits);

/// Gains E0715 where the picture alone would take more than limits.memory, or than machineMemory(). Nothing is allocated.
void checkPictureFits(const scene::Image& image, const scene::Limits& limits,
                      const scene::Location& location, scene::Diagnostics& diagnostics);

} // namespace rt::cli
