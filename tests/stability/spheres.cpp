// S: spheres far away, grazed, tiny and huge.
#include <tests/stability/cases.hpp>

#include <core/geometry/surface.hpp>
#include <core/octree/octree.hpp>
#include <tests/stability/counting.hpp>
#include <tests/stability/quad.hpp>
#include <tests/tolerance.hpp>

#include <cmath>

namespace rt::stability {

namespace {

using geometry::Primitives;
using geometry::Ray;
using octree::Octree;

struct Ball {
    explicit Ball(const geometry::Sphere& sphere_) : sphere(sphere_) {
        test::addSpheres(primitives, {sphere});
        tree = Octree::build(primitives);
    }
    geometry::Sphere sphere;
    Primitives primitives;
    Octree tree;
};

/// From `distance` radii away, passing the middle at `impact` radii.
Ray toward(const Ball& ball, double distance, double impact, Random& random) {
    const Vec3 d = random.direction();
    const Vec3 side = numeric::normalize(numeric::cross(d, random.direction()));
    Ray ray;
    ray.origin = ball.sphere.center + ball.sphere.radius * (side * impact - d * distance);
    ray.direction = d;
    return ray;
}

struct Exact {
    bool hit;
    Quad margin; // of the impact from the radius, relative
    Quad t;      // nearest in front
};

Exact exactly(const Ball& ball, const Ray& ray) {
    const QVec f = QVec(ball.sphere.center) - QVec(ray.origin), d(ray.direction);
    const Quad r = ball.sphere.radius;
    const Quad a = dot(d, d), b = dot(f, d), c = dot(f, f) - r * r;
    const Quad discriminant = b * b - a * c;
    Exact exact{discriminant > 0, 0, 0};
    exact.margin = squareRoot(dot(f, f) - b * b / a) / r - 1;
    if (!exact.hit) return exact;
    const Quad root = squareRoot(discriminant), q = b < 0 ? b - root : b + root;
    const Quad first = c / q < q / a ? c / q : q / a, second = c / q < q / a ? q / a : c / q;
    exact.t = first > 0 ? first : second;
    exact.hit = exact.t > 0;
    return exact;
}

struct Seen {
    Tally decisions, distance, position;
    Seen& operator+=(const Seen& o) {
        return decisions += o.decisions, distance += o.distance, position += o.position, *this;
    }
};

void look(const Ball& ball, const Ray& ray, double distance, Seen& seen) {
    const Exact exact = exactly(ball, ray);
    const double u = numeric::kUnitRoundoff, reach = std::fmax(1, distance);
    if (magnitude(exact.margin) < tolerance::kTangent * u * reach) return;
    const geometry::Hit hit = ball.tree.closest(ray);
    seen.decisions.add(static_cast<bool>(hit) != exact.hit);
    if (!hit || !exact.hit) return;
    const auto fromSurface = [&](const QVec& p) {
        const QVec f = p - QVec(ball.sphere.center);
        return magnitude(squareRoot(dot(f, f)) - Quad(ball.sphere.radius));
    };
    seen.distance.error(fromSurface(QVec(ray.origin) + QVec(ray.direction) * Quad(hit.t)) /
                        (u * reach * ball.sphere.radius));
    const geometry::Surface s = geometry::surfaceAt(ball.primitives, ray, hit);
    seen.position.error(fromSurface(s.position) / s.error);
}

std::string power(double x) { return "1e" + std::to_string(std::lround(std::log10(x))); }

} // namespace

void spheres(const Load& load, Table& table) {
    const Ball unit({Vec3(0.25, -3, 0.5), 1});
    Seen all;
    for (double distance = 10; distance <= 1e6; distance *= 10) {
        const auto seen =
            sumOver<Seen>(load.of(20'000, 16'000'000), load.seed, [&](Random& random, Seen& sum) {
                look(unit, toward(unit, distance, std::sqrt(random.unit()), random), distance, sum);
            });
        table.count("S1", "D/r " + power(distance) + ": missed or invented", seen.decisions.wrong,
                    seen.decisions.of);
        all += seen;
    }
    table.measure("S1", "distance from the sphere, D/r 1e1 to 1e6", all.distance.worst,
                  tolerance::kSphereError, "u D/r", all.distance.of);
    table.measure("S1", "re-projected point, in the bound that it carries", all.position.worst, 1,
                  "bounds", all.position.of);
    for (const double margin : {1 / 1e4, 1 / 1e10})
        for (const double distance : {10.0, 1e3, 1e5}) {
            if (margin < tolerance::kTangent * numeric::kUnitRoundoff * distance) continue;
            const auto seen = sumOver<Seen>(
                load.of(20'000, 4'000'000), load.seed, [&](Random& random, Seen& sum) {
                    const double impact = random.below(2) ? 1 - margin : 1 + margin;
                    look(unit, toward(unit, distance, impact, random), distance, sum);
                });
            table.count("S2", "b/r 1 +- " + power(margin) + ", D/r " + power(distance),
                        seen.decisions.wrong, seen.decisions.of);
        }
    const auto tangent =
        sumOver<Seen>(load.of(40'000, 16'000'000), load.seed, [&](Random& random, Seen& sum) {
            const double distance = std::pow(10.0, random.in(0.5, 6));
            const double off = tolerance::kTangent * numeric::kUnitRoundoff * distance *
                               std::pow(10.0, random.in(0, 3));
            look(unit, toward(unit, distance, random.below(2) ? 1 - off : 1 + off, random),
                 distance, sum);
        });
    table.count("S2", "16 to 16000 u D/r from the tangent", tangent.decisions.wrong,
                tangent.decisions.of);
    const Ball dot({Vec3(0.5, 0.25, 1), 0.000001});
    const auto far =
        sumOver<Seen>(load.of(20'000, 4'000'000), load.seed, [&](Random& random, Seen& sum) {
            look(dot, toward(dot, 1e6, 1.5 * std::sqrt(random.unit()), random), 1e6, sum);
        });
    table.count("S3", "r 1e-6 seen from 1", far.decisions.wrong, far.decisions.of);
    // A floor: the camera 1 above the top of a ball of a million, rays down to the horizon.
    const Ball floor({Vec3(0, 0, -1e6), 1e6});
    const Tally below =
        tally(load.of(20'000, 4'000'000), load.seed, [&](Random& random, Tally& sum) {
            Ray ray;
            ray.origin = {0, 0, 1};
            ray.direction = random.direction();
            ray.direction.z = -std::fabs(ray.direction.z);
            const Exact exact = exactly(floor, ray);
            const geometry::Hit hit = floor.tree.closest(ray);
            // Half of all directions are within 30 degrees of the horizon: what is looked at are the others.
            if (ray.direction.z > -0.5 || !exact.hit) return;
            sum.error(hit ? magnitude(Quad(hit.t) / exact.t - 1) : NAN);
        });
    table.measure("S4", "floor of radius 1e6 from 1 above, steeper than 30 degrees: t", below.worst,
                  tolerance::kFloorDistance, "relative", below.of);
}

} // namespace rt::stability
