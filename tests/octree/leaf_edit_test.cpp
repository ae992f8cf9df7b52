#include <core/octree/leaf_edit.hpp>
#include <core/octree/leaves.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <tuple>

namespace rt::test {
namespace {

using geometry::Vec3;
using octree::LooseTriangle;
using octree::SharedBlock;
using octree::Tree;

const std::uint32_t kSharedLeaf = octree::leafReference(octree::kSharedLeaf, 0);

LooseTriangle triangleOf(std::uint32_t id) {
    return {id, {Vec3(id, 0, 0), Vec3(id, 1, 0), Vec3(id, 0, 1)}};
}

void expectSame(const LooseTriangle& expected, const LooseTriangle& stored) {
    EXPECT_EQ(expected.id, stored.id);
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(expected.corner[c], stored.corner[c]) << c;
}

/// A leaf of one shared block, and what it should hold.
struct Leaf {
    Tree tree;
    octree::Extent places; // only appends
    std::uint32_t reference = kSharedLeaf;
    std::vector<LooseTriangle> triangles;

    Leaf() {
        tree.shared.resize(1);
        SharedBlock& block = tree.shared[0];
        block = {};
        std::fill(std::begin(block.id), std::end(block.id), octree::kEmptyChild);
        places.of[octree::kShared] = 1;
        tree.triangles.resize(1);
    }
    void add(const LooseTriangle& triangle) {
        ASSERT_TRUE(octree::hasRoom(tree, reference, triangle));
        reference = octree::addTriangle(tree, places, reference, triangle);
        triangles.push_back(triangle);
    }
    void drop(unsigned positions) {
        const auto box = octree::dropTriangles(tree, reference, positions);
        std::sort(triangles.begin(), triangles.end(),
                  [](const auto& a, const auto& b) { return a.id < b.id; });
        std::vector<LooseTriangle> kept;
        numeric::Box3d bounds;
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            if (positions >> i & 1) continue;
            kept.push_back(triangles[i]);
            for (const Vec3& p : triangles[i].corner) bounds.add(p);
        }
        triangles = kept;
        EXPECT_EQ(bounds.min, box.min);
        EXPECT_EQ(bounds.max, box.max);
    }
    void expectAll() {
        std::sort(triangles.begin(), triangles.end(),
                  [](const auto& a, const auto& b) { return a.id < b.id; });
        ASSERT_EQ(triangles.size(), octree::idsOfTriangles(tree, reference).size());
        for (std::size_t i = 0; i < triangles.size(); ++i)
            expectSame(triangles[i], octree::triangleAt(tree, reference, static_cast<int>(i)));
    }
};

TEST(LeafEdit, ACornerThatNothingUsesAnyMoreIsNotTakenForAnother) {
    Leaf leaf;
    leaf.add(triangleOf(5));
    leaf.add(triangleOf(9));
    leaf.drop(0b01); // the corners of 5 are still in the block
    LooseTriangle turned = triangleOf(5);
    std::swap(turned.corner[0], turned.corner[1]);
    leaf.add(turned);
    leaf.expectAll();
}

TEST(LeafEdit, TrianglesStandByRisingIdWhateverTheOrderTheyCameIn) {
    Leaf leaf;
    for (const std::uint32_t id : {7u, 3u, 9u, 1u}) leaf.add(triangleOf(id));
    leaf.expectAll();
    leaf.drop(0b0101);
    leaf.expectAll();
    leaf.add(triangleOf(4));
    leaf.expectAll();
}

TEST(LeafEdit, ALeafWithoutRoomForMoreCornersTakesThemApartUpToEight) {
    Leaf leaf;
    for (std::uint32_t id = 8; id-- > 0;) leaf.add(triangleOf(id)); // 24 corners
    leaf.expectAll();
    EXPECT_FALSE(octree::hasRoom(leaf.tree, leaf.reference, triangleOf(8)));
}

TEST(LeafEdit, ALeafOfOneIsNarrowIfThatIsExactAndWanted) {
    LooseTriangle fine = triangleOf(2);
    fine.corner[1].y = 0.1;
    for (const auto& [triangle, storage, kind] :
         {std::tuple(triangleOf(2), octree::Storage::narrowest, octree::kNarrowSharedLeaf),
          std::tuple(triangleOf(2), octree::Storage::f64, octree::kSharedLeaf),
          std::tuple(fine, octree::Storage::narrowest, octree::kSharedLeaf)}) {
        Tree tree;
        tree.shared.resize(1);
        tree.narrowShared.resize(1);
        octree::Extent places;
        const std::uint32_t leaf = octree::leafOf(tree, places, storage, triangle);
        EXPECT_EQ(kind, octree::kindOfLeaf(leaf));
        EXPECT_EQ(1u, octree::sizeOfLeaf(tree, leaf));
        expectSame(triangle, octree::triangleAt(tree, leaf, 0));
    }
}

TEST(LeafEdit, ASharedLeafTakesSixteenThatShareCorners) {
    Leaf leaf;
    const auto strip = [](std::uint32_t id) {
        return LooseTriangle{id, {Vec3(id, 0, 0), Vec3(id + 1, 0, 0), Vec3(0, 1, 0)}};
    };
    for (std::uint32_t id = 0; id < 14; ++id) leaf.add(strip(id)); // 16 corners
    leaf.expectAll();
    EXPECT_FALSE(octree::hasRoom(leaf.tree, leaf.reference, strip(14)));
    leaf.add({14, {Vec3(3, 0, 0), Vec3(7, 0, 0), Vec3(0, 1, 0)}});
    leaf.expectAll();
}

} // namespace
} // namespace rt::test
