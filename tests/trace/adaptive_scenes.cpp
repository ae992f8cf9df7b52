#include <tests/trace/adaptive_scenes.hpp>

#include <core/numeric/elementary.hpp>
#include <core/trace/direction.hpp>

#include <cmath>
#include <random>

namespace rt::trace {
namespace {

void checksAsColor(const void*, const rt_surface_point* points, std::uint32_t count, double* rgb) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto x = static_cast<long>(std::floor(points[i].world[0]));
        const auto y = static_cast<long>(std::floor(points[i].world[1]));
        rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = (x + y) & 1 ? 0.9 : 0.1;
    }
}

void stripesAsColor(const void*, const rt_surface_point* points, std::uint32_t count, double* rgb) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const double u = points[i].uv[0], v = points[i].uv[1];
        const auto stripe = static_cast<long>(std::floor(u * 37.3 + v * 11)) % 3;
        rgb[3 * i] = stripe == 0, rgb[3 * i + 1] = stripe == 1;
        rgb[3 * i + 2] = 0.5 + 0.5 * numeric::sin(40 * v);
    }
}

const rt_texture_type kChecksType{sizeof(rt_texture_type), 0,       nullptr, nullptr,
                                  checksAsColor,           nullptr, nullptr};
const rt_texture_type kStripesType{sizeof(rt_texture_type), 0,       nullptr, nullptr,
                                   stripesAsColor,          nullptr, nullptr};
const material::Texture kChecks{&kChecksType, nullptr}, kStripes{&kStripesType, nullptr};

Material plastic(const LinearRgb& color, double specular = 0.2) {
    Material m = matte(color);
    m.specular = LinearRgb::grey(specular);
    m.environment = LinearRgb::grey(0.05);
    return m;
}

Material checked(Material m) {
    m.colorTexture = &kChecks;
    return m;
}

void floorAt(SceneMaker& scene, double z, const Material& material) {
    scene.parallelogram({-20, -20, z}, {40, 0, 0}, {0, 60, 0}, scene.add(material));
}

/// E. Haines's sphereflake.
void flake(SceneMaker& scene, const Vec3& center, double radius, const Vec3& up, int level,
           MaterialId material) {
    scene.sphere(center, radius, material);
    if (level == 0) return;
    const Vec3 x = unit(cross(std::fabs(up.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}, up));
    const Vec3 y = cross(up, x);
    const double pi = std::acos(-1.0);
    for (int k = 0; k < 9; ++k) {
        const double azimuth = k < 6 ? k * pi / 3 : (k - 6) * 2 * pi / 3 + pi / 6;
        const double height = k < 6 ? 0 : std::sqrt(2.0 / 3);
        const double flat = std::sqrt(1 - height * height);
        const Vec3 outward =
            flat * std::cos(azimuth) * x + flat * std::sin(azimuth) * y + height * up;
        flake(scene, center + outward * (radius * 4 / 3), radius / 3, outward, level - 1, material);
    }
}

} // namespace

const std::vector<NamedScene>& scenesThatAreHardToSample() {
    static const std::vector<NamedScene> scenes{
        {"balls",
         [](SceneMaker& s) {
             floorAt(s, -1, plastic({0.8, 0.9, 0.7}));
             s.sphere({-1, 0, 0}, 1, s.add(plastic({0.9, 0.3, 0.2}, 0.4)));
             s.sphere({1.3, 1, 0}, 1, s.add(mirror(0.9)));
             s.sphere({0.4, -2, -0.4}, 0.6, s.add(clear(1.5, {0.9, 0.9, 0.9})));
         }},
        {"checker to the horizon",
         [](SceneMaker& s) {
             s.parallelogram({-200, -20, -1}, {400, 0, 0}, {0, 400, 0},
                             s.add(checked(plastic({1, 1, 1}))));
             s.sphere({0, 1, 0}, 1, s.add(mirror(0.8)));
         }},
        {"flake",
         [](SceneMaker& s) {
             flake(s, {0, 0, 0}, 1, {0, 0, 1}, 3, s.add(plastic({0.7, 0.7, 0.75}, 0.4)));
             floorAt(s, -1.8, plastic({0.8, 0.75, 0.6}, 0));
         }},
        {"rough mesh",
         [](SceneMaker& s) {
             s.icosphere({0, 0, 0}, 1.4, 4, false, s.add(plastic({0.8, 0.8, 0.9})));
             std::mt19937 random(7);
             std::uniform_real_distribution<> bump(-0.08, 0.08);
             for (Vec3& p : s.world.primitives.triangles.positions) p *= 1 + bump(random);
             floorAt(s, -1.5, plastic({0.5, 0.6, 0.6}, 0.3));
         }},
        {"cloud",
         [](SceneMaker& s) {
             std::mt19937 random(1);
             std::uniform_real_distribution<> u(-1, 1);
             const auto a = s.add(plastic({0.9, 0.5, 0.1})), b = s.add(mirror(0.7));
             for (int i = 0; i < 400; ++i) {
                 const double x = 3 * u(random), y = 3 * u(random), z = 2 * u(random);
                 s.sphere({x, y, z}, 0.12, i % 3 ? a : b);
             }
         }},
        {"needles",
         [](SceneMaker& s) {
             std::mt19937 random(2);
             std::uniform_real_distribution<> u(-1, 1);
             const auto a = s.add(flatColored({0.9, 0.8, 0.2}));
             for (int i = 0; i < 60; ++i) {
                 const double x = 3 * u(random), y = 2 * u(random), z = u(random) - 2;
                 const double dx = u(random), dy = u(random);
                 s.parallelogram({x, y, z}, {0.02, 0, 0}, {dx, dy, 4}, a);
             }
         }},
        {"glass",
         [](SceneMaker& s) {
             floorAt(s, -1, checked(plastic({1, 1, 1}, 0)));
             const auto glass = s.add(clear(1.5, {0.95, 0.95, 0.95}));
             s.sphere({-1.2, 0, 0}, 1, glass);
             s.box({0.3, -1, -1}, {1.8, 0.5, 0.5}, glass);
             s.icosphere({0, -2.5, -0.5}, 0.5, 3, true, glass);
         }},
        {"stripes",
         [](SceneMaker& s) {
             Material m = matte({1, 1, 1});
             m.colorTexture = &kStripes;
             s.parallelogram({-4, 0, -3}, {8, 0, 0}, {0, 3, 6}, s.add(m));
         }},
        {"one sheet",
         [](SceneMaker& s) {
             s.parallelogram({-4, 0, -3}, {8, 0, 0}, {0, 3, 6}, s.add(matte({0.9, 0.8, 0.7})));
         }},
        {"mirrors",
         [](SceneMaker& s) {
             const auto m = s.add(plastic({0.9, 0.9, 0.9}, 0.7));
             for (int i = 0; i < 5; ++i)
                 for (int j = 0; j < 5; ++j) s.sphere({i - 2.0, j - 2.0, 0}, 0.45, m);
             floorAt(s, -0.5, checked(plastic({1, 1, 1}, 0.5)));
         }},
        {"shadows of slats",
         [](SceneMaker& s) {
             const auto a = s.add(matte({0.9, 0.9, 0.9}));
             for (int i = 0; i < 40; ++i)
                 s.parallelogram({-3, i * 0.2 - 2, 1.2 + 0.01 * i}, {6, 0, 0}, {0, 0.1, 0}, a);
             floorAt(s, -1, matte({0.8, 0.7, 0.6}));
         }},
        {"interpolated normals",
         [](SceneMaker& s) {
             s.icosphere({-1, 0, 0}, 1, 2, true, s.add(plastic({0.2, 0.5, 0.9}, 0.3)));
             s.icosphere({1.2, 0, 0}, 1, 1, false, s.add(plastic({0.9, 0.5, 0.2}, 0.1)));
         }},
    };
    return scenes;
}

} // namespace rt::trace
