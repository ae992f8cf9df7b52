// A circular cylinder between two points, exact.
#include "frustum.hpp"

struct Cylinder {
    rt::Vector3 start, end;
    double radius;
    bool closed;
};

constexpr std::array kParameters{
    rt::parameter<&Cylinder::start>("start", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                    "Center of one end."),
    rt::parameter<&Cylinder::end>("end", RT_UNIT_LENGTH, "[0, 0, 1]", rt::unlimited,
                                  "Center of the other end."),
    rt::parameter<&Cylinder::radius>("radius", RT_UNIT_LENGTH, "1", rt::positive,
                                     "Radius of the cylinder."),
    rt::parameter<&Cylinder::closed>(
        "closed", "true", "A solid with end discs; otherwise a tube, which is a sheet.")};

void lower(const Cylinder& c, rt::Geometry& out) {
    if (!(rt::length(c.end - c.start) > 0))
        throw rt::ParameterError("end", "is the same point as start");
    out.custom(Frustum(c.start, c.end, c.radius, c.radius, c.closed),
               c.closed ? rt::Kind::solid : rt::Kind::surface);
}

RT_SHAPE_PLUGIN("cylinder", "1.0.0", kParameters, lower, "A circular cylinder, closed or open.",
                "- cylinder: {start: [0, 0, 0], end: [0, 0, 2], radius: 0.5, material: steel}\n")
