// Rays under way: what each is for, and those that wait to be traced.
#pragma once
#include <core/geometry/ray.hpp>
#include <core/trace/groups.hpp>
#include <core/trace/path_sums.hpp>
#include <core/trace/wave.hpp>
#include <core/trace/work.hpp>

#include <algorithm>
#include <span>
#include <vector>

namespace rt::trace {

/// Rays with what they met, under the same index.
struct Batch {
    std::span<const Work> works;
    std::span<geometry::Ray> rays;
    std::span<geometry::Hit> hits;
};

/// A stack of rays that wait. Taking the last, at most so many, keeps its size linear in the depth.
class Pending {
public:
    void clear() {
        size_ = 0;
        pushes_.clear();
    }
    bool empty() const { return size_ == 0; }
    std::size_t size() const { return size_; }

    /// Room for `count` more, sorted into the groups of which `by` was told, since the octree traces together
    /// what goes in one direction (glass.yaml of tests/bench/versus: 1.2 times as fast). Calls fill(k, work,
    /// ray) for each, of group groupOf(k). What was taken before is overwritten. termsEnd: their terms, and those
    /// of all that wait, are lower.
    template <class GroupOf, class Fill>
    void push(std::size_t count, ByDirection& by, PathSums::Term termsEnd, const GroupOf& groupOf,
              const Fill& fill) {
        if (count == 0) return;
        pushes_.push_back({size_, termsEnd});
        const std::size_t end = size_ + count;
        if (rays_.size() < end) {
            rays_.resize(2 * end);
            works_.resize(2 * end);
            groups_.resize(2 * end);
        }
        by.order();
        for (std::size_t k = 0; k < count; ++k) {
            const std::uint8_t group = groupOf(k);
            const std::size_t to = size_ + by.placeIn(group);
            fill(k, works_.data()[to], rays_.data()[to]);
            groups_.data()[to] = group;
        }
        size_ = end;
    }

    /// The last kWave, or all, which then wait no more; in place until the next push.
    struct Taken {
        std::span<geometry::Ray> rays;
        std::span<const Work> works;
        std::span<const std::uint8_t> groups;
    };
    Taken take() {
        const std::size_t count = std::min(size_, kWave);
        size_ -= count;
        while (!pushes_.empty() && pushes_.back().first >= size_) pushes_.pop_back();
        return {std::span(rays_).subspan(size_, count), std::span(works_).subspan(size_, count),
                std::span(groups_).subspan(size_, count)};
    }

    /// Of those that wait; 0 if none does.
    PathSums::Term termsEnd() const { return pushes_.empty() ? 0 : pushes_.back().termsEnd; }

private:
    struct Push {
        std::size_t first;
        PathSums::Term termsEnd;
    };
    std::vector<Push> pushes_; // of which any wait
    std::vector<geometry::Ray> rays_;
    std::vector<Work> works_;
    std::vector<std::uint8_t> groups_;
    std::size_t size_ = 0;
};

} // namespace rt::trace
