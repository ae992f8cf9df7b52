// O: rays that leave a surface meet neither it nor skip what lies close by.
#include <tests/stability/cases.hpp>

#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>
#include <tests/stability/counting.hpp>
#include <tests/tolerance.hpp>

#include <cmath>

namespace rt::stability {

namespace {

using geometry::Hit;
using geometry::Primitives;
using geometry::Ray;
using geometry::Surface;
using numeric::dot;
using numeric::Vec3;
using octree::Octree;

struct Setting {
    double size;
    Vec3 center;
};

std::vector<Setting> settings() {
    std::vector<Setting> all;
    for (const double size : {0.000001, 0.001, 1.0, 1e3, 1e6})
        for (const double away : {0.0, 1.0, 1e3})
            all.push_back({size, Vec3(0.7, -1, 0.4) * (away * size)});
    return all;
}

/// To a point, from a thousandth to a thousand sizes away.
Ray toward(const Vec3& point, double size, Random& random) {
    Ray ray;
    ray.origin = point + random.direction() * (size * std::pow(10.0, random.in(-3, 3)));
    ray.direction = (point - ray.origin) * std::pow(10.0, random.in(-2, 2));
    return ray;
}

/// A direction on the side of the normal, often nearly along the surface.
Vec3 leaving(const Vec3& normal, Random& random) {
    Vec3 d = random.direction();
    if (random.below(2)) d -= dot(d, normal) * normal * (1 - std::pow(10.0, random.in(-12, 0)));
    return dot(d, normal) >= 0 ? d : -d;
}

struct Left {
    Tally self, lost; // met itself on leaving; not the other side on entering
    Left& operator+=(const Left& o) { return self += o.self, lost += o.lost, *this; }
};

/// `aim` picks points of a convex closed body.
template <class Aim>
Left leave(const Primitives& p, const Setting& at, std::uint64_t rays, std::uint64_t seed,
           const Aim& aim) {
    const Octree tree = Octree::build(p);
    return sumOver<Left>(rays, seed, [&](Random& random, Left& sum) {
        bool corner = false;
        const Ray ray = toward(aim(random, corner), at.size, random);
        const Hit hit = tree.closest(ray);
        if (!hit) return;
        const Surface s = geometry::surfaceAt(p, ray, hit);
        sum.self.add(static_cast<bool>(
            tree.closest(geometry::spawnRay(s, leaving(s.geometricNormal, random)))));
        // From a corner the way in is outside of other faces that meet there.
        if (corner) return;
        const Vec3 inward = -(s.geometricNormal + 0.3 * random.direction());
        sum.lost.add(!tree.closest(geometry::spawnRay(s, inward)));
    });
}

} // namespace

void leavingSurfaces(const Load& load, Table& table) {
    const std::uint64_t rays = load.of(2'000, 400'000);
    Left sphere, custom, ball, cube;
    Tally gaps, shadows;
    for (const Setting& at : settings()) {
        const geometry::Sphere round{at.center, at.size};
        const auto onSphere = [&](Random& random, bool&) {
            return at.center + at.size * random.direction();
        };
        Primitives p;
        test::addSpheres(p, {round});
        sphere += leave(p, at, rays, load.seed, onSphere);
        p = {};
        test::addCustoms(p, {round}, true);
        custom += leave(p, at, rays, load.seed, onSphere);
        for (const bool flat : {false, true}) {
            const test::Mesh mesh = flat ? test::box(8, Vec3(at.size), at.center)
                                         : test::icosphere(3, at.size, at.center);
            p = {};
            test::addMesh(p, mesh.positions, mesh.indices);
            (flat ? cube
                  : ball) += leave(p, at, rays, load.seed, [&](Random& random, bool& corner) {
                const auto& t =
                    mesh.indices[random.below(static_cast<std::uint32_t>(mesh.indices.size()))];
                const double u = random.unit(), v = random.unit() * (1 - u);
                const Vec3 a = mesh.positions[t[0]];
                corner = random.below(8) == 0;
                return corner ? a
                              : a + u * (mesh.positions[t[1]] - a) + v * (mesh.positions[t[2]] - a);
            });
        }

        // Between a parallelogram and what lies above and below it.
        const double largest =
            std::fmax(at.size, numeric::maxComponent(numeric::abs(at.center)) + at.size);
        const Vec3 u(at.size, 0, 0), v(0, at.size, 0), gap(0, 0, tolerance::kSmallestGap * largest);
        p = {};
        test::addParallelograms(p, {{at.center, u, v}, {at.center + gap, u, v}});
        test::addMesh(p, {at.center - gap, at.center - gap + u, at.center - gap + v}, {{0, 1, 2}},
                      false);
        const Octree tree = Octree::build(p);
        gaps += tally(rays, load.seed, [&](Random& random, Tally& sum) {
            const Hit start{1, 0.1 + 0.3 * random.unit(), 0.1 + 0.3 * random.unit(),
                            geometry::PrimitiveId{0}};
            Ray ray;
            ray.direction = {0, 0, 1};
            const Surface s = geometry::surfaceAt(p, ray, start);
            Vec3 d = random.direction();
            d.z += d.z < 0 ? -0.1 : 0.1;
            const auto met = static_cast<std::uint32_t>(tree.closest(geometry::spawnRay(s, d)).id);
            sum.add(met != (d.z > 0 ? 1u : 2u));
        });
        shadows += tally(rays, load.seed, [&](Random& random, Tally& sum) {
            const Hit start{1, 0.1 + 0.3 * random.unit(), 0.1 + 0.3 * random.unit(),
                            geometry::PrimitiveId{0}};
            Ray ray;
            ray.direction = {0, 0, 1};
            const Surface s = geometry::surfaceAt(p, ray, start);
            const Vec3 light =
                s.position + Vec3(0.1 * at.size, 0, random.below(2) ? at.size : -at.size);
            sum.add(!tree.occluded(geometry::spawnRayTo(s, light)));
        });
    }
    const std::string sizes = ", sizes 1e-6 to 1e6, up to 1e3 sizes away";
    table.count("O1", "sphere" + sizes + ": met on leaving it", sphere.self.wrong, sphere.self.of);
    table.count("O1", "sphere: the far side lost from within", sphere.lost.wrong, sphere.lost.of);
    table.count("O1", "icosphere 1280" + sizes + ": met on leaving it", ball.self.wrong,
                ball.self.of);
    table.count("O1", "icosphere 1280: the far side lost from within", ball.lost.wrong,
                ball.lost.of);
    table.count("O1", "box with coplanar neighbours" + sizes + ": met on leaving it",
                cube.self.wrong, cube.self.of);
    table.count("O1", "box with coplanar neighbours: the far side lost", cube.lost.wrong,
                cube.lost.of);
    table.count("O1", "a plugin's sphere" + sizes + ": met on leaving it", custom.self.wrong,
                custom.self.of);
    table.count("O2", "parallel neighbour 1e-9 of max(p, s) away: missed", gaps.wrong, gaps.of);
    table.count("O2", "... by shadow rays", shadows.wrong, shadows.of);
}

} // namespace rt::stability
