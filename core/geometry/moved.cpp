#include <core/geometry/moved.hpp>

#include <cstring>

namespace rt::geometry {
namespace {

template <class T> bool sameBits(const T& a, const T& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool sameSegments(const Primitives& a, const Primitives& b) {
    if (a.segments.size() != b.segments.size()) return false;
    for (std::size_t i = 0; i < a.segments.size(); ++i) {
        const Segment &s = a.segments[i], &t = b.segments[i];
        if (s.first != t.first || s.count != t.count || s.kind != t.kind || s.index != t.index)
            return false;
    }
    return true;
}

bool sameTriangle(const Triangles& a, const Triangles& b, std::uint32_t i) {
    for (std::size_t c = 0; c < 3; ++c)
        if (!sameBits(a.positions[a.indices[i][c]], b.positions[b.indices[i][c]])) return false;
    return true;
}

bool sameCustom(const Customs& a, const Customs& b, std::uint32_t i) {
    const CustomPrimitive &p = a.primitives[i], &q = b.primitives[i];
    return p.primitive == q.primitive && p.shape == q.shape &&
           a.shapes[p.shape] == b.shapes[q.shape] && sameBits(p.bounds, q.bounds);
}

} // namespace

std::optional<std::vector<PrimitiveId>> movedBetween(const Primitives& before,
                                                     const Primitives& after) {
    if (!sameSegments(before, after)) return std::nullopt;
    std::vector<PrimitiveId> moved;
    for (const Segment& segment : before.segments)
        for (std::uint32_t k = 0; k < segment.count; ++k) {
            const std::uint32_t i = segment.index + k;
            bool same = true;
            switch (segment.kind) {
            case Kind::triangle:
                same = sameTriangle(before.triangles, after.triangles, i);
                break;
            case Kind::sphere:
                same = sameBits(before.spheres[i], after.spheres[i]);
                break;
            case Kind::parallelogram:
                same = sameBits(before.parallelograms[i], after.parallelograms[i]);
                break;
            case Kind::custom:
                same = sameCustom(before.customs, after.customs, i);
                break;
            }
            if (!same) moved.push_back(PrimitiveId{static_cast<std::uint32_t>(segment.first) + k});
        }
    return moved;
}

} // namespace rt::geometry
