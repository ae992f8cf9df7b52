// The loader `openmesh`: OBJ and PLY files, repaired, to triangles with corner normals. Our own text passes read them, since
// OpenMesh's readers lose vertices and faces and say that all is well; OpenMesh holds the connectivity.
#include "import_parameters.hpp"
#include "report.hpp"
#include "write_obj.hpp"

#include <rt/plugin.hpp>

namespace {

using rt::loaders::ImportOptions;

void load(const ImportOptions& options, const rt::File& file, rt::Kind kind, rt::Geometry& out) {
    rt::loaders::put(rt::loaders::importMesh(file.path, options), kind, out);
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
    "openmesh", "1.0.0", "obj|ply", rt::loaders::kImportParameters, load, repair,
    RT_LOADS_CONCURRENTLY, "Reads OBJ and PLY meshes, also gzipped, and repairs them.",
    "- mesh: {file: dragon.obj, kind: solid, normals: smooth, material: glass}\n")
