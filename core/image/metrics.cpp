#include <core/image/metrics.hpp>
#include <core/numeric/elementary.hpp>
#include <core/numeric/rounding.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

namespace rt::image {
namespace {

std::array<double, 3> channels(const LinearRgb& c) { return {c.r, c.g, c.b}; }

void requireOneSize(const Framebuffer& a, const Framebuffer& b) {
    if (a.width != b.width || a.height != b.height)
        throw std::invalid_argument("the pictures differ in size");
}

enum class Kind { finite, infinite, nan };

Kind kindOf(const LinearRgb& c) {
    Kind kind = Kind::finite;
    for (const double v : channels(c)) {
        if (std::isnan(v)) return Kind::nan;
        if (std::isinf(v)) kind = Kind::infinite;
    }
    return kind;
}

struct Sums {
    double square = 0, squareOfRest = 0, absolute = 0, relativeSquare = 0, ours = 0, reference = 0;
    Sums& operator+=(const Sums& o) {
        square += o.square, squareOfRest += o.squareOfRest, absolute += o.absolute,
            relativeSquare += o.relativeSquare;
        ours += o.ours, reference += o.reference;
        return *this;
    }
};

} // namespace

double Difference::psnr() const {
    return rmse > 0 ? 20 * (numeric::log(peak / rmse) / numeric::log(10)) : numeric::kInfinity;
}

Region checkedRegion(const Framebuffer& picture, const Framebuffer& reference,
                     const CompareOptions& options) {
    requireOneSize(picture, reference);
    if (options.mask) requireOneSize(picture, *options.mask);
    const Region region = options.crop.value_or(Region{0, 0, picture.width, picture.height});
    if (region.x0 >= region.x1 || region.y0 >= region.y1 || region.x1 > picture.width ||
        region.y1 > picture.height)
        throw std::invalid_argument("the crop is empty or leaves the picture");
    return region;
}

Difference difference(const Framebuffer& picture, const Framebuffer& reference,
                      const CompareOptions& options) {
    const Region region = checkedRegion(picture, reference, options);
    Difference result;
    Sums total;
    std::uint64_t finite = 0, rest = 0;
    for (std::uint32_t y = region.y0; y < region.y1; ++y) {
        Sums
            row; // summed by rows, so that the rounding of a sum grows with the side and not with the area
        for (std::uint32_t x = region.x0; x < region.x1; ++x) {
            if (options.mask) {
                const LinearRgb& m = options.mask->at(x, y);
                if (!(m.r + m.g + m.b > 1.5)) continue;
            }
            ++result.pixels;
            const LinearRgb &a = picture.at(x, y), &b = reference.at(x, y);
            const Kind kind = std::max(kindOf(a), kindOf(b));
            if (kind != Kind::finite) {
                ++(kind == Kind::nan ? result.nan : result.infinite);
                ++result.over;
                continue;
            }
            ++finite;
            const auto ours = channels(a), theirs = channels(b);
            double most = 0, square = 0;
            for (std::size_t c = 0; c < 3; ++c) {
                const double d = std::fabs(ours[c] - theirs[c]);
                square += d * d;
                row.absolute += d;
                row.relativeSquare += d * d / (theirs[c] * theirs[c] + 0.01);
                row.ours += ours[c];
                row.reference += theirs[c];
                if (d > most) most = d;
                result.peak = std::max({result.peak, ours[c], theirs[c]});
            }
            row.square += square;
            if (most > options.tolerance)
                ++result.over;
            else
                ++rest, row.squareOfRest += square;
            if (most > result.max) result.max = most, result.maxX = x, result.maxY = y;
        }
        total += row;
    }
    if (finite == 0) return result;
    const double count = 3.0 * double(finite);
    result.rmse = std::sqrt(total.square / count);
    if (rest) result.rmseOfRest = std::sqrt(total.squareOfRest / (3.0 * double(rest)));
    result.meanAbsolute = total.absolute / count;
    result.meanRelativeSquare = total.relativeSquare / count;
    if (total.ours != total.reference)
        result.energyError =
            total.reference != 0 ? total.ours / total.reference - 1 : numeric::kInfinity;
    return result;
}

Framebuffer differencePicture(const Framebuffer& picture, const Framebuffer& reference,
                              double gain) {
    requireOneSize(picture, reference);
    Framebuffer out(picture.width, picture.height);
    for (std::size_t i = 0; i < out.pixels.size(); ++i) {
        const LinearRgb &a = picture.pixels[i], &b = reference.pixels[i];
        out.pixels[i] = kindOf(a) == Kind::finite && kindOf(b) == Kind::finite
                            ? LinearRgb{gain * std::fabs(a.r - b.r), gain * std::fabs(a.g - b.g),
                                        gain * std::fabs(a.b - b.b)}
                            : LinearRgb::grey(1);
    }
    return out;
}

} // namespace rt::image
