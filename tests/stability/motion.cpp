// A: poses do not drift, and a frame is the same alone as in its sequence.
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
    // A3: nothing is updated in place: each frame's tree is built from its poses. What a tree that has
    // seen other frames could do differently is what a tree of other options could.
    const test::Mesh mesh = test::icosphere(3, 1, Vec3(0.0), 0.1);
    const RestObject rest{.center = Vec3(0.0), .normal = {}, .faces = {}};
    const auto film = filmOf(scene::Rotate{{0.3, 0, 0}, {1, 1, 1}, {50.0}}, 10'000);
    Tally differing;
    for (std::uint32_t frame = 0; frame <= 10'000; frame += load.full ? 50 : 1000) {
        const auto pose = poseOf(film, rest, frame).worldFromRest;
        test::Mesh posed = mesh;
        for (Vec3& v : posed.positions) v = pose.point(v);
        geometry::Primitives p;
        test::addMesh(p, posed.positions, posed.indices);
        const auto tree = octree::Octree::build(p),
                   other = octree::Octree::build(p, {.maxObjects = 3});
        differing += tally(load.of(200, 2'000), load.seed + frame, [&](Random& random, Tally& sum) {
            geometry::Ray ray;
            ray.origin = random.inBox(3);
            ray.direction = random.inBox(1) - ray.origin;
            const geometry::Hit a = tree.closest(ray), b = other.closest(ray);
            sum.add(a.id != b.id || a.t != b.t);
        });
    }
    table.count("A3", "trees of one frame, built in two ways: answers that differ", differing.wrong,
                differing.of);
}

} // namespace rt::stability
