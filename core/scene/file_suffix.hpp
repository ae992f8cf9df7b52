// What a file's name says of what reads it.
#pragma once
#include <string>

namespace rt::scene {

/// Lower case, without the dot; that of the inner name for `.gz`.
std::string fileSuffix(const std::string& path);

} // namespace rt::scene
