// Leaves of triangles, changed where they stand. What stays in a leaf is taken from its block: to look each
// up among the primitives again would cost three cache misses.
#pragma once
#include <core/numeric/box.hpp>
#include <core/octree/octree.hpp>
#include <core/octree/tree.hpp>

#include <span>

namespace rt::octree {

struct LooseTriangle {
    std::uint32_t id;
    geometry::Vec3 corner[3];
};

/// Is the leaf one block of triangles? Only those can be edited.
bool isTriangles(std::uint32_t leaf);

/// The ids of such a leaf, at most 16.
std::span<const std::uint32_t> idsOfTriangles(const Tree& tree, std::uint32_t leaf);

LooseTriangle triangleAt(const Tree& tree, std::uint32_t leaf, int position);

/// Takes away the triangles at these positions of its ids, not all; returns the bounds of the others.
numeric::Box3d dropTriangles(Tree& tree, std::uint32_t leaf, unsigned positions);

/// A new leaf of one triangle, which nothing refers to yet.
std::uint32_t leafOf(Tree& tree, Places& places, Storage storage, const LooseTriangle& triangle);

/// Can another triangle join, so that it stays one block?
bool hasRoom(const Tree& tree, std::uint32_t leaf, const LooseTriangle& triangle);

/// Puts a triangle into a leaf that has room for it. Returns the leaf, or one of another kind that takes
/// its place, which nothing refers to yet.
std::uint32_t addTriangle(Tree& tree, Places& places, std::uint32_t leaf,
                          const LooseTriangle& triangle);

} // namespace rt::octree
