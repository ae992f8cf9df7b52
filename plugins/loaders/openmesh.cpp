// The loader `openmesh`: OBJ and PLY files, repaired, to triangles with corner normals. Our own text passes read them, since
// OpenMesh's readers lose vertices and faces and say that all is well; OpenMesh holds the connectivity.
#include "mesh_import.hpp"

#include "report.hpp"
#include "write_obj.hpp"

#include <rt/plugin.hpp>

namespace {

using rt::loaders::ImportOptions;

constexpr std::array kParameters{
    rt::choice<&ImportOptions::normals>("normals", "auto|file|smooth|flat", "auto",
                                        "auto: the file's normals where it gives them, elsewhere "
                                        "smooth within its smoothing groups, elsewhere flat; file: "
                                        "the file's or flat; smooth: computed, hard along edges "
                                        "sharper than crease_angle; flat: one per triangle."),
    rt::parameter<&ImportOptions::creaseAngle>("crease_angle", RT_UNIT_ANGLE, "50deg",
                                               rt::range(0, 180),
                                               "With normals: smooth, the angle between two faces "
                                               "above which the edge they share is hard."),
    rt::choice<&ImportOptions::repair>("repair", "full|orient|none", "full",
                                       "full: duplicate and degenerate faces dropped, winding made "
                                       "consistent and outward; orient: the winding "
                                       "only; none: faces as the file has them.")};

void load(const ImportOptions& options, const rt::File& file, rt::Kind kind, rt::Geometry& out) {
    rt::loaders::Import import = rt::loaders::importMesh(file.path, options);
    for (const std::string& note : import.notes(kind == rt::Kind::solid)) out.note(note);
    std::vector<std::uint32_t> handles;
    for (const rt::Material& material : import.materials) handles.push_back(out.material(material));
    for (std::uint32_t& m : import.mesh.materials)
        if (m != RT_NO_INDEX) m = handles[m];
    import.mesh.kind = kind;
    out.mesh(import.mesh);
}

void repair(const ImportOptions& options, const rt::File& file, rt::TextOut& mesh,
            rt::TextOut& report, bool everyFace) {
    const rt::loaders::MeshFile read = rt::loaders::readMesh(file.path);
    const rt::loaders::RepairedMesh repaired = rt::loaders::repair(read, options.repair);
    if (mesh)
        rt::loaders::writeObj(read, repaired, [&](std::string_view text) { mesh.write(text); });
    if (report)
        rt::loaders::writeReport(read, repaired, everyFace,
                                 [&](std::string_view text) { report.write(text); });
}

} // namespace

RT_REPAIRING_LOADER_PLUGIN(
    "openmesh", "1.0.0", "obj|ply", kParameters, load, repair,
    "Reads OBJ and PLY meshes, also gzipped, and repairs them.",
    "- mesh: {file: dragon.obj, kind: solid, normals: smooth, material: glass}\n")
