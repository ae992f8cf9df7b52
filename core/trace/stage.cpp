#include <core/trace/stage.hpp>

#include <core/geometry/bounds.hpp>
#include <core/numeric/elementary.hpp>
#include <core/numeric/rounding.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>

namespace rt::trace {
namespace {

using geometry::Kind;
using geometry::Primitives;
using geometry::Segment;
using numeric::Box3d;

Box3d boundsWithSlack(const Primitives& primitives, const Segment& segment) {
    const Box3d box = geometry::boundsOf(primitives, segment);
    // Surfaces coincide when they are within each other's error bounds.
    const double slack = geometry::errorBoundWithin(box);
    return {box.min - slack, box.max + slack};
}

bool overlap(const Box3d& a, const Box3d& b) {
    for (int axis = 0; axis < 3; ++axis)
        if (!(a.min[axis] <= b.max[axis] && b.min[axis] <= a.max[axis])) return false;
    return true;
}

/// May a point lie on both of two spheres, within error bounds that sum to `slack`? Not where one is outside of the other,
/// or within it.
bool mayTouch(const geometry::Sphere& a, const geometry::Sphere& b, double slack) {
    const Vec3 apart = b.center - a.center;
    const double distance = std::sqrt(dot(apart, apart));
    return distance <= a.radius + b.radius + slack &&
           distance + slack >= std::fabs(a.radius - b.radius);
}

bool segmentTransmits(const world::World& world, const Segment& segment) {
    const auto& ofTriangles = world.primitives.triangles.materials;
    const auto transmits = [&](geometry::MaterialId id) {
        return !world.materials[static_cast<std::uint32_t>(id)].isOpaque();
    };
    if (segment.kind != Kind::triangle || ofTriangles.empty()) return transmits(segment.material);
    return std::any_of(ofTriangles.begin() + segment.index,
                       ofTriangles.begin() + segment.index + segment.count, transmits);
}

std::vector<bool> objectsThatMayCoincide(const world::World& world) {
    const auto& segments = world.primitives.segments;
    std::size_t objects = world.objectNames.size();
    for (const Segment& s : segments)
        objects = std::max(objects, static_cast<std::size_t>(s.object) + 1);

    struct Extent {
        Box3d box;
        std::size_t object;
        bool transmits;
        const geometry::Sphere* sphere; // if it is a single one
    };
    std::vector<Extent> extents;
    for (const Segment& s : segments)
        extents.push_back({boundsWithSlack(world.primitives, s), static_cast<std::size_t>(s.object),
                           segmentTransmits(world, s),
                           s.kind == Kind::sphere && s.count == 1
                               ? &world.primitives.spheres[s.index]
                               : nullptr});
    // Sweep along x: only boxes that are open at the same x are compared.
    std::sort(extents.begin(), extents.end(),
              [](const Extent& a, const Extent& b) { return a.box.min.x < b.box.min.x; });
    std::vector<bool> may(objects, false);
    std::vector<const Extent*> open;
    for (const Extent& next : extents) {
        std::erase_if(open, [&](const Extent* e) { return e->box.max.x < next.box.min.x; });
        for (const Extent* e : open) {
            if (e->object == next.object || !(e->transmits || next.transmits)) continue;
            if ((may[e->object] || !e->transmits) && (may[next.object] || !next.transmits))
                continue;
            if (!overlap(e->box, next.box)) continue;
            if (e->sphere && next.sphere &&
                !mayTouch(*e->sphere, *next.sphere,
                          geometry::errorBoundWithin(e->box) +
                              geometry::errorBoundWithin(next.box)))
                continue;
            if (e->transmits) may[e->object] = true;
            if (next.transmits) may[next.object] = true;
        }
        open.push_back(&next);
    }
    return may;
}

std::vector<std::uint8_t> ranksOf(const std::vector<material::Material>& materials) {
    std::vector<std::size_t> order(materials.size());
    std::iota(order.begin(), order.end(), 0);
    const auto key = [&](std::size_t i) {
        const material::Material& m = materials[i];
        return std::tuple(!m.isOpaque(), m.isMirror(), m.colorTexture);
    };
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return key(a) < key(b); });
    constexpr std::size_t kFew = kRankOfMisses / (kKindOfRank + 1);
    std::vector<std::uint8_t> ranks(materials.size());
    for (std::size_t i = 0; i < order.size(); ++i)
        ranks[order[i]] =
            static_cast<std::uint8_t>(i * kFew / std::max(order.size(), kFew) * (kKindOfRank + 1));
    return ranks;
}

/// Where (H.N)^s reaches 2^-53, half the last place of a highlight of 1.
double leastHighlight(const material::Material& m) {
    if (m.specular.isBlack()) return numeric::kInfinity;
    return std::max(numeric::pow(0.5, 53 / m.shininess), std::numeric_limits<double>::denorm_min());
}

} // namespace

Stage::Stage(const octree::Octree& tree, const world::World& theWorld,
             const scene::Description& description)
    : octree(tree), world(theWorld), background(description.background, theWorld),
      box(description.bounds), depth(description.render.depth), cutoff(description.render.cutoff) {
    for (std::uint32_t i = 0; i < description.lights.size(); ++i) {
        const scene::PointLight& light = description.lights[i];
        const LinearRgb color = light.color * light.brightness;
        if (!color.isBlack()) lights.push_back({light.position, color, i});
    }
    for (const auto& m : world.materials) opaque.push_back(m.isOpaque());
    for (const auto& m : world.materials) {
        const bool glows = !m.environment.isBlack();
        lit.push_back({glows || !m.diffuse.isBlack(), glows && !m.isOpaque(), leastHighlight(m)});
    }
    ranks = ranksOf(world.materials);
    constexpr std::size_t kManyPlanes =
        4096; // would only push more useful things out of the caches
    if (world.primitives.parallelograms.size() <= kManyPlanes)
        for (const auto& p : world.primitives.parallelograms)
            planes.push_back(geometry::planeOf(p));
    nothing.assign(opaque.size(), false);
    transmits = std::any_of(world.primitives.segments.begin(), world.primitives.segments.end(),
                            [&](const Segment& s) { return segmentTransmits(world, s); });
    if (transmits) mayCoincide = objectsThatMayCoincide(world);
    anyMayCoincide = std::find(mayCoincide.begin(), mayCoincide.end(), true) != mayCoincide.end();
    ties = tiesOf(world.primitives);
}

} // namespace rt::trace
