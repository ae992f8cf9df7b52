#include <core/image/flip.hpp>
#include <core/image/metrics.hpp>
#include <core/image/quantize.hpp>
#include <core/numeric/elementary.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace rt::image {
namespace {

// Symbols of the paper: (Y, Cx, Cz) a linear opponent space, HyAB a distance in L*a*b*, q_c, q_f, p_c, p_t its constants.
constexpr double kColourExponent = 0.7, kFeatureExponent = 0.5;     // q_c, q_f
constexpr double kLargeColourShare = 0.4, kLargeColourError = 0.95; // p_c, p_t
constexpr double kFeatureWidth = 0.082;                             // degrees, w

using Triple = std::array<double, 3>;
using Kernel = std::vector<double>; // odd length, centre in the middle

struct Plane {
    std::ptrdiff_t width, height;
    std::vector<double> values;
    double& at(std::ptrdiff_t x, std::ptrdiff_t y) {
        return values[static_cast<std::size_t>(y * width + x)];
    }
    double at(std::ptrdiff_t x, std::ptrdiff_t y) const {
        return values[static_cast<std::size_t>(y * width + x)];
    }
};

/// Separable correlation; beyond the border its last pixel repeats.
Plane filtered(const Plane& in, const Kernel& along, const Kernel& down) {
    Plane rows{in.width, in.height, std::vector<double>(in.values.size())}, out = rows;
    const auto reach = [](const Kernel& k) { return static_cast<std::ptrdiff_t>(k.size() / 2); };
    for (std::ptrdiff_t y = 0; y < in.height; ++y)
        for (std::ptrdiff_t x = 0; x < in.width; ++x)
            for (std::ptrdiff_t i = -reach(along); i <= reach(along); ++i)
                rows.at(x, y) += along[static_cast<std::size_t>(i + reach(along))] *
                                 in.at(std::clamp<std::ptrdiff_t>(x + i, 0, in.width - 1), y);
    for (std::ptrdiff_t y = 0; y < in.height; ++y)
        for (std::ptrdiff_t i = -reach(down); i <= reach(down); ++i) {
            const double weight = down[static_cast<std::size_t>(i + reach(down))];
            const std::ptrdiff_t from = std::clamp<std::ptrdiff_t>(y + i, 0, in.height - 1);
            for (std::ptrdiff_t x = 0; x < in.width; ++x) out.at(x, y) += weight * rows.at(x, from);
        }
    return out;
}

template <class Weight> Kernel kernelOf(int radius, Weight weight) {
    Kernel kernel;
    for (int i = -radius; i <= radius; ++i) kernel.push_back(weight(static_cast<double>(i)));
    return kernel;
}

/// Positive weights to a sum of 1, negative ones to -1.
Kernel normalized(Kernel kernel) {
    double positive = 0, negative = 0;
    for (const double w : kernel) (w < 0 ? negative : positive) += std::fabs(w);
    for (double& w : kernel) w /= w < 0 ? negative : positive;
    return kernel;
}

// Linear Rec. 709 to XYZ divided by the white point of the matrix; each row sums to 1 then.
constexpr double kMatrix[3][3] = {
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};

Triple relativeXyz(const Triple& rgb) {
    Triple xyz{};
    for (int i = 0; i < 3; ++i) {
        const auto& row = kMatrix[i];
        xyz[i] = (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]) / (row[0] + row[1] + row[2]);
    }
    return xyz;
}

/// The inverse of relativeXyz, by Cramer's rule.
Triple rgbOfRelativeXyz(const Triple& relative) {
    const auto& m = kMatrix;
    Triple xyz{};
    for (int i = 0; i < 3; ++i) xyz[i] = relative[i] * (m[i][0] + m[i][1] + m[i][2]);
    const auto minor = [&](int r0, int r1, int c0, int c1) {
        return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
    };
    const double determinant =
        m[0][0] * minor(1, 2, 1, 2) - m[0][1] * minor(1, 2, 0, 2) + m[0][2] * minor(1, 2, 0, 1);
    return {
        (minor(1, 2, 1, 2) * xyz[0] - minor(0, 2, 1, 2) * xyz[1] + minor(0, 1, 1, 2) * xyz[2]) /
            determinant,
        (-minor(1, 2, 0, 2) * xyz[0] + minor(0, 2, 0, 2) * xyz[1] - minor(0, 1, 0, 2) * xyz[2]) /
            determinant,
        (minor(1, 2, 0, 1) * xyz[0] - minor(0, 2, 0, 1) * xyz[1] + minor(0, 1, 0, 1) * xyz[2]) /
            determinant};
}

/// L*a*b* with a* and b* weakened in the dark (Hunt effect).
Triple huntLab(const Triple& rgb) {
    Triple f = relativeXyz(rgb);
    constexpr double kDelta = 6.0 / 29;
    for (double& v : f)
        v = v > kDelta * kDelta * kDelta ? numeric::pow(v, 1.0 / 3)
                                         : v / (3 * kDelta * kDelta) + 4.0 / 29;
    const double lightness = 116 * f[1] - 16, hunt = 0.01 * lightness;
    return {lightness, hunt * 500 * (f[0] - f[1]), hunt * 200 * (f[1] - f[2])};
}

double hyab(const Triple& a, const Triple& b) {
    const double da = a[1] - b[1], db = a[2] - b[2];
    return std::fabs(a[0] - b[0]) + std::sqrt(da * da + db * db);
}

/// What the eye makes of one picture.
struct Seen {
    std::vector<Triple> colour;        // Hunt-adjusted L*a*b*
    std::vector<double> edges, points; // lengths of the first and second derivatives of luminance
};

std::vector<double> gradientLength(const Plane& luminance, const Kernel& derivative,
                                   const Kernel& smooth) {
    const Plane along = filtered(luminance, derivative, smooth),
                down = filtered(luminance, smooth, derivative);
    std::vector<double> length(along.values.size());
    for (std::size_t i = 0; i < length.size(); ++i)
        length[i] = std::sqrt(along.values[i] * along.values[i] + down.values[i] * down.values[i]);
    return length;
}

Seen seen(const Framebuffer& frame, double pixelsPerDegree) {
    const std::size_t count = frame.pixels.size();
    const Plane empty{frame.width, frame.height, std::vector<double>(count)};
    Plane y = empty, cx = empty, cz = empty, luminance = empty;
    const auto shown = [](double c) { return linearFromSrgb8(srgb8(c)); };
    for (std::size_t i = 0; i < count; ++i) {
        const LinearRgb& p = frame.pixels[i];
        const Triple xyz = relativeXyz({shown(p.r), shown(p.g), shown(p.b)});
        y.values[i] = 116 * xyz[1] - 16;
        cx.values[i] = 500 * (xyz[0] - xyz[1]);
        cz.values[i] = 200 * (xyz[1] - xyz[2]);
        luminance.values[i] = xyz[1];
    }

    // Contrast sensitivity: Gaussians exp(-pi^2 d^2 / b), d in degrees; the widest, b = 0.04, gives the radius.
    constexpr double kPiSquare = std::numbers::pi * std::numbers::pi;
    const int radius =
        static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPiSquare)) * pixelsPerDegree));
    const auto gaussian = [&](double b) {
        return kernelOf(radius, [&](double i) {
            const double degrees = i / pixelsPerDegree;
            return numeric::exp(-kPiSquare * degrees * degrees / b);
        });
    };
    const auto sum = [](const Kernel& k) {
        double total = 0;
        for (const double w : k) total += w;
        return total;
    };
    const Kernel achromatic = normalized(gaussian(0.0047)), redGreen = normalized(gaussian(0.0053));
    const Kernel wide = gaussian(0.04), narrow = gaussian(0.025); // blue-yellow is a mixture of two
    const double wideShare = 34.1 * std::sqrt(std::numbers::pi / 0.04) * sum(wide) * sum(wide);
    const double narrowShare =
        13.5 * std::sqrt(std::numbers::pi / 0.025) * sum(narrow) * sum(narrow);
    y = filtered(y, achromatic, achromatic);
    cx = filtered(cx, redGreen, redGreen);
    const Plane first = filtered(cz, normalized(wide), normalized(wide));
    const Plane second = filtered(cz, normalized(narrow), normalized(narrow));

    Seen result;
    result.colour.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double blueYellow = (wideShare * first.values[i] + narrowShare * second.values[i]) /
                                  (wideShare + narrowShare);
        const double relativeY = (y.values[i] + 16) / 116;
        Triple rgb = rgbOfRelativeXyz(
            {relativeY + cx.values[i] / 500, relativeY, relativeY - blueYellow / 200});
        for (double& c : rgb) c = std::clamp(c, 0.0, 1.0);
        result.colour[i] = huntLab(rgb);
    }

    const double deviation = 0.5 * kFeatureWidth * pixelsPerDegree;
    const int featureRadius = static_cast<int>(std::ceil(3 * deviation));
    const auto bell = [&](double i) { return numeric::exp(-i * i / (2 * deviation * deviation)); };
    const Kernel smooth = normalized(kernelOf(featureRadius, bell));
    const Kernel edge = normalized(kernelOf(featureRadius, [&](double i) { return -i * bell(i); }));
    const Kernel point = normalized(kernelOf(
        featureRadius, [&](double i) { return (i * i / (deviation * deviation) - 1) * bell(i); }));
    result.edges = gradientLength(luminance, edge, smooth);
    result.points = gradientLength(luminance, point, smooth);
    return result;
}

} // namespace

double meanFlip(const Framebuffer& picture, const Framebuffer& reference, double pixelsPerDegree) {
    checkedRegion(picture, reference, {});
    const Seen ours = seen(picture, pixelsPerDegree), theirs = seen(reference, pixelsPerDegree);
    const double most = numeric::pow(hyab(huntLab({0, 1, 0}), huntLab({0, 0, 1})),
                                     kColourExponent); // green to blue
    const double knee = kLargeColourShare * most;
    double sum = 0;
    for (std::size_t i = 0; i < ours.colour.size(); ++i) {
        const double distance =
            numeric::pow(hyab(theirs.colour[i], ours.colour[i]), kColourExponent);
        const double colour =
            distance < knee
                ? kLargeColourError / knee * distance
                : kLargeColourError + (distance - knee) / (most - knee) * (1 - kLargeColourError);
        const double feature = std::max(std::fabs(theirs.edges[i] - ours.edges[i]),
                                        std::fabs(theirs.points[i] - ours.points[i]));
        sum +=
            numeric::pow(colour, 1 - numeric::pow(feature / std::numbers::sqrt2, kFeatureExponent));
    }
    return sum / double(ours.colour.size());
}

} // namespace rt::image
