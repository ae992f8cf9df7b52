#include <tests/stability/any_mesh.hpp>

#include <core/geometry/intersect.hpp>
#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/scene/validate.hpp>
#include <formats/yaml_reader.hpp>
#include <tests/stability/counting.hpp>
#include <tests/stability/quad.hpp>

#include <filesystem>
#include <map>
#include <stdexcept>

namespace rt::stability {

namespace {

using geometry::Hit;
using geometry::Primitives;
using geometry::Ray;
using octree::Octree;

world::World load(const std::string& file) {
    const std::string path = std::filesystem::absolute(file).string();
    const auto source = std::make_shared<const scene::Source>(scene::Source{
        "mesh", "rt: 1\ncamera: {position: [0, -1, 0], look_at: [0, 0, 0], field_of_view: 45deg}\n"
                "objects:\n  - mesh: {file: '" +
                    path + "'}\n"});
    scene::Diagnostics diagnostics;
    plugin_host::Catalog catalog(plugin_host::searchPath({}));
    std::optional<world::World> world;
    if (const auto root = formats::parseYaml(source, diagnostics))
        if (const auto description = scene::validate(*root, catalog, diagnostics, {}))
            world = plugin_host::lower(*description, catalog, diagnostics);
    if (!world)
        throw std::runtime_error(diagnostics.all().empty() ? "cannot be loaded"
                                                           : diagnostics.all()[0].message);
    if (world->primitives.triangles.indices.empty()) throw std::runtime_error("no triangles");
    return std::move(*world);
}

struct Edge {
    std::uint32_t a, b;           // positions
    std::uint32_t faces[2], left; // and how many more there are
};

/// By position, not by index: corners that were split for their normals are one.
std::vector<Edge> edgesOf(const Primitives& p) {
    std::map<std::array<double, 3>, std::uint32_t> first;
    std::vector<std::uint32_t> same;
    for (std::uint32_t i = 0; i < p.triangles.positions.size(); ++i) {
        const Vec3& v = p.triangles.positions[i];
        same.push_back(first.try_emplace({v.x, v.y, v.z}, i).first->second);
    }
    std::map<std::array<std::uint32_t, 2>, Edge> edges;
    for (std::uint32_t f = 0; f < p.triangles.indices.size(); ++f)
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& t = p.triangles.indices[f];
            const auto [a, b] = std::minmax(same[t[k]], same[t[(k + 1) % 3]]);
            const auto [at, isNew] = edges.try_emplace({a, b}, Edge{a, b, {f, f}, 0});
            if (isNew) continue;
            at->second.faces[1] = f;
            ++at->second.left;
        }
    std::vector<Edge> all;
    for (const auto& [key, edge] : edges) all.push_back(edge);
    return all;
}

struct Corners {
    Vec3 a, b, c;
};

Corners cornersOf(const Primitives& p, std::uint32_t face) {
    const auto& t = p.triangles.indices[face];
    return {p.triangles.positions[t[0]], p.triangles.positions[t[1]], p.triangles.positions[t[2]]};
}

/// [Möller, Trumbore 1997] in binary128, edges included; t, or a negative number.
Quad exactHit(const Corners& t, const QVec& origin, const QVec& direction) {
    const QVec ab = QVec(t.b) - QVec(t.a), ac = QVec(t.c) - QVec(t.a), s = origin - QVec(t.a);
    const QVec p = cross(direction, ac), q = cross(s, ab);
    const Quad determinant = dot(ab, p);
    if (determinant == 0) return -1;
    const Quad u = dot(s, p) / determinant, v = dot(direction, q) / determinant;
    return u >= 0 && v >= 0 && u + v <= 1 ? dot(ac, q) / determinant : Quad(-1);
}

struct Checked {
    Tally leaks, boxes, self;
    Checked& operator+=(const Checked& o) {
        return leaks += o.leaks, boxes += o.boxes, self += o.self, *this;
    }
};

} // namespace

std::string checkMesh(const std::string& file, std::uint64_t rays, std::uint64_t seed,
                      Table& table) {
    const world::World world = load(file);
    const Primitives& p = world.primitives;
    const Octree tree = Octree::build(p);
    const std::vector<Edge> edges = edgesOf(p);
    std::vector<Edge> inner;
    std::size_t border = 0, shared = 0;
    for (const Edge& e : edges) {
        if (e.left == 1) inner.push_back(e);
        border += e.left == 0, shared += e.left > 1;
    }
    numeric::Box3d box;
    for (const Vec3& v : p.triangles.positions) box.add(v);
    const double size = numeric::length(box.diagonal());
    const auto faces = static_cast<std::uint32_t>(p.triangles.indices.size());

    const auto found = sumOver<Checked>(rays, seed, [&](Random& random, Checked& sum) {
        const std::uint64_t kind = random.below(3);
        Ray ray;
        ray.origin = box.centre() + random.direction() * (size * (kind ? random.unit() : 2.0));
        if (kind == 0 && !inner.empty()) {
            // Through an edge between two faces, not where they fold away: one of the two is met.
            const Edge& e = inner[random.below(static_cast<std::uint32_t>(inner.size()))];
            const Vec3 a = p.triangles.positions[e.a], b = p.triangles.positions[e.b];
            ray.direction = a + random.unit() * (b - a) - ray.origin;
            // Seen from the start, the faces lie on both sides of the edge, by more than the kernel's
            // shear can round: γ3 of the distance, twice.
            const auto side = [&](std::uint32_t face) {
                const QVec n = cross(QVec(a) - QVec(ray.origin), QVec(b) - QVec(ray.origin));
                Quad far = 0;
                for (const std::uint32_t corner : p.triangles.indices[face]) {
                    const Quad d = dot(n, QVec(p.triangles.positions[corner]) - QVec(a));
                    if (magnitude(d) > magnitude(far)) far = d;
                }
                const double reach = numeric::length(a - ray.origin) + size;
                const bool clear =
                    magnitude(far) > numeric::gamma(6) * reach * magnitude(squareRoot(dot(n, n)));
                return clear ? far : Quad(0);
            };
            if (!(side(e.faces[0]) * side(e.faces[1]) < 0)) return;
            Quad nearest = -1;
            for (const std::uint32_t face : e.faces) {
                const Quad t = exactHit(cornersOf(p, face), ray.origin, ray.direction);
                if (t > 0 && (nearest < 0 || t < nearest)) nearest = t;
            }
            if (nearest < 0) return;
            const Hit hit = tree.closest(ray);
            const auto id = static_cast<std::uint32_t>(hit.id);
            const bool either = id == e.faces[0] || id == e.faces[1];
            sum.leaks.add(!hit || (!either && hit.t > static_cast<double>(nearest)));
            return;
        }
        const std::uint32_t face = random.below(faces);
        const Corners t = cornersOf(p, face);
        const double u = random.unit(), v = random.unit() * (1 - u);
        const Vec3 point = t.a + u * (t.b - t.a) + v * (t.c - t.a);
        ray.direction = point - ray.origin;
        if (kind == 1) {
            // What the kernel finds on the face that was aimed at, the boxes must not hide. Often
            // along an axis, or in a plane of two.
            if (const std::uint32_t axis = random.below(6); axis < 3) {
                const int i = static_cast<int>(axis);
                ray.origin[i] = point[i];
                ray.direction[i] = random.below(2) ? 0.0 : -0.0;
                if (ray.direction == Vec3(0.0)) return;
            }
            Hit alone;
            if (!geometry::intersectTriangle(geometry::frameOf(ray), t.a, t.b, t.c, ray.tMax,
                                             alone))
                return;
            const Hit hit = tree.closest(ray);
            sum.boxes.add(!(hit && hit.t <= alone.t));
            return;
        }
        // A ray that leaves: whatever it meets at once must be met by the exact ray, too.
        const Hit hit = tree.closest(ray);
        if (!hit) return;
        const geometry::Surface s = geometry::surfaceAt(p, ray, hit);
        Vec3 d = random.direction();
        if (dot(d, s.geometricNormal) < 0) d = -d;
        const Ray leaving = geometry::spawnRay(s, d);
        const Hit next = tree.closest(leaving);
        const Corners from = cornersOf(p, static_cast<std::uint32_t>(hit.id));
        const QVec ab = QVec(from.b) - QVec(from.a), ac = QVec(from.c) - QVec(from.a);
        const QVec exact = QVec(from.a) + ab * Quad(hit.u) + ac * Quad(hit.v);
        const bool near = next && next.t < numeric::gamma(1 << 20) * size;
        sum.self.add(near &&
                     !(exactHit(cornersOf(p, static_cast<std::uint32_t>(next.id)), exact, d) > 0));
    });
    table.count("T1", "rays through an edge that meet neither face", found.leaks.wrong,
                found.leaks.of);
    table.count("B1", "rays that a box keeps from the face aimed at", found.boxes.wrong,
                found.boxes.of);
    table.count("O1", "rays that meet, on leaving, what the exact ray does not", found.self.wrong,
                found.self.of);
    return file + ": " + std::to_string(faces) + " triangles, " + std::to_string(edges.size()) +
           " edges, " + std::to_string(border) + " of one face, " + std::to_string(shared) +
           " of more than two.";
}

} // namespace rt::stability
