#include <core/world/append.hpp>

#include <algorithm>
#include <utility>

namespace rt::world {
namespace {

using geometry::Kind;
using geometry::kNoIndex;
using geometry::MaterialId;
using Corners = std::array<std::uint32_t, 3>;

template <class T> void appendAll(std::vector<T>& to, std::vector<T>&& from) {
    if (to.empty())
        to = std::move(from);
    else
        to.insert(to.end(), std::make_move_iterator(from.begin()),
                  std::make_move_iterator(from.end()));
}

/// Corners that are there for every triangle or for none.
void appendCorners(std::vector<Corners>& to, std::size_t toTriangles, std::vector<Corners>&& from,
                   std::size_t fromTriangles, std::uint32_t offset) {
    if (to.empty() && from.empty()) return;
    constexpr Corners kNone{kNoIndex, kNoIndex, kNoIndex};
    to.resize(toTriangles, kNone);
    from.resize(fromTriangles, kNone);
    if (offset != 0)
        for (Corners& corners : from)
            for (std::uint32_t& index : corners)
                if (index != kNoIndex) index += offset;
    appendAll(to, std::move(from));
}

/// One material per triangle, where it was that of the segment.
void spellMaterials(geometry::Primitives& primitives) {
    std::vector<MaterialId>& materials = primitives.triangles.materials;
    if (!materials.empty()) return;
    for (const geometry::Segment& segment : primitives.segments)
        if (segment.kind == Kind::triangle)
            materials.resize(std::size_t{segment.index} + segment.count, segment.material);
}

} // namespace

std::optional<std::string> append(World& to, World&& from, std::size_t sharedMaterials,
                                  std::uint64_t maxPrimitives) {
    geometry::Primitives &p = to.primitives, &q = from.primitives;
    geometry::Triangles &t = p.triangles, &f = q.triangles;
    const auto fits = [](std::size_t a, std::size_t b, std::uint64_t most) {
        return std::uint64_t{a} + b <= most;
    };
    const auto most =
        std::min<std::uint64_t>(maxPrimitives, kNoIndex - 1); // the last id means none
    if (!fits(p.count(), q.count(), most))
        return "the scene has more than " + std::to_string(most) + " primitives";
    if (!fits(t.positions.size(), f.positions.size(), kNoIndex) ||
        !fits(t.normals.size(), f.normals.size(), kNoIndex) ||
        !fits(t.uvs.size(), f.uvs.size(), kNoIndex))
        return "the scene has more than 2^32 - 1 vertices";

    const auto newMaterials = static_cast<std::uint32_t>(to.materials.size() - sharedMaterials);
    const auto renumber = [&](MaterialId& id) {
        if (static_cast<std::size_t>(id) >= sharedMaterials)
            id = MaterialId{static_cast<std::uint32_t>(id) + newMaterials};
    };
    for (std::size_t i = sharedMaterials; i < from.materials.size(); ++i) {
        to.materials.push_back(from.materials[i]);
        to.materialNames.push_back(std::move(from.materialNames[i]));
    }
    for (geometry::Segment& segment : q.segments) renumber(segment.material);
    for (MaterialId& material : f.materials) renumber(material);

    if (!t.materials.empty() || !f.materials.empty()) spellMaterials(p), spellMaterials(q);
    const std::size_t had = t.indices.size(), gained = f.indices.size();
    const auto count32 = [](const auto& items) { return static_cast<std::uint32_t>(items.size()); };
    appendCorners(t.normalIndices, had, std::move(f.normalIndices), gained, count32(t.normals));
    appendCorners(t.uvIndices, had, std::move(f.uvIndices), gained, count32(t.uvs));
    const std::uint32_t firstOf[] = {static_cast<std::uint32_t>(had), count32(p.spheres),
                                     count32(p.parallelograms), count32(p.customs.primitives)};
    const std::uint32_t firstId = p.count();
    for (geometry::Segment segment : q.segments) {
        segment.first = geometry::PrimitiveId{static_cast<std::uint32_t>(segment.first) + firstId};
        segment.index += firstOf[static_cast<std::size_t>(segment.kind)];
        p.segments.push_back(segment);
    }
    if (const std::uint32_t offset = count32(t.positions); offset != 0)
        for (Corners& corners : f.indices)
            for (std::uint32_t& index : corners) index += offset;
    appendAll(t.indices, std::move(f.indices));
    appendAll(t.positions, std::move(f.positions));
    appendAll(t.normals, std::move(f.normals));
    appendAll(t.uvs, std::move(f.uvs));
    appendAll(t.materials, std::move(f.materials));
    appendAll(t.sourceFaces, std::move(f.sourceFaces));
    appendAll(p.spheres, std::move(q.spheres));
    appendAll(p.parallelograms, std::move(q.parallelograms));
    for (geometry::CustomPrimitive& primitive : q.customs.primitives)
        primitive.shape += count32(p.customs.shapes);
    appendAll(p.customs.primitives, std::move(q.customs.primitives));
    appendAll(p.customs.shapes, std::move(q.customs.shapes));
    return std::nullopt;
}

} // namespace rt::world
