#include "normals.hpp"

#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rt::loaders {
namespace {

constexpr std::uint32_t kNone = RT_NO_INDEX;

/// arctan of x in [0, 1]: the nearest sixteenth from the table, the rest, at most 1/32, by its series, whose first
/// term left out is below 2^-64. [Muller 2016, ch. 4: table-driven reduction]
double arctangent(double x) {
    static constexpr double kTable[] = {// atan(k / 16)
                                        0.0,
                                        0.06241880999595735,
                                        0.12435499454676144,
                                        0.18534794999569476,
                                        0.24497866312686414,
                                        0.3028848683749714,
                                        0.35877067027057225,
                                        0.4124104415973873,
                                        0.4636476090008061,
                                        0.5123894603107377,
                                        0.5585993153435624,
                                        0.6022873461349642,
                                        0.6435011087932844,
                                        0.6823165548747481,
                                        0.7188299996216245,
                                        0.7531512809621944,
                                        0.7853981633974483};
    const int k = static_cast<int>(x * 16 + 0.5);
    const double c = k / 16.0;
    const double r = (x - c) / (1 + x * c), r2 = r * r;
    double series = 1.0 / 13;
    for (const double n : {11.0, 9.0, 7.0, 5.0, 3.0}) series = 1 / n - r2 * series;
    return kTable[k] + (r - r * r2 * series);
}

/// Angle of the point (x, y), y >= 0, in [0, pi].
double angleOf(double x, double y) {
    const double ax = std::fabs(x);
    if (!(ax + y > 0)) return 0;
    const double acute = y <= ax ? arctangent(y / ax) : std::numbers::pi / 2 - arctangent(ax / y);
    return x < 0 ? std::numbers::pi - acute : acute;
}

/// cos of an angle in [0, pi]. Only thresholds are made with it.
double cosine(double angle) {
    const bool obtuse = angle > std::numbers::pi / 2;
    const double x = obtuse ? std::numbers::pi - angle : angle, x2 = x * x;
    double sum = 0;
    for (int n = 26; n >= 2; n -= 2) sum = (1 - sum) * x2 / (n * (n - 1));
    return obtuse ? sum - 1 : 1 - sum;
}

double largestComponent(const Vector3& v) {
    return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)});
}

/// Scaled so that its square neither overflows nor underflows.
Vector3 tamed(const Vector3& v) {
    const double largest = largestComponent(v);
    return largest == 0 ? v : v / largest;
}

/// Unit normal, or 0 when rounding of the corners' own coordinates may have turned it anywhere.
Vector3 reliableNormal(const Vector3& a, const Vector3& b, const Vector3& c) {
    const Vector3 ab = b - a, ac = c - a;
    const double edge = std::max(largestComponent(ab), largestComponent(ac));
    if (edge == 0) return {};
    const double coordinate =
        std::max({largestComponent(a), largestComponent(b), largestComponent(c)});
    const Vector3 n = cross(ab / edge, ac / edge);
    const double largest = largestComponent(n);
    // Each edge component is off by up to u times the coordinates, and enters two products of at most 1.
    if (!(largest > gamma(8) * std::max(1.0, coordinate / edge))) return {};
    return normalize(n / largest);
}

struct Traits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    VertexAttributes(0);
    HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
    EdgeAttributes(0);
    FaceAttributes(0);
};
using HalfedgeMesh = OpenMesh::PolyMesh_ArrayKernelT<Traits>;
using OpenMesh::HalfedgeHandle;
using OpenMesh::VertexHandle;

std::uint32_t nextIn(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
std::uint32_t previousIn(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// The connectivity is known, also where three faces meet in an edge or two fans in a vertex, so it is
/// written through OpenMesh's kernel; add_face would search for it again and refuses such places.
/// Every fan of corners joined round a position becomes a vertex of its own, so the mesh is manifold.
/// Half-edge h of `mesh` becomes handles[h]; faces keep their numbers.
void connect(const ConnectedTriangles& mesh, HalfedgeMesh& out,
             std::vector<HalfedgeHandle>& handles) {
    const auto halves = static_cast<std::uint32_t>(mesh.mate.size());
    std::vector<std::uint32_t> fan(halves, kNone); // of the vertex where h begins
    out.reserve(mesh.positions.size(), halves / 2 + 1, halves / 3);
    for (std::uint32_t seed = 0; seed < halves; ++seed) {
        if (fan[seed] != kNone) continue;
        const Vector3& p = mesh.positions[mesh.vertices[seed / 3][seed % 3]];
        const auto id = static_cast<std::uint32_t>(out.add_vertex({p.x, p.y, p.z}).idx());
        std::uint32_t h = seed;
        do { // counter-clockwise
            fan[h] = id;
            h = mesh.mate[previousIn(h)];
        } while (h != kNone && h != seed);
        if (h == seed) continue;
        for (h = seed; mesh.mate[h] != kNone;) { // clockwise
            h = nextIn(mesh.mate[h]);
            fan[h] = id;
        }
    }
    handles.assign(halves, HalfedgeHandle());
    std::vector<HalfedgeHandle> boundary(out.n_vertices()); // leaving each open vertex
    for (std::uint32_t h = 0; h < halves; ++h) {
        if (handles[h].is_valid()) continue;
        const VertexHandle from(static_cast<int>(fan[h])), to(static_cast<int>(fan[nextIn(h)]));
        handles[h] = out.new_edge(from, to);
        const HalfedgeHandle opposite = out.opposite_halfedge_handle(handles[h]);
        if (mesh.mate[h] != kNone)
            handles[mesh.mate[h]] = opposite;
        else
            boundary[fan[nextIn(h)]] = opposite;
    }
    for (std::uint32_t t = 0; t < halves / 3; ++t) {
        const OpenMesh::FaceHandle face = out.new_face();
        out.set_halfedge_handle(face, handles[3 * t]);
        for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
            out.set_face_handle(handles[h], face);
            out.set_next_halfedge_handle(handles[h], handles[nextIn(h)]);
        }
    }
    for (std::uint32_t h = halves; h-- > 0;) {
        const VertexHandle v(static_cast<int>(fan[h]));
        if (mesh.mate[h] == kNone)
            out.set_next_halfedge_handle(out.opposite_halfedge_handle(handles[h]),
                                         boundary[fan[h]]);
        out.set_halfedge_handle(v, boundary[fan[h]].is_valid() ? boundary[fan[h]] : handles[h]);
    }
}

} // namespace

double angleBetween(const Vector3& a, const Vector3& b) {
    const Vector3 p = tamed(a), q = tamed(b);
    return angleOf(dot(p, q), length(cross(p, q)));
}

CornerNormals cornerNormals(const ConnectedTriangles& mesh, std::span<const std::uint32_t> smooth,
                            Radians creaseAngle) {
    HalfedgeMesh halfedges;
    std::vector<HalfedgeHandle> handles;
    connect(mesh, halfedges, handles);
    std::vector<std::uint32_t> cornerAt(2 * halfedges.n_edges(), kNone); // per handle: 3 t + i
    for (std::uint32_t h = 0; h < handles.size(); ++h)
        cornerAt[static_cast<std::size_t>(handles[h].idx())] = h;

    const auto corner = [&](std::uint32_t h) -> const Vector3& {
        return mesh.positions[mesh.vertices[h / 3][h % 3]];
    };
    std::vector<Vector3> triangleNormals(mesh.vertices.size());
    for (std::uint32_t t = 0; t < mesh.vertices.size(); ++t)
        triangleNormals[t] = reliableNormal(corner(3 * t), corner(3 * t + 1), corner(3 * t + 2));

    const double threshold = cosine(creaseAngle.value);
    const auto hard = [&](std::uint32_t t, std::uint32_t u) {
        if (smooth[t] != smooth[u]) return true;
        if (mesh.face[t] == mesh.face[u]) return false;
        const Vector3 &a = triangleNormals[t], &b = triangleNormals[u];
        if (dot(a, a) == 0 || dot(b, b) == 0) return false;
        return dot(a, b) < threshold;
    };

    CornerNormals out;
    out.corners.assign(handles.size(), kNone);
    out.normals.reserve(halfedges.n_vertices());
    std::vector<std::uint32_t> ring; // corners round the vertex, counter-clockwise
    for (const VertexHandle v : halfedges.vertices()) {
        ring.clear();
        HalfedgeHandle first = halfedges.halfedge_handle(v);
        const bool open = halfedges.is_boundary(first);
        const auto turn = [&](HalfedgeHandle h) {
            return halfedges.opposite_halfedge_handle(halfedges.prev_halfedge_handle(h));
        };
        if (open) first = turn(first);
        HalfedgeHandle h = first;
        do {
            ring.push_back(cornerAt[static_cast<std::size_t>(h.idx())]);
            h = turn(h);
        } while (h != first && !halfedges.is_boundary(h));

        // Begin a sector where one begins; a ring without hard edges begins at its lowest triangle, so
        // that the order of the sum does not depend on how faces were wound before the repair.
        const auto n = ring.size();
        const auto breaks = [&](std::size_t i) { // between corner i - 1 and corner i
            if (i % n == 0 && open) return true;
            return hard(ring[(i + n - 1) % n] / 3, ring[i % n] / 3);
        };
        std::size_t start = 0;
        while (start < n && !breaks(start)) ++start;
        if (start == n)
            start =
                static_cast<std::size_t>(std::min_element(ring.begin(), ring.end()) - ring.begin());
        for (std::size_t i = 0; i < n;) {
            std::size_t j = i;
            Vector3 sum;
            do {
                const std::uint32_t c = ring[(start + j) % n];
                const Vector3 &p = corner(c), &q = corner(nextIn(c)), &r = corner(previousIn(c));
                sum = sum + triangleNormals[c / 3] * angleBetween(q - p, r - p);
                ++j;
            } while (j < n && !breaks(start + j));
            const std::uint32_t t = ring[start + i < n ? start + i : start + i - n] / 3;
            const double size = length(sum);
            // Angles add up to at most a few turns; what cancels to less than their rounding has no direction.
            if (smooth[t] != 0 && j - i > 1 && size > gamma(64) * static_cast<double>(j - i)) {
                for (std::size_t k = i; k < j; ++k)
                    out.corners[ring[(start + k) % n]] =
                        static_cast<std::uint32_t>(out.normals.size());
                out.normals.push_back(sum / size);
            }
            i = j;
        }
    }
    return out;
}

} // namespace rt::loaders
