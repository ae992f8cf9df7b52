// Bytes as OBJ or PLY: read, repair, cut, normals, into the world and its octree, and written again. Nothing may crash,
// hang or give a number that is not finite, and the octree answers as its definition does.
#include <core/geometry/bounds.hpp>
#include <core/octree/octree.hpp>
#include <core/plugin_host/sink.hpp>
#include <plugins/loaders/mesh_import.hpp>
#include <plugins/loaders/report.hpp>
#include <plugins/loaders/write_obj.hpp>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>

using namespace rt::loaders;

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

/// The primitives as the plugin boundary takes them, or nothing where it refuses a coordinate.
std::optional<rt::world::World> worldOf(const rt::Mesh& mesh) {
    using namespace rt::plugin_host;
    rt::world::World world;
    rt::scene::Diagnostics diagnostics;
    Call call{};
    call.diagnostics = &diagnostics;
    Sink sink({.world = &world,
               .object{},
               .material{},
               .fileMaterials = false,
               .worldFromObject{},
               .imageTexture{}},
              call);
    try {
        rt::Geometry(nullptr, sink.table(), nullptr, 0).mesh(mesh);
    } catch (const rt::detail::HostRefused&) {
        require(call.failed);
        return std::nullopt;
    }
    return world;
}

/// Rays at middles and corners of triangles, from outside and along an axis, against the scan of all primitives.
void shootAt(const rt::geometry::Primitives& primitives) {
    using namespace rt::octree;
    using rt::numeric::Vec3;
    const Octree tree = Octree::build(primitives, {.threads = 1});
    const auto& positions = primitives.triangles.positions;
    const auto& indices = primitives.triangles.indices;
    constexpr std::size_t kRays = 12;
    const rt::numeric::Box3d bounds = rt::geometry::boundsOf(primitives);
    const Vec3 eye = bounds.max + (bounds.max - bounds.min) * 0.5;
    for (std::size_t i = 0; i < kRays && i < indices.size(); ++i) {
        const auto& [a, b, c] = indices[i * indices.size() / kRays];
        const Vec3 middle = (positions[a] + positions[b] + positions[c]) / 3.0;
        for (const Ray& ray : {Ray{.origin = eye, .direction = middle - eye},
                               Ray{.origin = eye, .direction = positions[a] - eye},
                               Ray{.origin = middle, .direction = Vec3(0, 0, 1)}}) {
            if (ray.direction == Vec3(0.0)) continue;
            const Hit hit = tree.closest(ray), expected = closestBruteForce(primitives, ray);
            require(hit.id == expected.id && hit.t == expected.t);
            require(tree.occluded(ray) == occludedBruteForce(primitives, ray));
        }
    }
}

void check(const MeshFile& file, const ImportOptions& options) {
    Import import;
    try {
        import = importMesh(file, options);
    } catch (const FileError&) {
        return;
    }
    (void)import.notes();
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
    if (const auto world = worldOf(mesh)) shootAt(world->primitives);
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
