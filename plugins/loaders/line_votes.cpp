#include "line_votes.hpp"

#include "exact.hpp"
#include "triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rt::loaders {
namespace {

double component(const Vector3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

struct Line {
    Vector2 at; // in the plane of the two other axes
    std::uint32_t id;
};

/// Calls visit(line id, depth along `axis`, +1 or -1: the face's winding seen from the far end) for every crossing.
/// `lines` are sorted by at.y.
template <class Visit>
void castLines(const PolygonView& mesh, std::span<const std::uint32_t> faces, int axis,
               const std::vector<Line>& lines, Visit&& visit) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::vector<Vector2> outline;
    std::vector<Vector3> corners;
    for (const std::uint32_t face : faces) {
        outline.clear(), corners.clear();
        double minX = kInfinity, maxX = -kInfinity, minY = kInfinity, maxY = -kInfinity;
        for (auto c = mesh.faceStart[face]; c < mesh.faceStart[face + 1]; ++c) {
            const Vector3& p = mesh.positions[mesh.vertex[c]];
            const Vector2 q{component(p, u), component(p, v)};
            minX = std::min(minX, q.x), maxX = std::max(maxX, q.x);
            minY = std::min(minY, q.y), maxY = std::max(maxY, q.y);
            outline.push_back(q), corners.push_back(p);
        }
        auto line = std::lower_bound(lines.begin(), lines.end(), minY,
                                     [](const Line& l, double y) { return l.at.y < y; });
        bool known = false;
        Vector3 normal;
        for (; line != lines.end() && line->at.y <= maxY; ++line) {
            const Vector2 q = line->at;
            if (q.x < minX || q.x > maxX) continue;
            bool inside =
                false; // crossing number with exact sides: what two faces share is counted alike by both
            for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
                Vector2 a = outline[j], b = outline[i];
                if ((a.y > q.y) == (b.y > q.y)) continue;
                if (a.y > b.y) std::swap(a, b);
                if (orientation(a, b, q) > 0) inside = !inside;
            }
            if (!inside) continue;
            if (!known) normal = newellNormal(corners), known = true;
            const double along = component(normal, axis);
            if (along == 0) continue;
            const double depth =
                component(corners[0], axis) - ((q.x - outline[0].x) * component(normal, u) +
                                               (q.y - outline[0].y) * component(normal, v)) /
                                                  along;
            visit(line->id, depth, along > 0 ? 1 : -1, face);
        }
    }
}

} // namespace

double outsideVote(const PolygonView& mesh, std::span<const std::uint32_t> faces,
                   const std::vector<char>& flipped) {
    double lower[3] = {kInfinity, kInfinity, kInfinity};
    double upper[3] = {-kInfinity, -kInfinity, -kInfinity};
    for (const std::uint32_t face : faces)
        for (auto c = mesh.faceStart[face]; c < mesh.faceStart[face + 1]; ++c)
            for (int a = 0; a < 3; ++a) {
                const double x = component(mesh.positions[mesh.vertex[c]], a);
                lower[a] = std::min(lower[a], x), upper[a] = std::max(upper[a], x);
            }

    const int side =
        std::clamp(static_cast<int>(std::sqrt(static_cast<double>(faces.size()))), 4, 32);
    struct Ends {
        double first = kInfinity, last = -kInfinity;
        int firstWinding = 0, lastWinding = 0;
    };
    std::vector<Line> lines(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    std::vector<Ends> ends;
    long votes = 0, total = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        // Off the middle of the grid's cells, where symmetric models have their edges.
        constexpr double kOffset = 0.4142;
        std::size_t id = 0;
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i, ++id)
                lines[id] = {{lower[u] + (upper[u] - lower[u]) * ((i + kOffset) / side),
                              lower[v] + (upper[v] - lower[v]) * ((j + kOffset) / side)},
                             static_cast<std::uint32_t>(id)};
        ends.assign(lines.size(), {});
        castLines(mesh, faces, axis, lines,
                  [&](std::uint32_t l, double depth, int winding, std::uint32_t face) {
                      if (flipped[face]) winding = -winding;
                      Ends& e = ends[l];
                      if (depth < e.first)
                          e.first = depth, e.firstWinding = winding;
                      else if (depth == e.first && winding != e.firstWinding)
                          e.firstWinding = 0;
                      if (depth > e.last)
                          e.last = depth, e.lastWinding = winding;
                      else if (depth == e.last && winding != e.lastWinding)
                          e.lastWinding = 0;
                  });
        for (const Ends& e : ends) {
            votes += e.lastWinding - e.firstWinding;
            total += (e.lastWinding != 0) + (e.firstWinding != 0);
        }
    }
    return total == 0 ? 0 : static_cast<double>(votes) / static_cast<double>(total);
}

std::vector<char> insideOf(const PolygonView& mesh, std::span<const std::uint32_t> faces,
                           std::span<const Vector3> points) {
    std::vector<Line> lines;
    for (std::size_t i = 0; i < points.size(); ++i)
        lines.push_back({{points[i].x, points[i].y}, static_cast<std::uint32_t>(i)});
    std::sort(lines.begin(), lines.end(),
              [](const Line& a, const Line& b) { return a.at.y < b.at.y; });
    std::vector<char> inside(points.size(), 0);
    castLines(mesh, faces, 2, lines, [&](std::uint32_t l, double depth, int, std::uint32_t) {
        if (depth > points[l].z) inside[l] ^= 1;
    });
    return inside;
}

} // namespace rt::loaders
