// A sphere under a shear or an unequal scale: an ellipsoid, held against its exact equation in binary128.
#include <core/numeric/rounding.hpp>
#include <core/numeric/transform.hpp>
#include <tests/plugin_host/describe.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <random>

namespace rt::plugin_host {
namespace {

using Exact = __float128;
using numeric::AffineTransform;
using numeric::Mat3;
using numeric::Vec3;

struct ExactVec {
    Exact x, y, z;
    friend ExactVec operator-(ExactVec a, ExactVec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};
Exact dot(ExactVec a, ExactVec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
ExactVec exact(const Vec3& v) { return {v.x, v.y, v.z}; }

/// Solves m x = v by Cramer's rule.
ExactVec solve(const Mat3& m, const ExactVec& v) {
    const auto cross = [](ExactVec a, ExactVec b) {
        return ExactVec{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    };
    const ExactVec a = exact(m[0]), b = exact(m[1]), c = exact(m[2]);
    const Exact determinant = dot(a, cross(b, c));
    return {dot(v, cross(b, c)) / determinant, dot(a, cross(v, c)) / determinant,
            dot(a, cross(b, v)) / determinant};
}

/// f(t) = |objectFromWorld(o + t d) - c|² - r² = a t² + 2 b t + c, exactly from the given numbers.
struct Quadratic {
    Exact a, b, c;
    Exact discriminant() const { return b * b - a * c; }
    Exact at(Exact t) const { return (a * t + 2 * b) * t + c; }
};

Quadratic quadraticOf(const AffineTransform& worldFromObject, const Vec3& center, double radius,
                      const Vec3& origin, const Vec3& direction) {
    const ExactVec o =
        solve(worldFromObject.linear, exact(origin) - exact(worldFromObject.translation));
    const ExactVec d = solve(worldFromObject.linear, exact(direction)), f = o - exact(center);
    return {dot(d, d), dot(f, d), dot(f, f) - Exact(radius) * radius};
}

const AffineTransform kMaps[] = {
    {Mat3(Vec3(1, 0, 0), Vec3(0.5, 1, 0), Vec3(0, 0, 1)), Vec3(0.0)},           // shear
    {Mat3(Vec3(3, 0, 0), Vec3(0, 0.25, 0), Vec3(0, 0, 1)), Vec3(5, -3, 2)},     // unequal scale
    {Mat3(Vec3(-1, 0.25, 0), Vec3(0, 2, 0), Vec3(0.5, 0, 1)), Vec3(1, 1, 100)}, // with a mirror
};

TEST(ObjectSphere, AgreesWithTheExactEllipsoid) {
    const Vec3 center(0.5, -0.25, 1);
    const double radius = 1.5;
    for (const AffineTransform& map : kMaps) {
        test::Scene scene({RT_SHIPPED_PLUGINS});
        scene.add("sphere", {{"center", center}, {"radius", radius}}).worldFromObject = map;
        const auto world = scene.lower();
        ASSERT_TRUE(world) << scene.said();
        ASSERT_TRUE(world->primitives.spheres.empty()); // never a wrong sphere
        ASSERT_EQ(world->primitives.customs.primitives.size(), 1u);
        EXPECT_TRUE(world->primitives.segments[0].solid);
        const geometry::CustomShape& custom = *world->primitives.customs.shapes[0];
        const auto& box = world->primitives.customs.primitives[0].bounds;

        std::mt19937_64 random(7);
        std::uniform_real_distribution<double> uniform(-1, 1);
        int hits = 0, misses = 0;
        double worst = 0;
        for (int i = 0; i < 20000; ++i) {
            const Vec3 origin =
                map.point(center) + 8.0 * Vec3(uniform(random), uniform(random), uniform(random));
            const Vec3 target =
                map.point(center + 2.0 * Vec3(uniform(random), uniform(random), uniform(random)));
            const Vec3 direction = target - origin;
            const Quadratic q = quadraticOf(map, center, radius, origin, direction);
            const Vec3 o = custom.objectFromWorld.point(origin),
                       d = custom.objectFromWorld.direction(direction);
            const rt_ray ray{{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, numeric::kInfinity};
            rt_hit hit;
            hit.t = -1;
            const std::uint32_t id = 0;
            const bool found = custom.shape.intersect(custom.shape.data, &id, 1, &ray, &hit) != 0;
            // What rounding may change: the sign of a discriminant within its own error bound, the side of t = 0.
            const Exact slack =
                tolerance::roundings(64) * (q.b * q.b + q.a * Exact(64 * radius * radius));
            const bool inside = q.c < 0;
            if (!inside && (q.discriminant() < slack || q.b > 0)) {
                if (q.discriminant() < -slack || q.b > 0) {
                    ASSERT_FALSE(found);
                    EXPECT_EQ(hit.t, -1); // a miss writes nothing
                    ++misses;
                }
                continue;
            }
            ASSERT_TRUE(found);
            ++hits;
            // f(t) / 2r is how far o + t d is from the surface in object space. What may be off: the map of the ray
            // to object space (rounding of the map's terms) and the root (of the ray's length up to there).
            const Vec3 terms = numeric::Mat3(numeric::abs(custom.objectFromWorld.linear[0]),
                                             numeric::abs(custom.objectFromWorld.linear[1]),
                                             numeric::abs(custom.objectFromWorld.linear[2])) *
                                   (numeric::abs(origin) + numeric::abs(map.translation) +
                                    hit.t * numeric::abs(direction)) +
                               numeric::abs(center);
            const double distance = std::fabs(static_cast<double>(q.at(hit.t))) / (2 * radius);
            worst = std::max(worst, distance / length(terms));
            const Vec3 p(hit.position[0], hit.position[1], hit.position[2]),
                n(hit.normal[0], hit.normal[1], hit.normal[2]);
            EXPECT_LE(std::fabs(length(p - center) - radius),
                      hit.position_error + tolerance::roundings(4) * radius);
            EXPECT_NEAR(length(n), 1, tolerance::roundings(8));
            EXPECT_GT(dot(exact(n), exact(p - center)), Exact(0)); // outward
            const Vec3 w = custom.worldFromObject.point(p);
            EXPECT_TRUE(w.x >= box.min.x && w.x <= box.max.x && w.y >= box.min.y &&
                        w.y <= box.max.y && w.z >= box.min.z && w.z <= box.max.z);
            double t[4];
            const std::uint32_t crossings =
                custom.shape.crossings(custom.shape.data, 0, &ray, t, 4);
            EXPECT_EQ(crossings, inside ? 1u : 2u);
            EXPECT_EQ(t[0], hit.t);
        }
        EXPECT_LE(worst, tolerance::roundings(4)); // measured: 1.93 u
        EXPECT_GT(hits, 4000);
        EXPECT_GT(misses, 1000);
    }
}

TEST(ObjectSphere, PrefersTheLowestOfEqualHitsInAnyOrder) {
    test::Scene scene({RT_SHIPPED_PLUGINS, std::filesystem::path(RT_TEST_MODULES) / "twins"});
    scene.add("twins").worldFromObject = kMaps[0];
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    const geometry::CustomShape& custom = *world->primitives.customs.shapes[0];
    const rt_ray ray{{0, 0, -5}, 0, {0, 0, 1}, numeric::kInfinity};
    for (const auto& order : {std::array<std::uint32_t, 3>{0, 1, 2}, {2, 1, 0}, {1, 2, 0}}) {
        rt_hit hit;
        ASSERT_EQ(custom.shape.intersect(custom.shape.data, order.data(), 3, &ray, &hit), 1);
        EXPECT_EQ(hit.primitive, 0u);
        EXPECT_EQ(hit.t, 4);
    }
    const rt_ray nan{{0, 0, std::nan("")}, 0, {0, 0, 1}, numeric::kInfinity};
    rt_hit hit;
    hit.t = -1;
    const std::uint32_t id = 0;
    EXPECT_EQ(custom.shape.intersect(custom.shape.data, &id, 1, &nan, &hit), 0); // a NaN is a miss
    EXPECT_EQ(hit.t, -1);
}

} // namespace
} // namespace rt::plugin_host
