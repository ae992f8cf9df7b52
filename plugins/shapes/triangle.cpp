// One triangle: a sheet.
#include <rt/plugin.hpp>

struct Triangle {
    rt::Vector3 a, b, c;
};

constexpr std::array kParameters{
    rt::parameter<&Triangle::a>("a", RT_UNIT_LENGTH, rt::required, rt::unlimited, "First corner."),
    rt::parameter<&Triangle::b>("b", RT_UNIT_LENGTH, rt::required, rt::unlimited, "Second corner."),
    rt::parameter<&Triangle::c>("c", RT_UNIT_LENGTH, rt::required, rt::unlimited,
                                "Third corner; counter-clockwise seen from the front.")};

void lower(const Triangle& triangle, rt::Geometry& out) {
    const auto& [a, b, c] = triangle;
    if (rt::cross(b - a, c - a) == rt::Vector3{})
        throw rt::ParameterError("c",
                                 "lies on the line through a and b, so that there is no triangle");
    rt::Mesh mesh;
    mesh.positions = {a, b, c};
    mesh.triangles = {{0, 1, 2}};
    mesh.uvs = {{0, 0}, {1, 0}, {0, 1}};
    out.mesh(mesh);
}

RT_SHAPE_PLUGIN("triangle", "1.0.0", kParameters, lower, "One triangle; a sheet.",
                "- triangle: {a: [0, 0, 0], b: [1, 0, 0], c: [0, 1, 0], material: paper}\n")
