#include <core/geometry/bounds.hpp>

#include <core/geometry/intersect.hpp>

namespace rt::geometry {

Box3d boundsOf(const Primitives& primitives, const Segment& segment) {
    Box3d box;
    for (std::uint32_t i = segment.index; i < segment.index + segment.count; ++i)
        switch (segment.kind) {
        case Kind::triangle:
            for (const std::uint32_t corner : primitives.triangles.indices[i])
                box.add(primitives.triangles.positions[corner]);
            break;
        case Kind::sphere: {
            const Sphere& s = primitives.spheres[i];
            box.add(Box3d{s.center - Vec3(s.radius), s.center + Vec3(s.radius)});
            break;
        }
        case Kind::parallelogram:
            for (const Vec3& corner : cornersOf(primitives.parallelograms[i])) box.add(corner);
            break;
        case Kind::custom:
            box.add(primitives.customs.primitives[i].bounds);
            break;
        }
    return box;
}

Box3d boundsOf(const Primitives& primitives) {
    Box3d box;
    for (const Segment& segment : primitives.segments) box.add(boundsOf(primitives, segment));
    return box;
}

} // namespace rt::geometry
