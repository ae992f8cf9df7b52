// What the tree is: walks cells, nodes and leaves.
#include "scenes.hpp"

#include <core/octree/cells.hpp>
#include <core/octree/emit.hpp>
#include <core/octree/leaves.hpp>
#include <core/octree/references.hpp>
#include <core/parallel/parallel.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

namespace rt::test {
namespace {

using octree::Cell;
using octree::Cells;
using octree::kEmptyChild;
using octree::kNoCell;
using octree::Reference;

using Quad = __float128;

class Structure : public testing::TestWithParam<int> {
protected:
    void SetUp() override {
        auto scenes = mixedScenes();
        scene_ = std::move(scenes[static_cast<std::size_t>(GetParam())]);
        auto references = octree::referencesOf(*scene_.primitives);
        count_ = references.boundedCount;
        cells_ = std::make_unique<Cells>(*scene_.primitives, std::move(references.bounded), count_,
                                         references.scale, octree::BuildOptions{});
        tree_ = octree::emit(*cells_, references.unbounded, *scene_.primitives);
    }

    static float twiceCenter(const Reference& r, int axis) { return r.lower[axis] + r.upper[axis]; }

    bool centersAgree(const Cell& cell, int axis) const {
        for (std::uint32_t i = cell.begin; i < cell.end; ++i)
            if (twiceCenter(cells_->references()[i], axis) !=
                twiceCenter(cells_->references()[cell.begin], axis))
                return false;
        return true;
    }

    /// `open`: axes that the level of the octree around this cell has not cut yet.
    void walkCuts(std::uint32_t index, unsigned open) {
        const Cell& cell = (*cells_)[index];
        if (!cell.isCut()) return;
        ++cuts_;
        if (!(open >> cell.axis & 1)) {
            // A new level may start only where the old one's remaining cuts can separate nothing.
            for (int a = 0; a < 3; ++a)
                ASSERT_TRUE(!(open >> a & 1) || centersAgree(cell, a)) << "axis " << a;
            open = 7;
            ASSERT_TRUE(open >> cell.axis & 1);
        }
        const Cell &below = (*cells_)[cell.below], &above = (*cells_)[cell.above];
        ASSERT_EQ(cell.begin, below.begin);
        ASSERT_EQ(below.end, above.begin);
        ASSERT_EQ(cell.end, above.end);
        ASSERT_LT(below.begin, below.end);
        ASSERT_LT(above.begin, above.end);
        float lastBelow = -2, firstAbove = 2; // a plane lies between them
        for (std::uint32_t i = cell.begin; i < cell.end; ++i) {
            const float c = twiceCenter(cells_->references()[i], cell.axis);
            if (i < below.end)
                lastBelow = std::max(lastBelow, c);
            else
                firstAbove = std::min(firstAbove, c);
        }
        ASSERT_LT(lastBelow, firstAbove);
        open &= ~(1u << cell.axis);
        if (open == 0) {
            ++levels_;
            open = 7;
        }
        walkCuts(cell.below, open);
        walkCuts(cell.above, open);
    }

    bool isWithin(std::uint32_t cell, std::uint32_t root) const {
        if (cell == root) return true;
        const Cell& r = (*cells_)[root];
        if (!r.isCut()) return false;
        const std::uint32_t side =
            (*cells_)[cell].begin < (*cells_)[r.below].end ? r.below : r.above;
        return isWithin(cell, side);
    }

    /// The emitted node merges cells of `cell`'s subtree, and nothing else.
    void walkNodes(std::uint32_t cell, std::uint32_t node) {
        ++nodes_;
        std::uint32_t children[octree::kNodeChildren];
        const int count = cells_->childrenOf(cell, children);
        ASSERT_GE(count, 1);
        ASSERT_LE(count, 8);
        std::uint32_t at = (*cells_)[cell].begin;
        for (int i = 0; i < count; ++i) { // in a row, without gap or overlap
            ASSERT_TRUE(isWithin(children[i], cell));
            ASSERT_EQ(at, (*cells_)[children[i]].begin);
            at = (*cells_)[children[i]].end;
        }
        ASSERT_EQ(at, (*cells_)[cell].end);
        const octree::Node& bytes = tree_.nodes[node];
        unsigned used = 0;
        for (int i = 0; i < count; ++i) {
            const Cell& child = (*cells_)[children[i]];
            int slot = -1;
            for (int s = 0; s < 8 && slot < 0; ++s) {
                bool same = !(used >> s & 1) && bytes.child[s] != kEmptyChild;
                for (int a = 0; a < 3; ++a)
                    same = same && bytes.planes[2 * a][s] == child.lower[a] &&
                           bytes.planes[2 * a + 1][s] == child.upper[a];
                if (same && (bytes.child[s] & octree::kLeaf)) same = holds(bytes.child[s], child);
                if (same) slot = s;
            }
            ASSERT_GE(slot, 0) << "child " << i << " has no slot";
            used |= 1u << slot;
            const bool isLeaf = bytes.child[slot] & octree::kLeaf;
            ASSERT_EQ(cells_->isLeaf(children[i]), isLeaf);
            if (!isLeaf) walkNodes(children[i], bytes.child[slot]);
        }
        for (int s = 0; s < 8; ++s) ASSERT_TRUE((used >> s & 1) || bytes.child[s] == kEmptyChild);
    }

    bool holds(std::uint32_t reference, const Cell& cell) {
        std::vector<std::uint32_t> in, expected;
        octree::idsOfLeaf(tree_, reference, in);
        for (std::uint32_t i = cell.begin; i < cell.end; ++i)
            expected.push_back(cells_->references()[i].id);
        std::sort(in.begin(), in.end());
        std::sort(expected.begin(), expected.end());
        return in == expected;
    }

    Scene scene_;
    std::uint32_t count_ = 0;
    std::unique_ptr<Cells> cells_;
    octree::Tree tree_;
    std::size_t cuts_ = 0, levels_ = 0, nodes_ = 0;
};

TEST_P(Structure, EveryLevelCutsOnceInXOnceInYOnceInZ) {
    ASSERT_NE(kNoCell, cells_->root());
    walkCuts(cells_->root(), 7);
    EXPECT_GT(cuts_, 500u);
    EXPECT_GT(levels_, 100u) << "few levels were cut on all three axes: the test is weak";
}

TEST_P(Structure, NodesMergeCellsAndNothingElse) {
    walkNodes(cells_->root(), 0);
    EXPECT_EQ(tree_.nodes.size(), nodes_);
}

TEST_P(Structure, EveryPrimitiveIsInOneCell) {
    std::vector<std::uint32_t> ids;
    for (std::uint32_t i = 0; i < count_; ++i) ids.push_back(cells_->references()[i].id);
    std::sort(ids.begin(), ids.end());
    ASSERT_EQ(scene_.primitives->count(), ids.size());
    for (std::uint32_t i = 0; i < ids.size(); ++i) ASSERT_EQ(i, ids[i]);
}

TEST_P(Structure, BytesDependOnNoThread) {
    const auto bytesWith = [&](int threads) {
        std::string bytes;
        parallel::withThreads(threads, [&] {
            auto references = octree::referencesOf(*scene_.primitives);
            const std::uint32_t count = references.boundedCount;
            const Cells cells(*scene_.primitives, std::move(references.bounded), count,
                              references.scale, octree::BuildOptions{});
            const octree::Tree tree = octree::emit(cells, references.unbounded, *scene_.primitives);
            const auto add = [&](const auto& array) {
                bytes.append(reinterpret_cast<const char*>(array.data()), array.bytes());
            };
            add(tree.nodes);
            add(tree.shared);
            add(tree.triangles);
            add(tree.narrowShared);
            add(tree.narrowTriangles);
            add(tree.spheres);
            add(tree.parallelograms);
            add(tree.records);
            add(tree.runs);
            add(tree.customIds);
        });
        return bytes;
    };
    const std::string one = bytesWith(1);
    EXPECT_GT(one.size(), 100000u);
    EXPECT_TRUE(one == bytesWith(2));
    EXPECT_TRUE(one == bytesWith(7));
}

INSTANTIATE_TEST_SUITE_P(Scenes, Structure, testing::Range(0, 6));

TEST(Structure, CornersOfOneHashAreToldApart) {
    // Multiples of the inverse of the hash's factor: all have the same entry, then all have their own.
    constexpr std::uint32_t kInverse = 0x0E8B2F51u;
    static_assert(kInverse * 0x9E3779B1u == 1u);
    for (const std::uint32_t step : {kInverse, kInverse << 24}) {
        octree::CornerSet corners;
        for (int round = 0; round < 3; ++round)
            for (std::uint32_t i = 0; i < 16; ++i)
                ASSERT_EQ(static_cast<int>(i), corners.add(i * step)) << "round " << round;
        EXPECT_EQ(-1, corners.add(16 * step));
        EXPECT_EQ(16, corners.size());
        for (int i = 0; i < 16; ++i) EXPECT_EQ(static_cast<std::uint32_t>(i) * step, corners.at(i));
    }
}

TEST(Structure, BoxesAreTheTightestF32OnesAroundThePrimitive) {
    Random random(23);
    for (const double size : {1e-300, 1e-3, 1.0, 1e30}) {
        std::vector<Vec3> positions{Vec3(0.0), Vec3(size),
                                    Vec3(-size)}; // the last box but one has zeros
        std::vector<std::array<std::uint32_t, 3>> indices{{0, 1, 2}, {0, 0, 0}};
        for (std::uint32_t i = 0; i < 1000; ++i) {
            for (int c = 0; c < 3; ++c) positions.push_back(random.inBox(size));
            indices.push_back({3 * i + 3, 3 * i + 4, 3 * i + 5});
        }
        Primitives p;
        addMesh(p, positions, indices);
        const octree::References references = octree::referencesOf(p);
        ASSERT_EQ(p.count(), references.boundedCount);
        for (std::uint32_t i = 0; i < references.boundedCount; ++i) {
            const Reference& r = references.bounded[i];
            for (int a = 0; a < 3; ++a) {
                Quad lower = HUGE_VAL, upper = -HUGE_VAL;
                for (const std::uint32_t c : indices[r.id]) {
                    const Quad x = (static_cast<Quad>(positions[c][a]) - references.center[a]) *
                                   references.scale;
                    lower = std::min(lower, x);
                    upper = std::max(upper, x);
                }
                ASSERT_LE(r.lower[a], lower);
                ASSERT_GT(std::nextafter(r.lower[a], 2.0f), lower);
                ASSERT_GE(r.upper[a], upper);
                ASSERT_LT(std::nextafter(r.upper[a], -2.0f), upper);
            }
        }
    }
}

TEST(Structure, NoLeafHasMoreThanMaxObjects) {
    const Mesh ball = icosphere(4, 1, Vec3(0.0), 0.1);
    Primitives p;
    addMesh(p, ball.positions, ball.indices);
    for (const std::uint32_t most : {3u, 6u, 11u}) { // two boxes may have one centre
        const auto histogram =
            octree::Octree::build(p, {.maxObjects = most}).statistics().leafHistogram;
        std::uint64_t more = 0;
        for (std::size_t n = most + 1; n < histogram.size(); ++n) more += histogram[n];
        EXPECT_EQ(more, 0u) << most;
    }
}

/// The surface of what is small enough is 0 in f32; that of the cells around it is not.
TEST(Structure, WhatHasNoAreaInF32LeavesTheRestItsCells) {
    Primitives p;
    Random random(41);
    // The middle of all is 0, near which f32 tells apart what is small.
    std::vector<geometry::Sphere> spheres{{{-1, -1, -1}, 0.1}, {{1, 1, 1}, 0.1}};
    for (int i = 0; i < 400; ++i) spheres.push_back({random.inBox(1), 0.01});
    for (int i = 0; i < 40; ++i) spheres.push_back({random.inBox(std::exp2(-90)), std::exp2(-95)});
    addSpheres(p, spheres);
    const auto statistics = octree::Octree::build(p).statistics();
    EXPECT_GT(statistics.leaves, 50u);
    EXPECT_LE(statistics.leafHistogram.size(), 17u);
}

TEST(Structure, ThreadsShareLargeTreesTheSameWay) {
    // Big enough for the parallel passes over one cell.
    const Mesh ball = icosphere(6, 1, Vec3(0.0), 0.1);
    Primitives p;
    addMesh(p, ball.positions, ball.indices);
    const auto one = octree::Octree::build(p, {.threads = 1}),
               four = octree::Octree::build(p, {.threads = 4});
    EXPECT_EQ(one.statistics().bytes, four.statistics().bytes);
    EXPECT_EQ(one.statistics().leafHistogram, four.statistics().leafHistogram);
    octree::Visits a, b;
    Random random(11);
    for (int i = 0; i < 2000; ++i) {
        Ray ray;
        ray.origin = random.inBox(1);
        ray.direction = random.direction();
        const auto h = one.closest(ray, &a), g = four.closest(ray, &b);
        ASSERT_EQ(h.id, g.id);
        ASSERT_EQ(h.t, g.t);
    }
    EXPECT_EQ(a.nodes, b.nodes);
    EXPECT_EQ(a.triangles, b.triangles);
}

} // namespace
} // namespace rt::test
