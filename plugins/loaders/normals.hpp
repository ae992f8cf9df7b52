// Corner normals of a triangle mesh over OpenMesh's half-edges: angle-weighted, broken at hard edges.
#pragma once
#include <rt/plugin.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace rt::loaders {

/// Triangles whose half-edges know their mates. Half-edge 3 t + i runs from corner i of triangle t to the next.
struct ConnectedTriangles {
    std::span<const Vector3> positions;
    std::vector<std::array<std::uint32_t, 3>> vertices; // into positions
    std::vector<std::uint32_t> mate; // 3 per triangle; runs the other way, or RT_NO_INDEX
    std::vector<std::uint32_t> face; // per triangle: edges inside one face are never hard
};

struct CornerNormals {
    std::vector<Vector3> normals;       // unit
    std::vector<std::uint32_t> corners; // 3 per triangle, into normals; RT_NO_INDEX: flat
};

/// Normals for the corners of every triangle with smooth[t] != 0. The corners round a vertex are split where edges are hard: open,
/// between triangles of different smooth[t], or with an angle between their normals above `creaseAngle`.
/// Within a sector the normal is the sum of the triangles' unit normals weighted with their angles at the vertex
/// [Thuermer & Wuethrich 1998]; a triangle whose normal is lost in the rounding of its corners counts nothing and breaks nothing. A sector
/// whose sum cancels is flat.
CornerNormals cornerNormals(const ConnectedTriangles& mesh, std::span<const std::uint32_t> smooth,
                            Radians creaseAngle);

/// Angle between two vectors, in [0, pi], within 1e-15; the same bits on every CPU. 0 when either is 0.
double angleBetween(const Vector3& a, const Vector3& b);

} // namespace rt::loaders
