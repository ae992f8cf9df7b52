// A ring torus about the z axis, exact: the roots of a quartic.
#include <rt/plugin.hpp>

struct Torus {
    double majorRadius, minorRadius;
};

constexpr std::array kParameters{
    rt::parameter<&Torus::majorRadius>("major_radius", RT_UNIT_LENGTH, "1", rt::positive,
                                       "From the center of the torus to the center of the tube."),
    rt::parameter<&Torus::minorRadius>("minor_radius", RT_UNIT_LENGTH, "0.25", rt::positive,
                                       "Radius of the tube.")};

/// c[0] + c[1] s + … + c[N] s^N
template <int N> struct Polynomial {
    double c[N + 1];

    double operator()(double s) const {
        double value = c[N];
        for (int i = N - 1; i >= 0; --i) value = value * s + c[i];
        return value;
    }
    Polynomial<N - 1> derivative() const {
        Polynomial<N - 1> d;
        for (int i = 0; i < N; ++i) d.c[i] = (i + 1) * c[i + 1];
        return d;
    }
    /// Where the sign of the value changes in (low, high), rising: between two zeros of the derivative it changes at most
    /// once, so that no change is lost and none is found twice. A value of 0 counts as positive: a ray that only touches
    /// misses. Newton's steps where they stay between the two ends and shrink, bisection elsewhere.
    int signChanges(double low, double high, double out[N]) const {
        double ends[N + 1] = {low};
        int count = 1;
        if constexpr (N > 1) count += derivative().signChanges(low, high, ends + 1);
        ends[count] = high;
        int found = 0;
        for (int i = 0; i < count; ++i) {
            double a = ends[i], b = ends[i + 1];
            const bool negative = (*this)(a) < 0;
            if (negative == ((*this)(b) < 0)) continue;
            double s = a + (b - a) / 2;
            for (double step = rt::kInfinity;;) {
                const double value = (*this)(s);
                ((value < 0) == negative ? a : b) = s;
                double next = a + (b - a) / 2, newStep = b - a;
                if constexpr (N > 1) {
                    const double newton = s - value / derivative()(s);
                    if (newton == s) break;
                    // Only while it converges: each step at most half of the one before.
                    if (newton > a && newton < b && std::fabs(newton - s) < step / 2)
                        next = newton, newStep = std::fabs(newton - s);
                }
                if (!(next > a && next < b)) break; // the ends are neighbours
                s = next, step = newStep;
            }
            out[found++] = s;
        }
        return found;
    }
};

class ExactTorus {
public:
    ExactTorus(double majorRadius, double minorRadius) : major_(majorRadius), minor_(minorRadius) {}

    rt::Box bounds() const {
        const double slack = rt::gamma(16) * (major_ + minor_), across = major_ + minor_ + slack,
                     up = minor_ + slack;
        return {{-across, -across, -up}, {across, across, up}};
    }

    bool intersect(const rt_ray& ray, rt_hit& hit) const {
        double t[4];
        const std::uint32_t found = crossings(ray, t, 4);
        if (found == 0) return false;
        const rt::Vector3 p = rt::vector(ray.origin) + t[0] * rt::vector(ray.direction);
        // Back onto the tube: from the nearest point of its centre line.
        const double fromAxis = std::sqrt(p.x * p.x + p.y * p.y);
        const rt::Vector3 middle{major_ * p.x / fromAxis, major_ * p.y / fromAxis, 0};
        const rt::Vector3 normal = rt::normalize(p - middle), position = middle + normal * minor_;
        hit.t = t[0];
        hit.position[0] = position.x, hit.position[1] = position.y, hit.position[2] = position.z;
        hit.position_error =
            rt::gamma(16) * (major_ + minor_); // at most 16 operations touch any term
        hit.normal[0] = normal.x, hit.normal[1] = normal.y, hit.normal[2] = normal.z;
        hit.uv[0] = rt::turns(p.y, p.x);
        hit.uv[1] = rt::turns(p.z, fromAxis - major_);
        return true;
    }

    std::uint32_t crossings(const rt_ray& ray, double* t, std::uint32_t capacity) const {
        // In units of the outer radius, from the ray's point nearest to the middle, along a unit direction: every number
        // below is then at most of the order of 1, however large or far away the torus is.
        const double size = major_ + minor_, R = major_ / size, r = minor_ / size;
        const rt::Vector3 direction = rt::vector(ray.direction), origin = rt::vector(ray.origin);
        const double speed = rt::length(direction);
        const rt::Vector3 d = direction / speed;
        const double shift = -rt::dot(origin, d);
        const rt::Vector3 o = (origin + shift * d) / size;
        const double oo = rt::dot(o, o);
        if (!(oo < 1)) return 0; // past the bounding sphere, or a NaN
        double low = -std::sqrt(1 - oo), high = -low;
        if (d.z != 0) { // between the planes that touch the tube
            const double a = (-r - o.z) / d.z, b = (r - o.z) / d.z;
            low = std::fmax(low, a < b ? a : b), high = std::fmin(high, a < b ? b : a);
        } else if (!(std::fabs(o.z) < r)) {
            return 0;
        }
        if (!(low < high)) return 0;
        // (|p|² + R² - r²)² = 4 R² (x² + y²) with p = o + s d, |p|² = s² + 2 s o·d + o·o
        const double od = rt::dot(o, d), k = oo + (R - r) * (R + r), across = d.x * d.x + d.y * d.y;
        const double mixed = o.x * d.x + o.y * d.y, away = o.x * o.x + o.y * o.y, four = 4 * R * R;
        const Polynomial<4> f{{k * k - four * away, 4 * od * k - 2 * four * mixed,
                               4 * od * od + 2 * k - four * across, 4 * od, 1}};
        double s[4];
        const int count = f.signChanges(low, high, s);
        std::uint32_t found = 0;
        for (int i = 0; i < count; ++i) {
            const double at = (shift + refined(s[i], o, d, R, r) * size) / speed;
            if (at > ray.t_min && at < ray.t_max && found < capacity) t[found++] = at;
        }
        return found;
    }

private:
    /// The quartic loses digits as the tube gets thin. (ρ - R)² + z² = r², ρ² = x² + y², does not: two of Newton's steps
    /// on it bring the root back to the rounding of the point itself. Where they do not help, the ray grazes.
    static double refined(double s, rt::Vector3 o, rt::Vector3 d, double R, double r) {
        double before = rt::kInfinity;
        double best = s;
        for (int i = 0; i < 3; ++i) {
            const rt::Vector3 p = o + s * d;
            const double squared = p.x * p.x + p.y * p.y, fromAxis = std::sqrt(squared);
            const double across = (squared - R * R) / (fromAxis + R),
                         value = (across - r) * (across + r) + p.z * p.z;
            if (!(std::fabs(value) < before)) break;
            before = std::fabs(value), best = s;
            s -= value / (2 * (across * (p.x * d.x + p.y * d.y) / fromAxis + p.z * d.z));
        }
        return best;
    }

    double major_, minor_;
};

void lower(const Torus& torus, rt::Geometry& out) {
    if (torus.minorRadius >= torus.majorRadius)
        throw rt::ParameterError("minor_radius",
                                 "must be smaller than major_radius, or the torus meets itself");
    out.custom(ExactTorus(torus.majorRadius, torus.minorRadius), rt::Kind::solid);
}

RT_SHAPE_PLUGIN(
    "torus", "1.0.0", kParameters, lower, "A ring torus about the z axis; a solid.",
    "- torus: {major_radius: 1, minor_radius: 0.25, translate: [0, 0, 1], material: gold}\n")
