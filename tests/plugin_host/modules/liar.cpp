// A unit sphere that breaks one rule of custom shapes on request.
#include <rt/plugin.hpp>

#include <atomic>

struct Liar {
    enum class Lie {
        none,
        writes_on_miss,
        normal,
        position_error,
        bounds,
        nan_hits,
        beyond,
        crossings_order,
        crossings_first,
        crossings_odd,
        crossings_capacity,
        threads,
        position,
        passes_over,
        primitive
    };
    Lie lie;
};

constexpr std::array kParameters{
    rt::choice<&Liar::lie>("lie",
                           "none|writes_on_miss|normal|position_error|bounds|nan_hits|beyond|"
                           "crossings_order|crossings_first|crossings_odd|"
                           "crossings_capacity|threads|position|passes_over|primitive",
                           "none", "Which rule to break.")};

namespace {

using Lie = Liar::Lie;
std::atomic<unsigned> gCalls{0};

struct LyingSphere {
    Lie lie;

    rt::Box bounds() const {
        const double r = lie == Lie::bounds ? 0.75 : 1.0 + rt::gamma(4);
        return {{-r, -r, -r}, {r, r, r}};
    }

    int roots(const rt_ray& ray, double t[2]) const {
        const rt::Vector3 o = rt::vector(ray.origin), d = rt::vector(ray.direction);
        const double a = rt::dot(d, d), nearest = -rt::dot(o, d) / a;
        const rt::Vector3 p = o + nearest * d;
        const double square = 1 - rt::dot(p, p);
        if (!(square > 0)) return 0;
        const double half = std::sqrt(square / a);
        int count = 0;
        for (double root : {nearest - half, nearest + half})
            if (root > ray.t_min && root < ray.t_max) t[count++] = root;
        return count;
    }

    bool intersect(const rt_ray& ray, rt_hit& hit) const {
        double t[2];
        const int count = roots(ray, t);
        if (count == 0 && lie == Lie::nan_hits && std::isnan(ray.origin[0]))
            return hit = rt_hit{}, true;
        if (count == 0) return false;
        const double first = lie == Lie::passes_over && count == 2 ? t[1] : t[0];
        const rt::Vector3 n =
            rt::normalize(rt::vector(ray.origin) + first * rt::vector(ray.direction));
        const double scale = lie == Lie::normal ? 1.5 : 1, radius = lie == Lie::position_error
                                                                        ? 1 + rt::gamma(1 << 20)
                                                                    : lie == Lie::position ? -1
                                                                                           : 1;
        hit = {first,
               {radius * n.x, radius * n.y, radius * n.z},
               rt::gamma(16),
               {scale * n.x, scale * n.y, scale * n.z},
               {0, 0},
               0,
               0};
        if (lie == Lie::beyond) hit.t = -1;
        if (lie == Lie::threads) hit.uv[0] = gCalls++;
        return true;
    }

    std::uint32_t crossings(const rt_ray& ray, double* t, std::uint32_t capacity) const {
        double all[2];
        int count = roots(ray, all);
        if (lie == Lie::crossings_order && count == 2) std::swap(all[0], all[1]);
        if (lie == Lie::crossings_first && count > 0) all[0] *= 1 - rt::gamma(4);
        if (lie == Lie::crossings_odd && count == 2) count = 1;
        const auto found =
            static_cast<std::uint32_t>(count) < capacity || lie == Lie::crossings_capacity
                ? static_cast<std::uint32_t>(count)
                : capacity;
        for (std::uint32_t i = 0; i < found && i < capacity; ++i) t[i] = all[i];
        return found;
    }
};

/// The C boundary itself, for what the sugar would put right.
struct Raw {
    static void bounds(const void*, std::uint32_t, double lower[3], double upper[3]) {
        for (int i = 0; i < 3; ++i) lower[i] = -1.0 - rt::gamma(4), upper[i] = 1 + rt::gamma(4);
    }
    template <Lie lie>
    static std::int32_t intersect(const void*, const std::uint32_t*, std::uint32_t,
                                  const rt_ray* ray, rt_hit* hit) {
        rt_hit candidate{};
        if (!LyingSphere{Lie::none}.intersect(*ray, candidate)) {
            if (lie == Lie::writes_on_miss) hit->t = 0;
            return 0;
        }
        *hit = candidate;
        if (lie == Lie::primitive) hit->primitive = 5;
        return 1;
    }
};

rt_status lower(const rt_host*, const rt_value* values, rt_sink* sink) {
    const auto lie = static_cast<Lie>(values[0].integer);
    if (lie == Lie::writes_on_miss || lie == Lie::primitive) {
        static int nothing;
        rt_custom custom{};
        custom.struct_size = sizeof custom;
        custom.kind = RT_SOLID;
        custom.primitive_count = 1;
        custom.data = &nothing;
        custom.bounds = Raw::bounds;
        custom.intersect = lie == Lie::primitive ? Raw::intersect<Lie::primitive>
                                                 : Raw::intersect<Lie::writes_on_miss>;
        custom.release = [](void*) {};
        return sink->add_custom(sink, &custom);
    }
    rt::Geometry(nullptr, sink, nullptr, 0).custom(LyingSphere{lie}, rt::Kind::solid);
    return RT_OK;
}

constexpr auto kRows = rt::detail::rows(kParameters);
constexpr rt_shape kShape{sizeof(rt_shape), 1, kRows.data(), lower};

} // namespace

extern "C" RT_EXPORT constexpr rt_module rt_plugin_entry = rt::detail::module(
    "liar", "1.0.0", "A sphere that lies.", "- liar: {lie: none}\n", &kShape, nullptr, nullptr);
