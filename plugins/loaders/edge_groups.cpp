#include "edge_groups.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

namespace rt::loaders {

EdgeGroups::EdgeGroups(std::span<const std::uint32_t> vertex,
                       std::span<const std::uint32_t> faceStart, std::uint32_t vertexCount)
    : bucketStart_(vertexCount + std::size_t{1}), other_(vertex.size()), half_(vertex.size()) {
    const auto forEachHalf = [&](auto&& visit) {
        for (std::size_t f = 0; f + 1 < faceStart.size(); ++f) {
            const std::uint32_t last = faceStart[f + 1] - 1;
            for (std::uint32_t h = faceStart[f]; h <= last; ++h)
                visit(h, vertex[h], vertex[h == last ? faceStart[f] : h + 1]);
        }
    };
    // A counting sort by the lower vertex keeps half-edges in order; buckets are short.
    forEachHalf([&](std::uint32_t, std::uint32_t a, std::uint32_t b) {
        ++bucketStart_[std::min(a, b) + std::size_t{1}];
    });
    for (std::size_t v = 0; v < vertexCount; ++v) bucketStart_[v + 1] += bucketStart_[v];
    std::vector<std::uint32_t> fill(bucketStart_.begin(), bucketStart_.end() - 1);
    forEachHalf([&](std::uint32_t h, std::uint32_t a, std::uint32_t b) {
        const std::uint32_t at = fill[std::min(a, b)]++;
        other_[at] = std::max(a, b), half_[at] = h;
    });
    std::vector<std::pair<std::uint32_t, std::uint32_t>> large;
    for (std::size_t v = 0; v < vertexCount; ++v) {
        const std::size_t from = bucketStart_[v], to = bucketStart_[v + 1];
        if (to - from > 64) {
            large.clear();
            for (std::size_t i = from; i < to; ++i) large.emplace_back(other_[i], half_[i]);
            std::sort(large.begin(), large.end());
            for (std::size_t i = from; i < to; ++i) std::tie(other_[i], half_[i]) = large[i - from];
            continue;
        }
        for (std::size_t i = from + 1; i < to; ++i) { // stable
            const std::uint32_t other = other_[i], half = half_[i];
            std::size_t j = i;
            for (; j > from && other_[j - 1] > other; --j)
                other_[j] = other_[j - 1], half_[j] = half_[j - 1];
            other_[j] = other, half_[j] = half;
        }
    }
}

} // namespace rt::loaders
