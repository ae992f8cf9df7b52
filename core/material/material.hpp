// The Whitted material of a surface and the textures that colour it.
#pragma once
#include <core/numeric/colour.hpp>
#include <rt/plugin.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace rt::material {

using numeric::LinearRgb;

/// A texture plugin's state, evaluated at any point; destroyed with the last reference.
using Texture = rt_texture;

struct Material {
    LinearRgb color{1, 1, 1};
    const Texture* colorTexture = nullptr; // multiplies color
    LinearRgb diffuse, specular, transmission, environment;
    double shininess = 20;
    double ior = 1; // inside over outside

    bool isOpaque() const { return transmission.isBlack(); }
    bool isMirror() const { return !specular.isBlack(); }
};

} // namespace rt::material
