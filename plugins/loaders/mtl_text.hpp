// Wavefront material libraries: what rt's materials can express of them.
#pragma once
#include "mesh_file.hpp"

#include <map>
#include <string>
#include <vector>

namespace rt::loaders {

struct MaterialLibrary {
    std::map<std::string, Material, std::less<>> materials; // the first of equal names counts
    std::vector<std::string> notes;
};

/// Path of the file that `name`, written in a file of the folder `root`/`subfolder`, means, or empty when it
/// is absolute, leaves `root` (also by a symbolic link), or is missing. Backslashes separate folders too.
/// `why`, if not null, receives the reason.
std::string besideMesh(const std::string& root, const std::string& subfolder, std::string name,
                       std::string* why);

/// Kd -> diffuse; Ks -> specular, unless illum 0 or 1 says that nothing shines; Ke -> environment;
/// Ns -> shininess; Ni -> ior; map_Kd -> color_file. d (or 1 - Tr) is opacity: transmission is
/// (1 - d) Tf, and diffuse is weighted with d; Tf without d counts unless it is (1, 1, 1).
/// `name` is the library relative to `root`, the folder of the mesh. Throws FileError for malformed
/// and non-finite numbers.
MaterialLibrary readMtl(const std::string& root, const std::string& name, std::string text);

} // namespace rt::loaders
