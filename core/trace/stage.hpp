// What all rays of one render share: geometry, lights, background, and what the scene has any of.
#pragma once
#include <core/octree/octree.hpp>
#include <core/scene/description.hpp>
#include <core/trace/background.hpp>
#include <core/trace/coplanar.hpp>
#include <core/trace/scene_box.hpp>
#include <core/world/world.hpp>

#include <span>
#include <vector>

namespace rt::trace {

struct Light {
    Vec3 position;
    LinearRgb color;         // brightness included, not black
    std::uint32_t index = 0; // in the scene's lights
};

/// From where a light can add to what is seen of a material.
struct Lit {
    bool front, back;
    double highlight; // the least H.N that alone is worth asking whether the light is seen
};

/// Rays at surfaces are sorted by rank: matt ones first, then mirrors, then what lets light through; each by
/// material, while these are few, and kind of primitive.
inline constexpr std::uint8_t kKindOfRank = 3, kRankOfMisses = 64;
inline constexpr std::size_t kRanks = kRankOfMisses + 1;

/// Immutable while rays are traced; threads share it.
struct Stage {
    Stage(const octree::Octree& octree, const world::World& world,
          const scene::Description& description);

    /// Of hits that answer `rays`, those on faces in one plane become the lowest of them.
    void settle(std::span<const geometry::Ray> rays, std::span<geometry::Hit> hits,
                std::vector<geometry::Crossing>& scratch, octree::Visits* visits) const {
        if (ties.none()) return;
        for (std::size_t i = 0; i < rays.size(); ++i)
            if (hits[i] && ties.isHigher[static_cast<std::uint32_t>(hits[i].id)])
                hits[i] =
                    lowestOfTied(octree, world.primitives, ties, rays[i], hits[i], scratch, visits);
    }

    std::uint8_t rankOf(const geometry::Segment& segment, geometry::PrimitiveId id) const {
        const auto material = geometry::materialOf(world.primitives, segment, id);
        return ranks.data()[static_cast<std::uint32_t>(material)] |
               static_cast<std::uint8_t>(segment.kind);
    }

    const octree::Octree& octree;
    const world::World& world;
    std::vector<Light> lights;
    Background background;
    SceneBox box;
    std::uint32_t depth;
    double cutoff;

    std::vector<geometry::Plane> planes; // of the parallelograms, unless there are many

    bool transmits;            // some surface lets light through
    std::vector<bool> opaque;  // by MaterialId
    std::vector<bool> nothing; // by MaterialId, all false: no material stops a query of crossings
    std::vector<Lit> lit;      // by MaterialId
    std::vector<std::uint8_t> ranks; // likewise, without the kind
    std::vector<bool> mayCoincide;   // by ObjectId: transmissive and within reach of another object
    bool anyMayCoincide = false;
    Ties ties; // faces of different objects in one plane
};

} // namespace rt::trace
