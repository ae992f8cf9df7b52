// Polygons from a file, by the file's loader, or from lists in the scene itself.
#include <rt/plugin.hpp>

#include <algorithm>

struct MeshShape {
    rt::File file;
    rt::Kind kind;
    std::vector<rt::Vector3> vertices;
    std::vector<std::vector<std::int64_t>> faces;
};

constexpr std::array kParameters{
    rt::loadedFile<&MeshShape::file>("file", rt::absent,
                                     "File of polygons, such as model/dragon.obj."),
    rt::choice<&MeshShape::kind>(
        "kind", "surface|solid", "surface",
        "A surface is a sheet; a solid is closed, and light enters and leaves it."),
    rt::parameter<&MeshShape::vertices>("vertices", "[]", "Corners, instead of a file."),
    rt::parameter<&MeshShape::faces>(
        "faces", "[]",
        "Corners of each polygon as numbers of vertices, from 0; counter-clockwise seen "
        "from outside.")};

namespace {

std::string faceName(std::size_t face) { return "faces[" + std::to_string(face) + "]"; }

using Corners = rt::Mesh::Corners;

/// The fan of triangles from one of the polygon's corners that has no triangle turned against the others, for the
/// first such corner. Convex polygons have one at every corner, many concave ones at some.
std::vector<Corners> fan(const std::vector<rt::Vector3>& positions,
                         const std::vector<std::uint32_t>& polygon) {
    // Newell: half the normal's length is the area, whatever the polygon's shape.
    rt::Vector3 normal;
    const std::size_t n = polygon.size();
    for (std::size_t i = 0; i < n; ++i)
        normal = normal + rt::cross(positions[polygon[i]], positions[polygon[(i + 1) % n]]);
    if (normal == rt::Vector3{}) return {};
    for (std::size_t first = 0; first < n; ++first) {
        std::vector<Corners> triangles;
        for (std::size_t i = 1; i + 1 < n; ++i) {
            const Corners t{polygon[first], polygon[(first + i) % n], polygon[(first + i + 1) % n]};
            const auto &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
            if (!(rt::dot(rt::cross(b - a, c - a), normal) >= 0)) break;
            triangles.push_back(t);
        }
        if (triangles.size() == n - 2) return triangles;
    }
    return {};
}

void lower(const MeshShape& shape, rt::Geometry& out) {
    if (shape.file) {
        if (!shape.vertices.empty())
            throw rt::ParameterError("vertices", "cannot stand beside a file");
        if (!shape.faces.empty()) throw rt::ParameterError("faces", "cannot stand beside a file");
        return out.load("file", shape.kind);
    }
    if (shape.vertices.empty())
        throw rt::ParameterError("file", "is missing, and there are no vertices either");
    if (shape.faces.empty()) throw rt::ParameterError("faces", "are missing");
    rt::Mesh mesh;
    mesh.kind = shape.kind;
    mesh.positions = shape.vertices;
    for (std::size_t i = 0; i < shape.faces.size(); ++i) {
        const auto& face = shape.faces[i];
        if (face.size() < 3)
            throw rt::ParameterError("faces", faceName(i) + " has fewer than three corners");
        std::vector<std::uint32_t> polygon;
        for (const std::int64_t vertex : face) {
            if (vertex < 0 || static_cast<std::size_t>(vertex) >= shape.vertices.size())
                throw rt::ParameterError("faces", faceName(i) + " names vertex " +
                                                      std::to_string(vertex) +
                                                      ", and the vertices are 0 to " +
                                                      std::to_string(shape.vertices.size() - 1));
            const auto corner = static_cast<std::uint32_t>(vertex);
            if (std::find(polygon.begin(), polygon.end(), corner) != polygon.end())
                throw rt::ParameterError("faces", faceName(i) + " names vertex " +
                                                      std::to_string(vertex) + " twice");
            polygon.push_back(corner);
        }
        const auto triangles = fan(mesh.positions, polygon);
        if (triangles.empty())
            throw rt::ParameterError(
                "faces", faceName(i) + " cannot be cut into a fan of triangles; split it");
        for (const Corners& triangle : triangles) {
            mesh.triangles.push_back(triangle);
            mesh.sourceFaces.push_back(static_cast<std::uint32_t>(i));
        }
    }
    out.mesh(mesh);
}

} // namespace

RT_SHAPE_PLUGIN(
    "mesh", "1.0.0", kParameters, lower, "Polygons, from a file or from lists in the scene.",
    "- mesh: {file: model/dragon.obj, kind: solid, material: glass}\n"
    "- mesh: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces: [[0, 1, 2]], material: paper}\n")
