#include <core/image/quantize.hpp>
#include <core/image/ssim.hpp>
#include <core/numeric/elementary.hpp>

#include <array>
#include <vector>

namespace rt::image {
namespace {

constexpr double kPeak = 255, kC1 = (0.01 * kPeak) * (0.01 * kPeak),
                 kC2 = (0.03 * kPeak) * (0.03 * kPeak);

double channel(const LinearRgb& c, int i) { return i == 0 ? c.r : i == 1 ? c.g : c.b; }

/// Of two windows with means a, b, variances and covariance.
double similarity(double a, double b, double varianceA, double varianceB, double covariance,
                  double c1 = kC1) {
    return (2 * a * b + c1) * (2 * covariance + kC2) /
           ((a * a + b * b + c1) * (varianceA + varianceB + kC2));
}

bool counts(const Framebuffer* mask, std::uint32_t x0, std::uint32_t y0) {
    if (!mask) return true;
    for (std::uint32_t y = y0; y < y0 + 8; ++y)
        for (std::uint32_t x = x0; x < x0 + 8; ++x)
            if (const LinearRgb& m = mask->at(x, y); !(m.r + m.g + m.b > 1.5)) return false;
    return true;
}

/// 8-bit sRGB luma, Rec. 601.
std::vector<double> lumaOf(const Framebuffer& frame) {
    std::vector<double> luma(frame.pixels.size());
    for (std::size_t i = 0; i < luma.size(); ++i) {
        const LinearRgb& c = frame.pixels[i];
        luma[i] = 0.299 * srgb8(c.r) + 0.587 * srgb8(c.g) + 0.114 * srgb8(c.b);
    }
    return luma;
}

constexpr int kSide = 11;

std::array<double, kSide> gaussian() {
    std::array<double, kSide> weight{};
    double sum = 0;
    for (int i = 0; i < kSide; ++i)
        sum += weight[i] = numeric::exp(-(i - 5) * (i - 5) / (2 * 1.5 * 1.5));
    for (double& w : weight) w /= sum;
    return weight;
}

/// Gaussian mean of every window that lies inside, (width - 10) x (height - 10).
std::vector<double> blurred(const std::vector<double>& values, std::size_t width,
                            std::size_t height) {
    static const std::array<double, kSide> weight = gaussian();
    const std::size_t outWidth = width - (kSide - 1), outHeight = height - (kSide - 1);
    std::vector<double> rows(outWidth * height), out(outWidth * outHeight);
    for (std::size_t y = 0; y < height; ++y)
        for (std::size_t x = 0; x < outWidth; ++x)
            for (std::size_t k = 0; k < kSide; ++k)
                rows[y * outWidth + x] += weight[k] * values[y * width + x + k];
    for (std::size_t y = 0; y < outHeight; ++y)
        for (std::size_t k = 0; k < kSide; ++k)
            for (std::size_t x = 0; x < outWidth; ++x)
                out[y * outWidth + x] += weight[k] * rows[(y + k) * outWidth + x];
    return out;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> out(a.size());
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = a[i] * b[i];
    return out;
}

} // namespace

std::optional<double> ssimBlocks(const Framebuffer& picture, const Framebuffer& reference,
                                 const CompareOptions& options) {
    const Region region = checkedRegion(picture, reference, options);
    const std::uint32_t columns = (region.x1 - region.x0) / 4, rows = (region.y1 - region.y0) / 4;
    double sum = 0;
    std::uint64_t windows = 0;
    for (std::uint32_t row = 0; row + 1 < rows; ++row)
        for (std::uint32_t column = 0; column + 1 < columns; ++column) {
            const std::uint32_t x0 = region.x0 + 4 * column, y0 = region.y0 + 4 * row;
            if (!counts(options.mask, x0, y0)) continue;
            ++windows;
            for (int c = 0; c < 3; ++c) {
                std::uint32_t a = 0, b = 0, aa = 0, bb = 0, ab = 0; // 64 * 255^2 fits
                for (std::uint32_t y = y0; y < y0 + 8; ++y)
                    for (std::uint32_t x = x0; x < x0 + 8; ++x) {
                        const std::uint32_t p = srgb8(channel(picture.at(x, y), c)),
                                            q = srgb8(channel(reference.at(x, y), c));
                        a += p, b += q, aa += p * p, bb += q * q, ab += p * q;
                    }
                const double meanA = a / 64.0, meanB = b / 64.0;
                sum += similarity(meanA, meanB, (aa - a * meanA) / 63, (bb - b * meanB) / 63,
                                  (ab - a * meanB) / 63, kC1 / 64);
            }
        }
    if (windows == 0) return {};
    return sum / (3.0 * double(windows));
}

std::optional<double> ssimGaussian(const Framebuffer& picture, const Framebuffer& reference) {
    checkedRegion(picture, reference, {});
    const std::size_t width = picture.width, height = picture.height;
    if (width < kSide || height < kSide) return {};
    const auto a = lumaOf(picture), b = lumaOf(reference);
    const auto blur = [&](const std::vector<double>& values) {
        return blurred(values, width, height);
    };
    const auto meanA = blur(a), meanB = blur(b), aa = blur(product(a, a)), bb = blur(product(b, b)),
               ab = blur(product(a, b));
    double sum = 0;
    for (std::size_t i = 0; i < meanA.size(); ++i)
        sum += similarity(meanA[i], meanB[i], aa[i] - meanA[i] * meanA[i],
                          bb[i] - meanB[i] * meanB[i], ab[i] - meanA[i] * meanB[i]);
    return sum / double(meanA.size());
}

} // namespace rt::image
