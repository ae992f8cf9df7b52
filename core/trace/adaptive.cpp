#include <core/trace/adaptive.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace rt::trace {
namespace {

/// The k-th point of every pixel: a Kronecker sequence on the plastic number, whose first n points
/// are spread evenly for every n [Roberts, The Unreasonable Effectiveness of Quasirandom Sequences,
/// 2018]. The first is the middle.
PicturePoint pointOf(std::uint32_t x, std::uint32_t y, std::uint32_t k) {
    constexpr double kPlastic = 1.32471795724474602596;
    const double column = 0.5 + k * (1 / kPlastic), row = 0.5 + k * (1 / (kPlastic * kPlastic));
    return {x + (column - std::floor(column)), y + (row - std::floor(row))};
}

struct Pixel {
    LinearRgb sum;
    double sumOfSquares = 0; // over samples and channels
    std::uint32_t samples = 0;
    double squaredError = 0; // estimated, mean over channels
};

constexpr std::uint32_t kMostSamples = 1u << 16;

/// From 1 to 4, so that a variance can be had, then twice as many each time.
std::uint32_t moreSamples(std::uint32_t samples) { return samples <= 1 ? 4 - samples : samples; }

class Adaptive {
public:
    Adaptive(const View& view, Sampler sampler, const Region& region, const Options& options,
             RayCounts& counts)
        : view_(view), sampler_(sampler), region_(region), options_(options), counts_(counts),
          pixels_(std::size_t(region.width()) * region.height()) {}

    /// One sample in each pixel of the list, tile by tile; false when stopped.
    bool sampleAll() {
        const Tiles tiles(region_);
        return forEachPiece(tiles.count(), options_, counts_, 0, kShareOfFirstPass,
                            [&](std::size_t index, Scratch& scratch, RayCounts& counted) {
                                const Region tile = tiles[index];
                                for (std::uint32_t y = tile.y0; y < tile.y1; ++y)
                                    for (std::uint32_t x = tile.x0; x < tile.x1; ++x)
                                        add(at(x, y), x, y, 1, scratch, counted);
                            });
    }

    bool refine(const std::vector<std::uint32_t>& list, double from, double to) {
        constexpr std::size_t kPixelsPerPiece = 64;
        const std::size_t pieces = (list.size() + kPixelsPerPiece - 1) / kPixelsPerPiece;
        return forEachPiece(pieces, options_, counts_, from, to,
                            [&](std::size_t piece, Scratch& scratch, RayCounts& counted) {
                                const std::size_t end =
                                    std::min(list.size(), (piece + 1) * kPixelsPerPiece);
                                for (std::size_t i = piece * kPixelsPerPiece; i < end; ++i) {
                                    Pixel& pixel = pixels_[list[i]];
                                    add(pixel, region_.x0 + list[i] % region_.width(),
                                        region_.y0 + list[i] / region_.width(),
                                        moreSamples(pixel.samples), scratch, counted);
                                }
                            });
    }

    /// Updates the estimate of every pixel; returns that of the region.
    double estimate() {
        double sum = 0;
        for (std::uint32_t y = region_.y0; y < region_.y1; ++y)
            for (std::uint32_t x = region_.x0; x < region_.x1; ++x) {
                Pixel& pixel = at(x, y);
                pixel.squaredError = squaredError(x, y);
                sum += pixel.squaredError;
            }
        return std::sqrt(sum / static_cast<double>(pixels_.size()));
    }

    /// Pixels where a sample lowers the squared error by more than `gain`, by index.
    std::vector<std::uint32_t> worthMoreThan(double gain) const {
        std::vector<std::uint32_t> list;
        for (std::uint32_t i = 0; i < pixels_.size(); ++i)
            if (pixels_[i].squaredError > gain * pixels_[i].samples &&
                pixels_[i].samples < kMostSamples)
                list.push_back(i);
        return list;
    }

    double largestGain() const {
        double largest = 0;
        for (const Pixel& p : pixels_)
            if (p.samples < kMostSamples) largest = std::max(largest, p.squaredError / p.samples);
        return largest;
    }

    void write(image::Framebuffer& frame) const {
        for (std::uint32_t y = region_.y0; y < region_.y1; ++y)
            for (std::uint32_t x = region_.x0; x < region_.x1; ++x)
                if (at(x, y).samples) frame.at(x, y) = mean(at(x, y));
    }

    static constexpr double kShareOfFirstPass = 0.3; // of the progress bar

private:
    Pixel& at(std::uint32_t x, std::uint32_t y) {
        return pixels_[std::size_t(y - region_.y0) * region_.width() + (x - region_.x0)];
    }
    const Pixel& at(std::uint32_t x, std::uint32_t y) const {
        return const_cast<Adaptive*>(this)->at(x, y);
    }

    static LinearRgb mean(const Pixel& p) { return p.sum * (1.0 / p.samples); }

    void add(Pixel& pixel, std::uint32_t x, std::uint32_t y, std::uint32_t count, Scratch& scratch,
             RayCounts& counted) {
        constexpr std::uint32_t kBatch = 64;
        PicturePoint points[kBatch];
        LinearRgb colors[kBatch];
        for (std::uint32_t done = 0; done < count;) {
            const std::uint32_t batch = std::min(kBatch, count - done);
            for (std::uint32_t i = 0; i < batch; ++i) points[i] = pointOf(x, y, pixel.samples + i);
            sampler_(view_, {points, batch}, colors, scratch, counted);
            for (std::uint32_t i = 0; i < batch; ++i) {
                const LinearRgb& c = colors[i];
                pixel.sum += c;
                pixel.sumOfSquares += c.r * c.r + c.g * c.g + c.b * c.b;
            }
            pixel.samples += batch;
            done += batch;
        }
    }

    static double squaredDistance(const LinearRgb& a, const LinearRgb& b) {
        const double r = a.r - b.r, g = a.g - b.g, u = a.b - b.b;
        return r * r + g * g + u * u;
    }

    /// The variance between samples of the pixel, and, with the weight of kPriorSamples of them, the
    /// contrast to its neighbours, which knows of edges that the samples have missed so far; divided
    /// by n^1.5, the rate at which evenly spread samples resolve an edge [Mitchell 1996].
    double squaredError(std::uint32_t x, std::uint32_t y) const {
        const Pixel& pixel = at(x, y);
        const LinearRgb here = mean(pixel);
        double contrast = 0;
        for (std::uint32_t ny = std::max(y, region_.y0 + 1) - 1; ny < std::min(y + 2, region_.y1);
             ++ny)
            for (std::uint32_t nx = std::max(x, region_.x0 + 1) - 1;
                 nx < std::min(x + 2, region_.x1); ++nx)
                contrast = std::max(contrast, squaredDistance(here, mean(at(nx, ny))));
        const double n = pixel.samples;
        const double spread = std::max(
            0.0, pixel.sumOfSquares - (pixel.sum.r * pixel.sum.r + pixel.sum.g * pixel.sum.g +
                                       pixel.sum.b * pixel.sum.b) /
                                          n); // (n - 1) times the variance
        const double variance =
            (spread + kPriorSamples * kVarianceOfContrast * contrast) / (n - 1 + kPriorSamples);
        return variance / (n * std::sqrt(n)) / 3;
    }

    // A pixel that a straight edge crosses anywhere has a variance of 1/6 of the squared contrast on
    // average; one in two neighbours of an edge is crossed.
    static constexpr double kPriorSamples = 1;
    static constexpr double kVarianceOfContrast = 1.0 / 6;

    const View& view_;
    Sampler sampler_;
    Region region_;
    const Options& options_;
    RayCounts& counts_;
    std::vector<Pixel> pixels_;
};

} // namespace

void sampleAdaptively(const View& view, Sampler sampler, double rmse, const Region& region,
                      const Options& options, Result& result) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    Adaptive adaptive(view, sampler, region, options, result.counts);
    result.complete = adaptive.sampleAll();
    if (!result.complete) return adaptive.write(result.frame);
    double best = adaptive.estimate();
    // Halving thresholds equalise what one more sample is worth in every pixel.
    double gain = adaptive.largestGain() / 2;
    double reached = best;
    double progress = Adaptive::kShareOfFirstPass;
    while (reached > rmse || reached > best) {
        const auto list = adaptive.worthMoreThan(gain);
        if (list.empty()) {
            if (adaptive.largestGain() == 0) break; // every pixel is exact or has all its samples
            gain /= 2;
            continue;
        }
        const auto passStart = Clock::now();
        const double next = progress + (1 - progress) / 8;
        result.complete = adaptive.refine(list, progress, next);
        progress = next;
        if (!result.complete) break;
        reached = adaptive.estimate();
        // Only a new best may end it: an earlier pass with the same estimate would end it there.
        best = std::min(best, reached);
        if (options.timeBudget && reached <= best) {
            const std::chrono::duration<double> spent = Clock::now() - start,
                                                pass = Clock::now() - passStart;
            if (spent.count() + pass.count() > *options.timeBudget) break;
        }
    }
    adaptive.write(result.frame);
    result.estimatedError = reached;
    if (options.progress) options.progress(1);
}

} // namespace rt::trace
