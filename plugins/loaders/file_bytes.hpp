// A whole file in memory: regular files only, gzip unpacked, never more than a limit.
#pragma once
#include <cstdint>
#include <string>

namespace rt::loaders {

/// Most bytes that a mesh may unpack to.
inline constexpr std::uint64_t kLargestMesh = std::uint64_t{4} << 30;
/// Most bytes of a material library.
inline constexpr std::uint64_t kLargestLibrary = std::uint64_t{64} << 20;

/// The bytes of the regular file at `path`; a file that begins with gzip's magic is unpacked.
/// Throws FileError, beginning with the file's name, when it cannot be opened or read, is no regular
/// file, is damaged gzip or longer than `limit`.
std::string readFile(const std::string& path, std::uint64_t limit);

} // namespace rt::loaders
