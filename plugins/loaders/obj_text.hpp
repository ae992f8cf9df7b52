// Wavefront OBJ: a strict text pass that loses nothing it does not name.
#pragma once
#include "mesh_file.hpp"

#include <string>

namespace rt::loaders {

/// Reads the OBJ text that stood in the file `path`, and the material libraries it names. Understood:
/// v vt vn f (every index form, negative and forward indices), o g s usemtl mtllib, comments, joined
/// lines, LF CRLF CR, a UTF-8 mark. Everything else is counted in a note.
/// Throws FileError ("name.obj:12:3: ...") for an index 0 or out of range, a malformed or non-finite
/// number, UTF-16, binary data, and for a file without faces.
MeshFile readObj(const std::string& path, std::string text);

} // namespace rt::loaders
