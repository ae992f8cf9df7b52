// C and T8: whole pictures, one sample a pixel, against the same picture in binary128.
#include <tests/stability/cases.hpp>

#include <core/report/arithmetic.hpp>
#include <tests/stability/counting.hpp>
#include <tests/tolerance.hpp>
#include <tests/trace/scene_maker.hpp>

#include <cmath>
#include <functional>

namespace rt::stability {

namespace {

using material::Material;
using numeric::LinearRgb;
using numeric::Vec3;
using trace::SceneMaker;

void checks(const void*, const rt_surface_point* points, std::uint32_t count, double* rgb) {
    for (std::uint32_t i = 0; i < count; ++i) {
        // Lines of the pattern that are at no multiple of a pixel.
        const auto x = static_cast<long>(std::floor(points[i].uv[0] * 31.7 + 0.37)),
                   y = static_cast<long>(std::floor(points[i].uv[1] * 29.3 + 0.21));
        rgb[3 * i] = rgb[3 * i + 1] = rgb[3 * i + 2] = (x + y) & 1 ? 0.9 : 0.2;
    }
}

const rt_texture_type kChecksType{
    sizeof(rt_texture_type), 0, nullptr, nullptr, checks, nullptr, nullptr};
const material::Texture kChecks{&kChecksType, nullptr};

Material glossy(const LinearRgb& color, double specular) {
    Material m = trace::matte(color);
    m.specular = LinearRgb::grey(specular);
    return m;
}

void floorOf(SceneMaker& s, const Vec3& origin, double side) {
    Material m = trace::matte({1, 1, 1});
    m.colorTexture = &kChecks;
    s.parallelogram(origin, {side, 0, 0}, {0, side, 0}, s.add(m));
}

struct Pictured {
    const char* name;
    std::function<void(SceneMaker&)>
        make; // about 1 large, around the origin; look from (0.1, -6, 2)
};

std::vector<Pictured> scenes() {
    return {
        {"spheres: mirror, glass, checks",
         [](SceneMaker& s) {
             floorOf(s, {-20.1, -12.3, -1.03}, 50);
             s.sphere({-1.1, 0.2, 0}, 1, s.add(glossy({0.9, 0.3, 0.2}, 0.3)));
             s.sphere({1.3, 1, 0.1}, 1.1, s.add(trace::mirror(0.9)));
             s.sphere({0.3, -2, -0.3}, 0.6, s.add(trace::clear(1.5, {0.9, 0.95, 0.9})));
         }},
        {"mesh with slivers",
         [](SceneMaker& s) {
             floorOf(s, {-20.1, -12.3, -1.03}, 50);
             const test::Mesh m = test::needles(150, 5, {1.2, 0.9, 1}, {0.1, 0.1, 0.05});
             s.mesh(m.positions, m.indices, true, s.add(glossy({0.7, 0.8, 0.9}, 0.3)));
         }},
        {"stack of glass slabs",
         [](SceneMaker& s) {
             floorOf(s, {-20.1, -12.3, -1.03}, 50);
             const auto glass = s.add(trace::clear(1.5, {0.97, 0.98, 0.97}));
             for (int i = 0; i < 6; ++i)
                 s.box({-1.5, -1.7 + 0.3 * i, -0.9}, {1.6, -1.55 + 0.3 * i, 0.8}, glass);
             s.sphere({0.2, 2, 0}, 0.8, s.add(trace::matte({0.9, 0.2, 0.1})));
         }},
        {"coplanar faces",
         [](SceneMaker& s) {
             // The floor once more in its own plane, and a block that stands in it.
             floorOf(s, {-20.25, -12.5, -1}, 50);
             s.parallelogram({-2, -3, -1}, {4.5, 0, 0}, {0, 5, 0},
                             s.add(trace::matte({0.9, 0.1, 0.1})));
             s.box({-1, -0.5, -1}, {0.75, 1, 0.5}, s.add(glossy({0.3, 0.6, 0.9}, 0.2)));
             s.box({0.75, -0.5, -1}, {1.5, 1, 0}, s.add(trace::matte({0.9, 0.8, 0.2})));
         }},
        {"teapot in a stadium: 1e-3 and 1e4",
         [](SceneMaker& s) {
             floorOf(s, {-5010.1, -5012.3, -1.03}, 1e4);
             s.sphere({0.1, 6.1e3, 0}, 5e3, s.add(trace::matte({0.5, 0.6, 0.8})));
             s.icosphere({0.2, 0.1, 0}, 1, 2, true, s.add(glossy({0.8, 0.5, 0.2}, 0.3)));
             const auto dust = s.add(trace::matte({0.9, 0.9, 0.1}));
             Random random(5);
             for (int i = 0; i < 60; ++i)
                 s.sphere(Vec3(0.1, -5.9, 1.97) + 0.02 * random.inBox(1) + Vec3(0, 0.05, -0.015),
                          0.001, dust);
         }},
    };
}

void place(SceneMaker& scene, double scale, const Vec3& offset) {
    const auto moved = [&](Vec3& p) { p = p * scale + offset; };
    auto& p = scene.world.primitives;
    for (Vec3& v : p.triangles.positions) moved(v);
    for (auto& s : p.spheres) moved(s.center), s.radius *= scale;
    for (auto& g : p.parallelograms) moved(g.origin), g.edgeU *= scale, g.edgeV *= scale;
    for (auto& l : scene.description.lights) moved(l.position);
    moved(scene.description.camera.position);
}

void frame(SceneMaker& scene, std::uint32_t width) {
    scene.description.image.width = width, scene.description.image.height = width * 2 / 3;
    scene.description.camera.screenWidth = 1.5;
    scene.description.camera.screenDistance = 1.4;
    scene.description.background.color = {0.3, 0.45, 0.7};
    scene.description.render.depth = 8;
    scene.look({0.1, -6, 2}, {0.013, 6, -2.1});
    scene.light({-4, -6, 8}, {0.8, 0.8, 0.7});
    scene.light({5, -2, 5}, {0.3, 0.3, 0.4});
}

Tally against128(SceneMaker& scene) {
    const auto product = scene.render().frame;
    const auto exact =
        report::renderIn(report::Arithmetic::f128Reference, scene.world, scene.description, 0)
            .frame;
    Tally sum;
    for (std::size_t i = 0; i < product.pixels.size(); ++i) {
        const LinearRgb &a = product.pixels[i], &b = exact.pixels[i];
        double worst = 0;
        for (const double d : {a.r - b.r, a.g - b.g, a.b - b.b})
            worst = std::fabs(d) <= worst ? worst : std::fabs(d);
        sum.add(!(worst <= tolerance::kWrongPixel));
        sum.worst = worst <= sum.worst ? sum.worst : worst;
    }
    return sum;
}

void sweep(const Load& load, Table& table) {
    const std::uint32_t width = load.width(36, 240);
    struct Stand {
        double scale, away;
    };
    const Stand near[] = {{0.000001, 0}, {0.001, 0}, {1, 0},   {1e3, 0},
                          {1e6, 0},      {1, 1e3},   {1, 1e5}, {1, 1e6}};
    for (const Pictured& pictured : scenes()) {
        Tally sum, far;
        const auto made = [&](const Stand& stand) {
            SceneMaker scene;
            frame(scene, width);
            pictured.make(scene);
            place(scene, stand.scale, Vec3(1, -0.7, 0.4) * stand.away);
            return against128(scene);
        };
        for (const Stand& stand : near) sum += made(stand);
        table.count("C2",
                    std::string(pictured.name) + ": wrong pixels, x 1e-6 to 1e6, up to 1e6 away",
                    sum.wrong, sum.of);
        table.measure("C2", std::string(pictured.name) + ": largest difference", sum.worst,
                      tolerance::kLargestDifference, "of white", sum.of);
        far = made({1, 1e9});
        table.measure("C2", std::string(pictured.name) + ": wrong pixels 1e9 away, of 38 400",
                      38400.0 * static_cast<double>(far.wrong) / static_cast<double>(far.of), 10,
                      "", far.of);
    }
}

void cameras(const Load& load, Table& table) {
    const Pictured balls = scenes()[0];
    // On the planes between octants and their corner, in the plane of the floor, within glass.
    const Vec3 eyes[] = {{0, -6, 0}, {0, 0, 3}, {0, 0, 0}, {1, -5, -1.03}, {0.3, -2, -0.3}};
    Tally sum;
    for (const Vec3& eye : eyes) {
        SceneMaker scene;
        frame(scene, load.width(36, 240));
        balls.make(scene);
        scene.look(eye, Vec3(0.013, 1, 0.1) - eye * 0.1);
        sum += against128(scene);
    }
    table.count("C1", "camera on octant planes, their corner, a face, within glass: wrong pixels",
                sum.wrong, sum.of);
}

void degenerate(const Load& load, Table& table) {
    SceneMaker scene;
    frame(scene, load.width(96, 480));
    scenes()[0].make(scene);
    const auto m = scene.add(glossy({0.5, 0.5, 0.5}, 0.5)), g = scene.add(trace::clear(1.5));
    for (const auto material : {m, g}) {
        scene.sphere({0, 0, 0.3}, 0, material);
        scene.parallelogram({-1, -1, 0}, {1, 1, 0}, {2, 2, 0}, material);
        scene.parallelogram({-1, -1, 0}, {0, 0, 0}, {0, 0, 0}, material);
        scene.mesh({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {-3, 0, 1}, {3, 0, 1}},
                   {{{0, 1, 2}}, {{0, 0, 0}}, {{3, 4, 3}}}, false, material);
    }
    scene.light({-1.1, 0.2, 1});     // on a ball
    scene.light({0.25, 0.5, -1.03}); // on the floor
    for (auto& p : scene.world.primitives.triangles.normals) p = Vec3(0.0);
    const trace::Result result = scene.render();
    Tally sum;
    for (const LinearRgb& p : result.frame.pixels) sum.add(!std::isfinite(p.r + p.g + p.b));
    sum.wrong += result.counts.notFinite;
    table.count("C4", "degenerate primitives, lights on surfaces: samples not finite", sum.wrong,
                sum.of);
    SceneMaker beyond;
    frame(beyond, 36);
    scenes()[0].make(beyond);
    place(beyond, 1, Vec3(1e15, -1e15, 1e15));
    Tally away;
    for (const LinearRgb& p : beyond.render().frame.pixels)
        away.add(!std::isfinite(p.r + p.g + p.b));
    table.count("C2", "1e15 away: samples not finite", away.wrong, away.of);
}

/// n x n quads of a tilted plane, each cut in two, with corners that f64 holds exactly or not.
test::Mesh tilted(std::uint32_t n, double side) {
    test::Mesh m;
    for (std::uint32_t j = 0; j <= n; ++j)
        for (std::uint32_t i = 0; i <= n; ++i) {
            const double u = side * (double(i) / n - 0.5), v = side * (double(j) / n - 0.5);
            m.positions.push_back(Vec3(0.1, 0.3, -0.2) + Vec3(1, 0.25, 0.125) * u +
                                  Vec3(-0.125, 0.75, 0.5) * v);
        }
    for (std::uint32_t j = 0; j < n; ++j)
        for (std::uint32_t i = 0; i < n; ++i) {
            const std::uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
            m.indices.insert(m.indices.end(), {{a, b, d}, {a, d, c}});
        }
    return m;
}

void coplanar(const Load& load, Table& table) {
    Tally sum;
    for (const double scale : {0.001, 1.0, 1e3})
        for (const double away : {0.0, 1e3})
            for (const bool finerFirst : {false, true}) {
                SceneMaker scene;
                frame(scene, load.width(60, 480));
                scene.description.lights.clear();
                scene.light({0.1, -6, 2}, {1, 1, 1}); // from the eye: no shadows
                const auto first = scene.add(trace::flatColored({1, 0, 0})),
                           second = scene.add(trace::flatColored({0, 1, 0}));
                const test::Mesh coarse = tilted(3, 4), fine = tilted(17, 4);
                const test::Mesh &a = finerFirst ? fine : coarse, &b = finerFirst ? coarse : fine;
                scene.mesh(a.positions, a.indices, false, first);
                scene.mesh(b.positions, b.indices, false, second);
                place(scene, scale, Vec3(1, -0.7, 0.4) * (away * scale));
                for (const LinearRgb& p : scene.render().frame.pixels)
                    if (p.r + p.g > 0 && p.b == 0) sum.add(p.g > 0);
            }
    table.count("T8", "coplanar meshes of other tessellation: pixels of the higher id", sum.wrong,
                sum.of);
}

} // namespace

void coplanarFaces(const Load& load, Table& table) { coplanar(load, table); }

void pictures(const Load& load, Table& table) {
    sweep(load, table);
    cameras(load, table);
    degenerate(load, table);
}

} // namespace rt::stability
