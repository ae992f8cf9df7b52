// Rays in groups that the octree traces together: groupOf in wave.inl.
#pragma once
#include <array>
#include <cstdint>
#include <utility>

namespace rt::trace {

inline constexpr std::size_t kGroups = 24;

/// Gives rays places, group by group: first each is noted, then each gets its place.
class ByDirection {
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
    /// Calls visit(first, count) for the places of each group that has any, when all were asked for.
    template <class Visit> void forEachGroup(const Visit& visit) const {
        std::uint32_t first = 0;
        for (const std::uint32_t end : next_) {
            if (end > first) visit(first, end - first);
            first = end;
        }
    }

private:
    std::array<std::uint32_t, kGroups> next_; // by group: first its size, then its next place
};

/// Calls visit(first, count) for each run of equal groups.
template <class Groups, class Visit> void forEachRun(const Groups& groups, const Visit& visit) {
    for (std::size_t first = 0, end; first < groups.size(); first = end) {
        for (end = first + 1; end < groups.size() && groups[end] == groups[first];) ++end;
        visit(first, end - first);
    }
}

} // namespace rt::trace
