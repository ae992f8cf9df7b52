// A: poses do not drift, a frame is the same alone as in its sequence, and an octree that follows answers as a fresh one.
#include <tests/stability/cases.hpp>

#include <core/animation/poses.hpp>
#include <core/octree/octree.hpp>
#include <tests/stability/counting.hpp>
#include <tests/stability/quad.hpp>
#include <tests/tolerance.hpp>

#include <cmath>
#include <stdexcept>

#include <quadmath.h>

namespace rt::stability {

namespace {

using animation::ObjectPose;
using animation::RestObject;

scene::Description filmOf(const scene::Motion& motion, std::uint32_t frames) {
    scene::Description film;
    film.objects.resize(1);
    scene::Track track;
    track.target = scene::ObjectTarget{{0}, std::nullopt, false};
    track.motion = motion;
    track.frames = {0, frames};
    film.animation = scene::Animation{.frames = frames + 1, .fps = 24, .tracks = {track}};
    return film;
}

ObjectPose poseOf(const scene::Description& film, const RestObject& rest, std::uint32_t frame) {
    scene::Diagnostics diagnostics;
    const auto poses = animation::posesAt(film, {&rest, 1}, frame, diagnostics);
    if (!poses) throw std::runtime_error("a pose cannot be had");
    return (*poses)[0];
}

/// Rays into the middle of a scene of this size whose answers differ.
Tally differing(const octree::Octree& a, const octree::Octree& b, double size, std::uint64_t rays,
                std::uint64_t seed) {
    return tally(rays, seed, [&](Random& random, Tally& sum) {
        geometry::Ray ray;
        ray.origin = random.inBox(3 * size);
        ray.direction = random.inBox(size) - ray.origin;
        const geometry::Hit p = a.closest(ray), q = b.closest(ray);
        sum.add(p.id != q.id || p.t != q.t || p.u != q.u || p.v != q.v ||
                a.occluded(ray) != b.occluded(ray));
    });
}

/// A mesh that turns as a whole, and is followed through every frame.
void followBody(const Load& load, Table& table) {
    const test::Mesh mesh = test::icosphere(3, 1, Vec3(0.0), 0.1);
    const RestObject rest{.center = Vec3(0.0), .normal = {}, .faces = {}};
    const auto film = filmOf(scene::Rotate{{0.3, 0, 0}, {1, 1, 1}, {50.0}}, 10'000);
    geometry::Primitives p;
    test::addMesh(p, mesh.positions, mesh.indices);
    auto tree = octree::Octree::build(p, {.movable = true});
    std::vector<geometry::PrimitiveId> all;
    for (std::uint32_t i = 0; i < p.count(); ++i) all.push_back(geometry::PrimitiveId{i});
    Tally differ;
    const std::uint32_t frames = load.full ? 10'000 : 500;
    for (std::uint32_t frame = 0; frame <= frames; ++frame) {
        const auto pose = poseOf(film, rest, frame).worldFromRest;
        for (std::size_t i = 0; i < mesh.positions.size(); ++i)
            p.triangles.positions[i] = pose.point(mesh.positions[i]);
        tree.update(p, all);
        if (frame % 50 == 0)
            differ += differing(tree, octree::Octree::build(p), 1, load.of(200, 2'000),
                                load.seed + frame);
    }
    table.count(
        "A3",
        "a mesh that turns, followed from frame to frame: answers other than a fresh octree's",
        differ.wrong, differ.of);
}

/// Each motion moves 1 % of the triangles by at most 1 % of the diagonal.
void followScatter(const Load& load, Table& table) {
    geometry::Primitives p;
    const auto add = [&](const test::Mesh& mesh) {
        std::vector<Vec3> corners; // each triangle with its own
        std::vector<std::array<std::uint32_t, 3>> indices;
        for (const auto& triangle : mesh.indices) {
            const auto first = static_cast<std::uint32_t>(corners.size());
            for (const std::uint32_t c : triangle) corners.push_back(mesh.positions[c]);
            indices.push_back({first, first + 1, first + 2});
        }
        test::addMesh(p, corners, indices);
    };
    add(test::icosphere(load.full ? 6 : 5, 1, Vec3(0.0), 0.05));
    if (load.full) add(test::icosphere(5, 0.5, Vec3(0.0), 0.05));
    const double reach = 0.01 * 2 * std::sqrt(3.0);
    const std::uint64_t motions = load.of(60, 10'000);
    Random random(load.seed);
    auto tree = octree::Octree::build(p, {.movable = true});
    Tally differ;
    double nodes = 0, cost = 0;
    for (std::uint64_t i = 0; i < motions; ++i) {
        std::vector<geometry::PrimitiveId> moved;
        for (std::uint32_t k = 0; k < p.count() / 100; ++k) {
            const std::uint32_t triangle = random.below(p.count());
            const Vec3 by = random.direction() * (random.unit() * reach);
            for (const std::uint32_t c : p.triangles.indices[triangle])
                p.triangles.positions[c] += by;
            moved.push_back(geometry::PrimitiveId{triangle});
        }
        tree.update(p, moved);
        const auto fresh = octree::Octree::build(p, {.movable = true});
        differ += differing(tree, fresh, 1, 100, load.seed + i);
        const auto ours = tree.statistics(), theirs = fresh.statistics();
        nodes =
            std::max(nodes, static_cast<double>(ours.nodes) / static_cast<double>(theirs.nodes));
        cost = std::max(cost, ours.cost / theirs.cost);
    }
    const std::string what = std::to_string(motions) + " motions of 1 % of " +
                             std::to_string(p.count()) + " triangles: ";
    table.count("A3", what + "answers other than a fresh octree's", differ.wrong, differ.of);
    table.measure("A3", what + "nodes", nodes, 1.5, "of a fresh octree's", motions);
    table.measure("A3", what + "cost", cost, 1.15, "of a fresh octree's", motions);
}

} // namespace

void motion(const Load& load, Table& table) {
    for (const double away : {0.0, 1e3}) {
        const Vec3 pivot(away, -away, 0.5 * away);
        const RestObject rest{.center = pivot + Vec3(1, 0, 0), .normal = {}, .faces = {}};
        constexpr std::uint32_t kFrames = 10'000;
        const double turns = 100 * 2 * 3.141592653589793; // the stored angle is the exact one
        const auto film = filmOf(scene::Rotate{pivot, {0, 0, 1}, {turns}}, kFrames);
        Tally drift, alone;
        std::vector<ObjectPose> sequence;
        for (std::uint32_t k = 0; k <= kFrames; ++k) sequence.push_back(poseOf(film, rest, k));
        Random random(load.seed);
        for (std::uint32_t i = 0; i <= kFrames; ++i) {
            const Quad angle = Quad(turns) * i / kFrames;
            const QVec off = QVec(sequence[i].worldFromRest.point(rest.center)) - QVec(pivot) -
                             QVec(cosq(angle), sinq(angle), 0);
            drift.error(magnitude(squareRoot(dot(off, off))) / (1 + numeric::length(pivot)));
            const std::uint32_t k = random.below(kFrames + 1);
            const ObjectPose pose = poseOf(film, rest, k);
            alone.add(pose.worldFromRest.linear != sequence[k].worldFromRest.linear ||
                      pose.worldFromRest.translation != sequence[k].worldFromRest.translation);
        }
        const std::string at = away > 0 ? " at 1000" : "";
        table.measure("A1", "10 000 steps of 100 turns" + at + ": off the circle", drift.worst,
                      tolerance::kTurned, "relative", drift.of);
        table.count("A1", "a frame alone differs from the frame in sequence" + at, alone.wrong,
                    alone.of);
    }
    for (const std::uint32_t frames : {10'000u, 100'000u}) {
        const RestObject rest{.center = Vec3(1e3, 1e3, 1e3), .normal = {}, .faces = {}};
        const auto film = filmOf(scene::MoveDirect{{1, 0, 0}, 1}, frames);
        Tally path;
        for (std::uint32_t k = 0; k <= frames; k += load.full ? 1 : 101) {
            const Quad exact = Quad(1e3) + Quad(k) / frames;
            const Vec3 there = poseOf(film, rest, k).worldFromRest.point(rest.center);
            path.error(magnitude(Quad(there.x) - exact) / 1e3);
        }
        table.measure("A2", "1 unit in " + std::to_string(frames) + " frames at 1000: off the line",
                      path.worst, numeric::gamma(4), "relative", path.of);
    }
    followBody(load, table);
    followScatter(load, table);
}

} // namespace rt::stability
