// T: accuracy of t and of normals on the thinnest triangles. (Leaks: closed_meshes.cpp.)
#include <tests/stability/cases.hpp>

#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>
#include <tests/stability/counting.hpp>
#include <tests/stability/quad.hpp>
#include <tests/tolerance.hpp>

#include <cmath>
#include <numbers>

namespace rt::stability {

namespace {

using geometry::Primitives;
using geometry::Ray;

double degreesOff(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& normal) {
    const QVec n = cross(QVec(b) - QVec(a), QVec(c) - QVec(a)), off = cross(n, QVec(normal));
    if (!(dot(n, QVec(normal)) > 0)) return 180;
    return magnitude(squareRoot(dot(off, off) / dot(n, n))) * 180 / std::numbers::pi;
}

} // namespace

void triangles(const Load& load, Table& table) {
    // t on needles, held against the plane of the face that was hit.
    const test::Mesh mesh = test::needles(2000, 8, Vec3(1.0), Vec3(0.0));
    Primitives p;
    test::addMesh(p, mesh.positions, mesh.indices);
    const octree::Octree tree = octree::Octree::build(p);
    const Tally distance =
        tally(load.of(50'000, 20'000'000), load.seed, [&](Random& random, Tally& sum) {
            Ray ray;
            ray.origin = random.inBox(1.5);
            ray.direction = random.direction();
            const geometry::Hit hit = tree.closest(ray);
            if (!hit) return;
            const auto& t = mesh.indices[static_cast<std::uint32_t>(hit.id)];
            const QVec a(mesh.positions[t[0]]);
            const QVec n = cross(QVec(mesh.positions[t[1]]) - a, QVec(mesh.positions[t[2]]) - a);
            const Quad along = dot(n, QVec(ray.direction));
            const Quad exact = dot(n, a - QVec(ray.origin)) / along;
            // What rounding does to the problem itself. A corner off by u of its distance moves the plane by
            // as much. And the edge functions, six products of distances from the ray in all, are off by u
            // of those: over their sum, twice the area as the ray sees it, an error of the weights, which
            // count with the difference of depths.
            const double length = numeric::length(ray.direction);
            double reach = 0, beside = 0, nearest = numeric::kInfinity, farthest = 0;
            for (const std::uint32_t corner : t) {
                const Vec3 to = mesh.positions[corner] - ray.origin;
                const double depth = numeric::dot(to, ray.direction) / length;
                reach = std::fmax(reach, numeric::length(to));
                beside = std::fmax(beside, numeric::length(to - ray.direction * (depth / length)));
                nearest = std::fmin(nearest, depth), farthest = std::fmax(farthest, depth);
            }
            const double cosine = magnitude(along / squareRoot(dot(n, n))) / length;
            const double seen = magnitude(along) / length;
            const double moved =
                (reach / cosine + 6 * beside * beside / seen * (farthest - nearest)) / length;
            sum.error(magnitude(Quad(hit.t) - exact) / (numeric::kUnitRoundoff * moved));
        });
    table.measure(
        "T2",
        "t on needles, over what one rounding does to the problem (the kernel's shear alone is "
        "three, in each of two components of a corner)",
        distance.worst, tolerance::kNeedleDistance, "u", distance.of);
    for (const double thin : {1 / 1e3, 1 / 1e5, 1 / 1e6}) {
        const Tally normals =
            tally(load.of(5'000, 4'000'000), load.seed, [&](Random& random, Tally& sum) {
                const double size = std::pow(10.0, random.in(-6, 6));
                const Vec3 a = random.inBox(100) * size, b = a + random.direction() * size;
                const Vec3 c = a + (b - a) * random.unit() + random.direction() * (thin * size);
                const QVec n = cross(QVec(b) - QVec(a), QVec(c) - QVec(a));
                const Vec3 normal = geometry::triangleNormal(a, b, c);
                if (dot(n, n) > 0) sum.error(degreesOff(a, b, c, normal));
            });
        table.measure("T7",
                      "normal of slivers 1 : 1e" + std::to_string(std::lround(std::log10(thin))),
                      normals.worst, tolerance::kNormalDegrees, "degrees", normals.of);
    }
}

} // namespace rt::stability
