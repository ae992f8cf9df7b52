// The sphereflake of [Haines 1987, A Proposal for Standard Graphics Environments]: nine spheres of a third of the size on
// every sphere. All of them are core primitives: nothing of this file runs while rendering.
#include <rt/plugin.hpp>

struct Sphereflake {
    rt::Vector3 center;
    double radius;
    std::int64_t levels;
};

constexpr std::array kParameters{
    rt::parameter<&Sphereflake::center>("center", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                        "Center of the largest sphere."),
    rt::parameter<&Sphereflake::radius>("radius", RT_UNIT_LENGTH, "1", rt::positive,
                                        "Radius of the largest sphere."),
    rt::parameter<&Sphereflake::levels>("levels", RT_UNIT_COUNT, "4", rt::range(1, 8),
                                        "Sizes of spheres; each has nine times "
                                        "as many as the one before.")};

/// A sphere stands on its parent in the direction w. Six children lie in the plane across w, three between it and w.
void grow(rt::Vector3 center, double radius, const rt::Basis& basis, std::int64_t levels,
          std::vector<rt_sphere>& out) {
    out.push_back({{center.x, center.y, center.z}, radius});
    if (levels == 1) return;
    const double half = std::sqrt(3.0) / 2, slant = std::sqrt(2.0 / 3), rise = std::sqrt(1.0 / 3);
    const double ring[12][2] = {{1, 0},        {half, 0.5},  {0.5, half},  {0, 1},
                                {-0.5, half},  {-half, 0.5}, {-1, 0},      {-half, -0.5},
                                {-0.5, -half}, {0, -1},      {0.5, -half}, {half, -0.5}};
    const auto child = [&](double u, double v, double w) {
        const rt::Vector3 direction = rt::normalize(basis.u * u + basis.v * v + basis.w * w);
        grow(center + direction * (radius * 4 / 3), radius / 3, rt::basisAbout(direction),
             levels - 1, out);
    };
    for (int i = 0; i < 12; i += 2) child(ring[i][0], ring[i][1], 0);
    for (int i = 1; i < 12; i += 4) child(slant * ring[i][0], slant * ring[i][1], rise);
}

void lower(const Sphereflake& flake, rt::Geometry& out) {
    std::vector<rt_sphere> spheres;
    grow(flake.center, flake.radius, rt::basisAbout({0, 0, 1}), flake.levels, spheres);
    out.spheres(spheres);
}

RT_SHAPE_PLUGIN("sphereflake", "1.0.0", kParameters, lower,
                "Spheres on spheres on spheres; solids.",
                "- sphereflake: {radius: 1, levels: 4, material: mirror}\n")
