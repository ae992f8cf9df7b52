#include "line_votes.hpp"

#include "exact.hpp"
#include "triangulate.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rt::loaders {
namespace {

double component(const Vector3& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

/// Parallel lines, given by their crossings with a plane across them.
class Lines {
public:
    explicit Lines(const std::vector<Vector2>& at) {
        std::vector<std::uint32_t> order(at.size());
        for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return at[a].y != at[b].y ? at[a].y < at[b].y : at[a].x < at[b].x;
        });
        for (const std::uint32_t i : order) {
            if (rowY_.empty() || rowY_.back() != at[i].y) {
                rowY_.push_back(at[i].y);
                rowStart_.push_back(static_cast<std::uint32_t>(x_.size()));
            }
            x_.push_back(at[i].x), id_.push_back(i);
        }
        rowStart_.push_back(static_cast<std::uint32_t>(x_.size()));
    }

    /// Calls visit(id, crossing) for the lines that cross the rectangle.
    template <class Visit> void within(Vector2 lower, Vector2 upper, Visit&& visit) const {
        const auto first = std::lower_bound(rowY_.begin(), rowY_.end(), lower.y);
        for (auto row = static_cast<std::size_t>(first - rowY_.begin());
             row < rowY_.size() && rowY_[row] <= upper.y; ++row) {
            const auto from = x_.begin() + rowStart_[row], to = x_.begin() + rowStart_[row + 1];
            for (auto x = std::lower_bound(from, to, lower.x); x != to && *x <= upper.x; ++x)
                visit(id_[static_cast<std::size_t>(x - x_.begin())], Vector2{*x, rowY_[row]});
        }
    }

private:
    std::vector<double> rowY_, x_;
    std::vector<std::uint32_t> rowStart_, id_;
};

/// Calls visit(line, depth along `axis`, +1 or -1: the side of the face seen from the far end, face) for
/// every crossing.
template <class Visit>
void castLines(const PolygonView& mesh, std::span<const std::uint32_t> faces, int axis,
               const Lines& lines, Visit&& visit) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    std::vector<Vector3> corners;
    const auto flat = [&](const Vector3& p) { return Vector2{component(p, u), component(p, v)}; };
    for (const std::uint32_t face : faces) {
        Vector2 lower{kInfinity, kInfinity}, upper{-kInfinity, -kInfinity};
        for (auto c = mesh.faceStart[face]; c < mesh.faceStart[face + 1]; ++c) {
            const Vector2 q = flat(mesh.positions[mesh.vertex[c]]);
            lower = {std::min(lower.x, q.x), std::min(lower.y, q.y)};
            upper = {std::max(upper.x, q.x), std::max(upper.y, q.y)};
        }
        corners.clear();
        Vector3 normal;
        lines.within(lower, upper, [&](std::uint32_t line, Vector2 at) {
            if (corners.empty()) {
                for (auto c = mesh.faceStart[face]; c < mesh.faceStart[face + 1]; ++c)
                    corners.push_back(mesh.positions[mesh.vertex[c]]);
                normal = newellNormal(corners);
            }
            // Crossing number with exact sides: an edge that two faces share is counted alike by both.
            bool inside = false;
            for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
                Vector2 a = flat(corners[j]), b = flat(corners[i]);
                if ((a.y > at.y) == (b.y > at.y)) continue;
                if (a.y > b.y) std::swap(a, b);
                if (orientation(a, b, at) > 0) inside = !inside;
            }
            const double along = component(normal, axis);
            if (!inside || along == 0) return;
            const Vector2 q = flat(corners[0]);
            const double depth =
                component(corners[0], axis) -
                ((at.x - q.x) * component(normal, u) + (at.y - q.y) * component(normal, v)) / along;
            visit(line, depth, along > 0 ? 1 : -1, face);
        });
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
    std::vector<Vector2> at(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    std::vector<Ends> ends;
    long votes = 0, total = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        // Off the middle of the grid's cells, where symmetric models have their edges.
        constexpr double kOffset = 0.4142;
        for (std::size_t i = 0; i < at.size(); ++i) {
            const auto column = static_cast<double>(i % static_cast<std::size_t>(side));
            const auto row = static_cast<double>(i / static_cast<std::size_t>(side));
            at[i] = {lower[u] + (upper[u] - lower[u]) * ((column + kOffset) / side),
                     lower[v] + (upper[v] - lower[v]) * ((row + kOffset) / side)};
        }
        ends.assign(at.size(), {});
        castLines(mesh, faces, axis, Lines(at),
                  [&](std::uint32_t line, double depth, int winding, std::uint32_t face) {
                      if (flipped[face]) winding = -winding;
                      Ends& e = ends[line];
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
    std::vector<Vector2> at;
    for (const Vector3& p : points) at.push_back({p.x, p.y});
    std::vector<char> inside(points.size(), 0);
    castLines(mesh, faces, 2, Lines(at), [&](std::uint32_t l, double depth, int, std::uint32_t) {
        if (depth > points[l].z) inside[l] ^= 1;
    });
    return inside;
}

} // namespace rt::loaders
