// A straight change from one colour to another, in linear light.
#include <rt/plugin.hpp>

struct Gradient {
    enum class Space { uv, object, world };

    rt::Color a, b;
    rt::Vector3 from, to;
    Space space;

    rt::Color at(const rt_surface_point& p) const {
        const rt::Vector3 x = space == Space::uv       ? rt::Vector3{p.uv[0], p.uv[1], 0}
                              : space == Space::object ? rt::vector(p.object)
                                                       : rt::vector(p.world);
        const rt::Vector3 along = to - from;
        const double t = rt::dot(x - from, along) / rt::dot(along, along);
        if (!(t > 0)) return a;
        if (!(t < 1)) return b;
        return a * (1 - t) + b * t;
    }
};

constexpr std::array kParameters{
    rt::parameter<&Gradient::a>("a", "0", "Color at `from` and before it."),
    rt::parameter<&Gradient::b>("b", "1", "Color at `to` and beyond it."),
    rt::parameter<&Gradient::from>("from", RT_UNIT_LENGTH, "[0, 0, 0]", rt::unlimited,
                                   "Where the change begins."),
    rt::parameter<&Gradient::to>("to", RT_UNIT_LENGTH, "[0, 1, 0]", rt::unlimited,
                                 "Where the change ends."),
    rt::choice<&Gradient::space>("space", "uv|object|world", "uv",
                                 "The space of the points; uv has no third axis.")};

Gradient create(const Gradient& gradient, rt::Host&) {
    if (const rt::Vector3 along = gradient.to - gradient.from; !(rt::dot(along, along) > 0))
        throw rt::ParameterError("to", "is the same point as from, so that there is no direction");
    return gradient;
}

RT_TEXTURE_PLUGIN("gradient", "1.0.0", kParameters, create,
                  "A straight change from one color to another.",
                  "dusk: {gradient: {a: [1, 0.5, 0.2], b: [0.1, 0.2, 0.5]}}\n")
