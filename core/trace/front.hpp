// What rays met, and the memory in which it is shaded.
#pragma once
#include <core/octree/octree.hpp>
#include <core/trace/coincident.hpp>
#include <core/trace/paths.hpp>
#include <core/trace/wave.hpp>

#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace rt::trace {

inline constexpr std::uint32_t kNoCoincident = 0xFFFFFFFFu;

/// A ray at the surface that it met; numbers are in the wave, under the same index.
struct Encounter {
    const geometry::Segment* segment;
    geometry::MaterialId material;
    std::uint32_t coincident; // in Scratch::coincident, or kNoCoincident
    geometry::Vec2 uv;        // of all but spheres
};

/// Encounters that are shaded together.
struct Front {
    Batch batch;
    std::size_t count;        // of encounters
    std::size_t senders;      // the first that may send off a ray
    std::size_t transmitters; // the first that may let light through
    Wave wave;
    Encounter met[kWave];

    void start(const Batch& of) {
        batch = of;
        count = 0;
        senders = transmitters = kWave;
    }
    const Work& workOf(std::size_t i) const { return batch.works.data()[wave.ray[i]]; }
    const geometry::Ray& rayOf(std::size_t i) const { return batch.rays.data()[wave.ray[i]]; }
    const geometry::Hit& hitOf(std::size_t i) const { return batch.hits.data()[wave.ray[i]]; }
};

enum class RayKind : std::uint8_t { reflected, refracted };

/// A ray that an encounter sends off; the wave has it.
struct Child {
    std::uint32_t encounter; // of one in contact: number in Scratch::ofContacts
    std::uint32_t depth;
    PathSums::Term term;
    std::uint32_t node = 0;
    RayKind kind;
    bool ofContact;
    std::uint8_t group; // of ByDirection
};

/// Memory of one thread; grows to what the scenes it has met need, then is never allocated again.
struct Scratch {
    struct {
        std::vector<geometry::Ray> rays;
        std::vector<LinearRgb*> colorOf;
    } camera; // of the sampler
    std::vector<Work> primaries;
    Pending pending;
    std::vector<geometry::Hit> hits; // of the batch, as the next three
    std::vector<const geometry::Segment*> segments;
    std::vector<std::uint8_t> ranks;
    std::vector<std::uint32_t> sorted;
    std::unique_ptr<Front> front = std::make_unique_for_overwrite<Front>();
    std::unique_ptr<Front> contact; // one opaque surface that another touches; when it is needed
    std::vector<Child> children;
    std::size_t childCount = 0;
    ByDirection childrenByDirection;
    std::vector<std::pair<Work, geometry::Ray>> ofContacts;
    std::vector<geometry::Ray> shadowRays;
    std::vector<std::uint32_t> toLight; // by shadow ray: number of the encounter
    std::size_t shadowCount = 0;        // of both
    std::vector<std::uint8_t> occluded;
    octree::CrossingLists crossed;
    ByDirection shadowsByDirection;
    PathSums sums;
    std::vector<geometry::Crossing> crossings;
    std::vector<rt_surface_point> texturePoints;
    std::vector<double> textureColors;
    std::vector<Coincident> coincident; // the first so many are of the front
    std::uint32_t coincidents = 0;
};

/// The first `count` of memory that only ever grows.
template <class T> std::span<T> room(std::vector<T>& memory, std::size_t count) {
    if (memory.size() < count) memory.resize(count);
    return {memory.data(), count};
}

inline Vec3 at(const Columns& c, std::size_t i) { return {c.x.at[i], c.y.at[i], c.z.at[i]}; }
inline LinearRgb colorAt(const Columns& c, std::size_t i) {
    return {c.x.at[i], c.y.at[i], c.z.at[i]};
}
inline void put(Columns& c, std::size_t i, const Vec3& v) {
    c.x.at[i] = v.x, c.y.at[i] = v.y, c.z.at[i] = v.z;
}
inline void put(Columns& c, std::size_t i, const LinearRgb& v) {
    c.x.at[i] = v.r, c.y.at[i] = v.g, c.z.at[i] = v.b;
}

} // namespace rt::trace
