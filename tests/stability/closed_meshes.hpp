// Rays at the weakest spots of closed meshes, through the octree: nothing may get out.
#pragma once
#include <core/octree/octree.hpp>
#include <tests/octree/scenes.hpp>
#include <tests/stability/cases.hpp>

namespace rt::stability {

enum class Aim : std::uint8_t { vertices, edges, anywhere };

struct Leaks {
    std::uint64_t rays = 0;    // from inside, of `closest`
    std::uint64_t leaks = 0;   // met nothing
    std::uint64_t shadows = 0; // ... of `occluded`
    std::uint64_t crossed = 0; // rays whose crossings were counted: one in 16
    std::uint64_t even = 0;    // ... an even number of times

    Leaks& operator+=(const Leaks& o) {
        rays += o.rays, leaks += o.leaks, shadows += o.shadows;
        crossed += o.crossed, even += o.even;
        return *this;
    }
    std::uint64_t wrong() const { return leaks + shadows + even; }
};

/// A closed mesh in one tree per SIMD level of this CPU.
class ClosedMesh {
public:
    /// Rays start within `reach` of `inside`, in each coordinate.
    ClosedMesh(test::Mesh mesh, const numeric::Vec3& inside, double reach);

    /// 16 at a time to one face, alone and in batches; one in 16 of these groups through each SIMD level but the widest.
    Leaks leaks(Aim aim, std::uint64_t rays, std::uint64_t seed) const;

    const geometry::Primitives& primitives() const { return *primitives_; }
    const octree::Octree& tree() const { return trees_[0]; }

private:
    test::Mesh mesh_;
    numeric::Vec3 inside_;
    double reach_;
    std::unique_ptr<geometry::Primitives> primitives_;
    std::vector<octree::Octree> trees_; // the widest level first
};

/// x * scale + offset.
test::Mesh placed(const test::Mesh& mesh, double scale, const numeric::Vec3& offset);

} // namespace rt::stability
