// Rays in groups, sorted by counting.
#pragma once
#include <array>
#include <cstdint>
#include <utility>

namespace rt::trace {

/// Gives rays places, group by group: first each is noted, then each gets its place.
template <std::size_t kGroups> class Groups {
public:
    void start() { next_.fill(0); }
    /// `wanted`: 1, or 0 for none.
    void note(std::size_t group, std::uint32_t wanted = 1) { next_[group] += wanted; }
    /// After the last note().
    void order() {
        std::uint32_t sum = 0;
        for (std::uint32_t& n : next_) sum += std::exchange(n, sum);
    }
    /// As often as the group was noted.
    std::uint32_t placeIn(std::size_t group) { return next_[group]++; }
    /// Calls visit(group, first, count) for the places of each that has any, when all were asked for.
    template <class Visit> void forEachGroup(const Visit& visit) const {
        std::uint32_t first = 0;
        for (std::size_t group = 0; group < kGroups; ++group) {
            const std::uint32_t end = next_[group];
            if (end > first) visit(group, first, end - first);
            first = end;
        }
    }

private:
    std::array<std::uint32_t, kGroups> next_; // by group: first its size, then its next place
};

/// The groups that the octree traces together: groupOf in wave.inl.
using ByDirection = Groups<24>;

/// Calls visit(first, count) for each run of equal keyOf(i), i < size.
template <class KeyOf, class Visit>
void forEachRun(std::size_t size, const KeyOf& keyOf, const Visit& visit) {
    for (std::size_t first = 0, end; first < size; first = end) {
        const auto key = keyOf(first);
        for (end = first + 1; end < size && keyOf(end) == key;) ++end;
        visit(first, end - first);
    }
}

} // namespace rt::trace
