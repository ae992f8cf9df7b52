// A tree that follows moved primitives against one that is built anew. Many motions: A3 of tests/stability/motion.cpp.
#include "scenes.hpp"

#include <core/geometry/moved.hpp>
#include <core/octree/octree.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

namespace rt::test {
namespace {

using geometry::Kind;
using geometry::PrimitiveId;
using octree::Crossing;
using octree::Hit;
using octree::Octree;

constexpr double kMostNodes = 1.5, kMostCost = 1.15; // of a fresh build's: the project's bars

bool sameBits(double a, double b) {
    return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}
bool same(const Hit& a, const Hit& b) {
    return a.id == b.id && sameBits(a.t, b.t) && sameBits(a.u, b.u) && sameBits(a.v, b.v);
}

/// Rays whose answers differ between the two trees.
std::size_t countDiffering(const Octree& a, const Octree& b, const Scene& scene,
                           std::uint64_t first, std::uint64_t count) {
    std::size_t differing = 0;
    std::vector<Crossing> p, q;
    for (std::uint64_t i = first; i < first + count; ++i) {
        const Ray ray = rayFor(scene, i);
        p.clear();
        q.clear();
        a.crossings(ray, {}, p);
        b.crossings(ray, {}, q);
        bool equal = p.size() == q.size();
        for (std::size_t k = 0; equal && k < p.size(); ++k)
            equal = p[k].id == q[k].id && sameBits(p[k].t, q[k].t);
        differing +=
            !equal || !same(a.closest(ray), b.closest(ray)) || a.occluded(ray) != b.occluded(ray);
    }
    return differing;
}

std::uint64_t primitivesIn(const Octree& tree) {
    const auto statistics = tree.statistics();
    std::uint64_t sum = 0;
    for (std::size_t n = 0; n < statistics.leafHistogram.size(); ++n)
        sum += n * statistics.leafHistogram[n];
    return sum;
}

/// Triangles with corners of their own, so that each can move alone.
void separate(Primitives& p) {
    std::vector<Vec3> positions;
    for (auto& corners : p.triangles.indices)
        for (std::uint32_t& c : corners) {
            positions.push_back(p.triangles.positions[c]);
            c = static_cast<std::uint32_t>(positions.size() - 1);
        }
    p.triangles.positions = std::move(positions);
}

/// Moves one primitive; custom ones cannot.
bool move(Primitives& p, PrimitiveId id, const Vec3& by) {
    const auto& segment = p.segmentOf(id);
    const auto i =
        segment.index + static_cast<std::uint32_t>(id) - static_cast<std::uint32_t>(segment.first);
    switch (segment.kind) {
    case Kind::triangle:
        for (const std::uint32_t c : p.triangles.indices[i]) p.triangles.positions[c] += by;
        return true;
    case Kind::sphere:
        p.spheres[i].center += by;
        return true;
    case Kind::parallelogram:
        p.parallelograms[i].origin += by;
        return true;
    case Kind::custom:
        return false;
    }
    return false;
}

std::vector<PrimitiveId> moveSome(Primitives& p, Random& random, std::size_t count, double reach) {
    std::vector<PrimitiveId> moved;
    for (std::size_t i = 0; i < count; ++i) {
        const PrimitiveId id{random.below(p.count())};
        if (move(p, id, random.inBox(reach))) moved.push_back(id);
    }
    return moved;
}

class Update : public testing::TestWithParam<int> {};

TEST_P(Update, AnswersAreThoseOfAFreshBuild) {
    auto scenes = mixedScenes();
    Scene& scene = scenes[static_cast<std::size_t>(GetParam())];
    Primitives& p = *scene.primitives;
    separate(p);
    Random random(static_cast<std::uint64_t>(GetParam()));
    Octree tree = Octree::build(p, {.movable = true});
    const std::uint64_t held = primitivesIn(tree);
    std::uint64_t entered = 0;
    for (int step = 0; step < 12; ++step) {
        // Few and many, near and far, and at last out of the space that the tree was built in.
        const double reach = scene.size * (step == 11 ? 10 : step % 3 == 0 ? 0.3 : 0.01);
        const auto moved = moveSome(p, random, p.count() / (step % 2 ? 100 : 20), reach);
        const auto report = tree.update(p, moved);
        entered += report.entered;
        EXPECT_EQ(moved.size(), report.moved);
        EXPECT_EQ(held, primitivesIn(tree));
        const Octree fresh = Octree::build(p, {.movable = true});
        const auto ours = tree.statistics(), theirs = fresh.statistics();
        EXPECT_EQ(0u,
                  countDiffering(tree, fresh, scene, 700 * static_cast<std::uint64_t>(step), 700))
            << "step " << step;
        EXPECT_LE(static_cast<double>(ours.nodes), kMostNodes * static_cast<double>(theirs.nodes));
        EXPECT_LE(ours.cost, kMostCost * theirs.cost) << "step " << step;
    }
    EXPECT_GT(entered, 0u);
    EXPECT_EQ(0u, countDiffering(tree, Octree::build(p), scene, 0, 3000));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Update, testing::Range(0, 6));

TEST(Update, BlocksThatAreFreeHoldNothing) {
    auto scenes = mixedScenes();
    Scene& scene = scenes[0];
    Primitives& p = *scene.primitives;
    separate(p);
    Random random(3);
    Octree tree = Octree::build(p, {.movable = true});
    for (int step = 0; step < 5; ++step) {
        tree.update(p, moveSome(p, random, p.count() / 50, 0.1 * scene.size));
        for (std::uint64_t i = 0; i < 300; ++i) {
            const Ray ray = rayFor(scene, i);
            ASSERT_TRUE(same(tree.closest(ray), tree.closestWithoutTree(ray))) << i;
        }
    }
}

/// A scene of one still and one moving closed mesh.
struct TwoBodies {
    Scene scene;
    Mesh still = icosphere(5, 1, Vec3(0.0), 0.1), body = icosphere(4, 0.4, Vec3(0.0), 0.1);
    TwoBodies() { place({-1.5, 0, 0}, 0); }

    void place(const Vec3& at, double angle) {
        *scene.primitives = Primitives();
        addMesh(*scene.primitives, still.positions, still.indices);
        std::vector<Vec3> turned;
        const double c = std::cos(angle), s = std::sin(angle);
        for (const Vec3& q : body.positions)
            turned.push_back(at + Vec3(c * q.x - s * q.y, s * q.x + c * q.y, q.z));
        addMesh(*scene.primitives, turned, body.indices);
        scene.size = 2;
    }
    std::vector<PrimitiveId> idsOfBody() const {
        std::vector<PrimitiveId> ids;
        for (std::size_t i = still.indices.size(); i < scene.primitives->count(); ++i)
            ids.push_back(PrimitiveId{static_cast<std::uint32_t>(i)});
        return ids;
    }
};

TEST(Update, ARigidBodyKeepsItsSubtree) {
    TwoBodies bodies;
    Octree tree = Octree::build(*bodies.scene.primitives, {.movable = true});
    for (int step = 1; step <= 40; ++step) { // around the still one, turning
        const double a = 0.1 * step;
        bodies.place({-1.5 * std::cos(a), 1.5 * std::sin(a), 0}, 2 * a);
        const auto report = tree.update(*bodies.scene.primitives, bodies.idsOfBody());
        const Octree fresh = Octree::build(*bodies.scene.primitives);
        ASSERT_EQ(0u, countDiffering(tree, fresh, bodies.scene,
                                     300 * static_cast<std::uint64_t>(step), 300))
            << "step " << step;
        EXPECT_FALSE(report.whole) << "step " << step;
        EXPECT_LE(report.rebuilt, bodies.body.indices.size()) << "step " << step;
        EXPECT_LE(tree.statistics().cost, kMostCost * fresh.statistics().cost) << "step " << step;
    }
}

/// A node's height decides how much room the stacks of rays in turns have; statistics() looks whether it is true.
TEST(Update, ARebuiltSubtreeRaisesTheHeightsAboveIt) {
    TwoBodies bodies;
    Octree tree = Octree::build(*bodies.scene.primitives, {.movable = true});
    std::uint64_t rebuilt = 0;
    for (int step = 1; step <= 40; ++step) {
        const double a = 0.1 * step;
        bodies.place({-1.5 * std::cos(a), 1.5 * std::sin(a), 0}, 2 * a);
        rebuilt += tree.update(*bodies.scene.primitives, bodies.idsOfBody()).rebuilt;
        ASSERT_NO_THROW(tree.statistics()) << "step " << step;
    }
    EXPECT_GT(rebuilt, 0u);
}

TEST(Update, EverythingMayMoveAtOnce) {
    TwoBodies bodies;
    Octree tree = Octree::build(*bodies.scene.primitives, {.movable = true});
    for (Vec3& q : bodies.scene.primitives->triangles.positions) q = q * 0.9 + Vec3(0.05);
    std::vector<PrimitiveId> all;
    for (std::uint32_t i = 0; i < bodies.scene.primitives->count(); ++i)
        all.push_back(PrimitiveId{i});
    tree.update(*bodies.scene.primitives, all);
    EXPECT_EQ(0u,
              countDiffering(tree, Octree::build(*bodies.scene.primitives), bodies.scene, 0, 2000));
}

TEST(Update, WithoutMovableItBuildsAnew) {
    TwoBodies bodies;
    Octree tree = Octree::build(*bodies.scene.primitives);
    bodies.place({0, 0, 1.5}, 1);
    EXPECT_TRUE(tree.update(*bodies.scene.primitives, bodies.idsOfBody()).whole);
    EXPECT_EQ(0u,
              countDiffering(tree, Octree::build(*bodies.scene.primitives), bodies.scene, 0, 2000));
}

TEST(Update, WhatIsNoMotionIsRefused) {
    TwoBodies bodies;
    Primitives& p = *bodies.scene.primitives;
    Octree tree = Octree::build(p, {.movable = true});
    const PrimitiveId none[] = {PrimitiveId{p.count()}};
    EXPECT_THROW(tree.update(p, none), std::invalid_argument);
    Primitives more = p;
    addSpheres(more, {{Vec3(0.0), 1}});
    EXPECT_THROW(tree.update(more, {}), std::invalid_argument);
    EXPECT_THROW(Octree().update(p, {}), std::invalid_argument);
}

TEST(MovedBetween, NamesWhatDiffersByValue) {
    auto scenes = mixedScenes();
    const Primitives& before = *scenes[0].primitives;
    Primitives after = before;
    separate(after); // other indices, same values
    EXPECT_TRUE(geometry::movedBetween(before, after)->empty());
    Random random(9);
    auto moved = moveSome(after, random, 50, 1);
    std::sort(moved.begin(), moved.end());
    moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
    EXPECT_EQ(moved, geometry::movedBetween(before, after));
    addSpheres(after, {{Vec3(0.0), 1}});
    EXPECT_FALSE(geometry::movedBetween(before, after));
}

} // namespace
} // namespace rt::test
