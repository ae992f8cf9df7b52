#include <core/trace/grid.hpp>

#include <algorithm>

namespace rt::trace {
namespace {

constexpr std::uint32_t kPixelsInLine = 64 / sizeof(LinearRgb); // of the caches, or fewer

constexpr std::uint32_t kBlock = 4; // columns, and rows: the octree's bundles are best that way

/// The order of a band of samples in which any 16 neighbours in the list are neighbours in the
/// picture: columns of blocks, each row by row.
struct InBlocks {
    std::uint32_t width, height;

    std::size_t count() const { return std::size_t(width) * height; }
    std::size_t operator()(std::uint32_t column, std::uint32_t row) const {
        const std::uint32_t left = column / kBlock * kBlock;
        return std::size_t(left) * height + row * std::min(kBlock, width - left) + (column - left);
    }
    /// Calls visit(column, row) in that order.
    template <class Visit> void forEach(const Visit& visit) const {
        for (std::uint32_t left = 0; left < width; left += kBlock)
            for (std::uint32_t row = 0; row < height; ++row)
                for (std::uint32_t column = left; column < std::min(left + kBlock, width); ++column)
                    visit(column, row);
    }
};

/// Rows of pixels that are sampled together: a row of blocks, and as many as fill some bundles.
std::uint32_t rowsOfBand(std::uint32_t width, std::uint32_t n) {
    constexpr std::uint32_t kSamples = 1024;
    return std::max((kBlock + n - 1) / n, kSamples / (width * n * n));
}

} // namespace

bool sampleGrid(const View& view, Sampler sampler, std::uint32_t n, scene::Sampling sampling,
                const Region& region, const Options& options, image::Framebuffer& frame,
                RayCounts& counts) {
    const Tiles tiles(region);
    const double first = sampling == scene::Sampling::center ? 0.5 : 0;
    std::vector<double> offset(n); // of the samples from the corner of their pixel
    for (std::uint32_t k = 0; k < n; ++k) offset[k] = (k + first) / n;
    const auto blacken = [&frame](const Region& part) {
        for (std::uint32_t y = part.y0; y < part.y1; ++y)
            std::fill_n(&frame.at(part.x0, y), part.width(), LinearRgb{});
    };
    std::vector<std::uint8_t> begun(tiles.count());
    const bool complete = forEachPiece(
        tiles.count(), options, counts, 0, 1,
        [&](std::size_t number, Scratch& scratch, RayCounts& counted) {
            const Region tile = tiles[number];
            begun[number] = true;
            blacken(tile);
            const std::uint32_t rows = rowsOfBand(tile.width(), n);
            std::vector<PicturePoint> points;
            std::vector<LinearRgb> colors;
            std::vector<double> columns, rowsOfPicture; // of the samples
            for (std::uint32_t x = tile.x0; x < tile.x1; ++x)
                for (const double within : offset) columns.push_back(x + within);
            for (std::uint32_t y0 = tile.y0; y0 < tile.y1; y0 += rows) {
                if (options.stop && options.stop->load(std::memory_order_relaxed)) return;
                const std::uint32_t y1 = std::min(y0 + rows, tile.y1);
                const InBlocks blocks{tile.width() * n, (y1 - y0) * n};
                rowsOfPicture.clear();
                for (std::uint32_t y = y0; y < y1; ++y)
                    for (const double within : offset) rowsOfPicture.push_back(y + within);
                colors.resize(blocks.count());
                points.resize(blocks.count());
                PicturePoint* next = points.data();
                blocks.forEach([&](std::uint32_t column, std::uint32_t row) {
                    *next++ = {columns.data()[column], rowsOfPicture.data()[row]};
                });
                // The picture is not in the caches; this way it will be when the colors are there
                // (checker.yaml of tests/bench/versus: 3 % faster).
                for (std::uint32_t y = y0; y < y1; ++y)
                    for (std::uint32_t x = tile.x0; x < tile.x1; x += kPixelsInLine)
                        __builtin_prefetch(&frame.at(x, y), 1);
                sampler(view, points, colors.data(), scratch, counted);
                if (n == 1) {
                    const LinearRgb* color = colors.data();
                    blocks.forEach([&](std::uint32_t column, std::uint32_t row) {
                        frame.at(tile.x0 + column, y0 + row) = *color++;
                    });
                    continue;
                }
                for (std::uint32_t y = y0; y < y1; ++y)
                    for (std::uint32_t x = tile.x0; x < tile.x1; ++x) {
                        LinearRgb sum;
                        for (std::uint32_t row = 0; row < n; ++row)
                            for (std::uint32_t column = 0; column < n; ++column)
                                sum +=
                                    colors[blocks((x - tile.x0) * n + column, (y - y0) * n + row)];
                        frame.at(x, y) = sum * (1.0 / (double(n) * n));
                    }
            }
        });
    for (std::size_t number = 0; number < tiles.count(); ++number)
        if (!begun[number]) blacken(tiles[number]);
    return complete;
}

} // namespace rt::trace
