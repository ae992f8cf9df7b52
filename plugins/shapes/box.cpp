// A box along the axes: twelve core triangles.
#include <rt/plugin.hpp>

struct BoxShape {
    rt::Vector3 min, max;
};

constexpr std::array kParameters{
    rt::parameter<&BoxShape::min>("min", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                  "Corner of the smallest coordinates."),
    rt::parameter<&BoxShape::max>("max", RT_UNIT_LENGTH, "[1, 1, 1]", rt::unlimited,
                                  "Corner of the largest coordinates.")};

void lower(const BoxShape& box, rt::Geometry& out) {
    const auto& [min, max] = box;
    if (!(min.x < max.x && min.y < max.y && min.z < max.z))
        throw rt::ParameterError("max", "must be larger than min on every axis");
    rt::Mesh mesh;
    mesh.kind = rt::Kind::solid;
    for (unsigned i = 0; i < 8; ++i) // bit 0: x, bit 1: y, bit 2: z
        mesh.positions.push_back(
            {i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z});
    mesh.uvs = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const std::uint32_t sides[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                       {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (std::uint32_t side = 0; side < 6; ++side)
        for (std::uint32_t k : {1u, 2u}) {
            mesh.triangles.push_back({sides[side][0], sides[side][k], sides[side][k + 1]});
            mesh.uvIndices.push_back({0, k, k + 1});
            mesh.sourceFaces.push_back(side);
        }
    out.mesh(mesh);
}

RT_SHAPE_PLUGIN("box", "1.0.0", kParameters, lower, "A box along the axes; a solid.",
                "- box: {min: [-1, -1, 0], max: [1, 1, 2], material: glass}\n")
