#include <core/octree/references.hpp>

#include <core/geometry/intersect.hpp>
#include <core/numeric/box.hpp>
#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <bit>
#include <cmath>

namespace rt::octree {
namespace {

using geometry::Kind;
using geometry::Primitives;
using numeric::Box3d;
using numeric::Vec3;

constexpr std::uint32_t kChunk = 16384; // primitives that one task takes

Box3d boundsOf(const Primitives& primitives, Kind kind, std::uint32_t index) {
    Box3d box;
    switch (kind) {
    case Kind::triangle:
        for (const std::uint32_t i : primitives.triangles.indices[index])
            box.add(primitives.triangles.positions[i]);
        break;
    case Kind::sphere: {
        const auto& sphere = primitives.spheres[index];
        const Vec3 radius(std::fabs(sphere.radius));
        // The sums round; the box may not.
        for (int i = 0; i < 3; ++i) {
            box.min[i] = numeric::nextDown(sphere.center[i] - radius[i]);
            box.max[i] = numeric::nextUp(sphere.center[i] + radius[i]);
        }
        break;
    }
    case Kind::parallelogram:
        for (const Vec3& corner : geometry::cornersOf(primitives.parallelograms[index]))
            box.add(corner);
        break;
    case Kind::custom:
        box = primitives.customs.primitives[index].bounds;
        break;
    }
    return box;
}

/// NaN coordinates can hide in a box; what has one is met by no ray, or decides that for itself.
bool isBounded(const Primitives& primitives, Kind kind, std::uint32_t index, const Box3d& box) {
    if (box.empty() || !numeric::isFinite(box.min) || !numeric::isFinite(box.max)) return false;
    if (kind != Kind::triangle) return true;
    for (const std::uint32_t i : primitives.triangles.indices[index])
        if (!numeric::isFinite(primitives.triangles.positions[i])) return false;
    return true;
}

/// Next f32 below.
float stepDown(float f) {
    const auto bits = std::bit_cast<std::uint32_t>(f);
    if (f == 0) return std::bit_cast<float>(0x80000001u);
    return std::bit_cast<float>(f > 0 ? bits - 1 : bits + 1);
}

/// The largest f32 at or below the exact (x − center) · scale.
float lowerInOctreeSpace(double x, double center, double scale) {
    const double d = x - center, t = d - x;
    const double rest = (x - (d - t)) + (-center - t); // d + rest is exact [Knuth 1969]
    const double scaled = d * scale;
    const float f = static_cast<float>(scaled);
    const auto back = static_cast<double>(f);
    return back > scaled || (back == scaled && rest < 0) ? stepDown(f) : f;
}
float upperInOctreeSpace(double x, double center, double scale) {
    return -lowerInOctreeSpace(-x, -center, scale);
}

void fill(Reference& reference, std::uint32_t id, Kind kind, const Box3d& box,
          const double center[3], double scale) {
    for (int i = 0; i < 3; ++i) {
        reference.lower[i] = lowerInOctreeSpace(box.min[i], center[i], scale);
        reference.upper[i] = upperInOctreeSpace(box.max[i], center[i], scale);
    }
    reference.id = id;
    reference.kind = static_cast<std::uint32_t>(kind);
}

} // namespace

References referencesOf(const Primitives& primitives, bool movable) {
    References result;
    const std::uint32_t count = primitives.count();
    const std::size_t chunks = (count + kChunk - 1) / kChunk;
    struct Part {
        Box3d bounds;
        std::uint32_t bounded = 0;
        std::vector<Reference> unbounded;
    };
    std::vector<Part> parts(chunks);
    // Calls visit(id, kind, index, box) for the chunk's primitives.
    const auto overChunk = [&](std::size_t chunk, const auto& visit) {
        std::uint32_t id = static_cast<std::uint32_t>(chunk) * kChunk;
        const std::uint32_t last = std::min(id + kChunk, count);
        const auto* segment = &primitives.segmentOf(geometry::PrimitiveId{id});
        for (; id < last; ++id) {
            while (id >= static_cast<std::uint32_t>(segment->first) + segment->count) ++segment;
            const auto index = segment->index + id - static_cast<std::uint32_t>(segment->first);
            visit(id, segment->kind, index, boundsOf(primitives, segment->kind, index));
        }
    };
    parallel::forEach(chunks, 0, [&](std::size_t chunk) {
        Part& part = parts[chunk];
        overChunk(chunk, [&](std::uint32_t id, Kind kind, std::uint32_t index, const Box3d& box) {
            if (isBounded(primitives, kind, index, box)) {
                part.bounds.add(box);
                ++part.bounded;
            } else {
                part.unbounded.push_back({{}, id, {}, static_cast<std::uint32_t>(kind)});
            }
        });
    });
    Box3d bounds;
    for (const Part& part : parts) {
        bounds.add(part.bounds);
        result.boundedCount += part.bounded;
        result.unbounded.insert(result.unbounded.end(), part.unbounded.begin(),
                                part.unbounded.end());
    }
    if (result.boundedCount == 0) return result;
    const Vec3 center = bounds.min * 0.5 + bounds.max * 0.5;
    const double half =
        numeric::maxComponent(numeric::componentMax(bounds.max - center, center - bounds.min));
    if (!(half < 0x1p1000)) { // no power of two brings this into range
        result.boundedCount = 0;
        result.unbounded.clear();
        for (std::size_t chunk = 0; chunk < chunks; ++chunk)
            overChunk(chunk, [&](std::uint32_t id, Kind kind, std::uint32_t, const Box3d&) {
                result.unbounded.push_back({{}, id, {}, static_cast<std::uint32_t>(kind)});
            });
        return result;
    }
    for (int i = 0; i < 3; ++i) result.center[i] = center[i];
    if (half > numeric::powerOfTwo(-1000))
        result.scale = std::ldexp(1.0, -(std::ilogb(half) + (movable ? 2 : 1)));
    result.bounded.reset(new Reference[result.boundedCount]);
    std::uint32_t at = 0;
    std::vector<std::uint32_t> start(chunks);
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        start[chunk] = at;
        at += parts[chunk].bounded;
    }
    parallel::forEach(chunks, 0, [&](std::size_t chunk) {
        Reference* out = result.bounded.get() + start[chunk];
        overChunk(chunk, [&](std::uint32_t id, Kind kind, std::uint32_t index, const Box3d& box) {
            if (!isBounded(primitives, kind, index, box)) return;
            fill(*out++, id, kind, box, result.center, result.scale);
        });
    });
    return result;
}

bool inOctreeSpace(const Box3d& box, const double center[3], double scale, float lower[3],
                   float upper[3]) {
    for (int i = 0; i < 3; ++i) {
        lower[i] = lowerInOctreeSpace(box.min[i], center[i], scale);
        upper[i] = upperInOctreeSpace(box.max[i], center[i], scale);
        if (!(lower[i] >= -1 && upper[i] <= 1)) return false;
    }
    return true;
}

bool referenceOf(const Primitives& primitives, std::uint32_t id, const double center[3],
                 double scale, Reference& reference) {
    const auto& segments = primitives.segments;
    const auto& segment =
        segments.size() == 1 ? segments[0] : primitives.segmentOf(geometry::PrimitiveId{id});
    const std::uint32_t index = segment.index + id - static_cast<std::uint32_t>(segment.first);
    const Box3d box = boundsOf(primitives, segment.kind, index);
    if (!isBounded(primitives, segment.kind, index, box)) return false;
    reference.id = id;
    reference.kind = static_cast<std::uint32_t>(segment.kind);
    return inOctreeSpace(box, center, scale, reference.lower, reference.upper);
}

} // namespace rt::octree
