// The exact point of a hit, and the one way off a surface.
#pragma once
#include <core/geometry/ray.hpp>

#include <span>

namespace rt::geometry {

/// A point on a primitive. World space.
struct Surface {
    Vec3 position; // re-projected onto the primitive
    double error;  // bound on the distance between position and the primitive, along the normal
    Vec3 geometricNormal; // unit, outward; never turned toward the ray
    Vec3 shadingNormal;   // unit; interpolated where the mesh has normals, else geometricNormal
    Vec2 uv{0};           // of all but spheres: see uvOf
    const Segment* segment;
    PrimitiveId id;
    ObjectId object;
    MaterialId material;
    bool solid;
    bool planar;
};

/// The point that `hit`, an answer to `ray`, stands for.
Surface surfaceAt(const Primitives& primitives, const Ray& ray, const Hit& hit);
/// Likewise; `segment` is that of the hit.
Surface surfaceAt(const Primitives& primitives, const Ray& ray, const Hit& hit,
                  const Segment& segment);

/// What all points of a parallelogram have in common.
struct Plane {
    Vec3 normal;  // as Surface::geometricNormal; 0 where there is none
    double error; // as Surface::error
};
Plane planeOf(const Parallelogram& p);
inline Vec3 pointOn(const Parallelogram& p, const Hit& hit) {
    return p.origin + (hit.u * p.edgeU + hit.v * p.edgeV);
}

/// Bound on the error of any triangle, sphere or parallelogram within `box`.
double errorBoundWithin(const Box3d& box);

/// Triangle: its uvs, else the weights of corners 1 and 2; sphere: longitude and latitude about z, from
/// 0 to 1, computed here for those who want them; parallelogram: along its edges.
Vec2 uvOf(const Surface& surface);

/// Asks the caches for what surfaceAt will read of the hits; those without a primitive are skipped.
void prefetchSurfaces(const Primitives& primitives, std::span<const Hit> hits);

/// Number of the face in the mesh's file; elsewhere within the segment.
std::uint32_t sourceFaceOf(const Primitives& primitives, PrimitiveId id);

/// Precondition: `segment` is that of `id`, and of spheres.
inline const Sphere& sphereOf(const Primitives& primitives, const Segment& segment,
                              PrimitiveId id) {
    return primitives.spheres.data()[segment.index + static_cast<std::uint32_t>(id) -
                                     static_cast<std::uint32_t>(segment.first)];
}

/// Material of a primitive; cheaper than surfaceAt.
inline MaterialId materialOf(const Primitives& primitives, const Segment& segment, PrimitiveId id) {
    if (segment.kind != Kind::triangle || primitives.triangles.materials.empty())
        return segment.material;
    return primitives.triangles.materials[segment.index + static_cast<std::uint32_t>(id) -
                                          static_cast<std::uint32_t>(segment.first)];
}
inline MaterialId materialOf(const Primitives& primitives, PrimitiveId id) {
    return materialOf(primitives, primitives.segmentOf(id), id);
}

/// (b − a) × (c − a) as a unit vector within 1e-10 degrees of the exact one however thin the
/// triangle; (0, 0, 0) when a, b, c lie exactly on a line.
Vec3 triangleNormal(const Vec3& a, const Vec3& b, const Vec3& c);

/// The ray from the surface along `direction`, started on the side that the direction points to and
/// far enough off that rounding cannot put it on the other side.
Ray spawnRay(const Surface& surface, const Vec3& direction);

/// Likewise toward `point`, which is at t = 1; nothing at or behind the point is met.
Ray spawnRayTo(const Surface& surface, const Vec3& point);

} // namespace rt::geometry
