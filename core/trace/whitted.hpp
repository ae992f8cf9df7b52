// The light along a ray, after T. Whitted, An Improved Illumination Model for Shaded Display, CACM 23(6), 1980.
//
//   C = sum over lights of color diffuse max(0, L.N) S + specular (H.N)^s S + environment S
//       + color transmission T + color specular R
//
// L unit to the light, N the normal toward the viewer, H halfway between L and the viewer, S the
// light's color times the transmission of every surface between; R and T what the mirrored and the
// refracted ray see. On total reflection transmission joins specular. A light on the far side of the
// surface reaches the viewer through it: opaque, S is 0; otherwise the surface itself is one of those
// between, and only the environment term is left.
//
// ior is a ratio at each surface, inside over outside. So a ray needs no memory of what it is in:
// nested solids refract as the product of the ratios that were crossed, in whatever order.
#pragma once
#include <core/numeric/elementary.hpp>
#include <core/trace/coincident.hpp>
#include <core/trace/counts.hpp>
#include <core/trace/direction.hpp>
#include <core/trace/shadow_terminator.hpp>
#include <core/trace/stage.hpp>

#include <algorithm>
#include <vector>

namespace rt::trace {

/// What the rays of a render can meet; one kernel is compiled for each.
struct Features {
    bool transmission; // some surface lets light through
    bool counting;     // visits of the octree are counted
};

enum class RayKind : std::uint8_t { primary, reflected, refracted };

/// A ray still to be traced and how much of what it sees reaches the picture.
struct Work {
    geometry::Ray ray; // unit direction
    LinearRgb weight{1, 1, 1};
    std::uint32_t depth = 0; // bounces so far
    RayKind kind = RayKind::primary;
    std::uint32_t node = 0; // the observer's number for this ray
};

/// Memory of one thread; grows to the deepest scene it has met, then is never allocated again.
struct Scratch {
    std::vector<Work> pending;
    std::vector<geometry::Crossing> crossings;
    Coincident coincident;
};

/// A surface as the ray sees it: normals turned toward the ray.
struct Facing {
    geometry::Surface surface;
    Vec3 normal;    // interpolated
    Vec3 geometric; // of the flat primitive
    bool leaving;   // the ray arrives from the inside
};

enum class Fate : std::uint8_t { traced, nothingToAdd, cutByDepth, cutByContribution };

/// Sees nothing and costs nothing.
struct NoObserver {
    static constexpr bool kActive = false;
};

template <Features kFeatures, class Observer = NoObserver> class Whitted {
public:
    Whitted(const Stage& stage, Scratch& scratch, RayCounts& counts, Observer& observer)
        : stage_(stage), scratch_(scratch), counts_(counts), observer_(observer) {}

    /// Linear light along a ray of unit direction that was clipped to the scene's box.
    LinearRgb radiance(const geometry::Ray& primary) {
        sum_ = {};
        ++counts_.primary;
        Work first;
        first.ray = primary;
        if constexpr (Observer::kActive) first.node = observer_.primary(first);
        scratch_.pending.clear();
        scratch_.pending.push_back(first);
        while (!scratch_.pending.empty()) {
            const Work work = scratch_.pending.back();
            scratch_.pending.pop_back();
            follow(work);
        }
        return sum_;
    }

private:
    octree::Visits* visits() const { return kFeatures.counting ? &counts_.visits : nullptr; }

    void follow(const Work& work) {
        if (const geometry::Hit hit = stage_.octree.closest(work.ray, visits())) {
            shade(work, hit, geometry::surfaceAt(stage_.world.primitives, work.ray, hit));
        } else {
            const LinearRgb seen = stage_.background.seenBy(work.ray);
            if constexpr (Observer::kActive) observer_.miss(work, seen);
            sum_ += work.weight * seen;
        }
    }

    void shade(const Work& work, const geometry::Hit& hit, const geometry::Surface& surface) {
        const Facing facing = face(surface, work.ray.direction);
        const auto material =
            stage_.world.materials.data() + static_cast<std::uint32_t>(facing.surface.material);
        const LinearRgb color = colorAt(stage_.world, *material, facing.surface);
        if constexpr (Observer::kActive) observer_.hit(work, hit, facing, *material, color);
        sum_ += work.weight * lit(work, hit, facing, *material, color);

        LinearRgb mirror = material->specular;
        if constexpr (kFeatures.transmission)
            if (!material->isOpaque())
                if (!transmit(work, hit, facing, *material, color))
                    mirror += material->transmission;
        if (!mirror.isBlack()) reflect(work, facing, color * mirror);
    }

    static Facing face(const geometry::Surface& surface, const Vec3& direction) {
        const bool leaving = dot(direction, surface.geometricNormal) > 0;
        Facing facing{surface, leaving ? -surface.shadingNormal : surface.shadingNormal,
                      leaving ? -surface.geometricNormal : surface.geometricNormal, leaving};
        // Rays leave from beyond a second surface that coincides with this one: its bound too.
        facing.surface.error += surface.error;
        return facing;
    }

    /// The sum over the lights.
    LinearRgb lit(const Work& work, const geometry::Hit& hit, const Facing& facing,
                  const material::Material& material, const LinearRgb& color) {
        LinearRgb sum;
        const bool shines = !material.diffuse.isBlack() || !material.specular.isBlack();
        const bool glows = !material.environment.isBlack();
        if (!shines && !glows) return sum;
        geometry::Surface from = facing.surface;
        if (facing.surface.shadingNormal != facing.surface.geometricNormal)
            from.position = smoothPosition(stage_.world.primitives, facing.surface, hit,
                                           facing.leaving ? -1 : 1);
        for (const Light& light : stage_.lights) {
            const Vec3 toLight = light.position - facing.surface.position;
            const double squared = dot(toLight, toLight);
            if (!(squared > 0)) continue; // the light lies on the point: no direction
            const Vec3 direction = toLight / std::sqrt(squared);
            const double cosine = dot(direction, facing.normal);
            const bool front = cosine > 0;
            if (front ? !(shines || glows) : !glows || material.isOpaque()) continue;
            LinearRgb visible = visibleLight(light, front ? from : facing.surface);
            if (!front) visible *= material.transmission;
            LinearRgb added = material.environment * visible;
            if (front) {
                added += color * material.diffuse * cosine * visible;
                added += highlight(work, facing, material, direction) * visible;
            }
            if constexpr (Observer::kActive) observer_.light(work, light, visible, added);
            sum += added;
        }
        return sum;
    }

    static LinearRgb highlight(const Work& work, const Facing& facing,
                               const material::Material& material, const Vec3& toLight) {
        if (material.specular.isBlack()) return {};
        const Vec3 halfway = toLight - work.ray.direction;
        const double cosine = dot(halfway, facing.normal) / std::sqrt(dot(halfway, halfway));
        if (!(cosine > 0)) return {};
        return material.specular * numeric::pow(std::min(cosine, 1.0), material.shininess);
    }

    /// The light's color after all that lies between.
    LinearRgb visibleLight(const Light& light, const geometry::Surface& from) {
        ++counts_.shadow;
        geometry::Ray ray = geometry::spawnRayTo(from, light.position);
        stage_.box.clipEnd(ray);
        if constexpr (!kFeatures.transmission) {
            return stage_.octree.occluded(ray, visits()) ? LinearRgb{} : light.color;
        } else {
            auto& crossings = scratch_.crossings;
            crossings.clear();
            if (!stage_.octree.crossings(ray, stage_.opaque, crossings, visits())) return {};
            LinearRgb color = light.color;
            for (const geometry::Crossing& crossing : crossings) {
                const auto id = geometry::materialOf(stage_.world.primitives, crossing.id);
                color *= stage_.world.materials[static_cast<std::uint32_t>(id)].transmission;
            }
            return color;
        }
    }

    void reflect(const Work& work, const Facing& facing, const LinearRgb& share) {
        const Vec3 direction =
            intoHemisphere(reflected(work.ray.direction, facing.normal), facing.geometric);
        Work child;
        child.kind = RayKind::reflected;
        child.weight = work.weight * share;
        if (admit(work, child)) {
            child.ray = geometry::spawnRay(facing.surface, direction);
            push(child);
        }
    }

    /// False on total reflection.
    bool transmit(const Work& work, const geometry::Hit& hit, const Facing& facing,
                  const material::Material& material, const LinearRgb& color) {
        double ratio = 1; // index in front over index behind
        if (facing.surface.solid) ratio = facing.leaving ? material.ior : 1 / material.ior;
        const Coincident* also = nullptr;
        if (stage_.mayCoincide[static_cast<std::uint32_t>(facing.surface.object)]) {
            findCoincident(stage_, work.ray, hit, facing.surface, scratch_.crossings,
                           scratch_.coincident, visits());
            also = &scratch_.coincident;
            ratio *= also->indexRatio;
        }
        const bool ends = also && also->opaque; // in contact: nothing between that could bend it
        Vec3 direction = work.ray.direction;
        if (ratio != 1 && !ends) {
            // An interpolated normal may point away from the viewer.
            const bool usable = dot(direction, facing.normal) < 0;
            const auto bent =
                refracted(direction, usable ? facing.normal : facing.geometric, ratio);
            if (!bent) return false;
            direction = -intoHemisphere(-*bent, facing.geometric);
        }
        Work child;
        child.kind = RayKind::refracted;
        child.weight = work.weight * (color * material.transmission);
        if (also) child.weight *= also->filter;
        if (!admit(work, child)) return true;
        geometry::Surface from = facing.surface;
        if (also) from.error += also->error;
        child.ray = geometry::spawnRay(from, direction);
        if constexpr (Observer::kActive) observer_.transmitted(child, facing, also);
        if (ends) {
            geometry::Surface end = *also->opaque;
            end.error += from.error;
            if constexpr (Observer::kActive) observer_.starts(child);
            shade(child, also->opaqueHit, end);
        } else {
            push(child);
        }
        return true;
    }

    /// Is the child worth a ray?
    bool admit(const Work& parent, Work& child) {
        child.depth = parent.depth + 1;
        Fate fate = Fate::traced;
        if (child.weight.isBlack()) {
            fate = Fate::nothingToAdd;
        } else if (child.depth > stage_.depth) {
            fate = Fate::cutByDepth;
            ++counts_.cutByDepth;
            counts_.lostByDepth += child.weight.maxComponent();
        } else if (child.weight.maxComponent() < stage_.cutoff) {
            fate = Fate::cutByContribution;
            ++counts_.cutByContribution;
        }
        if constexpr (Observer::kActive) child.node = observer_.child(parent, child, fate);
        return fate == Fate::traced;
    }

    void push(Work& child) {
        ++(child.kind == RayKind::reflected ? counts_.reflected : counts_.refracted);
        counts_.deepest = std::max(counts_.deepest, child.depth);
        stage_.box.clipEnd(child.ray);
        if constexpr (Observer::kActive) observer_.starts(child);
        scratch_.pending.push_back(child);
    }

    const Stage& stage_;
    Scratch& scratch_;
    RayCounts& counts_;
    Observer& observer_;
    LinearRgb sum_;
};

} // namespace rt::trace
