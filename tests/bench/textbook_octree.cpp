#include "textbook_octree.hpp"

#include <core/geometry/intersect.hpp>
#include <core/numeric/box.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace rt::bench {
namespace {

using geometry::Hit;
using geometry::Ray;
using numeric::Vec3;

constexpr std::size_t kLeafSize = 8, kHopeless = 64;
constexpr int kMostLevels = 16;

/// The first octant that a ray of positive directions meets, of a cell entered at `enter` with its
/// middle planes at `middle`.
unsigned firstOctant(const Vec3& enter, const Vec3& middle) {
    const int axis = enter.x > enter.y ? (enter.x > enter.z ? 0 : 2) : (enter.y > enter.z ? 1 : 2);
    unsigned octant = 0;
    for (int a = 0; a < 3; ++a)
        if (a != axis && middle[a] < enter[axis]) octant |= 4u >> a;
    return octant;
}

} // namespace

TextbookOctree::TextbookOctree(const geometry::Primitives& primitives) : primitives_(primitives) {
    numeric::Box3d box;
    for (const auto& corners : primitives.triangles.indices)
        for (const std::uint32_t c : corners) box.add(primitives.triangles.positions[c]);
    center_ = box.centre();
    half_ = numeric::maxComponent(box.diagonal()) * 0.5001;
    std::vector<std::uint32_t> all(primitives.triangles.indices.size());
    std::iota(all.begin(), all.end(), 0u);
    root_ = build(std::move(all), center_, half_, 0);
}

/// By the separating axis theorem [Akenine-Möller 2001]; a little generous, so that rounding loses none.
bool TextbookOctree::reaches(std::uint32_t triangle, const Vec3& center, double half) const {
    half *= 1.000001;
    Vec3 v[3];
    for (std::size_t i = 0; i < 3; ++i)
        v[i] = primitives_.triangles.positions[primitives_.triangles.indices[triangle][i]] - center;
    for (int a = 0; a < 3; ++a)
        if (std::min({v[0][a], v[1][a], v[2][a]}) > half ||
            std::max({v[0][a], v[1][a], v[2][a]}) < -half)
            return false;
    const auto separates = [&](const Vec3& axis) {
        const double p[3] = {numeric::dot(axis, v[0]), numeric::dot(axis, v[1]),
                             numeric::dot(axis, v[2])};
        const double reach = half * (std::fabs(axis.x) + std::fabs(axis.y) + std::fabs(axis.z));
        return std::min({p[0], p[1], p[2]}) > reach || std::max({p[0], p[1], p[2]}) < -reach;
    };
    const Vec3 edges[3] = {v[1] - v[0], v[2] - v[1], v[0] - v[2]};
    if (separates(numeric::cross(edges[0], edges[1]))) return false;
    for (const Vec3& edge : edges)
        for (int a = 0; a < 3; ++a) {
            Vec3 unit(0.0);
            unit[a] = 1;
            if (separates(numeric::cross(unit, edge))) return false;
        }
    return true;
}

std::unique_ptr<TextbookOctree::Node> TextbookOctree::build(std::vector<std::uint32_t> triangles,
                                                            const Vec3& center, double half,
                                                            int depth) {
    if (triangles.empty()) return nullptr;
    auto node = std::make_unique<Node>();
    bytes_ += sizeof(Node);
    std::array<std::vector<std::uint32_t>, 8> parts;
    std::size_t total = 0;
    const auto centerOf = [&](unsigned octant) {
        const double quarter = half / 2;
        return center + Vec3(octant & 4 ? quarter : -quarter, octant & 2 ? quarter : -quarter,
                             octant & 1 ? quarter : -quarter);
    };
    const bool mayCut = triangles.size() > kLeafSize && depth < kMostLevels;
    if (mayCut)
        for (unsigned octant = 0; octant < 8; ++octant) {
            for (const std::uint32_t t : triangles)
                if (reaches(t, centerOf(octant), half / 2)) parts[octant].push_back(t);
            total += parts[octant].size();
        }
    // Around a vertex that many triangles share, cutting only copies them.
    if (!mayCut || (total > 6 * triangles.size() && triangles.size() < kHopeless)) {
        bytes_ += triangles.size() * sizeof(std::uint32_t);
        node->triangles = std::move(triangles);
        return node;
    }
    node->isLeaf = false;
    std::vector<std::uint32_t>().swap(triangles);
    for (unsigned octant = 0; octant < 8; ++octant)
        node->octants[octant] =
            build(std::move(parts[octant]), centerOf(octant), half / 2, depth + 1);
    return node;
}

struct TextbookOctree::Query {
    const Ray& ray;
    geometry::RayFrame frame;
    unsigned mirror; // octants of the mirrored ray to octants of the tree
    bool any;
    Hit hit;
    double limit;
    bool done = false;
};

Hit TextbookOctree::trace(const Ray& ray, bool any) const {
    Query query{ray, geometry::frameOf(ray), 0, any, {}, ray.tMax};
    if (!root_) return query.hit;
    Vec3 enter, leave;
    for (int a = 0; a < 3; ++a) {
        double o = ray.origin[a] - center_[a], d = ray.direction[a];
        if (d < 0) { // mirrored, so that all directions are positive
            o = -o;
            d = -d;
            query.mirror |= 4u >> a;
        }
        d = std::max(d, numeric::powerOfTwo(-100));
        enter[a] = (-half_ - o) / d;
        leave[a] = (half_ - o) / d;
    }
    if (numeric::maxComponent(enter) < std::min({leave.x, leave.y, leave.z}))
        visit(query, root_.get(), enter, leave);
    return query.hit;
}

void TextbookOctree::visit(Query& query, const Node* node, const Vec3& enter,
                           const Vec3& leave) const {
    if (!node || query.done || leave.x < 0 || leave.y < 0 || leave.z < 0) return;
    if (numeric::maxComponent(enter) > query.limit) {
        query.done = true;
        return;
    }
    if (node->isLeaf) {
        for (const std::uint32_t t : node->triangles) {
            const auto& corners = primitives_.triangles.indices[t];
            const auto& positions = primitives_.triangles.positions;
            Hit hit;
            if (!geometry::intersectTriangle(query.frame, positions[corners[0]],
                                             positions[corners[1]], positions[corners[2]],
                                             query.limit, hit))
                continue;
            hit.id = geometry::PrimitiveId{t};
            query.hit = hit;
            query.limit = hit.t;
            if (query.any) {
                query.done = true;
                return;
            }
        }
        return;
    }
    const Vec3 middle = (enter + leave) * 0.5;
    constexpr unsigned kOut = 8;
    for (unsigned octant = firstOctant(enter, middle); octant != kOut && !query.done;) {
        Vec3 from, to;
        for (int a = 0; a < 3; ++a) {
            const bool above = octant & (4u >> a);
            from[a] = above ? middle[a] : enter[a];
            to[a] = above ? leave[a] : middle[a];
        }
        visit(query, node->octants[octant ^ query.mirror].get(), from, to);
        const int axis = to.x < to.y ? (to.x < to.z ? 0 : 2) : (to.y < to.z ? 1 : 2);
        octant = octant & (4u >> axis) ? kOut : octant | 4u >> axis;
    }
}

} // namespace rt::bench
