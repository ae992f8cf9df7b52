// XXH3, 128 bits: guards against accidents, not against forgery.
#pragma once
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace rt::formats {

/// 32 hexadecimal digits.
std::string checksum(std::span<const std::byte> bytes);
std::string checksum(std::string_view text);
/// Of a file's content; nothing where it cannot be read.
std::optional<std::string> checksumOfFile(const std::string& path);

} // namespace rt::formats
