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
//
// Rays are traced in generations: all camera rays of a batch, then all their shadow rays to one light,
// then what they reflect and refract. What a ray contributes does not depend on its batch, and
// OrderedSums adds it up as if each sample had been followed alone.
#pragma once
#include <core/numeric/elementary.hpp>
#include <core/trace/coincident.hpp>
#include <core/trace/counts.hpp>
#include <core/trace/direction.hpp>
#include <core/trace/ordered_sums.hpp>
#include <core/trace/shadow_terminator.hpp>
#include <core/trace/stage.hpp>

#include <algorithm>
#include <span>
#include <vector>

namespace rt::trace {

/// Are visits of the octree counted, and of what? Rays that are traced together visit together; `rays`
/// traces each alone, so that the sum over them is what each costs.
enum class Counting : std::uint8_t { none, batches, rays };

/// What the rays of a render can meet; one kernel is compiled for each.
struct Features {
    bool transmission; // some surface lets light through
    Counting counting;
};

enum class RayKind : std::uint8_t { primary, reflected, refracted };

/// A ray still to be traced and how much of what it sees reaches the picture.
struct Work {
    geometry::Ray ray; // unit direction
    LinearRgb weight{1, 1, 1};
    std::uint32_t depth = 0; // bounces so far
    RayKind kind = RayKind::primary;
    std::uint32_t sample = 0;
    OrderedSums::Term term = 0; // what it contributes to the sample
    std::uint32_t node = 0;     // the observer's number for this ray
};

/// A surface as the ray sees it: normals turned toward the ray.
struct Facing {
    geometry::Surface surface;
    Vec3 normal;    // interpolated
    Vec3 geometric; // of the flat primitive
    bool leaving;   // the ray arrives from the inside
};

/// A ray at the surface that it met.
struct Encounter {
    Work work;
    geometry::Hit hit;
    Facing facing;
    const material::Material* material;
    LinearRgb color; // of the surface, texture included
    LinearRgb light; // sum over the lights so far, not yet weighted
};

/// A shadow ray under way.
struct ToLight {
    std::uint32_t encounter; // that it left from
    Vec3 direction;          // unit
    double cosine;           // to the normal toward the viewer
};

/// Memory of one thread; grows to what the scenes it has met need, then is never allocated again.
struct Scratch {
    struct {
        std::vector<geometry::Ray> rays;
        std::vector<LinearRgb*> colorOf;
    } camera; // of the sampler
    std::vector<Work> pending;
    std::vector<Encounter> met;
    std::vector<geometry::Ray> rays;
    std::vector<geometry::Hit> hits;
    std::vector<ToLight> toLight;
    std::vector<std::uint8_t> occluded;
    OrderedSums sums;
    std::vector<geometry::Crossing> crossings;
    Coincident coincident;
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

    /// The linear light along each ray, of unit direction and clipped to the scene's box; until the
    /// next call. Fastest when neighbours in the span are neighbours in the picture.
    std::span<const LinearRgb> radiance(std::span<const geometry::Ray> primaries) {
        meetPrimaries(primaries);
        for (;;) {
            shine(scratch_.met);
            for (const Encounter& encounter : scratch_.met) leave(encounter);
            if (scratch_.pending.empty()) return scratch_.sums.sums();
            meetPending();
        }
    }

private:
    octree::Visits* visits() const {
        return kFeatures.counting != Counting::none ? &counts_.visits : nullptr;
    }

    void meetPrimaries(std::span<const geometry::Ray> primaries) {
        counts_.primary += primaries.size();
        scratch_.pending.clear();
        scratch_.met.clear();
        scratch_.sums.start(primaries.size());
        closest(primaries);
        Work work;
        for (std::uint32_t i = 0; i < primaries.size(); ++i) {
            work.ray = primaries[i];
            work.sample = i;
            if constexpr (kFeatures.transmission) work.term = scratch_.sums.first(i);
            if constexpr (Observer::kActive) work.node = observer_.primary(work);
            meet(work, scratch_.hits[i]);
        }
    }

    /// Takes the last works and traces them. Taking the last, at most so many, keeps the memory of those
    /// that wait linear in the depth.
    void meetPending() {
        constexpr std::size_t kMost = 256;
        auto& pending = scratch_.pending;
        const std::size_t first = pending.size() - std::min(pending.size(), kMost);
        scratch_.rays.clear();
        for (std::size_t i = first; i < pending.size(); ++i)
            scratch_.rays.push_back(pending[i].ray);
        closest(scratch_.rays);
        scratch_.met.clear();
        for (std::size_t i = first; i < pending.size(); ++i)
            meet(pending[i], scratch_.hits[i - first]);
        pending.resize(first);
    }

    void meet(const Work& work, const geometry::Hit& hit) {
        if (hit) {
            const auto surface = geometry::surfaceAt(stage_.world.primitives, work.ray, hit);
            if (work.kind == RayKind::primary && startsOn(surface, work.ray, hit))
                return meetBeyond(work, surface);
            encounter(scratch_.met.emplace_back(), work, hit, surface);
        } else {
            const LinearRgb seen = stage_.background.seenBy(work.ray);
            if constexpr (Observer::kActive) observer_.miss(work, seen);
            contribute(work, seen);
        }
    }

    /// An eye in the plane of a face, by its error bound, does not see that face. (A ray that was slid into the scene's
    /// box does see what lies in the box's side.)
    bool startsOn(const geometry::Surface& surface, const geometry::Ray& ray,
                  const geometry::Hit& hit) const {
        return surface.planar && stage_.box.unbounded() &&
               hit.t * std::fabs(dot(ray.direction, surface.geometricNormal)) <= surface.error;
    }

    void meetBeyond(const Work& work, const geometry::Surface& surface) {
        Work beyond = work;
        beyond.ray = geometry::spawnRay(surface, work.ray.direction);
        beyond.ray.tMax = work.ray.tMax;
        geometry::Hit hit = stage_.octree.closest(beyond.ray, visits());
        stage_.settle({&beyond.ray, 1}, {&hit, 1}, scratch_.crossings, visits());
        meet(beyond, hit);
    }

    /// All that the ray itself adds, when its children have their terms.
    void contribute(const Work& work, const LinearRgb& light) {
        if constexpr (kFeatures.transmission)
            scratch_.sums.settle(work.sample, work.term, work.weight * light);
        else // one child at most: they come in order
            scratch_.sums.add(work.sample, work.weight * light);
    }

    /// Fills scratch_.hits.
    void closest(std::span<const geometry::Ray> rays) {
        scratch_.hits.resize(rays.size());
        if constexpr (kFeatures.counting == Counting::rays) {
            for (std::size_t i = 0; i < rays.size(); ++i)
                scratch_.hits[i] = stage_.octree.closest(rays[i], visits());
        } else {
            stage_.octree.closest(rays, scratch_.hits, octree::Coherence::coherent, visits());
        }
        stage_.settle(rays, scratch_.hits, scratch_.crossings, visits());
        geometry::prefetchSurfaces(stage_.world.primitives, scratch_.hits);
    }

    /// scratch_.occluded of scratch_.rays.
    void occluded() {
        const auto& rays = scratch_.rays;
        scratch_.occluded.resize(rays.size());
        if constexpr (kFeatures.counting == Counting::rays) {
            for (std::size_t i = 0; i < rays.size(); ++i)
                scratch_.occluded[i] = stage_.octree.occluded(rays[i], visits());
        } else {
            stage_.octree.occluded(rays, scratch_.occluded, octree::Coherence::coherent, visits());
        }
    }

    void encounter(Encounter& met, const Work& work, const geometry::Hit& hit,
                   const geometry::Surface& surface) {
        if constexpr (kFeatures.counting != Counting::none)
            ++counts_.hits[static_cast<std::size_t>(surface.segment->kind)];
        met.work = work;
        met.hit = hit;
        met.facing.surface = surface;
        face(met.facing, work.ray.direction);
        met.material = stage_.world.materials.data() + static_cast<std::uint32_t>(surface.material);
        met.color = colorAt(stage_.world, *met.material, surface);
        met.light = {};
        if constexpr (Observer::kActive)
            observer_.hit(work, hit, met.facing, *met.material, met.color);
    }

    void face(Facing& facing, const Vec3& direction) const {
        geometry::Surface& surface = facing.surface;
        facing.leaving = dot(direction, surface.geometricNormal) > 0;
        facing.normal = facing.leaving ? -surface.shadingNormal : surface.shadingNormal;
        facing.geometric = facing.leaving ? -surface.geometricNormal : surface.geometricNormal;
        // Rays leave from beyond a second surface that coincides with this one: its bound too.
        surface.error += std::max(surface.error, stage_.ties.errorBesideOf(surface.id));
    }

    /// Sums the lights up in `light` of each.
    void shine(std::span<Encounter> all) {
        for (const Light& light : stage_.lights) {
            scratch_.rays.clear();
            scratch_.toLight.clear();
            for (std::uint32_t i = 0; i < all.size(); ++i) aim(light, all[i], i);
            counts_.shadow += scratch_.rays.size();
            occluded();
            if constexpr (kFeatures.counting != Counting::none)
                for (const std::uint8_t blocked : scratch_.occluded) counts_.blocked += blocked;
            for (std::size_t i = 0; i < scratch_.rays.size(); ++i)
                add(light, scratch_.toLight[i], i, all[scratch_.toLight[i].encounter]);
        }
    }

    /// The shadow ray, where the light can matter.
    void aim(const Light& light, const Encounter& met, std::uint32_t number) {
        const material::Material& material = *met.material;
        const bool glows = !material.environment.isBlack();
        if (!glows && material.diffuse.isBlack() && material.specular.isBlack()) return;
        const geometry::Surface& surface = met.facing.surface;
        const Vec3 toLight = light.position - surface.position;
        const double squared = dot(toLight, toLight);
        if (!(squared > 0)) return; // the light lies on the point: no direction
        const Vec3 direction = toLight / std::sqrt(squared);
        const double cosine = dot(direction, met.facing.normal);
        const bool front = cosine > 0;
        if (!front && (!glows || material.isOpaque())) return;
        if (front && surface.shadingNormal != surface.geometricNormal) {
            geometry::Surface smoothed = surface;
            smoothed.position = smoothPosition(stage_.world.primitives, surface, met.hit,
                                               met.facing.leaving ? -1 : 1);
            scratch_.rays.push_back(geometry::spawnRayTo(smoothed, light.position));
        } else {
            scratch_.rays.push_back(geometry::spawnRayTo(surface, light.position));
        }
        stage_.box.clipEnd(scratch_.rays.back());
        scratch_.toLight.push_back({number, direction, cosine});
    }

    /// What the light adds through its shadow ray, by number.
    void add(const Light& light, const ToLight& to, std::size_t ray, Encounter& met) {
        const material::Material& material = *met.material;
        LinearRgb visible = light.color;
        if (scratch_.occluded[ray])
            visible = kFeatures.transmission ? filtered(light, scratch_.rays[ray]) : LinearRgb{};
        const bool front = to.cosine > 0;
        if (!front) visible *= material.transmission;
        LinearRgb added = material.environment * visible;
        if (front) {
            added += met.color * material.diffuse * to.cosine * visible;
            if (!visible.isBlack()) added += highlight(met, to.direction) * visible;
        }
        if constexpr (Observer::kActive) observer_.light(met.work, light, visible, added);
        met.light += added;
    }

    static LinearRgb highlight(const Encounter& met, const Vec3& toLight) {
        if (met.material->specular.isBlack()) return {};
        const Vec3 halfway = toLight - met.work.ray.direction;
        const double cosine = dot(halfway, met.facing.normal) / std::sqrt(dot(halfway, halfway));
        if (!(cosine > 0)) return {};
        return met.material->specular *
               numeric::pow(std::min(cosine, 1.0), met.material->shininess);
    }

    /// The light's color after all that a shadow ray crosses.
    LinearRgb filtered(const Light& light, const geometry::Ray& ray) {
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

    /// The surface is lit: sends off what it reflects and refracts.
    void leave(const Encounter& met) {
        LinearRgb mirror = met.material->specular;
        OrderedSums::Term last = met.work.term;
        if constexpr (kFeatures.transmission)
            if (!met.material->isOpaque())
                if (!transmit(met, last)) mirror += met.material->transmission;
        if (!mirror.isBlack()) reflect(met, met.color * mirror, last);
        contribute(met.work, met.light);
    }

    /// Its term goes behind `last`.
    void reflect(const Encounter& met, const LinearRgb& share, OrderedSums::Term last) {
        const Vec3 direction = intoHemisphere(reflected(met.work.ray.direction, met.facing.normal),
                                              met.facing.geometric);
        Work child;
        child.kind = RayKind::reflected;
        child.weight = met.work.weight * share;
        if (!admit(met.work, child)) return;
        child.ray = geometry::spawnRay(met.facing.surface, direction);
        if constexpr (kFeatures.transmission) child.term = scratch_.sums.after(last);
        push(child);
    }

    /// False on total reflection. `last` becomes the term behind which that of the mirrored ray goes:
    /// the refracted ray's own comes after that and its children's, but the light of an opaque surface
    /// in contact comes first.
    bool transmit(const Encounter& met, OrderedSums::Term& last) {
        const Work& work = met.work;
        const Facing& facing = met.facing;
        const material::Material& material = *met.material;
        double ratio = 1; // index in front over index behind
        if (facing.surface.solid) ratio = facing.leaving ? material.ior : 1 / material.ior;
        const Coincident* also = nullptr;
        if (stage_.mayCoincide[static_cast<std::uint32_t>(facing.surface.object)]) {
            findCoincident(stage_, work.ray, met.hit, facing.surface, scratch_.crossings,
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
        child.weight = work.weight * (met.color * material.transmission);
        if (also) child.weight *= also->filter;
        if (!admit(work, child)) return true;
        geometry::Surface from = facing.surface;
        if (also) from.error += also->error;
        child.ray = geometry::spawnRay(from, direction);
        child.term = scratch_.sums.after(last);
        if constexpr (Observer::kActive) observer_.transmitted(child, facing, also);
        if (ends) {
            geometry::Surface end = *also->opaque;
            end.error += from.error;
            if constexpr (Observer::kActive) observer_.starts(child);
            Encounter contact;
            encounter(contact, child, also->opaqueHit, end);
            shine({&contact, 1});
            leave(contact);
            last = child.term;
        } else {
            push(child);
        }
        return true;
    }

    /// Is the child worth a ray?
    bool admit(const Work& parent, Work& child) {
        child.depth = parent.depth + 1;
        child.sample = parent.sample;
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
};

} // namespace rt::trace
