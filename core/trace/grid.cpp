#include <core/trace/grid.hpp>

namespace rt::trace {

bool sampleGrid(const View& view, Sampler sampler, std::uint32_t n, scene::Sampling sampling,
                const Region& region, const Options& options, image::Framebuffer& frame,
                RayCounts& counts) {
    const Tiles tiles(region);
    const double first = sampling == scene::Sampling::center ? 0.5 : 0;
    return forEachPiece(
        tiles.count(), options, counts, 0, 1,
        [&](std::size_t index, Scratch& scratch, RayCounts& counted) {
            const Region tile = tiles[index];
            std::vector<PicturePoint> points(std::size_t(tile.width()) * n * n);
            std::vector<LinearRgb> colors(points.size());
            for (std::uint32_t y = tile.y0; y < tile.y1; ++y) {
                if (options.stop && options.stop->load(std::memory_order_relaxed)) return;
                std::size_t i = 0;
                for (std::uint32_t x = tile.x0; x < tile.x1; ++x)
                    for (std::uint32_t row = 0; row < n; ++row)
                        for (std::uint32_t column = 0; column < n; ++column)
                            points[i++] = {x + (column + first) / n, y + (row + first) / n};
                sampler(view, points, colors.data(), scratch, counted);
                i = 0;
                for (std::uint32_t x = tile.x0; x < tile.x1; ++x) {
                    LinearRgb sum;
                    for (std::uint32_t k = 0; k < n * n; ++k) sum += colors[i++];
                    frame.at(x, y) = sum * (1.0 / (double(n) * n));
                }
            }
        });
}

} // namespace rt::trace
