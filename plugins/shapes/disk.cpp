// A flat disk or ring, exact.
#include <rt/plugin.hpp>

struct Disk {
    rt::Vector3 center, normal;
    double radius, innerRadius;
};

constexpr std::array kParameters{
    rt::parameter<&Disk::center>("center", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                 "Center of the disk."),
    rt::parameter<&Disk::normal>("normal", RT_UNIT_NONE, "[0, 0, 1]", rt::unlimited,
                                 "Direction that the disk faces."),
    rt::parameter<&Disk::radius>("radius", RT_UNIT_LENGTH, "1", rt::positive,
                                 "Radius of the disk."),
    rt::parameter<&Disk::innerRadius>("inner_radius", RT_UNIT_LENGTH, "0", rt::notNegative,
                                      "Radius of a hole.")};

/// The part of a plane between two distances from a point.
struct Ring {
    rt::Vector3 center;
    rt::Basis basis; // w is the normal
    double radius, innerRadius;

    /// Bound on the rounding of a point of the plane: at most 8 operations touch any term.
    double error() const {
        return rt::gamma(8) *
               (std::fabs(center.x) + std::fabs(center.y) + std::fabs(center.z) + radius);
    }

    rt::Box bounds() const {
        const auto reach = [&](double w) {
            return radius * std::sqrt(std::fmax(0, 1 - w * w)) + error();
        };
        const rt::Vector3 extent{reach(basis.w.x), reach(basis.w.y), reach(basis.w.z)};
        return {center - extent, center + extent};
    }

    bool intersect(const rt_ray& ray, rt_hit& hit) const {
        const rt::Vector3 origin = rt::vector(ray.origin), direction = rt::vector(ray.direction);
        const double t = rt::dot(center - origin, basis.w) / rt::dot(direction, basis.w);
        const rt::Vector3 met = (origin - center) + t * direction;
        const double u = rt::dot(met, basis.u), v = rt::dot(met, basis.v), squared = u * u + v * v;
        if (!(t > ray.t_min && t < ray.t_max && squared <= radius * radius &&
              squared >= innerRadius * innerRadius))
            return false; // a NaN is a miss
        const rt::Vector3 position = center + basis.u * u + basis.v * v;
        hit.t = t;
        hit.position[0] = position.x, hit.position[1] = position.y, hit.position[2] = position.z;
        hit.position_error = error();
        hit.normal[0] = basis.w.x, hit.normal[1] = basis.w.y, hit.normal[2] = basis.w.z;
        hit.uv[0] = rt::turns(v, u), hit.uv[1] = std::sqrt(squared) / radius;
        return true;
    }
};

void lower(const Disk& disk, rt::Geometry& out) {
    if (!(rt::length(disk.normal) > 0)) throw rt::ParameterError("normal", "has no direction");
    if (disk.innerRadius >= disk.radius)
        throw rt::ParameterError("inner_radius", "must be smaller than radius");
    out.custom(Ring{disk.center, rt::basisAbout(rt::normalize(disk.normal)), disk.radius,
                    disk.innerRadius},
               rt::Kind::surface);
}

RT_SHAPE_PLUGIN("disk", "1.0.0", kParameters, lower, "A flat disk or ring; a sheet.",
                "- disk: {center: [0, 0, 1], radius: 2, inner_radius: 1, material: steel}\n")
