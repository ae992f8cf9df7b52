// B: no box of the tree hides a hit. What the scalar kernel finds on the primitive that was aimed at, the tree must
// answer with, or with something nearer.
#include <tests/stability/cases.hpp>

#include <core/geometry/intersect.hpp>
#include <core/octree/octree.hpp>
#include <tests/stability/counting.hpp>
#include <tests/stability/quad.hpp>
#include <tests/tolerance.hpp>

#include <cmath>

namespace rt::stability {

namespace {

using geometry::Hit;
using geometry::Primitives;
using geometry::Ray;
using octree::Octree;
using octree::Simd;

const double kZeros[] = {0.0, -0.0};

struct Aimed {
    Ray ray;
    std::uint32_t face;
};

/// Faces are tried in a tree of each SIMD level in turn.
template <class Aim>
Tally hidden(const test::Mesh& mesh, std::uint64_t rays, std::uint64_t seed, const Aim& aim) {
    Primitives p;
    test::addMesh(p, mesh.positions, mesh.indices, false);
    std::vector<Octree> trees;
    for (const Simd simd : {Simd::avx512, Simd::avx2, Simd::baseline})
        if (Octree::supports(simd)) trees.push_back(Octree::build(p, {.simd = simd}));
    return tally(rays, seed, [&](Random& random, Tally& sum) {
        Aimed aimed;
        aimed.face = random.below(static_cast<std::uint32_t>(mesh.indices.size()));
        const auto& t = mesh.indices[aimed.face];
        const Vec3 corners[] = {mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]};
        aim(random, corners, aimed.ray);
        Hit alone;
        if (!geometry::intersectTriangle(geometry::frameOf(aimed.ray), corners[0], corners[1],
                                         corners[2], aimed.ray.tMax, alone))
            return;
        const Octree& tree = trees[sum.of % trees.size()];
        const Hit hit = tree.closest(aimed.ray);
        sum.add(!(hit && hit.t <= alone.t) || !tree.occluded(aimed.ray));
    });
}

Vec3 inside(const Vec3 corners[3], Random& random) {
    const double u = random.unit(), v = random.unit() * (1 - u);
    return corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
}

/// n x n quads in the plane z = 0: all boxes are flat.
test::Mesh sheet(std::uint32_t n) {
    test::Mesh m;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i)
            m.positions.push_back({double(i) / n, double(j) / n, 0.25});
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            m.indices.insert(m.indices.end(), {{a, b, d}, {a, d, c}});
        }
    return m;
}

} // namespace

void boxes(const Load& load, Table& table) {
    const std::uint64_t rays = load.of(100'000, 25'000'000);
    // Corners on a grid of powers of two, so that split planes, origins and corners coincide.
    const test::Mesh cube = test::box(16, Vec3(1.0), Vec3(0.0));
    const Tally zero = hidden(cube, rays, load.seed, [](Random& random, const Vec3* c, Ray& ray) {
        const Vec3 spot = random.below(2) ? c[random.below(3)] : inside(c, random);
        ray.origin = {random.below(33) / 8.0 - 2, random.below(33) / 8.0 - 2,
                      random.below(33) / 8.0 - 2};
        const int axis = static_cast<int>(random.below(3));
        ray.origin[axis] = spot[axis];
        if (random.below(2)) ray.origin[(axis + 1) % 3] = spot[(axis + 1) % 3];
        ray.direction = spot - ray.origin;
        for (int i = 0; i < 3; ++i)
            if (ray.direction[i] == 0) ray.direction[i] = kZeros[random.below(2)];
        if (ray.direction == Vec3(0.0)) ray.direction = {0, 0, 1};
    });
    table.count("B1", "directions with +-0, starts and corners on split planes: hidden", zero.wrong,
                zero.of);
    const Tally flat =
        hidden(sheet(32), rays, load.seed, [](Random& random, const Vec3* c, Ray& ray) {
            const Vec3 spot = inside(c, random);
            ray.origin = {random.in(-2, 3), random.in(-2, 3),
                          0.25 + (random.below(2) ? 1 : -1) * std::pow(10.0, random.in(-12, 1))};
            ray.direction = spot - ray.origin;
        });
    table.count("B2", "flat boxes, starts 1e-12 to 10 off their plane: hidden", flat.wrong,
                flat.of);
    const test::Mesh bumps = test::icosphere(5, 1, Vec3(0.0), 0.05);
    const Tally tight = hidden(bumps, rays, load.seed, [](Random& random, const Vec3* c, Ray& ray) {
        ray.origin = random.inBox(3);
        ray.direction = c[random.below(3)] - ray.origin;
    });
    table.count("B3", "rays to corners, which touch the sides of their boxes: hidden", tight.wrong,
                tight.of);
    const Tally far = hidden(cube, rays, load.seed, [](Random& random, const Vec3* c, Ray& ray) {
        const std::uint32_t corner = random.below(3);
        const Vec3 spot = c[corner] + random.unit() * (c[(corner + 1) % 3] - c[corner]);
        ray.origin = random.direction() * 1e5;
        ray.direction = spot - ray.origin;
    });
    table.count("B4", "edges from 1e5 away: hidden", far.wrong, far.of);

    // B5: 2048 planes in a row. The tree never moves a ray's start, so nothing accumulates.
    for (const double away : {0.0, 1e3, 1e5}) {
        Primitives p;
        std::vector<geometry::Parallelogram> planes;
        for (int i = 0; i < 2048; ++i)
            planes.push_back({{away + i, away - 4096, away - 4096}, {0, 8192, 0}, {0, 0, 8192}});
        test::addParallelograms(p, planes);
        const Octree tree = Octree::build(p);
        const Tally lateral = tally(load.of(40, 4'000), load.seed, [&](Random& random, Tally& sum) {
            Ray ray;
            ray.origin = Vec3(away) + random.inBox(0.5) - Vec3(1, 0, 0);
            ray.direction = {1, random.in(-1, 1), random.in(-1, 1)};
            std::vector<geometry::Crossing> crossings;
            tree.crossings(ray, {}, crossings);
            if (crossings.size() != planes.size()) return sum.error(NAN);
            for (std::size_t i = 0; i < crossings.size(); ++i) {
                // direction.x is 1: t is how far the plane is; in cells, which are 1 wide.
                const Quad exact = Quad(planes[i].origin.x) - Quad(ray.origin.x);
                sum.error(magnitude(Quad(crossings[i].t) - exact));
            }
        });
        table.measure("B5",
                      "2048 planes in a row, at " + std::to_string(std::lround(away)) +
                          ": off the straight line",
                      lateral.worst, numeric::gamma(8) * (away + 2048), "cells", lateral.of);
    }
}

} // namespace rt::stability
