#include <core/geometry/primitives.hpp>

namespace rt::geometry {

const Segment& Primitives::searchedSegmentOf(PrimitiveId id) const {
    const Segment* at = segments.data(); // the one is among the `left` from here
    for (std::size_t left = segments.size(); left > 1;) {
        const std::size_t half = left / 2;
        at += half * (at[half].first <= id); // no branch: it could not be foretold
        left -= half;
    }
    return *at;
}

} // namespace rt::geometry
