// Squares or cubes of two colours, or of two textures.
#include <rt/plugin.hpp>

struct Checker {
    enum class Space { uv, object, world };

    rt::Color a, b;
    rt::TextureReference textureA, textureB;
    rt::Vector3 scale;
    Space space;

    /// std::floor, without a call.
    static double floorOf(double x) {
        if (!(std::fabs(x) < 0x1p52)) return x; // an integer, or NaN
        const auto truncated = static_cast<double>(static_cast<std::int64_t>(x));
        return truncated > x ? truncated - 1 : truncated;
    }

    rt::Color at(const rt_surface_point& p) const {
        const double* x = space == Space::object ? p.object : p.world;
        double cell = floorOf((space == Space::uv ? p.uv[0] : x[0]) * scale.x) +
                      floorOf((space == Space::uv ? p.uv[1] : x[1]) * scale.y);
        if (space != Space::uv) cell += floorOf(x[2] * scale.z);
        const bool even = cell == 2 * floorOf(cell / 2);
        const rt::TextureReference& texture = even ? textureA : textureB;
        const rt::Color color = even ? a : b;
        return texture ? color * texture.at(p) : color;
    }
};

constexpr std::array kParameters{
    rt::parameter<&Checker::a>("a", "1", "Color of the even cells."),
    rt::parameter<&Checker::b>("b", "0", "Color of the odd cells."),
    rt::parameter<&Checker::textureA>("texture_a", rt::absent,
                                      "Multiplies the color of the even cells."),
    rt::parameter<&Checker::textureB>("texture_b", rt::absent,
                                      "Multiplies the color of the odd cells."),
    rt::parameter<&Checker::scale>("scale", RT_UNIT_COUNT, "[1, 1, 1]", rt::unlimited,
                                   "Cells per unit along each axis."),
    rt::choice<&Checker::space>("space", "uv|object|world", "uv",
                                "What the cells divide; uv has no third axis.")};

Checker create(const Checker& checker, rt::Host&) { return checker; }

RT_TEXTURE_PLUGIN("checker", "1.0.0", kParameters, create, "Cells of two colors in turn.",
                  "tiles: {checker: {a: 0.9, b: [0.1, 0.1, 0.3], scale: [8, 8, 1]}}\n")
