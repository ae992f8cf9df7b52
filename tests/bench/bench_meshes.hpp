// Meshes to measure on: files, or made here.
#pragma once
#include <core/numeric/vec.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace rt::bench {

using numeric::Vec3;

struct Mesh {
    std::string name;
    std::vector<Vec3> positions; // values that f32 can hold, so that Embree sees the same geometry
    std::vector<std::array<std::uint32_t, 3>> indices;
    Vec3 eye, target, light;
    double fieldOfView = 0;                               // whole angle, radians
    std::uint32_t firstOfBody = 0, firstVertexOfBody = 0; // of the part that moves; 0: none
};

/// `what` is a mesh file that rt's loader reads, or one of
///   scan70k  bumpy knot of 70 394 triangles of all sizes, as a scanner gives
///   scan870k the same of 872 000
///   ico      displaced sphere of 1.3 million triangles
///   bodies   three displaced spheres of 983 040, and one of 81 920 circling them
///   stadium  a dense object of 1/100 of the size of the terraces around it, 150 000
///   soup     500 000 unconnected triangles
///   sliver   20 000 long needles
/// followed, after '*', by how often each triangle is cut into four. Throws std::runtime_error.
Mesh makeMesh(const std::string& what);

struct Ball {
    Vec3 center;
    double radius;
};
/// flake: the recursive sphereflake of 7381 spheres; random: 100 000.
std::vector<Ball> makeBalls(const std::string& what);

} // namespace rt::bench
