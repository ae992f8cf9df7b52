#include <core/trace/coplanar.hpp>

#include <core/geometry/bounds.hpp>
#include <core/geometry/intersect.hpp>
#include <core/trace/coincident.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace rt::trace {

namespace {

using geometry::Kind;
using geometry::PrimitiveId;
using geometry::Primitives;
using geometry::Segment;
using geometry::Vec3;
using numeric::Box3d;

/// γ8 of the coordinates: each face's own bound is γ5 of them at most (geometry::surfaceAt), less for the exact corners
/// that are compared here.
double boundOn(const Box3d& box) {
    return numeric::gamma(8) * (numeric::maxComponent(numeric::abs(box.min)) +
                                numeric::maxComponent(numeric::abs(box.max)));
}

bool overlap(const Box3d& a, const Box3d& b) {
    const double slack = boundOn(a) + boundOn(b);
    for (int axis = 0; axis < 3; ++axis)
        if (!(a.min[axis] <= b.max[axis] + slack && b.min[axis] <= a.max[axis] + slack))
            return false;
    return true;
}

struct Face {
    std::array<Vec3, 4> corners;
    std::size_t count; // 3 or 4
    Vec3 normal;       // unit
    Box3d box;
    std::uint32_t id, object;
    float error; // bound of its segment: the same for all faces of it, so that few pairs have news
    int axis;    // the largest component of the normal
    double height, bound; // where the plane meets a line along that axis; how sure that is
};

Face faceOf(const Primitives& primitives, const Segment& segment, const Box3d& segmentBox,
            std::uint32_t offset) {
    Face face{};
    face.error = numeric::roundUp(geometry::errorBoundWithin(segmentBox));
    face.id = static_cast<std::uint32_t>(segment.first) + offset;
    face.object = static_cast<std::uint32_t>(segment.object);
    const std::uint32_t index = segment.index + offset;
    if (segment.kind == Kind::triangle) {
        face.count = 3;
        for (std::size_t k = 0; k < 3; ++k)
            face.corners[k] =
                primitives.triangles.positions[primitives.triangles.indices[index][k]];
    } else {
        face.count = 4;
        face.corners = geometry::cornersOf(primitives.parallelograms[index]);
    }
    for (std::size_t k = 0; k < face.count; ++k) face.box.add(face.corners[k]);
    face.normal = geometry::triangleNormal(face.corners[0], face.corners[1], face.corners[2]);
    return face;
}

/// Where the plane of a face meets the line through `middle` along its axis. The farther the line and the thinner the
/// face, the less is known.
void putHeight(Face& face, const Vec3& middle) {
    // Weighted, so that planes at 45 degrees, of which there are many, do not differ by rounding.
    const Vec3 n = numeric::abs(face.normal) * Vec3(1, 1.0717, 1.1487);
    face.axis = n.x > n.y ? (n.x > n.z ? 0 : 2) : (n.y > n.z ? 1 : 2);
    const Vec3 from = face.corners[0] - middle;
    face.height = numeric::dot(face.normal, from) / face.normal[face.axis];
    const Vec3 u = face.corners[1] - face.corners[0], v = face.corners[2] - face.corners[0];
    const double longest = std::fmax(numeric::length(u), numeric::length(v));
    const double thin = numeric::length(numeric::cross(u, v)) / longest;
    face.bound = 4 * boundOn(face.box) * (1 + numeric::length(from) / thin);
}

/// Do the faces of one plane overlap by more than their edges? Separating axes, across the normal's axis.
bool overlapInPlane(const Face& a, const Face& b) {
    const int x = (a.axis + 1) % 3, y = (a.axis + 2) % 3;
    const double slack = boundOn(a.box) + boundOn(b.box);
    for (const Face* face : {&a, &b})
        for (std::size_t k = 0; k < face->count; ++k) {
            const Vec3 edge = face->corners[(k + 1) % face->count] - face->corners[k];
            const double nx = -edge[y], ny = edge[x], length = std::hypot(nx, ny);
            double low[2] = {numeric::kInfinity, numeric::kInfinity},
                   high[2] = {-numeric::kInfinity, -numeric::kInfinity};
            for (int side = 0; side < 2; ++side) {
                const Face& f = side ? b : a;
                for (std::size_t c = 0; c < f.count; ++c) {
                    const double along = (nx * f.corners[c][x] + ny * f.corners[c][y]) / length;
                    low[side] = std::fmin(low[side], along);
                    high[side] = std::fmax(high[side], along);
                }
            }
            if (high[0] <= low[1] + slack || high[1] <= low[0] + slack) return false;
        }
    return true;
}

/// Each corner of the one within the bounds of the plane of the other.
bool coplanar(const Face& a, const Face& b) {
    const double bound = boundOn(a.box) + boundOn(b.box);
    for (std::size_t k = 0; k < b.count; ++k)
        if (!(std::fabs(numeric::dot(a.normal, b.corners[k] - a.corners[0])) <=
              bound + a.bound * std::fabs(a.normal[a.axis])))
            return false;
    return true;
}

} // namespace

Ties tiesOf(const Primitives& primitives) {
    // Objects whose boxes overlap those of others; of them, the faces within such a box.
    struct Extent {
        const Segment* segment;
        Box3d box;
    };
    std::vector<Extent> extents;
    for (const Segment& s : primitives.segments)
        if (s.kind == Kind::triangle || s.kind == Kind::parallelogram)
            extents.push_back({&s, geometry::boundsOf(primitives, s)});
    std::sort(extents.begin(), extents.end(),
              [](const Extent& a, const Extent& b) { return a.box.min.x < b.box.min.x; });
    std::vector<std::vector<const Extent*>> others(extents.size());
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < extents.size(); ++i) {
        const Box3d& box = extents[i].box;
        std::erase_if(open, [&](std::size_t k) {
            return extents[k].box.max.x + boundOn(extents[k].box) < box.min.x - boundOn(box);
        });
        for (const std::size_t k : open)
            if (extents[k].segment->object != extents[i].segment->object &&
                overlap(extents[k].box, box)) {
                others[k].push_back(&extents[i]);
                others[i].push_back(&extents[k]);
            }
        open.push_back(i);
    }
    std::vector<Face> faces;
    Box3d all;
    for (std::size_t i = 0; i < extents.size(); ++i)
        for (std::uint32_t k = 0; !others[i].empty() && k < extents[i].segment->count; ++k) {
            const Face face = faceOf(primitives, *extents[i].segment, extents[i].box, k);
            if (face.normal == Vec3(0.0)) continue;
            if (std::none_of(others[i].begin(), others[i].end(),
                             [&](const Extent* e) { return overlap(e->box, face.box); }))
                continue;
            faces.push_back(face);
            all.add(face.box);
        }
    if (faces.empty()) return {};
    for (Face& face : faces) putHeight(face, all.centre());
    // Faces of one plane stand next to each other by axis and height.
    std::sort(faces.begin(), faces.end(), [](const Face& a, const Face& b) {
        return a.axis != b.axis ? a.axis < b.axis : a.height < b.height;
    });
    Ties ties{std::vector<bool>(primitives.count(), false),
              std::vector<float>(primitives.count(), 0)};
    bool any = false;
    for (auto first = faces.begin(), last = first; first != faces.end(); first = last) {
        while (++last != faces.end() && last->axis == first->axis &&
               last->height - (last - 1)->height <= last->bound + (last - 1)->bound) {
        }
        // Sweep along an axis of the plane: only faces that are open at the same place are compared.
        const int along = (first->axis + 1) % 3;
        std::sort(first, last, [along](const Face& a, const Face& b) {
            return a.box.min[along] < b.box.min[along];
        });
        for (auto a = first; a != last; ++a)
            for (auto b = a + 1; b != last && b->box.min[along] <= a->box.max[along]; ++b) {
                if (a->object == b->object) continue;
                const Face& higher = a->id > b->id ? *a : *b;
                float &besideA = ties.errorBeside[a->id], &besideB = ties.errorBeside[b->id];
                if (ties.isHigher[higher.id] && besideA >= b->error && besideB >= a->error)
                    continue;
                if (!overlap(a->box, b->box) || !coplanar(*a, *b) || !overlapInPlane(*a, *b))
                    continue;
                ties.isHigher[higher.id] = any = true;
                besideA = std::max(besideA, b->error), besideB = std::max(besideB, a->error);
            }
    }
    return any ? ties : Ties{};
}

geometry::Hit lowestOfTied(const octree::Octree& octree, const Primitives& primitives,
                           const Ties& ties, const geometry::Ray& ray, const geometry::Hit& hit,
                           std::vector<geometry::Crossing>& scratch, octree::Visits* visits) {
    const geometry::Surface surface = geometry::surfaceAt(primitives, ray, hit);
    const double cosine = std::fabs(numeric::dot(ray.direction, surface.geometricNormal));
    if (cosine == 0) return hit;
    geometry::Ray upTo = ray;
    const double behind = surface.error + ties.errorBesideOf(hit.id);
    upTo.tMax = std::min(ray.tMax, numeric::nextUp(hit.t + behind / cosine));
    static const std::vector<bool> nothingIsOpaque;
    scratch.clear();
    octree.crossings(upTo, nothingIsOpaque, scratch, visits);
    geometry::Hit lowest = hit;
    for (const geometry::Crossing& crossing : scratch) {
        if (crossing.id >= lowest.id) continue;
        const Segment& segment = primitives.segmentOf(crossing.id);
        if (segment.kind != Kind::triangle && segment.kind != Kind::parallelogram) continue;
        if (segment.object == surface.object) continue;
        const geometry::Hit other = hitOn(primitives, upTo, crossing.id);
        if (!other) continue;
        const geometry::Surface there = geometry::surfaceAt(primitives, upTo, other);
        if (std::fabs(other.t - hit.t) * cosine <= surface.error + there.error) lowest = other;
    }
    return lowest;
}

} // namespace rt::trace
