// The octree of the textbooks as the yardstick: a pointer per octant, cells halved in the middle,
// triangles in every leaf that they reach, parametric traversal [Revelles, Ureña, Lastra 2000].
#pragma once
#include <core/geometry/ray.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace rt::bench {

class TextbookOctree {
public:
    /// Triangles only; keeps a reference to `primitives`.
    explicit TextbookOctree(const geometry::Primitives& primitives);

    geometry::Hit closest(const geometry::Ray& ray) const { return trace(ray, false); }
    bool occluded(const geometry::Ray& ray) const { return static_cast<bool>(trace(ray, true)); }
    std::size_t bytes() const { return bytes_; }

private:
    struct Node {
        std::array<std::unique_ptr<Node>, 8> octants; // bit 0: z, 1: y, 2: x; 1 is above the middle
        std::vector<std::uint32_t> triangles;         // of a leaf
        bool isLeaf = true;
    };
    struct Query;

    std::unique_ptr<Node> build(std::vector<std::uint32_t> triangles, const geometry::Vec3& center,
                                double half, int depth);
    bool reaches(std::uint32_t triangle, const geometry::Vec3& center, double half) const;
    geometry::Hit trace(const geometry::Ray& ray, bool any) const;
    void visit(Query& query, const Node* node, const geometry::Vec3& enter,
               const geometry::Vec3& leave) const;

    const geometry::Primitives& primitives_;
    geometry::Vec3 center_{0.0};
    double half_ = 0;
    std::size_t bytes_ = 0;
    std::unique_ptr<Node> root_;
};

} // namespace rt::bench
