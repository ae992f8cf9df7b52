// Polygons to triangles by ear clipping in the plane that shows them largest.
#pragma once
#include <rt/plugin.hpp>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace rt::loaders {

/// Area-weighted normal of a polygon, twice its area long [Newell; Sutherland 1974]. Scaled so that it neither
/// overflows nor underflows: only the direction counts.
Vector3 newellNormal(std::span<const Vector3> polygon);

/// Cuts one polygon after the other; keeps its memory between them.
class Triangulator {
public:
    using Triangle = std::array<std::uint32_t, 3>;

    /// n - 2 triangles over the corners 0 .. n - 1 of `polygon` (n >= 3), wound as the polygon. A simple polygon is
    /// cut without overlap, so that the areas add up to its own; quads along the shorter valid diagonal. Judged in the coordinate
    /// plane most nearly parallel to the polygon, where orientations are exact; where an uneven polygon crosses itself
    /// there, in its best-fit plane. False: it crosses itself there too, and some triangle overlaps another.
    bool cut(std::span<const Vector3> polygon, std::vector<Triangle>& triangles);

private:
    void project(std::span<const Vector3> polygon, const Vector3& normal, bool alongNormal);
    bool cutProjected(std::span<const Vector3> polygon, std::vector<Triangle>& triangles);
    bool quad(std::span<const Vector3> polygon, std::vector<Triangle>& triangles) const;
    bool clipEars(std::vector<Triangle>& triangles);
    bool isEar(std::uint32_t i) const;
    int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const;

    std::vector<Vector2> points_;
    std::vector<std::uint32_t> previous_, next_, reflex_;
    std::vector<char> state_;
};

} // namespace rt::loaders
