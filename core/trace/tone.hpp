// What a sample brighter than display white becomes.
#pragma once
#include <core/numeric/colour.hpp>
#include <core/scene/description.hpp>

namespace rt::trace {

using numeric::LinearRgb;

/// `limit` keeps the hue: all channels are divided by the largest when that is over 1. `clamp` cuts
/// each channel at 1. Neither has a lower bound; negative light is cut by the encoder.
inline LinearRgb toned(LinearRgb c, scene::Tone tone) {
    const double largest = c.maxComponent();
    if (!(largest > 1)) return c;
    if (tone == scene::Tone::limit) return {c.r / largest, c.g / largest, c.b / largest};
    return {c.r > 1 ? 1 : c.r, c.g > 1 ? 1 : c.g, c.b > 1 ? 1 : c.b};
}

} // namespace rt::trace
