// Scenes and rays for the octree's tests: mixed kinds, hard cases, fixed seeds.
#pragma once
#include <core/geometry/ray.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace rt::test {

using geometry::Primitives;
using geometry::Ray;
using numeric::Vec3;

/// Numbers that are the same with every standard library.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits();
    double unit(); // in [0, 1)
    double in(double low, double high) { return low + (high - low) * unit(); }
    Vec3 inBox(double half) { return {in(-half, half), in(-half, half), in(-half, half)}; }
    Vec3 direction(); // unit, uniform
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits() % n); }

private:
    std::uint64_t state_;
};

struct Scene {
    std::string name;
    std::unique_ptr<Primitives> primitives = std::make_unique<Primitives>();
    Vec3 center{0.0};
    double size = 1; // half extent where most primitives are
};

/// Adders append one segment each.
void addMesh(Primitives& p, const std::vector<Vec3>& positions,
             const std::vector<std::array<std::uint32_t, 3>>& indices, bool solid = true);
void addSpheres(Primitives& p, const std::vector<geometry::Sphere>& spheres);
void addParallelograms(Primitives& p, const std::vector<geometry::Parallelogram>& all);
/// Custom spheres of a plugin shape.
void addCustoms(Primitives& p, const std::vector<geometry::Sphere>& spheres, bool withCrossings);

struct Mesh {
    std::vector<Vec3> positions;
    std::vector<std::array<std::uint32_t, 3>> indices;
};
/// Closed: 20 · 4^levels triangles, corners on a sphere moved in and out by `bumps` of the radius.
Mesh icosphere(int levels, double radius, Vec3 center, double bumps = 0);
/// Closed: a tube bent to a ring.
Mesh torus(std::uint32_t around, std::uint32_t across, double radius, double tube, Vec3 center);
/// Closed: a box of n x n quads a side, each cut in two.
Mesh box(std::uint32_t n, Vec3 half, Vec3 center);
/// Closed: a thin needle-shaped ellipsoid of long triangles.
Mesh needles(std::uint32_t around, std::uint32_t along, Vec3 half, Vec3 center);

/// Six scenes of at least 10 000 primitives.
std::vector<Scene> mixedScenes();

/// Ray number i of a scene: random ones, aimed at corners and edges, along axes, from surfaces, with
/// and without an end.
Ray rayFor(const Scene& scene, std::uint64_t i);

} // namespace rt::test
