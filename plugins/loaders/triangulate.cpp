#include "triangulate.hpp"

#include "exact.hpp"

#include <algorithm>
#include <cmath>

namespace rt::loaders {

Vector3 newellNormal(std::span<const Vector3> polygon) {
    const Vector3 origin = polygon[0];
    double largest = 0;
    for (const Vector3& p : polygon) {
        const Vector3 d = p - origin;
        largest = std::max({largest, std::fabs(d.x), std::fabs(d.y), std::fabs(d.z)});
    }
    if (largest == 0) return {};
    int exponent = 0;
    std::frexp(largest, &exponent);
    // Two steps, as 2^-exponent itself may overflow.
    const double half = std::ldexp(1.0, -exponent / 2),
                 rest = std::ldexp(1.0, -exponent - -exponent / 2);
    const auto scaled = [&](const Vector3& p) { return (p - origin) * half * rest; };
    Vector3 sum;
    Vector3 before = scaled(polygon[1]);
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        const Vector3 here = scaled(polygon[i]);
        sum = sum + cross(before, here);
        before = here;
    }
    return sum;
}

int Triangulator::turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    return orientation(points_[a], points_[b], points_[c]);
}

bool Triangulator::cut(std::span<const Vector3> polygon, std::vector<Triangle>& triangles) {
    const auto n = static_cast<std::uint32_t>(polygon.size());
    triangles.clear();
    if (n == 3) {
        triangles.push_back({0, 1, 2});
        return true;
    }
    const Vector3 normal = newellNormal(polygon);
    if (normal == Vector3{}) { // no plane shows it: a fan has as little area
        for (std::uint32_t i = 1; i + 1 < n; ++i) triangles.push_back({0, i, i + 1});
        return false;
    }
    // Dropping one coordinate keeps the others as they were written: the predicates are exact.
    project(polygon, normal, false);
    if (cutProjected(polygon, triangles)) return true;
    // A polygon that is not flat may cross itself there and not in its own plane.
    project(polygon, normal, true);
    std::vector<Triangle> inPlane;
    const bool clean = cutProjected(polygon, inPlane);
    if (clean) triangles = std::move(inPlane);
    return clean;
}

void Triangulator::project(std::span<const Vector3> polygon, const Vector3& normal,
                           bool alongNormal) {
    const double x = std::fabs(normal.x), y = std::fabs(normal.y), z = std::fabs(normal.z);
    const int axis = z >= x && z >= y ? 2 : x >= y ? 0 : 1;
    const auto at = [](const Vector3& p, int a) { return a == 0 ? p.x : a == 1 ? p.y : p.z; };
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const double depth = at(normal, axis);
    points_.resize(polygon.size());
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector3& p = polygon[i];
        Vector2 q{at(p, u), at(p, v)};
        if (alongNormal) {
            const double w = at(p, axis) - at(polygon[0], axis);
            q.x -= at(normal, u) / depth * w;
            q.y -= at(normal, v) / depth * w;
        }
        if (depth < 0) std::swap(q.x, q.y); // so that the polygon runs counter-clockwise
        points_[i] = q;
    }
}

bool Triangulator::cutProjected(std::span<const Vector3> polygon,
                                std::vector<Triangle>& triangles) {
    return polygon.size() == 4 ? quad(polygon, triangles) : clipEars(triangles);
}

bool Triangulator::quad(std::span<const Vector3> polygon, std::vector<Triangle>& triangles) const {
    // The diagonal from i is valid when both of its triangles turn left.
    const bool from0 = turn(0, 1, 2) > 0 && turn(0, 2, 3) > 0;
    const bool from1 = turn(1, 2, 3) > 0 && turn(1, 3, 0) > 0;
    const auto squared = [&](int a, int b) {
        const Vector3 d = polygon[b] - polygon[a];
        return dot(d, d);
    };
    const bool use1 = from1 && (!from0 || squared(1, 3) < squared(0, 2));
    if (use1)
        triangles.assign({{0, 1, 3}, {1, 2, 3}});
    else
        triangles.assign({{0, 1, 2}, {0, 2, 3}});
    if (from0 || from1) return true;
    // A corner on the line of its neighbours: one triangle is flat, none is turned over.
    if (turn(0, 1, 2) >= 0 && turn(0, 2, 3) >= 0) return true;
    triangles.assign({{0, 1, 3}, {1, 2, 3}});
    return turn(1, 2, 3) >= 0 && turn(1, 3, 0) >= 0;
}

bool Triangulator::isEar(std::uint32_t i) const {
    const std::uint32_t a = previous_[i], c = next_[i];
    for (const std::uint32_t r :
         reflex_) { // only a corner that does not turn left can lie in the ear
        if (state_[r] != 'r' || r == a || r == i || r == c) continue;
        const Vector2 &p = points_[r], &pa = points_[a], &pc = points_[c], &pi = points_[i];
        // The corner of a bridge to a hole is passed twice; its twin blocks nothing.
        if ((p.x == pa.x && p.y == pa.y) || (p.x == pc.x && p.y == pc.y) ||
            (p.x == pi.x && p.y == pi.y))
            continue;
        if (turn(a, i, r) >= 0 && turn(i, c, r) >= 0 && turn(c, a, r) >= 0) return false;
    }
    return true;
}

bool Triangulator::clipEars(std::vector<Triangle>& triangles) {
    const auto n = static_cast<std::uint32_t>(points_.size());
    previous_.resize(n), next_.resize(n), state_.assign(n, 'c'), reflex_.clear();
    for (std::uint32_t i = 0; i < n; ++i)
        previous_[i] = i == 0 ? n - 1 : i - 1, next_[i] = i + 1 == n ? 0 : i + 1;
    // 'c' turns left, 'r' does not, 'x' has been cut off.
    for (std::uint32_t i = 0; i < n; ++i)
        if (turn(previous_[i], i, next_[i]) <= 0) state_[i] = 'r', reflex_.push_back(i);

    bool clean = true;
    std::uint32_t left = n, i = 0, rejected = 0;
    const auto clip = [&](std::uint32_t ear) {
        const std::uint32_t a = previous_[ear], c = next_[ear];
        triangles.push_back({a, ear, c});
        next_[a] = c, previous_[c] = a, state_[ear] = 'x', --left, rejected = 0;
        for (const std::uint32_t v : {a, c}) {
            const char turned = turn(previous_[v], v, next_[v]) > 0 ? 'c' : 'r';
            if (turned == 'r' && state_[v] == 'c') reflex_.push_back(v); // it crosses itself
            state_[v] = turned;
        }
        // Corners of `reflex_` that have been settled cost a look each; drop them now and then.
        if (left % 64 == 0)
            std::erase_if(reflex_, [&](std::uint32_t r) { return state_[r] != 'r'; });
    };
    while (left > 3) {
        if (state_[i] == 'c' && isEar(i)) {
            const std::uint32_t after = next_[next_[i]]; // every other corner: fewer slivers
            clip(i);
            i = state_[after] == 'x' ? next_[i] : after;
            continue;
        }
        i = next_[i];
        if (++rejected < left) continue;
        // A simple polygon has an ear (Meisters 1975) unless corners lie on the line of their neighbours.
        // Take such a corner, or else, of a polygon that crosses itself, one that turns left.
        std::uint32_t best = i;
        char rank = 0;
        for (std::uint32_t k = 0, v = i; k < left; ++k, v = next_[v]) {
            const int t = turn(previous_[v], v, next_[v]);
            const char r = t == 0 ? 3 : t > 0 ? 2 : 1;
            if (r > rank || (r == rank && v < best)) best = v, rank = r;
        }
        clean &= rank == 3;
        i = next_[best];
        clip(best);
    }
    triangles.push_back({previous_[i], i, next_[i]});
    clean &= turn(previous_[i], i, next_[i]) >= 0;
    return clean;
}

} // namespace rt::loaders
