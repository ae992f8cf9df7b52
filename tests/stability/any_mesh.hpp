// The cases that any mesh allows: leaks at its edges, boxes that lose hits, rays that meet what they leave.
#pragma once
#include <tests/stability/table.hpp>

#include <string>

namespace rt::stability {

/// Loads `file` as a scene would. Returns what it holds. Throws std::runtime_error with the loader's message.
std::string checkMesh(const std::string& file, std::uint64_t rays, std::uint64_t seed,
                      Table& table);

} // namespace rt::stability
