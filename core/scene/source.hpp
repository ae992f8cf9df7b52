// A text file from disk as a Source, or a located reason why not.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <cstdint>
#include <memory>
#include <string>

namespace rt::scene {

/// The file's bytes, or null after an error: E0401 no such file, E0402 not readable, E0403 not a regular
/// file, E0404 outside of the sandbox, E0710 larger than `maxBytes`. A FIFO or device is refused, never waited for. The error stands at
/// `namedAt` where another file names this one. `ifTooLarge`: what to suggest then.
std::shared_ptr<const Source> readSource(const std::string& path, std::uint64_t maxBytes,
                                         Diagnostics& diagnostics, const Location& namedAt = {},
                                         const std::string& ifTooLarge = {});

} // namespace rt::scene
