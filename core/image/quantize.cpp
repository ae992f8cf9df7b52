#include <core/image/quantize.hpp>
#include <core/numeric/colour.hpp>
#include <core/numeric/rounding.hpp>

#include <array>

namespace rt::image {
namespace {

double clampedToUnit(double x) { return !(x > 0) ? 0 : x < 1 ? x : 1; }

/// To an integer, halves to even: what is added leaves no bit for a fraction.
double roundHalfToEven(double x) { return (x + 0x1.8p52) - 0x1.8p52; }

constexpr unsigned kCells =
    4096; // a cell of [0, 1] holds at most one limit: the steepest codes are 1 / 3295 apart

struct Srgb8Tables {
    std::array<double, 256> limit; // limit[k] parts code k from k + 1; none is above 255
    std::array<std::uint8_t, kCells + 1> first; // code at the lower end of a cell
    std::array<double, 256> linear;

    Srgb8Tables() {
        for (unsigned k = 0; k < 255; ++k) limit[k] = numeric::linearFromSrgb((k + 0.5) / 255);
        limit[255] = numeric::kInfinity;
        for (unsigned k = 0; k < 256; ++k) linear[k] = numeric::linearFromSrgb(k / 255.0);
        unsigned code = 0;
        for (unsigned cell = 0; cell <= kCells; ++cell) {
            while (limit[code] < double(cell) / kCells) ++code;
            first[cell] = static_cast<std::uint8_t>(code);
        }
    }
};

const Srgb8Tables& srgb8Tables() {
    static const Srgb8Tables tables;
    return tables;
}

std::uint8_t srgb8With(const Srgb8Tables& tables, double linear) {
    const double c = clampedToUnit(linear);
    unsigned code = tables.first[static_cast<unsigned>(c * kCells)];
    // Halves to even codes; without a branch, since none can be foretold.
    const double limit = tables.limit[code];
    code += static_cast<unsigned>(c > limit) | (static_cast<unsigned>(c == limit) & code & 1);
    return static_cast<std::uint8_t>(code);
}

} // namespace

std::uint8_t linear8(double linear) {
    return static_cast<std::uint8_t>(roundHalfToEven(255 * clampedToUnit(linear)));
}

std::uint16_t linear16(double linear) {
    return static_cast<std::uint16_t>(roundHalfToEven(65535 * clampedToUnit(linear)));
}

std::uint8_t srgb8(double linear) { return srgb8With(srgb8Tables(), linear); }

void toSrgb8(std::span<const double> linear, std::uint8_t* codes) {
    const Srgb8Tables& tables = srgb8Tables();
    for (const double c : linear) *codes++ = srgb8With(tables, c);
}

void toLinear8(std::span<const double> linear, std::uint8_t* codes) {
    for (const double c : linear) *codes++ = linear8(c);
}

std::vector<std::uint8_t> codesOf(const Framebuffer& frame,
                                  void (*encode)(std::span<const double>, std::uint8_t*)) {
    static_assert(sizeof(LinearRgb) == 3 * sizeof(double));
    std::vector<std::uint8_t> codes(frame.pixels.size() * 3);
    if (!codes.empty()) encode({&frame.pixels[0].r, codes.size()}, codes.data());
    return codes;
}

std::uint16_t srgb16(double linear) {
    const double encoded = numeric::srgbFromLinear(clampedToUnit(linear));
    return static_cast<std::uint16_t>(roundHalfToEven(65535 * encoded));
}

double linearFromSrgb8(std::uint8_t code) { return srgb8Tables().linear[code]; }

} // namespace rt::image
