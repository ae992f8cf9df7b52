// A square piece of a plane: one core primitive. A picture ends at its horizon anyway, and an octree needs bounds.
#include <rt/plugin.hpp>

struct Plane {
    rt::Vector3 point, normal;
    double size;
};

constexpr std::array kParameters{
    rt::parameter<&Plane::point>("point", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                 "Middle of the piece."),
    rt::parameter<&Plane::normal>("normal", RT_UNIT_NONE, "[0, 0, 1]", rt::unlimited,
                                  "Direction that the plane faces."),
    rt::parameter<&Plane::size>("size", RT_UNIT_LENGTH, "10000", rt::positive,
                                "Length of a side; u and v run over the whole piece.")};

void lower(const Plane& plane, rt::Geometry& out) {
    if (!(rt::length(plane.normal) > 0)) throw rt::ParameterError("normal", "has no direction");
    const rt::Basis basis = rt::basisAbout(rt::normalize(plane.normal));
    const rt::Vector3 u = basis.u * plane.size, v = basis.v * plane.size;
    out.parallelogram(plane.point - u / 2 - v / 2, u, v);
}

RT_SHAPE_PLUGIN("plane", "1.0.0", kParameters, lower, "A large square piece of a plane; a sheet.",
                "- plane: {point: [0, 0, -1], normal: [0, 0, 1], material: floor}\n")
