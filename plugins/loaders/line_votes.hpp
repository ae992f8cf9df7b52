// Lines along an axis through a set of polygons: which lies outermost, and is a point inside?
#pragma once
#include <rt/plugin.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace rt::loaders {

/// Polygons as an importer holds them: corner positions of face f.
struct PolygonView {
    std::span<const Vector3> positions;
    std::span<const std::uint32_t> vertex;    // per corner
    std::span<const std::uint32_t> faceStart; // as in MeshFile
};

/// How a component looks from outside: along parallel lines on a regular grid, three axes, both directions, the
/// face seen first votes for or against the winding that faces the viewer
/// (after Takayama et al. 2014, with parallel rays). +1: every first face is wound outward, -1: inward,
/// 0: undecided, as for a flat sheet. `flipped` per face. Deterministic.
double outsideVote(const PolygonView& mesh, std::span<const std::uint32_t> faces,
                   const std::vector<char>& flipped);

/// Per point: is it inside the closed component `faces`? Parity of exact crossings of a line along z; a point
/// on the surface is in or out.
std::vector<char> insideOf(const PolygonView& mesh, std::span<const std::uint32_t> faces,
                           std::span<const Vector3> points);

} // namespace rt::loaders
