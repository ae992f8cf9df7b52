// Stanford PLY, ASCII and binary of either byte order.
#pragma once
#include "mesh_file.hpp"

#include <string>

namespace rt::loaders {

/// Reads the bytes of the PLY file `path`. Elements and properties that are not used are passed over exactly.
/// Used: vertex x y z, nx ny nz, and uv under its usual names; face vertex_indices (vertex_index), and
/// texcoord, uv per corner. Throws FileError, also for what a header claims and the file is too short to hold.
MeshFile readPly(const std::string& path, std::string bytes);

} // namespace rt::loaders
