// What a ray that hits nothing sees.
#pragma once
#include <core/geometry/ray.hpp>
#include <core/numeric/colour.hpp>
#include <core/scene/description.hpp>
#include <core/world/world.hpp>

#include <array>

namespace rt::trace {

using geometry::Vec2;
using geometry::Vec3;
using numeric::LinearRgb;

/// Texture coordinates of a unit direction, both in [0, 1), v = 0 the bottom of the picture. Middle
/// column: +y; a quarter to its right: +x; the seam is at -y. All is at infinity.
///
/// lat_long: rows are latitudes, bottom -z, top +z.
Vec2 latLongUv(const Vec3& direction);
/// hemisphere: rows are heights |z|, bottom the horizon, top the zenith; mirrored below the horizon.
Vec2 hemisphereUv(const Vec3& direction);

/// The original program's background: a texel of a picture `size` wide and high, and no filter. The
/// line of the ray leaves the sphere (center, radius) at a point that is then looked up as seen from
/// the world's origin; +x is a quarter to the *left* of the middle column.
std::array<std::uint32_t, 2> legacyTexel(const geometry::Ray& ray, const Vec3& center,
                                         double radius, const std::array<std::uint32_t, 2>& size);

class Background {
public:
    Background(const scene::Background& background, const world::World& world);

    /// ray.direction is unit.
    LinearRgb seenBy(const geometry::Ray& ray) const {
        return layers_.empty() ? color_ : blend(ray);
    }

private:
    struct Layer {
        const material::Texture* texture;
        double share;
        std::array<std::uint32_t, 2> size; // 0, 0: the texture has no texels
    };
    LinearRgb blend(const geometry::Ray& ray) const;
    Vec2 uvOf(const Layer& layer, const geometry::Ray& ray) const;

    LinearRgb color_;
    std::vector<Layer> layers_;
    scene::Mapping mapping_;
    Vec3 center_;
    double radius_;
};

} // namespace rt::trace
