#include <core/octree/by_origin.hpp>

#include <core/numeric/box.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace rt::octree {
namespace {

// Twice as many rays, or finer places, gain nothing (octree_bench, soup and random spheres).
constexpr std::size_t kWindow = 1024; // rays that are sorted together
constexpr int kBits = 3;              // of a place, per axis
constexpr std::size_t kPlaces = 1u << 3 * kBits;

// Of the rays' extent. Soup +17 to 21 %, random spheres +16 %, a flake −3 %; with 0 those are +20, +23 and −14 %
// (octree_bench, Zen 3).
constexpr double kStrewn = 0.25;

/// Places along the curve through a box that keeps neighbours close [Morton 1966].
class Curve {
public:
    explicit Curve(const numeric::Box3d& box) : lower_(box.min) {
        for (int axis = 0; axis < 3; ++axis)
            factor_[axis] = (1 << kBits) / (box.max[axis] - box.min[axis]);
    }
    std::uint16_t placeOf(const numeric::Vec3& p) const {
        unsigned place = 0;
        for (int axis = 0; axis < 3; ++axis) {
            const double x = (p[axis] - lower_[axis]) * factor_[axis];
            constexpr double kLast = (1 << kBits) - 1;
            place |= kSpread[static_cast<unsigned>(x > 0 ? x < kLast ? x : kLast : 0)] << axis;
        }
        return static_cast<std::uint16_t>(place);
    }

private:
    static constexpr unsigned kSpread[] = {0, 1, 8, 9, 64, 65, 72, 73};
    numeric::Vec3 lower_, factor_;
};

double widthOf(const numeric::Box3d& box) { return numeric::maxComponent(box.diagonal()); }

/// Do rays that would go together start nearly as far apart as others? A few of them say.
bool areStrewn(std::span<const geometry::Ray> rays) {
    constexpr std::size_t kSamples = 4, kTogether = 16;
    if (rays.size() < kWindow / 4) return false;
    numeric::Box3d all;
    double widths = 0;
    for (std::size_t i = 0; i < kSamples; ++i) {
        numeric::Box3d box;
        const auto together = rays.subspan(rays.size() * i / kSamples, kTogether);
        for (std::size_t k = 0; k < kTogether; k += 5) box.add(together[k].origin);
        widths += widthOf(box);
        all.add(box);
    }
    return widths > kStrewn * kSamples * widthOf(all);
}

void sortAndTrace(const Kernel& kernel, const TreeView& tree, std::span<const geometry::Ray> rays,
                  std::span<std::uint8_t> answers, Visits* visits) {
    const std::size_t count = rays.size();
    numeric::Box3d box;
    for (const geometry::Ray& ray : rays) box.add(ray.origin);
    const Curve curve(box);
    std::array<std::uint16_t, kWindow> to; // [ray]: its place, then where it is in `sorted`
    std::array<std::uint16_t, kPlaces> next{};
    for (std::size_t i = 0; i < count; ++i) {
        to[i] = curve.placeOf(rays[i].origin);
        ++next[to[i]];
    }
    std::uint16_t sum = 0;
    for (std::uint16_t& n : next) sum = static_cast<std::uint16_t>(sum + std::exchange(n, sum));
    std::array<geometry::Ray, kWindow> sorted;
    for (std::size_t i = 0; i < count; ++i) {
        to[i] = next[to[i]]++;
        sorted[to[i]] = rays[i];
    }
    std::array<std::uint8_t, kWindow> found;
    kernel.occludedBatch(tree, sorted.data(), count, true, found.data(), visits);
    for (std::size_t i = 0; i < count; ++i) answers[i] = found[to[i]];
}

} // namespace

void occludedByOrigin(const Kernel& kernel, const TreeView& tree,
                      std::span<const geometry::Ray> rays, std::span<std::uint8_t> answers,
                      Visits* visits) {
    for (std::size_t first = 0; first < rays.size(); first += kWindow) {
        const std::size_t count = std::min(rays.size() - first, kWindow);
        const auto some = rays.subspan(first, count);
        const auto to = answers.subspan(first, count);
        if (areStrewn(some))
            sortAndTrace(kernel, tree, some, to, visits);
        else
            kernel.occludedBatch(tree, some.data(), count, true, to.data(), visits);
    }
}

} // namespace rt::octree
