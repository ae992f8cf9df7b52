// A circular cone, or its frustum, between two points, exact.
#include "frustum.hpp"

struct Cone {
    rt::Vector3 start, end;
    double startRadius, endRadius;
    bool closed;
};

constexpr std::array kParameters{
    rt::parameter<&Cone::start>("start", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                "Center of one end."),
    rt::parameter<&Cone::end>("end", RT_UNIT_LENGTH, "[0, 0, 1]", rt::unlimited,
                              "Center of the other end."),
    rt::parameter<&Cone::startRadius>("start_radius", RT_UNIT_LENGTH, "1", rt::notNegative,
                                      "Radius at the start."),
    rt::parameter<&Cone::endRadius>("end_radius", RT_UNIT_LENGTH, "0", rt::notNegative,
                                    "Radius at the end; 0 is a tip."),
    rt::parameter<&Cone::closed>("closed", "true",
                                 "A solid with end discs; otherwise the side alone, a sheet.")};

void lower(const Cone& c, rt::Geometry& out) {
    if (!(rt::length(c.end - c.start) > 0))
        throw rt::ParameterError("end", "is the same point as start");
    if (!(c.startRadius > 0 || c.endRadius > 0))
        throw rt::ParameterError("end_radius", "is 0, and so is start_radius");
    out.custom(Frustum(c.start, c.end, c.startRadius, c.endRadius, c.closed),
               c.closed ? rt::Kind::solid : rt::Kind::surface);
}

RT_SHAPE_PLUGIN("cone", "1.0.0", kParameters, lower, "A circular cone or frustum, closed or open.",
                "- cone: {start: [0, 0, 0], end: [0, 0, 2], start_radius: 1, material: steel}\n")
