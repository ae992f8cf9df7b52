#include <core/geometry/primitives.hpp>

namespace rt::geometry {

const Segment& Primitives::segmentOf(PrimitiveId id) const {
    // Where all before it are single primitives, as spheres are, an id is the number of its segment.
    const auto number = static_cast<std::uint32_t>(id);
    if (number < segments.size() && segments[number].first == id && segments[number].count > 0)
        return segments[number];
    const Segment* at = segments.data(); // the one is among the `left` from here
    for (std::size_t left = segments.size(); left > 1;) {
        const std::size_t half = left / 2;
        at += half * (at[half].first <= id); // no branch: it could not be foretold
        left -= half;
    }
    return *at;
}

} // namespace rt::geometry
