// Equal spheres on a grid, as core primitives or as a custom shape of this plugin's own: what does the boundary cost?
#include <rt/plugin.hpp>

struct BallGrid {
    std::int64_t side;
    bool custom;
};

constexpr std::array kParameters{
    rt::parameter<&BallGrid::side>("side", RT_UNIT_COUNT, "20", rt::range(1, 100),
                                   "Spheres along an edge."),
    rt::parameter<&BallGrid::custom>("custom", "false", "As a custom shape.")};

namespace {

struct Ball {
    rt::Vector3 center;
    double radius;

    rt::Box bounds() const {
        const rt::Vector3 r{radius, radius, radius};
        return {center - r, center + r};
    }
    bool intersect(const rt_ray& ray, rt_hit& hit) const {
        const rt::Vector3 d = rt::vector(ray.direction), f = center - rt::vector(ray.origin);
        const double a = rt::dot(d, d), b = rt::dot(f, d), r2 = radius * radius;
        const rt::Vector3 l = f - (b / a) * d;
        const double discriminant = r2 - rt::dot(l, l), c = rt::dot(f, f) - r2;
        const bool inside = c < 0;
        if (!(inside || discriminant >= 0)) return false;
        const double root = std::sqrt(inside ? b * b - a * c : a * discriminant),
                     q = b < 0 ? b - root : b + root;
        const double s = c / q, u = q / a, first = s < u ? s : u, second = s < u ? u : s;
        const double t = first > ray.t_min ? first : second;
        if (!(t > ray.t_min && t < ray.t_max)) return false;
        const rt::Vector3 n = rt::normalize(t * d - f), p = center + n * radius;
        hit = {t,
               {p.x, p.y, p.z},
               rt::gamma(12) *
                   (std::fabs(center.x) + std::fabs(center.y) + std::fabs(center.z) + radius),
               {n.x, n.y, n.z},
               {0, 0},
               0,
               0};
        return true;
    }
};

void lower(const BallGrid& grid, rt::Geometry& out) {
    std::vector<Ball> balls;
    std::vector<rt_sphere> spheres;
    const auto n = grid.side;
    for (std::int64_t i = 0; i < n * n * n; ++i) {
        const rt::Vector3 c{static_cast<double>(i % n), static_cast<double>(i / n % n),
                            static_cast<double>(i / n / n)};
        balls.push_back({c, 0.375});
        spheres.push_back({{c.x, c.y, c.z}, 0.375});
    }
    if (grid.custom)
        out.custom(std::move(balls), rt::Kind::solid);
    else
        out.spheres(spheres);
}

} // namespace

RT_SHAPE_PLUGIN("ball_grid", "1.0.0", kParameters, lower, "Spheres on a grid.",
                "- ball_grid: {side: 4}\n")
