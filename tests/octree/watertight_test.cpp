// Nothing gets through a closed surface, at any scale; boxes lose nothing; t is what binary128 says.
// RT_OCTREE_RAYS sets the number of rays per mesh and scale.
#include "scenes.hpp"

#include <core/octree/octree.hpp>

#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

namespace rt::test {
namespace {

using octree::Octree;

std::size_t rayCount(std::size_t inCi) {
    const char* const wanted = std::getenv("RT_OCTREE_RAYS");
    return wanted ? static_cast<std::size_t>(std::atoll(wanted)) : inCi;
}

struct Closed {
    const char* name;
    Mesh mesh;
    Vec3 inside;
};

std::vector<Closed> closedMeshes() {
    return {{"bumpy sphere", icosphere(4, 1, Vec3(0.0), 0.03), Vec3(0.0)},
            {"torus", torus(90, 30, 1, 0.4, Vec3(0.0)), Vec3(1, 0, 0)},
            {"box", box(12, {1, 0.5, 0.25}, Vec3(0.0)), Vec3(0.1, 0.05, 0.01)},
            {"needles", needles(600, 6, {0.5, 0.004, 1}, Vec3(0.0)), Vec3(0.0)}};
}

Mesh scaled(const Mesh& mesh, double scale, const Vec3& offset) {
    Mesh m = mesh;
    for (Vec3& p : m.positions) p = p * scale + offset;
    return m;
}

/// A corner or a point of an edge.
Vec3 weakSpot(const Mesh& mesh, Random& random) {
    const auto& t = mesh.indices[random.below(static_cast<std::uint32_t>(mesh.indices.size()))];
    const std::size_t i = random.below(3);
    const Vec3 a = mesh.positions[t[i]], b = mesh.positions[t[(i + 1) % 3]];
    return random.below(2) ? a : a + random.unit() * (b - a);
}

TEST(Watertight, ParallelogramsAndTrianglesShareEdges) {
    // A cube of 3 sides as n x n parallelograms and 3 as triangles, on coordinates that are exact.
    constexpr int kSides = 16;
    const Mesh cube = box(kSides, {1, 1, 1}, Vec3(0.0));
    Mesh half;
    half.positions = cube.positions;
    std::vector<geometry::Parallelogram> tiles;
    for (std::size_t i = 0; i < cube.indices.size(); i += 2) {
        const auto &t = cube.indices[i], &s = cube.indices[i + 1];
        if (i / 2 / (kSides * kSides) % 2 == 0) {
            half.indices.insert(half.indices.end(), {t, s});
        } else { // a, b, c and a, c, d
            const Vec3 a = cube.positions[t[0]];
            tiles.push_back({a, cube.positions[t[1]] - a, cube.positions[s[2]] - a});
        }
    }
    Primitives p;
    addMesh(p, half.positions, half.indices);
    addParallelograms(p, tiles);
    ASSERT_GT(tiles.size(), 500u);
    const Octree tree = Octree::build(p);
    Random random(5);
    for (std::size_t i = 0; i < rayCount(50000); ++i) {
        Ray ray;
        ray.origin = random.inBox(0.5);
        ray.direction = weakSpot(cube, random) - ray.origin;
        std::vector<geometry::Crossing> crossings;
        ASSERT_TRUE(tree.closest(ray)) << i;
        ASSERT_TRUE(tree.crossings(ray, {}, crossings));
        ASSERT_EQ(1u, crossings.size()) << i;
    }
}

TEST(Boxes, LoseNoHitAtAnyScale) {
    std::size_t hits = 0, rays = 0;
    for (int exponent = -30; exponent <= 30; exponent += 5)
        for (const double away : {0.0, 1.0, 1e5}) {
            const double scale = std::pow(10.0, exponent);
            const Vec3 offset = Vec3(0.3, 1, -0.6) * (away * scale);
            const Mesh mesh = scaled(icosphere(3, 1, Vec3(0.0), 0.3), scale, offset),
                       cube = scaled(box(6, {0.7, 0.7, 0.7}, Vec3(0.0)), scale, offset);
            Primitives p;
            addMesh(p, mesh.positions, mesh.indices);
            addMesh(p, cube.positions, cube.indices); // flat boxes
            addSpheres(p, {{offset, 0.1 * scale}, {offset + Vec3(scale), 0.01 * scale}});
            const Octree tree = Octree::build(p);
            Random random(static_cast<std::uint64_t>(exponent + 77));
            for (std::size_t i = 0; i < rayCount(1500); ++i) {
                const Mesh& target = i & 1 ? mesh : cube;
                Ray ray;
                const double reach = i % 5 == 0 ? 1e6 : i % 5 == 1 ? 0.001 : 2;
                const Vec3 spot = weakSpot(target, random);
                ray.origin = offset + random.inBox(reach * scale);
                if (i % 7 == 0) ray.origin[static_cast<int>(random.below(3))] = spot[0];
                ray.direction = spot - ray.origin;
                if (i % 3 == 0) { // in a plane, along an axis
                    const int axis = static_cast<int>(random.below(3));
                    ray.direction[axis] = random.below(2) ? 0.0 : -0.0;
                    ray.origin[axis] = spot[axis];
                    if (i % 2) {
                        ray.direction[(axis + 1) % 3] = random.below(2) ? 0.0 : -0.0;
                        ray.origin[(axis + 1) % 3] = spot[(axis + 1) % 3];
                    }
                }
                if (i % 11 == 0) // all but denormal
                    ray.direction[static_cast<int>(random.below(3))] =
                        std::numeric_limits<double>::denorm_min();
                ray.direction *= i % 4 == 0 ? 1 / 1e30 : i % 4 == 1 ? 1e30 : 1;
                const auto hit = tree.closest(ray), expected = tree.closestWithoutTree(ray);
                ASSERT_EQ(expected.id, hit.id) << "10^" << exponent << ", ray " << i;
                ASSERT_EQ(expected.t, hit.t) << "10^" << exponent << ", ray " << i;
                ASSERT_EQ(static_cast<bool>(expected), tree.occluded(ray));
                hits += static_cast<bool>(hit);
                ++rays;
            }
        }
    EXPECT_GT(hits, rays / 2) << "most rays miss: the test is weak";
}

TEST(Boxes, NaNAndZeroDirectionsAreMisses) {
    const auto scenes = mixedScenes();
    const Scene& scene = scenes[0];
    const Octree tree = Octree::build(*scene.primitives);
    const double nan = std::numeric_limits<double>::signaling_NaN();
    for (int i = 0; i < 3; ++i) {
        Ray ray;
        ray.origin = Vec3(0.0);
        ray.direction = {1, 2, 3};
        Ray other = ray;
        ray.origin[i] = nan;
        other.direction[i] = nan;
        EXPECT_FALSE(tree.closest(ray));
        EXPECT_FALSE(tree.closest(other));
        EXPECT_FALSE(tree.occluded(ray));
        EXPECT_FALSE(tree.occluded(other));
    }
    Ray still;
    still.origin = {0.1, 0.2, 0.3};
    still.direction = Vec3(0.0);
    EXPECT_FALSE(tree.closest(still));
}

TEST(Boxes, NaNPrimitivesAreNeverHit) {
    Primitives p;
    const double nan = std::numeric_limits<double>::quiet_NaN();
    addMesh(p, {{0, 0, 0}, {1, 0, 0}, {0, nan, 0}}, {{0, 1, 2}}, false);
    addMesh(p, {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, {{0, 1, 2}}, false);
    addSpheres(p, {{{nan, 0, 0}, 1}, {{0, 0, 5}, nan}});
    const Octree tree = Octree::build(p);
    Ray ray;
    ray.origin = {0.2, 0.2, -1};
    ray.direction = {0, 0, 1};
    EXPECT_EQ(geometry::PrimitiveId{1}, tree.closest(ray).id);
}

using Quad = __float128;

/// [Möller, Trumbore 1997] in binary128.
bool quadHit(const Vec3& a, const Vec3& b, const Vec3& c, const Ray& ray, Quad& t) {
    Quad e1[3], e2[3], d[3], s[3];
    for (int i = 0; i < 3; ++i) {
        e1[i] = static_cast<Quad>(b[i]) - a[i];
        e2[i] = static_cast<Quad>(c[i]) - a[i];
        d[i] = ray.direction[i];
        s[i] = static_cast<Quad>(ray.origin[i]) - a[i];
    }
    const auto cross = [](const Quad* x, const Quad* y, Quad* z) {
        for (int i = 0; i < 3; ++i)
            z[i] = x[(i + 1) % 3] * y[(i + 2) % 3] - x[(i + 2) % 3] * y[(i + 1) % 3];
    };
    const auto dot = [](const Quad* x, const Quad* y) {
        return x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
    };
    Quad p[3], q[3];
    cross(d, e2, p);
    const Quad determinant = dot(e1, p);
    if (determinant == 0) return false;
    const Quad u = dot(s, p) / determinant;
    cross(s, e1, q);
    const Quad v = dot(d, q) / determinant;
    if (!(u >= 0 && v >= 0 && u + v <= 1)) return false;
    t = dot(e2, q) / determinant;
    return t > 0;
}

TEST(Accuracy, AgreesWithBinary128) {
    for (const Closed& closed : closedMeshes()) {
        Primitives p;
        addMesh(p, closed.mesh.positions, closed.mesh.indices);
        const Octree tree = Octree::build(p);
        Random random(23);
        double worst = 0;
        for (std::size_t i = 0; i < std::min<std::size_t>(rayCount(150), 20000); ++i) {
            Ray ray;
            ray.origin = random.inBox(1.5);
            ray.direction = random.direction();
            Quad best = HUGE_VAL;
            std::uint32_t id = static_cast<std::uint32_t>(geometry::kNoPrimitive);
            for (std::uint32_t k = 0; k < p.triangles.indices.size(); ++k) {
                const auto& c = p.triangles.indices[k];
                Quad t;
                if (quadHit(p.triangles.positions[c[0]], p.triangles.positions[c[1]],
                            p.triangles.positions[c[2]], ray, t) &&
                    t < best) {
                    best = t;
                    id = k;
                }
            }
            const auto hit = tree.closest(ray);
            ASSERT_EQ(id, static_cast<std::uint32_t>(hit.id)) << closed.name << ", ray " << i;
            if (!hit) continue;
            const Quad error = (static_cast<Quad>(hit.t) - best) / best;
            worst = std::max(worst, std::fabs(static_cast<double>(error)));
        }
        EXPECT_LE(worst, tolerance::kHitDistance) << closed.name;
    }
}

} // namespace
} // namespace rt::test
