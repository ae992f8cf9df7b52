#include <core/numeric/colour.hpp>
#include <core/numeric/elementary.hpp>

namespace rt::numeric {

// IEC 61966-2-1:1999, 5.2. Its two branches meet only to within 1e-8; each side keeps the constants
// of the standard.
double linearFromSrgb(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : pow((encoded + 0.055) / 1.055, 2.4);
}

double srgbFromLinear(double linear) {
    if (linear <= 0.0031308) return linear * 12.92;
    const double power = pow(linear, 1 / 2.4);
    return power + 0.055 * (power - 1); // 1.055 p - 0.055, and exactly 1 at 1
}

} // namespace rt::numeric
