// R: total reflection, chains of slabs, white furnaces, nested media; rt has no Fresnel term, shares are the scene's.
#include <tests/stability/cases.hpp>

#include <core/trace/direction.hpp>
#include <core/trace/ray_tree.hpp>
#include <tests/stability/counting.hpp>
#include <tests/stability/quad.hpp>
#include <tests/tolerance.hpp>
#include <tests/trace/scene_maker.hpp>

#include <cmath>

namespace rt::stability {

namespace {

using trace::RayTree;
using trace::SceneMaker;

double angleBetween(const Vec3& a, const Vec3& b) {
    return std::atan2(numeric::length(numeric::cross(a, b)), numeric::dot(a, b));
}

/// The chain of refracted rays of the one ray from `from` along `direction`, from the first on.
std::vector<RayTree::Node> chainOf(SceneMaker& scene, const Vec3& from, const Vec3& direction) {
    const bool upright = std::fabs(direction.z) < std::fabs(direction.x) + std::fabs(direction.y);
    scene.look(from, direction, upright ? Vec3{0, 0, 1} : Vec3{0, 1, 0});
    scene.description.image.width = scene.description.image.height = 1;
    const RayTree tree = trace::tracePixel(scene.octree(), scene.world, scene.description, 0, 0);
    std::vector<RayTree::Node> chain{tree.nodes.at(*tree.samples.at(0).root)};
    for (bool found = true; found;) {
        found = false;
        for (const auto child : chain.back().children)
            if (tree.nodes[child].kind == RayTree::Kind::refracted &&
                tree.nodes[child].fate == RayTree::Fate::traced) {
                chain.push_back(tree.nodes[child]);
                found = true;
                break;
            }
    }
    return chain;
}

/// Sine of the angle to `normal` times the ratio, squared, exactly from the stored values.
Quad exactSineSquared(const Vec3& direction, const Vec3& normal, double ratio) {
    const QVec d(direction), n(normal);
    const QVec across = cross(d, n);
    return dot(across, across) / (dot(d, d) * dot(n, n)) * ratio * ratio;
}

void criticalAngle(const Load& load, Table& table) {
    Tally decisions, angles;
    decisions = tally(load.of(200'000, 40'000'000), load.seed, [](Random& random, Tally& sum) {
        const Vec3 normal = random.direction();
        const Vec3 tangent = numeric::normalize(numeric::cross(normal, random.direction()));
        const double ratio = random.in(1.05, 3), critical = std::asin(1 / ratio);
        const double delta = std::pow(10.0, random.in(-12, -2)) * (random.below(2) ? 1 : -1);
        const Vec3 d = tangent * std::sin(critical + delta) - normal * std::cos(critical + delta);
        const Quad sine = exactSineSquared(d, normal, ratio);
        // Of the angle that is stored: d sin² = 2 sin cos dθ ratio².
        const double off = magnitude(sine - 1) / (2 * ratio * std::cos(critical));
        if (off < tolerance::kCriticalAngle) return;
        sum.add(trace::refracted(trace::unit(d), normal, ratio).has_value() != (sine < 1));
    });
    angles = tally(load.of(50'000, 10'000'000), load.seed, [](Random& random, Tally& sum) {
        const Vec3 normal = random.direction();
        const Vec3 tangent = numeric::normalize(numeric::cross(normal, random.direction()));
        const double ratio = random.in(1.05, 3), critical = std::asin(1 / ratio);
        const double delta = std::pow(10.0, random.in(-6, -0.5));
        const Vec3 d =
            trace::unit(tangent * std::sin(critical - delta) - normal * std::cos(critical - delta));
        const auto bent = trace::refracted(d, normal, ratio);
        const Quad sine = exactSineSquared(d, normal, ratio);
        if (critical < delta || !(sine < 1)) return;
        if (!bent) return sum.error(NAN);
        // The exact direction from the same stored vectors, both taken at unit length.
        const QVec n = QVec(normal) * (1 / squareRoot(dot(normal, normal))),
                   in = QVec(d) * (1 / squareRoot(dot(d, d)));
        const QVec along = (in - n * dot(in, n)) * Quad(ratio);
        const QVec exact = along - n * squareRoot(1 - sine);
        const QVec off = cross(exact, QVec(*bent));
        sum.error(magnitude(squareRoot(dot(off, off))));
    });
    table.count("R1", "total reflection, 1e-12 to 1e-2 rad from the critical angle: decided wrong",
                decisions.wrong, decisions.of);
    table.measure("R1", "refracted angle, 1e-6 rad and more from it", angles.worst,
                  tolerance::kRefractedAngle, "rad", angles.of);
    // Through the tracer: from inside a block of glass through its top.
    SceneMaker block;
    block.box({-900, -900, -9}, {900, 900, 0}, block.add(trace::clear(1.5)));
    block.description.render.depth = 1;
    Random random(load.seed);
    Tally whole;
    for (std::uint64_t i = 0; i < load.of(2'000, 100'000); ++i) {
        const double delta = std::pow(10.0, random.in(-12, -2)) * (random.below(2) ? 1 : -1);
        const double angle = std::asin(1 / 1.5) + delta, turn = random.in(0, 6);
        const Vec3 in(std::sin(angle) * std::cos(turn), std::sin(angle) * std::sin(turn),
                      std::cos(angle));
        const auto chain = chainOf(block, {random.in(-1, 1), random.in(-1, 1), -3}, in);
        const Quad sine = exactSineSquared(chain[0].direction, {0, 0, 1}, 1.5);
        if (magnitude(sine - 1) / (3 * std::cos(angle)) < tolerance::kCriticalAngle) continue;
        whole.add((chain.size() > 1) != (sine < 1));
    }
    table.count("R1", "... through the tracer, out of a block of glass", whole.wrong, whole.of);
}

void slabs(const Load& load, Table& table) {
    for (const int count : {10, 100, 1000}) {
        SceneMaker scene;
        const auto glass = scene.add(trace::clear(1.5));
        for (int i = 0; i < count; ++i)
            scene.box({-1e5, -1e5, -1.5 * i - 1}, {1e5, 1e5, -1.5 * i}, glass);
        scene.description.render.depth = 2 * static_cast<std::uint32_t>(count) + 1;
        Random random(load.seed);
        Tally angles, lengths;
        for (std::uint64_t i = 0; i < load.of(4, 400); ++i) {
            Vec3 in = random.direction();
            in.z = -0.1 - std::fabs(in.z);
            in = trace::unit(in);
            const auto chain = chainOf(scene, {random.in(-9, 9), random.in(-9, 9), 1}, in);
            if (chain.size() != 2u * static_cast<unsigned>(count) + 1) angles.error(NAN);
            angles.error(angleBetween(chain.back().direction, in));
            for (const auto& node : chain)
                lengths.error(std::fabs(numeric::length(node.direction) - 1));
        }
        table.measure("R2", std::to_string(count) + " slabs through the tracer: out against in",
                      angles.worst, tolerance::kSlabChain, "rad", angles.of);
        if (count == 1000)
            table.measure("R2", "length of every direction, against 1",
                          lengths.worst / numeric::kUnitRoundoff, 4, "u", lengths.of);
    }
}

void energy(const Load& load, Table& table) {
    // rt has no Fresnel term to get wrong; the shares of mirror and glass are the scene's. Under total
    // reflection the transmitted share joins the mirrored one: nothing is lost and nothing gained.
    SceneMaker scene;
    scene.description.image.width = load.full ? 640 : 96;
    scene.description.image.height = load.full ? 480 : 72;
    scene.description.background.color = {1, 1, 1};
    scene.description.render.depth = 400;
    const auto glass = scene.add(trace::clear(1.5)), diamond = scene.add(trace::clear(2.4)),
               bubble = scene.add(trace::clear(1 / 1.5)), silver = scene.add(trace::mirror());
    scene.sphere({-1.2, 6, 0}, 1.1, glass);
    scene.sphere({-1.2, 6, 0.2}, 0.5, bubble);
    scene.sphere({1.3, 7, 0.4}, 1, silver);
    scene.icosphere({0.2, 5, -1}, 0.7, 2, true, glass);
    scene.box({0.9, 4.5, -1.2}, {1.9, 5.5, -0.4}, diamond);
    scene.parallelogram({-9, 2, -2.2}, {18, 0, 0}, {0, 12, 0}, silver);
    const trace::Result result = scene.render();
    // What a pixel lacks is the weight of the rays that were cut by depth, and nothing else.
    Tally excess;
    double lacking = 0;
    for (const auto& p : result.frame.pixels) {
        lacking += 1 - p.r;
        for (const double c : {p.r, p.g, p.b}) excess.error(std::fmax(0, c - 1));
    }
    const double pixels = static_cast<double>(result.frame.pixels.size());
    table.measure("R4", "white furnace, lossless glass and mirrors: light gained", excess.worst,
                  tolerance::kFurnace, "", excess.of);
    table.measure("R4", "... light lost beyond the share cut by depth, mean",
                  std::fabs(lacking - result.counts.lostByDepth) / pixels, tolerance::kFurnace, "",
                  excess.of);
    table.measure("R4", "share cut by depth 400",
                  result.counts.lostByDepth / static_cast<double>(result.counts.primary), 0.05,
                  "of all", result.counts.primary);
}

void nested(const Load& load, Table& table) {
    // Glass around water around ice, and three layers face to face: n sin is the same everywhere.
    const double index[] = {1.5, 1.333, 1.31};
    Tally angles, media;
    Random random(load.seed);
    for (std::uint64_t i = 0; i < load.of(100, 10'000); ++i) {
        const bool touching = i % 2;
        SceneMaker scene;
        std::vector<trace::ObjectId> ids;
        for (int k = 0; k < 3; ++k) {
            const double ior = touching || k == 0 ? index[k] : index[k] / index[k - 1];
            const Vec3 low = touching ? Vec3(-90, -90, -k - 1) : Vec3(-90 + k, -90 + k, -10 + k),
                       high = touching ? Vec3(90, 90, -k) : Vec3(90 - k, 90 - k, -k);
            ids.push_back(scene.box(low, high, scene.add(trace::clear(ior))));
        }
        Vec3 in = random.direction();
        in.z = -0.2 - std::fabs(in.z);
        in = trace::unit(in);
        const auto chain = chainOf(scene, {random.in(-1, 1), random.in(-1, 1), 1}, in);
        const double sine = std::hypot(in.x, in.y);
        const std::size_t expected = touching ? 5 : 7;
        media.add(chain.size() != expected);
        if (chain.size() != expected) continue;
        for (std::size_t k = 0; k < expected; ++k) {
            const double here = k == 0 || k + 1 == expected ? 1
                                : touching                  ? index[k - 1]
                                                            : index[k <= 3 ? k - 1 : 5 - k];
            const Vec3& d = chain[k].direction;
            angles.error(std::fabs(std::hypot(d.x, d.y) - sine / here));
            const std::size_t depth = touching ? (k == 0 || k == 4 ? 0 : 1) : k <= 3 ? k : 6 - k;
            media.add(chain[k].media.size() != depth ||
                      (depth && chain[k].media.back() != ids[touching ? k - 1 : depth - 1]));
        }
    }
    table.measure("R5", "nested and touching layers: sine against n sin", angles.worst,
                  tolerance::kSlabChain, "", angles.of);
    table.count("R5", "nested and touching layers: rays in a wrong medium", media.wrong, media.of);
}

} // namespace

void refraction(const Load& load, Table& table) {
    criticalAngle(load, table);
    slabs(load, table);
    energy(load, table);
    nested(load, table);
}

} // namespace rt::stability
