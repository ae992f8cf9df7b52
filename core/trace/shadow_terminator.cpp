#include <core/trace/shadow_terminator.hpp>

namespace rt::trace {

using geometry::Vec3;

Vec3 smoothPosition(const geometry::Primitives& primitives, const geometry::Surface& surface,
                    const geometry::Hit& hit, double side) {
    const auto& triangles = primitives.triangles;
    if (surface.segment->kind != geometry::Kind::triangle || triangles.normalIndices.empty())
        return surface.position;
    const std::uint32_t index = surface.segment->index + static_cast<std::uint32_t>(surface.id) -
                                static_cast<std::uint32_t>(surface.segment->first);
    const double weights[3] = {(1 - hit.u) - hit.v, hit.u, hit.v};
    Vec3 position = surface.position;
    for (std::size_t corner = 0; corner < 3; ++corner) {
        const std::uint32_t n = triangles.normalIndices[index][corner];
        if (n == geometry::kNoIndex) continue;
        const Vec3 normal = triangles.normals[n] * side;
        const Vec3& vertex = triangles.positions[triangles.indices[index][corner]];
        const double depth = numeric::dot(surface.position - vertex, normal);
        if (depth < 0) position -= normal * (weights[corner] * depth);
    }
    return position;
}

} // namespace rt::trace
