// Work over threads in pieces whose number, size and results do not depend on the threads.
#pragma once
#include <core/trace/counts.hpp>
#include <core/trace/render.hpp>
#include <core/trace/whitted.hpp>

#include <functional>

namespace rt::trace {

/// Calls body(piece, scratch, counts) for each piece < pieces; returns false when options.stop was
/// raised before all had begun. Adds what they counted to `counts`, in the order of the pieces.
/// Progress runs from `from` to `to`.
bool forEachPiece(std::size_t pieces, const Options& options, RayCounts& counts, double from,
                  double to, const std::function<void(std::size_t, Scratch&, RayCounts&)>& body);

/// A rectangle of pixels: columns x0 to x1 - 1, rows y0 to y1 - 1.
struct Region {
    std::uint32_t x0, y0, x1, y1;

    std::uint32_t width() const { return x1 - x0; }
    std::uint32_t height() const { return y1 - y0; }
};

/// The tiles of a region, neighbours far apart: at any time those that are done are a fair sample of
/// the picture, and so is their cost, from which the time that is left is told.
class Tiles {
public:
    explicit Tiles(const Region& region);
    std::size_t count() const { return std::size_t(columns_) * rows_; }
    Region operator[](std::size_t number) const;

private:
    Region region_;
    std::uint32_t columns_, rows_;
    std::size_t stride_; // has no divisor in common with count()
};

} // namespace rt::trace
