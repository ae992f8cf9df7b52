// From a mesh file to triangles ready for the scene: read, repair, triangulate, normals.
#pragma once
#include "repair.hpp"

#include <rt/plugin.hpp>

#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

namespace rt::loaders {

enum class Normals : std::uint8_t { automatic, file, smooth, flat };

struct ImportOptions {
    Normals normals = Normals::automatic;
    // Between the exterior angles of prisms with seven and with eight sides: eight sides and more are round.
    Radians creaseAngle{50 * std::numbers::pi / 180};
    Repair repair = Repair::full;
};

struct Import {
    std::string name; // of the file, for messages
    Mesh mesh;        // Mesh::materials index `materials`
    std::vector<Material> materials;
    RepairSummary summary;
    std::vector<std::string> fileNotes; // what the reader left out
    std::uint32_t zeroNormals = 0;      // of the file, without length
    std::uint32_t turnedNormals = 0;    // triangles whose normals in the file faced away
    std::uint32_t crossedFaces = 0;     // whose outline crosses itself

    /// One sentence each for everything that the user should know.
    std::vector<std::string> notes() const;
};

/// The sentence for a solid with boundary edges. `name` of its file, if it has one.
std::string notClosed(const std::string& name, std::uint32_t openEdges);

/// The file at `path` as it stands: .obj or .ply, or gzip of one (the suffix .gz is optional), by the
/// suffix. Throws FileError.
MeshFile readMesh(const std::string& path);

/// The same for text already read.
MeshFile readMesh(const std::string& path, std::string bytes);

Import importMesh(const std::string& path, const ImportOptions& options);
Import importMesh(const MeshFile& file, const ImportOptions& options);

} // namespace rt::loaders
