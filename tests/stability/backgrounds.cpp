// E: backgrounds at their poles and seams.
#include <tests/stability/cases.hpp>

#include <core/trace/background.hpp>
#include <tests/stability/counting.hpp>
#include <tests/tolerance.hpp>

#include <cmath>
#include <numbers>

namespace rt::stability {

namespace {

using numeric::Vec2;
using numeric::Vec3;

/// All that a direction can be: at random, within rounding of an axis, of the seam, of the horizon.
Vec3 hard(Random& random) {
    Vec3 d = random.direction();
    switch (random.below(6)) {
    case 0:
        return Vec3(d.x * std::pow(10.0, random.in(-320, 0)),
                    d.y * std::pow(10.0, random.in(-320, 0)), d.z < 0 ? -1 : 1);
    case 1:
        return {d.x * std::pow(10.0, random.in(-320, -1)), -1, 0.1 * d.z};
    case 2:
        return {random.below(2) ? 0.0 : -0.0, random.below(2) ? 0.0 : -0.0, d.z < 0 ? -1.0 : 1.0};
    case 3:
        return {random.below(2) ? 0.0 : -0.0, d.y < 0 ? -1.0 : 1.0, random.below(2) ? 0.0 : -0.0};
    case 4:
        return numeric::normalize(Vec3(d.x, d.y, d.z * std::pow(10.0, random.in(-300, 0))));
    default:
        return d;
    }
}

bool inside(const Vec2& uv) { return uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y < 1; }

} // namespace

void backgrounds(const Load& load, Table& table) {
    const std::uint64_t trials = load.of(100'000, 50'000'000);
    const Tally range = tally(trials, load.seed, [](Random& random, Tally& sum) {
        const Vec3 d = numeric::normalize(hard(random));
        sum.add(!inside(trace::latLongUv(d)) || !inside(trace::hemisphereUv(d)));
    });
    table.count("E1", "lat_long and hemisphere: NaN or outside the picture", range.wrong, range.of);
    constexpr std::uint32_t kWidth = 4096, kHeight = 2048;
    const Tally legacy = tally(trials, load.seed, [](Random& random, Tally& sum) {
        geometry::Ray ray;
        ray.origin = random.inBox(random.below(2) ? 0.5 : 3.0);
        ray.direction = numeric::normalize(hard(random));
        const auto texel = trace::legacyTexel(ray, Vec3(0.1, 0, 0), 2, {kWidth, kHeight});
        sum.add(texel[0] >= kWidth || texel[1] >= kHeight);
    });
    table.count("E1", "legacy_hemisphere: texels outside the picture", legacy.wrong, legacy.of);
    // Two directions an angle e apart on the two sides of the seam, and across the pole.
    const double e = tolerance::kSeamStep;
    const Tally seam = tally(trials, load.seed, [e](Random& random, Tally& sum) {
        const double height = random.in(-0.99, 0.99);
        const Vec2 left = trace::latLongUv(numeric::normalize(Vec3(-e / 2, -1, height))),
                   right = trace::latLongUv(numeric::normalize(Vec3(e / 2, -1, height)));
        const double step = std::fabs(left.x - right.x);
        sum.error(std::fmin(step, 1 - step) * kWidth);
    });
    table.measure("E1", "1e-9 rad across the seam, in columns of 4096", seam.worst, 1, "columns",
                  seam.of);
    const Tally pole = tally(trials, load.seed, [](Random& random, Tally& sum) {
        const double angle = std::pow(10.0, random.in(-9, -3)), turn = random.in(0, 6);
        const Vec3 d(angle * std::cos(turn), angle * std::sin(turn), 1); // tan of the angle
        const double polar = (1 - trace::latLongUv(numeric::normalize(d)).y) * std::numbers::pi;
        sum.error(std::fabs(polar - std::atan(std::hypot(d.x, d.y))));
    });
    table.measure("E1", "polar angle next to the pole", pole.worst, e, "rad", pole.of);
}

} // namespace rt::stability
