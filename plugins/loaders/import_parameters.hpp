// The rows of every loader of meshes that goes through importMesh().
#pragma once
#include "mesh_import.hpp"

namespace rt::loaders {

inline constexpr std::array kImportParameters{
    choice<&ImportOptions::normals>("normals", "auto|file|smooth|flat", "auto",
                                    "auto: the file's normals where it gives them, elsewhere "
                                    "smooth within its smoothing groups, elsewhere flat; file: "
                                    "the file's or flat; smooth: computed, hard along edges "
                                    "sharper than crease_angle; flat: one per triangle."),
    parameter<&ImportOptions::creaseAngle>("crease_angle", RT_UNIT_ANGLE, "50deg", range(0, 180),
                                           "With normals: smooth, the angle between two faces "
                                           "above which the edge they share is hard."),
    choice<&ImportOptions::repair>("repair", "full|orient|none", "full",
                                   "full: duplicate and degenerate faces dropped, winding made "
                                   "consistent and outward; orient: the winding "
                                   "only; none: faces as the file has them.")};

/// Puts what was read and repaired into the scene, with the notes that belong to it.
inline void put(Import import, Kind kind, Geometry& out) {
    for (const std::string& note : import.notes()) out.note(note);
    if (kind == Kind::solid && import.summary.openEdges != 0)
        out.warn(notClosed(import.name, import.summary.openEdges));
    std::vector<std::uint32_t> handles;
    for (const Material& material : import.materials) handles.push_back(out.material(material));
    for (std::uint32_t& m : import.mesh.materials)
        if (m != RT_NO_INDEX) m = handles[m];
    import.mesh.kind = kind;
    out.mesh(import.mesh);
}

} // namespace rt::loaders
