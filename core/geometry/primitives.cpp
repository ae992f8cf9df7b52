#include <core/geometry/primitives.hpp>

#include <algorithm>

namespace rt::geometry {

const Segment& Primitives::segmentOf(PrimitiveId id) const {
    const auto next = std::upper_bound(segments.begin(), segments.end(), id,
                                       [](PrimitiveId i, const Segment& s) { return i < s.first; });
    return *(next - 1);
}

} // namespace rt::geometry
