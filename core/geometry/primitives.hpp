// The world's geometry as structure-of-arrays by kind; what lowering makes and the octree holds. World space, f64.
#pragma once
#include <core/numeric/box.hpp>
#include <core/numeric/transform.hpp>
#include <core/numeric/vec.hpp>
#include <rt/plugin.h>

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace rt::geometry {

using numeric::AffineTransform;
using numeric::Box3d;
using numeric::Vec2;
using numeric::Vec3;

/// Position in the order of the scene: object by object, within an object as its shape emitted them.
/// Ties between equal hits go to the lowest.
enum class PrimitiveId : std::uint32_t {};
/// Index into the objects of the scene.
enum class ObjectId : std::uint32_t {};
/// Index into the world's materials.
enum class MaterialId : std::uint32_t {};

inline constexpr PrimitiveId kNoPrimitive{0xFFFFFFFFu};
inline constexpr std::uint32_t kNoIndex = RT_NO_INDEX;

enum class Kind : std::uint8_t { triangle, sphere, parallelogram, custom };

struct Triangles {
    std::vector<Vec3> positions;
    std::vector<std::array<std::uint32_t, 3>> indices; // counter-clockwise seen from outside
    std::vector<Vec3> normals;                         // unit
    std::vector<std::array<std::uint32_t, 3>>
        normalIndices; // empty, or one per triangle; kNoIndex: flat corner
    std::vector<Vec2> uvs;
    std::vector<std::array<std::uint32_t, 3>>
        uvIndices; // empty, or one per triangle; kNoIndex: (0, 0), in all three corners: no uvs
    std::vector<MaterialId> materials;      // empty, or one per triangle
    std::vector<std::uint32_t> sourceFaces; // empty, or one per triangle
};

struct Sphere {
    Vec3 center;
    double radius;
};

struct Parallelogram {
    Vec3 origin, edgeU, edgeV;
};

/// One rt_custom of a plugin with the frame it stands in; shared by its primitives.
struct CustomShape {
    rt_custom shape; // shape.data is released with the last reference
    AffineTransform worldFromObject, objectFromWorld;
};

struct CustomPrimitive {
    std::uint32_t shape;     // index into Customs::shapes
    std::uint32_t primitive; // number within that shape
    Box3d bounds;            // world space, conservative
};

struct Customs {
    std::vector<std::shared_ptr<const CustomShape>> shapes;
    std::vector<CustomPrimitive> primitives;
};

/// A run of primitives of one kind that one shape of one object emitted.
struct Segment {
    PrimitiveId first; // ids first .. first + count - 1
    std::uint32_t count;
    Kind kind;
    bool solid;
    std::uint32_t index; // of `first` in the array of its kind
    ObjectId object;
    MaterialId material;
};

struct Primitives {
    Triangles triangles;
    std::vector<Sphere> spheres;
    std::vector<Parallelogram> parallelograms;
    Customs customs;
    std::vector<Segment> segments; // by rising `first`, without gaps; id 0 is the first primitive

    std::uint32_t count() const {
        return segments.empty()
                   ? 0
                   : static_cast<std::uint32_t>(segments.back().first) + segments.back().count;
    }
    /// The segment that holds `id`. Precondition: id < count().
    const Segment& segmentOf(PrimitiveId id) const {
        // Where all before it are single primitives, as spheres are, an id is the number of its segment.
        const auto number = static_cast<std::uint32_t>(id);
        if (number < segments.size()) {
            const Segment& segment = segments.data()[number];
            if (segment.first == id && segment.count > 0) return segment;
        }
        return segments.size() == 1 ? segments.front() : searchedSegmentOf(id);
    }

private:
    const Segment& searchedSegmentOf(PrimitiveId id) const;
};

} // namespace rt::geometry
