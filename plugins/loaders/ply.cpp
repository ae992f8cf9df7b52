#include "ply.hpp"

namespace rt::loaders {

MeshFile readPly(const std::string& path, std::string) {
    throw FileError(std::string(fileName(path)) + ": PLY is not read yet");
}

} // namespace rt::loaders
