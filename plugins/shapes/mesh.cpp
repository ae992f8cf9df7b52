// Polygons from a file, by the file's loader, or from lists in the scene itself.
#include "../loaders/mesh_import.hpp"
#include "../loaders/triangulate.hpp"

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

/// Says it if the polygons of a solid leave edges open.
void warnOfOpenEdges(const MeshShape& shape, rt::Geometry& out) {
    rt::loaders::MeshFile polygons;
    polygons.positions = shape.vertices;
    for (const auto& face : shape.faces) {
        for (const std::int64_t vertex : face)
            polygons.cornerPosition.push_back(static_cast<std::uint32_t>(vertex));
        polygons.faceStart.push_back(static_cast<std::uint32_t>(polygons.cornerPosition.size()));
    }
    polygons.runs.emplace_back();
    const auto summary = rt::loaders::repair(polygons, rt::loaders::Repair::none).summary;
    if (summary.openEdges != 0) out.warn(rt::loaders::notClosed("", summary.openEdges));
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
    rt::loaders::Triangulator triangulator;
    std::vector<rt::loaders::Triangulator::Triangle> triangles;
    std::vector<rt::Vector3> points;
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
        points.clear();
        for (const std::uint32_t corner : polygon) points.push_back(mesh.positions[corner]);
        if (rt::loaders::newellNormal(points) == rt::Vector3{})
            throw rt::ParameterError("faces", faceName(i) + " has no area or crosses itself");
        if (!triangulator.cut(points, triangles))
            throw rt::ParameterError("faces", faceName(i) + " crosses itself");
        for (const auto& [a, b, c] : triangles) {
            mesh.triangles.push_back({polygon[a], polygon[b], polygon[c]});
            mesh.sourceFaces.push_back(static_cast<std::uint32_t>(i));
        }
    }
    if (shape.kind == rt::Kind::solid) warnOfOpenEdges(shape, out);
    out.mesh(mesh);
}

} // namespace

RT_SHAPE_PLUGIN(
    "mesh", "1.0.0", kParameters, lower, "Polygons, from a file or from lists in the scene.",
    "- mesh: {file: model/dragon.obj, kind: solid, material: glass}\n"
    "- mesh: {vertices: [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces: [[0, 1, 2]], material: paper}\n")
