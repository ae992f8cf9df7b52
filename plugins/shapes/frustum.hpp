// Cone frustum and cylinder between two circles about one axis: the primitive of the plugins cone and cylinder.
#pragma once
#include <rt/plugin.hpp>

/// Convex, so a ray is inside it in one interval: that of the slab between the end planes, cut with that of the infinite cone.
class Frustum {
public:
    /// `closed`: a solid with end discs; otherwise the side alone, a sheet. Precondition: start and end differ, radii are
    /// not negative and not both 0.
    Frustum(rt::Vector3 start, rt::Vector3 end, double startRadius, double endRadius, bool closed)
        : start_(start), basis_(rt::basisAbout(rt::normalize(end - start))),
          height_(rt::length(end - start)), startRadius_(startRadius), endRadius_(endRadius),
          slope_((endRadius - startRadius) / height_), closed_(closed) {}

    rt::Box bounds() const {
        rt::Box box;
        const rt::Vector3 end = start_ + basis_.w * height_;
        const auto axis = [&](double u, double v, double from, double to, double& lower,
                              double& upper) {
            const double reach = std::sqrt(u * u + v * v), a = startRadius_ * reach,
                         b = endRadius_ * reach;
            const double slack = error();
            lower = std::fmin(from - a, to - b) - slack;
            upper = std::fmax(from + a, to + b) + slack;
        };
        axis(basis_.u.x, basis_.v.x, start_.x, end.x, box.lower.x, box.upper.x);
        axis(basis_.u.y, basis_.v.y, start_.y, end.y, box.lower.y, box.upper.y);
        axis(basis_.u.z, basis_.v.z, start_.z, end.z, box.lower.z, box.upper.z);
        return box;
    }

    bool intersect(const rt_ray& ray, rt_hit& hit) const {
        Crossing crossings[2];
        const LocalRay local = localRay(ray);
        const std::uint32_t count = cross(local, crossings);
        for (std::uint32_t i = 0; i < count; ++i)
            if (crossings[i].t > ray.t_min && crossings[i].t < ray.t_max) {
                fill(local, crossings[i], hit);
                return true;
            }
        return false;
    }

    std::uint32_t crossings(const rt_ray& ray, double* t, std::uint32_t capacity) const {
        Crossing crossings[2];
        const std::uint32_t count = cross(localRay(ray), crossings);
        std::uint32_t found = 0;
        for (std::uint32_t i = 0; i < count; ++i)
            if (crossings[i].t > ray.t_min && crossings[i].t < ray.t_max && found < capacity)
                t[found++] = crossings[i].t;
        return found;
    }

private:
    enum class Part { side, start, end };
    struct Crossing {
        double s, t;
        Part part;
    };
    /// In the frame of the axis, from the ray's point nearest to the frustum's middle: what is added up below is then no
    /// larger than the frustum, however far away the ray starts. t = shift + s.
    struct LocalRay {
        rt::Vector3 origin, direction;
        double shift;
    };

    /// Bound on the rounding of a point computed in the frame of the axis: at most 16 operations touch any term.
    double error() const {
        return rt::gamma(16) * (std::fabs(start_.x) + std::fabs(start_.y) + std::fabs(start_.z) +
                                height_ + startRadius_ + endRadius_);
    }

    LocalRay localRay(const rt_ray& ray) const {
        const rt::Vector3 d = rt::vector(ray.direction), o = rt::vector(ray.origin) - start_;
        const double shift = -rt::dot(o - basis_.w * (height_ / 2), d) / rt::dot(d, d);
        const rt::Vector3 near = o + shift * d;
        return {{rt::dot(near, basis_.u), rt::dot(near, basis_.v), rt::dot(near, basis_.w)},
                {rt::dot(d, basis_.u), rt::dot(d, basis_.v), rt::dot(d, basis_.w)},
                shift};
    }

    std::uint32_t cross(const LocalRay& ray, Crossing crossings[2]) const {
        const rt::Vector3 &o = ray.origin, &d = ray.direction;
        const double shift = ray.shift;
        // Where the ray is between the end planes.
        double first = -rt::kInfinity, last = rt::kInfinity;
        if (d.z != 0) {
            const double a = -o.z / d.z, b = (height_ - o.z) / d.z;
            first = a < b ? a : b, last = a < b ? b : a;
        } else if (!(o.z >= 0 && o.z <= height_)) {
            return 0;
        }
        // x² + y² = R(z)² along the ray: A s² + 2 B s + C = 0, and B² - A C = |R0 (dx, dy) - k dz (ox, oy)|² - (ox dy - oy dx)²,
        // a difference of two squares that is taken as a product.
        const double radius = startRadius_ + slope_ * o.z, grow = slope_ * d.z;
        const double A = d.x * d.x + d.y * d.y - grow * grow,
                     B = o.x * d.x + o.y * d.y - grow * radius;
        const double C = (o.x * o.x + o.y * o.y) - radius * radius;
        const double mx = radius * d.x - grow * o.x, my = radius * d.y - grow * o.y;
        const double m = std::sqrt(mx * mx + my * my), l = std::fabs(o.x * d.y - o.y * d.x);
        const double discriminant = (m - l) * (m + l);
        double roots[2] = {rt::kInfinity, rt::kInfinity};
        if (discriminant > 0) {
            const double root = std::sqrt(discriminant), q = -(B + std::copysign(root, B));
            const double a = q / A, b = C / q;
            roots[0] = a < b ? a : b, roots[1] = a < b ? b : a;
        }
        std::uint32_t count = 0;
        const auto side = [&](double s) { crossings[count++] = {s, shift + s, Part::side}; };
        const auto within = [&](double s) { return s > first && s < last; };
        if (!closed_) {
            for (double s : roots)
                if (within(s)) side(s);
            return count;
        }
        const auto cap = [&](double s, bool atStart) {
            crossings[count++] = {s, shift + s, atStart ? Part::start : Part::end};
        };
        const auto inside = [&](double s, double r) { // of the disc at an end
            const double x = o.x + s * d.x, y = o.y + s * d.y;
            return x * x + y * y <= r * r;
        };
        const bool entersAtStart = d.z > 0;
        const bool inAtFirst = d.z != 0 && inside(first, entersAtStart ? startRadius_ : endRadius_);
        const bool inAtLast = d.z != 0 && inside(last, entersAtStart ? endRadius_ : startRadius_);
        double sides[2];
        int sideCount = 0;
        for (double s : roots)
            if (within(s)) sides[sideCount++] = s;
        if (inAtFirst && inAtLast) {
            cap(first, entersAtStart), cap(last, !entersAtStart);
        } else if (inAtFirst && sideCount != 0) {
            cap(first, entersAtStart), side(sides[sideCount - 1]);
        } else if (inAtLast && sideCount != 0) {
            side(sides[0]), cap(last, !entersAtStart);
        } else if (!inAtFirst && !inAtLast && sideCount == 2) {
            side(sides[0]), side(sides[1]);
        }
        return count;
    }

    void fill(const LocalRay& ray, const Crossing& crossing, rt_hit& hit) const {
        rt::Vector3 p = ray.origin + crossing.s * ray.direction, normal;
        const double fromAxis = std::sqrt(p.x * p.x + p.y * p.y);
        if (crossing.part == Part::side) {
            // Back onto the side at the same height.
            const double scale = (startRadius_ + slope_ * p.z) / fromAxis;
            normal = rt::normalize({p.x / fromAxis, p.y / fromAxis, -slope_});
            if (!(fromAxis > 0))
                normal = {0, 0, slope_ < 0 ? 1.0 : -1.0}; // the tip itself
            else
                p.x *= scale, p.y *= scale;
            hit.uv[0] = rt::turns(p.y, p.x), hit.uv[1] = p.z / height_;
        } else {
            const bool atStart = crossing.part == Part::start;
            p.z = atStart ? 0 : height_;
            normal = {0, 0, atStart ? -1.0 : 1.0};
            const double r = atStart ? startRadius_ : endRadius_;
            hit.uv[0] = rt::turns(p.y, p.x), hit.uv[1] = r > 0 ? fromAxis / r : 0;
        }
        const rt::Vector3 position = start_ + basis_.u * p.x + basis_.v * p.y + basis_.w * p.z;
        const rt::Vector3 outward =
            rt::normalize(basis_.u * normal.x + basis_.v * normal.y + basis_.w * normal.z);
        hit.t = crossing.t;
        hit.position[0] = position.x, hit.position[1] = position.y, hit.position[2] = position.z;
        hit.normal[0] = outward.x, hit.normal[1] = outward.y, hit.normal[2] = outward.z;
        hit.position_error = error();
    }

    rt::Vector3 start_;
    rt::Basis basis_; // w along the axis
    double height_, startRadius_, endRadius_, slope_;
    bool closed_;
};
