// Bytes as OBJ or PLY: read, repair, cut, normals, and written again. Nothing may crash, hang or give a number that is not finite.
#include <plugins/loaders/mesh_import.hpp>
#include <plugins/loaders/report.hpp>
#include <plugins/loaders/write_obj.hpp>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

using namespace rt::loaders;

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

void check(const MeshFile& file, const ImportOptions& options) {
    Import import;
    try {
        import = importMesh(file, options);
    } catch (const FileError&) {
        return;
    }
    (void)import.notes(true);
    const auto& mesh = import.mesh;
    require(!mesh.triangles.empty() && mesh.sourceFaces.size() == mesh.triangles.size());
    for (const auto& t : mesh.triangles)
        for (const std::uint32_t v : t) require(v < mesh.positions.size());
    for (const auto& t : mesh.normalIndices)
        for (const std::uint32_t n : t) require(n == kNone || n < mesh.normals.size());
    for (const auto& t : mesh.uvIndices)
        for (const std::uint32_t uv : t) require(uv == kNone || uv < mesh.uvs.size());
    for (const rt::Vector3& n : mesh.normals)
        require(std::fabs(rt::dot(n, n) - 1) <= rt::gamma(32));
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    const bool ply = (data[0] & 1) != 0;
    ImportOptions options;
    options.normals = static_cast<Normals>(data[0] >> 1 & 3);
    options.repair = static_cast<Repair>((data[0] >> 3 & 3) % 3);
    std::string bytes(reinterpret_cast<const char*>(data + 1), size - 1);
    MeshFile file;
    try { // no folder of this name exists, so no library is read
        file = readMesh(ply ? "/nowhere/at/all/a.ply" : "/nowhere/at/all/a.obj", std::move(bytes));
    } catch (const FileError&) {
        return 0;
    }
    check(file, options);
    const RepairedMesh repaired = repair(file, options.repair);
    std::string text;
    writeObj(file, repaired, [&](std::string_view piece) { text += piece; });
    writeReport(file, repaired, true, [](std::string_view) {});
    try { // what was written can be read, unless every face was dropped
        readMesh("a.obj", std::move(text));
    } catch (const FileError&) {
        for (const FaceOutcome& o : repaired.outcomes) require(o.action == FaceAction::dropped);
    }
    return 0;
}
