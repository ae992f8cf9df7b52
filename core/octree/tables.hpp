// Lookup tables of the traversal; data only.
#pragma once
#include <cstdint>

namespace rt::octree {

struct Tables {
    std::uint8_t nearest[8]
                        [256]; // [mirror][mask]: the slot that a ray with these signs meets first
    std::uint8_t compress[256][8]; // [mask]: the positions of its bits in a row
};

extern const Tables kTables;

} // namespace rt::octree
