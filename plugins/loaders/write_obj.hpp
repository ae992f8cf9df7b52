// A repaired mesh as OBJ text.
#pragma once
#include "repair.hpp"

#include <functional>
#include <string_view>

namespace rt::loaders {

/// The faces that are left, in the file's order, turned as the repair turned them and otherwise as written: polygons,
/// uvs, normals, objects, groups, smoothing groups and material names. Vertices that lie on each other are one; those without a face are
/// left out. Coordinates have as many digits as give the same double again. `write` is called with pieces of text.
void writeObj(const MeshFile& file, const RepairedMesh& repaired,
              const std::function<void(std::string_view)>& write);

} // namespace rt::loaders
