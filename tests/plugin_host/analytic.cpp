// The exact shapes of the shipped plugins against binary128, as far as STABILITY's rows S1, S3, O1 and C2 apply to them: hits
// lie on the surface, positions within their stated error, and rays that leave a surface do not meet it again, at sizes
// from 1e-6 to 1e6, at the origin and 1000 sizes away from it. RT_ANALYTIC_RAYS sets the rays of each case.
#include <core/geometry/surface.hpp>
#include <core/numeric/elementary.hpp>
#include <core/octree/octree.hpp>
#include <tests/plugin_host/describe.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>

namespace rt::plugin_host {
namespace {

using numeric::Vec3;
using Quad = __float128;

Quad squareRoot(Quad x) {
    if (!(x > 0)) return 0;
    Quad root = std::sqrt(static_cast<double>(x));
    for (int i = 0; i < 3; ++i) root = (root + x / root) / 2; // from 53 bits to more than 113
    return root;
}
Quad absolute(Quad x) { return x < 0 ? -x : x; }

struct QuadVector {
    Quad x, y, z;
    explicit QuadVector(const Vec3& v) : x(v.x), y(v.y), z(v.z) {}
    QuadVector(Quad a, Quad b, Quad c) : x(a), y(b), z(c) {}
    friend QuadVector operator-(const QuadVector& a, const QuadVector& b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    friend Quad dot(const QuadVector& a, const QuadVector& b) {
        return a.x * b.x + a.y * b.y + a.z * b.z;
    }
};

/// A surface of revolution about `axis` through `base`: half planes of it are (distance from the axis, height).
struct Shape {
    std::string type;
    test::Values values;
    Vec3 offset{0}; // of the object
    Vec3 base{0}, axis{0, 0, 1};
    double size;
    double tube = 0; // of a torus: rays are aimed at it
    // Distance from the surface, negative inside, positive before a disk's front.
    std::function<Quad(Quad radius, Quad height)> profile;

    Quad signedDistance(const QuadVector& p) const {
        const QuadVector from = p - QuadVector(base) - QuadVector(offset), along(axis);
        const Quad length = squareRoot(dot(along, along)), height = dot(from, along) / length;
        return profile(squareRoot(dot(from, from) - height * height), height);
    }
};

Quad distanceToSegment(Quad r, Quad z, Quad r0, Quad z0, Quad r1, Quad z1) {
    const Quad dr = r1 - r0, dz = z1 - z0;
    Quad s = ((r - r0) * dr + (z - z0) * dz) / (dr * dr + dz * dz);
    s = s < 0 ? 0 : s > 1 ? 1 : s;
    const Quad a = r - r0 - s * dr, b = z - z0 - s * dz;
    return squareRoot(a * a + b * b);
}

/// The closed side of radius r0 to r1 with end discs.
std::function<Quad(Quad, Quad)> frustum(double r0, double r1, const Vec3& axis) {
    return [=](Quad r, Quad z) {
        const QuadVector along(axis);
        const Quad h = squareRoot(dot(along, along));
        Quad least = distanceToSegment(r, z, r0, 0, r1, h);
        for (const Quad cap : {distanceToSegment(r, z, 0, 0, r0, 0),
                               distanceToSegment(r, z, 0, h, Quad(r1) + 1e-300, h)})
            if (cap < least) least = cap;
        const bool inside = z > 0 && z < h && r < r0 + (Quad(r1) - r0) * z / h;
        return inside ? -least : least;
    };
}

std::vector<Shape> shapes(double size, const Vec3& center) {
    std::vector<Shape> list;
    const Vec3 tilted = size * Vec3(0.5, -0.75, 1.25);
    {
        Shape s{"cylinder", {{"start", center}, {"end", center + tilted}, {"radius", 0.5 * size}},
                Vec3(0.0),  center,
                Vec3(0.0),  size,
                0,          {}};
        s.axis = (center + tilted) - center; // as the plugin sees it
        s.profile = frustum(0.5 * size, 0.5 * size, s.axis);
        list.push_back(s);
    }
    {
        Shape s{"cone",
                {{"start", center},
                 {"end", center + tilted},
                 {"start_radius", size},
                 {"end_radius", 0.25 * size}},
                Vec3(0.0),
                center,
                Vec3(0.0),
                size,
                0,
                {}};
        s.axis = (center + tilted) - center;
        s.profile = frustum(size, 0.25 * size, s.axis);
        list.push_back(s);
    }
    list.push_back({"disk",
                    {{"center", center},
                     {"normal", Vec3(0.5, -0.75, 1.25)},
                     {"radius", size},
                     {"inner_radius", 0.5 * size}},
                    Vec3(0.0),
                    center,
                    Vec3(0.5, -0.75, 1.25),
                    size,
                    0,
                    [](Quad, Quad z) { return z; }});
    for (const double tube : {0.25, 0.001})
        list.push_back({"torus",
                        {{"major_radius", size}, {"minor_radius", tube * size}},
                        center,
                        Vec3(0.0),
                        Vec3(0, 0, 1),
                        size,
                        tube,
                        [=](Quad r, Quad z) {
                            const Quad a = r - size;
                            return squareRoot(a * a + z * z) - tube * size;
                        }});
    return list;
}

int rayCount() {
    const char* const given = std::getenv("RT_ANALYTIC_RAYS");
    return given != nullptr ? std::atoi(given) : 3000;
}

struct Findings {
    int hits = 0, ownSurface = 0;
    double position = 0; // largest error of a position, as a share of its stated bound
    double distance = 0; // of o + t d from the surface, in u of the coordinates
};

Findings shoot(const Shape& shape) {
    test::Scene scene({RT_SHIPPED_PLUGINS});
    scene::Object& object = scene.add(shape.type, shape.values);
    object.worldFromObject.translation = shape.offset;
    const auto world = scene.lower();
    EXPECT_TRUE(world) << scene.said();
    Findings found;
    if (!world) return found;
    const auto octree = octree::Octree::build(world->primitives);
    const Vec3 middle = shape.base + shape.offset;
    std::mt19937_64 bits(1);
    const auto symmetric = [&] { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1; };
    const auto vector = [&] {
        const double x = symmetric(), y = symmetric(), z = symmetric();
        return Vec3(x, y, z);
    };
    for (int i = 0; i < rayCount(); ++i) {
        geometry::Ray ray;
        const double away = i % 3 == 0 ? 2 : i % 3 == 1 ? 20 : 1000;
        ray.origin = middle + away * shape.size * vector();
        Vec3 target = middle + 1.5 * shape.size * vector();
        if (shape.tube > 0) {
            const double angle = 4 * symmetric();
            target = middle + shape.size * (Vec3(numeric::cos(angle), numeric::sin(angle), 0) +
                                            1.5 * shape.tube * vector());
        }
        ray.direction = target - ray.origin;
        const geometry::Hit hit = octree.closest(ray);
        if (!hit) continue;
        ++found.hits;
        const geometry::Surface surface = geometry::surfaceAt(world->primitives, ray, hit);
        const auto off = [&](const QuadVector& p) {
            return static_cast<double>(absolute(shape.signedDistance(p)));
        };
        found.position =
            std::max(found.position, off(QuadVector(surface.position)) / surface.error);
        const Quad t = hit.t;
        const QuadVector at(ray.origin.x + t * ray.direction.x, ray.origin.y + t * ray.direction.y,
                            ray.origin.z + t * ray.direction.z);
        const double reach =
            numeric::length(ray.origin) + hit.t * numeric::length(ray.direction) + shape.size;
        found.distance = std::max(found.distance, off(at) / (numeric::kUnitRoundoff * reach));
        for (const double side : {1.0, -1.0}) {
            Vec3 direction = vector();
            direction /= numeric::length(direction);
            const double slope = dot(direction, surface.geometricNormal);
            if (side * slope < 0) direction = -direction;
            if (std::fabs(slope) < 0.05) continue;
            const geometry::Ray leaving = geometry::spawnRay(surface, direction);
            const geometry::Hit next = octree.closest(leaving);
            if (!next) continue;
            // Halfway to an honest hit the ray is well inside or outside; on its own surface it is neither.
            const Quad half = next.t / 2;
            const Quad depth = shape.signedDistance({leaving.origin.x + half * direction.x,
                                                     leaving.origin.y + half * direction.y,
                                                     leaving.origin.z + half * direction.z});
            found.ownSurface += !(side * depth > 4 * surface.error);
        }
    }
    return found;
}

TEST(Analytic, ShapesAreExactAtAllSizesAndPlaces) {
    for (const double size : {1 / 1e6, 1 / 1e3, 1.0, 1e3, 1e6})
        for (const double away : {0.0, 1000.0})
            for (const Shape& shape : shapes(size, away * size * Vec3(1, -0.5, 0.25))) {
                const Findings found = shoot(shape);
                const std::string which = shape.type + " of size " + std::to_string(size) + ", " +
                                          std::to_string(away) + " sizes away";
                EXPECT_GT(found.hits, rayCount() / 300) << which;
                EXPECT_EQ(found.ownSurface, 0) << which;
                EXPECT_LE(found.position, 1) << which;
                EXPECT_LE(found.distance, tolerance::kAnalyticSurface) << which;
                if (std::getenv("RT_ANALYTIC_RAYS") != nullptr)
                    std::printf("%s: %d hits, position %.3f, distance %.2f u\n", which.c_str(),
                                found.hits, found.position, found.distance);
            }
}

} // namespace
} // namespace rt::plugin_host
