#include <core/trace/tiles.hpp>

#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numbers>
#include <numeric>
#include <utility>
#include <vector>

namespace rt::trace {
namespace {

constexpr std::uint32_t kTileSide = 32; // pixels

/// What no thread uses at the moment. (A thread_local one would have its destructor registered by the C library,
/// which ends the program when there is no memory for that.)
class IdleScratches {
public:
    Scratch take() {
        const std::lock_guard lock(mutex_);
        if (idle_.empty()) return {};
        Scratch last = std::move(idle_.back());
        idle_.pop_back();
        return last;
    }
    void give(Scratch&& scratch) {
        const std::lock_guard lock(mutex_);
        idle_.push_back(std::move(scratch));
    }

private:
    std::mutex mutex_;
    std::vector<Scratch> idle_;
};

} // namespace

bool forEachPiece(std::size_t pieces, const Options& options, RayCounts& counts, double from,
                  double to, const std::function<void(std::size_t, Scratch&, RayCounts&)>& body) {
    std::vector<RayCounts> counted(pieces);
    std::atomic<bool> complete = true;
    std::atomic<std::size_t> done = 0;
    std::mutex reporting;
    parallel::forEach(pieces, options.threads, [&](std::size_t piece) {
        if (options.stop && options.stop->load(std::memory_order_relaxed)) {
            complete = false;
            return;
        }
        static IdleScratches idle;
        Scratch scratch = idle.take();
        body(piece, scratch, counted[piece]);
        idle.give(std::move(scratch));
        const std::size_t finished = ++done;
        if (!options.progress) return;
        const std::unique_lock lock(reporting, std::try_to_lock);
        if (lock)
            options.progress(from + (to - from) * static_cast<double>(finished) /
                                        static_cast<double>(pieces));
    });
    for (const RayCounts& c : counted) counts += c;
    return complete;
}

Tiles::Tiles(const Region& region)
    : region_(region), columns_((region.width() + kTileSide - 1) / kTileSide),
      rows_((region.height() + kTileSide - 1) / kTileSide) {
    // Multiples of the golden section of a whole spread evenly [Knuth, TAOCP 3, 6.4].
    stride_ = static_cast<std::size_t>(static_cast<double>(count()) / std::numbers::phi);
    while (std::gcd(stride_, count()) > 1) ++stride_;
}

Region Tiles::operator[](std::size_t number) const {
    const std::size_t index = number * stride_ % count();
    const auto column = static_cast<std::uint32_t>(index % columns_);
    const auto row = static_cast<std::uint32_t>(index / columns_);
    const std::uint32_t x = region_.x0 + column * kTileSide, y = region_.y0 + row * kTileSide;
    return {x, y, std::min(x + kTileSide, region_.x1), std::min(y + kTileSide, region_.y1)};
}

} // namespace rt::trace
