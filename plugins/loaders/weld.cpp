#include "weld.hpp"

#include <bit>

namespace rt::loaders {

std::vector<std::uint32_t> weldEqual(std::span<const Vector3> positions) {
    const auto n = static_cast<std::uint32_t>(positions.size());
    std::vector<std::uint32_t> first(n);
    // Open addressing at a load of at most one half; a slot holds an index, so nothing is stored twice.
    const std::size_t slots = std::bit_ceil(2 * std::size_t{n} + 2);
    std::vector<std::uint32_t> table(slots, RT_NO_INDEX);
    const auto mix = [](std::uint64_t h, double coordinate) {
        h ^= std::bit_cast<std::uint64_t>(coordinate + 0.0); // -0 + 0 is 0
        h *= 0x9E3779B97F4A7C15u; // 2^64 over the golden ratio [Knuth 6.4]
        return h ^ (h >> 32);
    };
    for (std::uint32_t i = 0; i < n; ++i) {
        const Vector3& p = positions[i];
        std::size_t slot = mix(mix(mix(0, p.x), p.y), p.z) & (slots - 1);
        while (table[slot] != RT_NO_INDEX && !(positions[table[slot]] == p))
            slot = (slot + 1) & (slots - 1);
        if (table[slot] == RT_NO_INDEX) table[slot] = i;
        first[i] = table[slot];
    }
    return first;
}

} // namespace rt::loaders
