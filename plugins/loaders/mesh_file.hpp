// What a mesh file says, before anything is judged: a list of polygons over lists of positions, uvs and normals.
#pragma once
#include <rt/plugin.hpp>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace rt::loaders {

inline constexpr std::uint32_t kNone = RT_NO_INDEX;

/// Why a file cannot be used; the message begins with its name and, for text, line and column.
struct FileError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// Coordinates beyond this are refused, so that products of three of them stay finite.
inline constexpr double kLargestCoordinate = 1e100;

/// The last component of `path`.
std::string_view fileName(std::string_view path);

inline constexpr std::uint32_t kSmoothingOff = 0;
inline constexpr std::uint32_t kSmoothingUnstated = kNone;

/// Faces from `firstFace` to the next run share these.
struct FaceRun {
    std::uint32_t firstFace = 0;
    std::uint32_t smoothing = kSmoothingUnstated; // smoothing group
    std::uint32_t material = kNone;               // index into materialNames
    std::uint32_t object = kNone, group = kNone;  // indices into names
};

/// Corners of face f: faceStart[f] <= c < faceStart[f + 1]. Every index is in range, every number
/// finite, and there is at least one face; a face may have fewer than three corners.
struct MeshFile {
    std::string path;
    std::vector<Vector3> positions;
    std::vector<Vector3> normals; // as written, any length
    std::vector<Vector2> uvs;

    std::vector<std::uint32_t> faceStart{0};
    std::vector<std::uint32_t> cornerPosition;
    std::vector<std::uint32_t> cornerUv, cornerNormal; // per corner or kNone; empty: none has one
    std::vector<FaceRun> runs;                         // by rising firstFace; the first is face 0

    std::vector<std::string> names;             // of objects and groups
    std::vector<std::string> materialLibraries; // as written
    std::vector<std::string> materialNames;     // as faces use them
    std::vector<std::uint32_t>
        materialIndex; // per name: into materials, or kNone where no library defines it
    std::vector<Material> materials;
    std::vector<std::string> notes; // what was left out, one sentence each

    std::uint32_t faceCount() const { return static_cast<std::uint32_t>(faceStart.size() - 1); }
};

} // namespace rt::loaders
