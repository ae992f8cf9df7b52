#include <core/trace/background.hpp>

#include <core/numeric/elementary.hpp>
#include <core/trace/direction.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace rt::trace {
namespace {

constexpr double kPi = std::numbers::pi;
const double kBelowOne = std::nextafter(1.0, 0.0);

double below1(double x) { return std::clamp(x, 0.0, kBelowOne); }

/// Full turns from -y by +x, [0, 1): the middle is +y.
double turn(double x, double y) { return below1(0.5 + numeric::atan2(x, y) / (2 * kPi)); }

/// The original's own pi, on which its columns depend.
constexpr double kLegacyPi = 3.1415926;

Vec3 legacyPoint(const geometry::Ray& ray, const Vec3& center, double radius) {
    const Vec3 toCenter = center - ray.origin;
    const double along = dot(ray.direction, toCenter);
    // A line that passes the sphere by is taken where it comes nearest.
    const double t =
        along + std::sqrt(std::max(0.0, radius * radius - dot(toCenter, toCenter) + along * along));
    return ray.origin + ray.direction * t;
}

/// Column and row as shares of the picture, row 0 on top.
Vec2 legacyShares(const Vec3& n) {
    if (n.x == 0 && n.y == 0) return {0.5, 1};
    return {(1 + numeric::atan2(-n.x, n.y) / kLegacyPi) / 2,
            1 - std::fabs(n.z) / std::sqrt(dot(n, n))};
}

std::uint32_t truncated(double share, std::uint32_t size) {
    return static_cast<std::uint32_t>(std::clamp((size - 1) * share, 0.0, size - 1.0));
}

} // namespace

Vec2 latLongUv(const Vec3& d) {
    const double polar = numeric::atan2(std::sqrt(d.x * d.x + d.y * d.y), d.z);
    return {turn(d.x, d.y), below1(1 - polar / kPi)};
}

Vec2 hemisphereUv(const Vec3& d) { return {turn(d.x, d.y), below1(std::fabs(d.z))}; }

std::array<std::uint32_t, 2> legacyTexel(const geometry::Ray& ray, const Vec3& center,
                                         double radius, const std::array<std::uint32_t, 2>& size) {
    const Vec2 shares = legacyShares(legacyPoint(ray, center, radius));
    return {truncated(shares.x, size[0]), truncated(shares.y, size[1])};
}

Background::Background(const scene::Background& background, const world::World& world)
    : color_(background.color), mapping_(background.mapping), center_(background.center),
      radius_(background.radius) {
    const auto add = [&](std::uint32_t index, double share) {
        const material::Texture* texture = world.textures.at(index).get();
        layers_.push_back({texture, share, {0, 0}});
        if (RT_HAS(texture->type, rt_texture_type, resolution) && texture->type->resolution)
            texture->type->resolution(texture->state, layers_.back().size.data());
    };
    const double share = background.fade ? 1 - background.fade->share : 1;
    if (background.texture)
        add(*background.texture, share);
    else
        color_ *= share;
    if (background.fade) add(background.fade->texture, background.fade->share);
    if (background.texture) color_ = {};
}

Vec2 Background::uvOf(const Layer& layer, const geometry::Ray& ray) const {
    switch (mapping_) {
    case scene::Mapping::latLong:
        return latLongUv(ray.direction);
    case scene::Mapping::hemisphere:
        return hemisphereUv(ray.direction);
    case scene::Mapping::legacyHemisphere:
        break;
    }
    const auto [width, height] = layer.size;
    if (width == 0 || height == 0) {
        const Vec2 shares = legacyShares(legacyPoint(ray, center_, radius_));
        return {below1(shares.x), below1(1 - shares.y)};
    }
    // The middle of the texel, where every filter gives the texel itself.
    const auto [column, row] = legacyTexel(ray, center_, radius_, layer.size);
    return {(column + 0.5) / width, 1 - (row + 0.5) / height};
}

LinearRgb Background::blend(const geometry::Ray& ray) const {
    LinearRgb sum = color_;
    const Vec3& d = ray.direction;
    for (const Layer& layer : layers_) {
        const Vec2 uv = uvOf(layer, ray);
        const rt_surface_point point{{uv.x, uv.y}, {d.x, d.y, d.z}, {d.x, d.y, d.z}};
        double rgb[3] = {0, 0, 0};
        layer.texture->type->evaluate(layer.texture->state, &point, 1, rgb);
        sum += LinearRgb{rgb[0], rgb[1], rgb[2]} * layer.share;
    }
    return sum;
}

} // namespace rt::trace
