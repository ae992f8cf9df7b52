// A parallelogram: one core primitive, a sheet. A rectangle where the edges are perpendicular.
#include <rt/plugin.hpp>

struct Parallelogram {
    rt::Vector3 origin, edgeU, edgeV;
};

constexpr std::array kParameters{
    rt::parameter<&Parallelogram::origin>("origin", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                          "One corner."),
    rt::parameter<&Parallelogram::edgeU>(
        "edge_u", RT_UNIT_LENGTH, rt::required, rt::unlimited,
        "From the corner along the first edge; u runs from 0 to 1 along it."),
    rt::parameter<&Parallelogram::edgeV>(
        "edge_v", RT_UNIT_LENGTH, rt::required, rt::unlimited,
        "From the corner along the second edge; v runs from 0 to 1 along it.")};

void lower(const Parallelogram& p, rt::Geometry& out) {
    if (rt::cross(p.edgeU, p.edgeV) == rt::Vector3{})
        throw rt::ParameterError("edge_v",
                                 "is parallel to edge_u, so that there is no parallelogram");
    out.parallelogram(p.origin, p.edgeU, p.edgeV);
}

RT_SHAPE_PLUGIN("parallelogram", "1.0.0", kParameters, lower, "A parallelogram; a sheet.",
                "- parallelogram: {origin: [-1, -1, 0], edge_u: [2, 0, 0], edge_v: [0, 2, 0], "
                "material: floor}\n")
