// A sphere: one core primitive.
#include <rt/plugin.hpp>

struct Sphere {
    rt::Vector3 center;
    double radius;
};

constexpr std::array kParameters{
    rt::parameter<&Sphere::center>("center", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                   "Center of the sphere."),
    rt::parameter<&Sphere::radius>("radius", RT_UNIT_LENGTH, "1", rt::positive,
                                   "Radius of the sphere.")};

void lower(const Sphere& sphere, rt::Geometry& out) { out.sphere(sphere.center, sphere.radius); }

RT_SHAPE_PLUGIN("sphere", "1.0.0", kParameters, lower, "A sphere; a solid.",
                "- sphere: {center: [0, 0, 1], radius: 1, material: glass}\n")
