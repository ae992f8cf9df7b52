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
#include <core/numeric/bits.hpp>
#include <core/numeric/elementary.hpp>
#include <core/trace/coincident.hpp>
#include <core/trace/counts.hpp>
#include <core/trace/direction.hpp>
#include <core/trace/ordered_sums.hpp>
#include <core/trace/shadow_terminator.hpp>
#include <core/trace/stage.hpp>
#include <core/trace/wave.hpp>

#include <algorithm>
#include <array>
#include <memory>
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

/// What a ray is traced for, and how much of what it sees reaches the picture.
struct Work {
    LinearRgb weight{1, 1, 1};
    std::uint32_t depth = 0; // bounces so far
    std::uint32_t sample = 0;
    OrderedSums::Term term = 0; // what it contributes to the sample
    std::uint32_t node = 0;     // the observer's number for this ray
    RayKind kind = RayKind::primary;
};

/// A surface as the ray sees it: normals turned toward the ray.
struct Facing {
    geometry::Surface surface;
    Vec3 normal;    // interpolated
    Vec3 geometric; // of the flat primitive
    bool leaving;   // the ray arrives from the inside
};

/// A ray at the surface that it met; numbers are in the wave, under the same index.
struct Encounter {
    Work work;
    geometry::Ray ray; // where something transmits
    geometry::Hit hit;
    geometry::Vec2 uv;
    const geometry::Segment* segment;
    geometry::MaterialId material;
    bool planar;
    std::uint32_t coincident; // in Scratch::coincident, or kNone
};

/// Encounters that are shaded together.
struct Front {
    Wave wave;
    std::vector<Encounter> met;
};

/// Memory of one thread; grows to what the scenes it has met need, then is never allocated again.
struct Scratch {
    struct {
        std::vector<geometry::Ray> rays;
        std::vector<LinearRgb*> colorOf;
    } camera; // of the sampler
    std::vector<geometry::Ray> pendingRays;
    std::vector<Work> pending;       // likewise
    std::vector<geometry::Ray> rays; // of the wave
    std::vector<Work> works;         // likewise
    std::vector<geometry::Hit> hits; // likewise
    std::vector<std::uint8_t> direction;
    std::unique_ptr<Front> front = std::make_unique<Front>();
    std::unique_ptr<Front> contact =
        std::make_unique<Front>(); // one opaque surface that another touches
    std::vector<geometry::Ray> shadowRays;
    std::vector<std::uint32_t> toLight; // by shadow ray: number of the encounter
    std::vector<std::uint8_t> occluded;
    OrderedSums sums;
    std::vector<geometry::Crossing> crossings;
    std::vector<Coincident> coincident; // the first so many are of the front
    std::uint32_t coincidents = 0;
};

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
    /// next call. At most kWave. Fastest when neighbours in the span are neighbours in the picture.
    std::span<const LinearRgb> radiance(std::span<const geometry::Ray> primaries) {
        meetPrimaries(primaries);
        for (;;) {
            Front& front = *scratch_.front;
            scratch_.coincidents = 0;
            surface(front);
            shine(front);
            leave(front);
            if (scratch_.pending.empty()) return scratch_.sums.sums();
            meetPending();
        }
    }

private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

    octree::Visits* visits() const {
        return kFeatures.counting != Counting::none ? &counts_.visits : nullptr;
    }

    void meetPrimaries(std::span<const geometry::Ray> primaries) {
        counts_.primary += primaries.size();
        scratch_.pending.clear();
        scratch_.pendingRays.clear();
        scratch_.sums.start(primaries.size());
        scratch_.hits.resize(primaries.size());
        closest(primaries, scratch_.hits);
        settle(primaries);
        Work work;
        for (std::uint32_t i = 0; i < primaries.size(); ++i) {
            work.sample = i;
            if constexpr (kFeatures.transmission) work.term = scratch_.sums.first(i);
            if constexpr (Observer::kActive) work.node = observer_.primary(work, primaries[i]);
            meet(work, primaries[i], scratch_.hits[i]);
        }
    }

    /// Takes the last works and traces them. Taking the last, at most so many, keeps the memory of those
    /// that wait linear in the depth. The octree traces together what goes in one direction, so they are
    /// sorted (glass.yaml of tests/bench/versus: 1.2 times as fast).
    void meetPending() {
        auto& pending = scratch_.pending;
        auto& pendingRays = scratch_.pendingRays;
        auto& rays = scratch_.rays;
        auto& works = scratch_.works;
        auto& direction = scratch_.direction;
        const std::size_t count = std::min(pending.size(), kWave), first = pending.size() - count;
        std::array<std::uint32_t, kDirections + 1> start{};
        direction.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            direction[i] = directionOf(pendingRays[first + i].direction);
            ++start[direction[i] + 1u];
        }
        for (std::size_t d = 1; d <= kDirections; ++d) start[d] += start[d - 1];
        auto next = start;
        rays.resize(count);
        works.resize(count);
        scratch_.hits.resize(count);
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t to = next[direction[i]]++;
            rays[to] = pendingRays[first + i];
            works[to] = pending[first + i];
        }
        pending.resize(first);
        pendingRays.resize(first);
        for (std::size_t d = 0; d < kDirections; ++d) {
            const std::size_t of = start[d + 1] - start[d];
            if (of > 0)
                closest(std::span<const geometry::Ray>(rays).subspan(start[d], of),
                        std::span(scratch_.hits).subspan(start[d], of));
        }
        settle(rays);
        for (std::size_t i = 0; i < count; ++i) meet(works[i], rays[i], scratch_.hits[i]);
    }

    static constexpr std::size_t kDirections = 24;

    /// Signs and largest component: what the rays of one bundle of the octree have in common.
    static std::uint8_t directionOf(const Vec3& d) {
        const double x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
        const unsigned axis = x > y && x > z ? 0 : y > z ? 1 : 2;
        return static_cast<std::uint8_t>(axis << 3 | unsigned(d.x < 0) << 2 |
                                         unsigned(d.y < 0) << 1 | unsigned(d.z < 0));
    }

    void closest(std::span<const geometry::Ray> rays, std::span<geometry::Hit> hits) {
        if constexpr (kFeatures.counting == Counting::rays) {
            for (std::size_t i = 0; i < rays.size(); ++i)
                hits[i] = stage_.octree.closest(rays[i], visits());
        } else {
            stage_.octree.closest(rays, hits, octree::Coherence::coherent, visits());
        }
    }

    void settle(std::span<const geometry::Ray> rays) {
        stage_.settle(rays, scratch_.hits, scratch_.crossings, visits());
        geometry::prefetchSurfaces(stage_.world.primitives, scratch_.hits);
        scratch_.front->met.clear();
    }

    /// scratch_.occluded of scratch_.shadowRays.
    void occluded() {
        const auto& rays = scratch_.shadowRays;
        scratch_.occluded.resize(rays.size());
        if constexpr (kFeatures.counting == Counting::rays) {
            for (std::size_t i = 0; i < rays.size(); ++i)
                scratch_.occluded[i] = stage_.octree.occluded(rays[i], visits());
        } else {
            stage_.octree.occluded(rays, scratch_.occluded, octree::Coherence::coherent, visits());
        }
    }

    void meet(const Work& work, const geometry::Ray& ray, const geometry::Hit& hit) {
        if (!hit) {
            const LinearRgb seen = stage_.background.seenBy(ray);
            if constexpr (Observer::kActive) observer_.miss(work, seen);
            return contribute(work, seen);
        }
        Front& front = *scratch_.front;
        const auto& primitives = stage_.world.primitives;
        const geometry::Segment& segment = primitives.segmentOf(hit.id);
        if (segment.kind == geometry::Kind::sphere && meetSphere(front, work, ray, hit, segment))
            return;
        const geometry::Surface surface = geometry::surfaceAt(primitives, ray, hit);
        if (work.kind == RayKind::primary && startsOn(surface, ray, hit))
            return meetBeyond(work, ray, surface);
        encounter(front, work, ray, hit, surface);
    }

    /// False where the kernel's arithmetic would leave the normal numbers.
    bool meetSphere(Front& front, const Work& work, const geometry::Ray& ray,
                    const geometry::Hit& hit, const geometry::Segment& segment) {
        const geometry::Sphere& sphere =
            geometry::sphereOf(stage_.world.primitives, segment, hit.id);
        const Vec3 fromCenter = (ray.origin - sphere.center) + hit.t * ray.direction;
        if (!numeric::bits::isModerate(numeric::bits::maxComponent(numeric::abs(fromCenter))))
            return false;
        const std::size_t i = front.met.size();
        Wave& wave = front.wave;
        put(wave.direction, i, ray.direction);
        put(wave.geometric, i, fromCenter);
        put(wave.center, i, sphere.center);
        wave.radius.at[i] = sphere.radius;
        wave.isSphere.at[i] = -1;
        Encounter& met = front.met.emplace_back();
        met.work = work;
        if constexpr (kFeatures.transmission) met.ray = ray;
        met.hit = hit;
        met.segment = &segment;
        met.material = segment.material;
        met.planar = false;
        return true;
    }

    void encounter(Front& front, const Work& work, const geometry::Ray& ray,
                   const geometry::Hit& hit, const geometry::Surface& surface) {
        const std::size_t i = front.met.size();
        Wave& wave = front.wave;
        put(wave.direction, i, ray.direction);
        put(wave.position, i, surface.position);
        put(wave.geometric, i, surface.geometricNormal);
        put(wave.normal, i, surface.shadingNormal);
        wave.error.at[i] = surface.error;
        wave.errorBeside.at[i] = std::max(surface.error, stage_.ties.errorBesideOf(surface.id));
        wave.isSphere.at[i] = 0;
        Encounter& met = front.met.emplace_back();
        met.work = work;
        if constexpr (kFeatures.transmission) met.ray = ray;
        met.hit = hit;
        met.uv = surface.uv;
        met.segment = surface.segment;
        met.material = surface.material;
        met.planar = surface.planar;
    }

    /// An eye in the plane of a face, by its error bound, does not see that face. (A ray that was slid into the scene's
    /// box does see what lies in the box's side.)
    bool startsOn(const geometry::Surface& surface, const geometry::Ray& ray,
                  const geometry::Hit& hit) const {
        return surface.planar && stage_.box.unbounded() &&
               hit.t * std::fabs(dot(ray.direction, surface.geometricNormal)) <= surface.error;
    }

    void meetBeyond(const Work& work, const geometry::Ray& ray, const geometry::Surface& surface) {
        geometry::Ray beyond = geometry::spawnRay(surface, ray.direction);
        beyond.tMax = ray.tMax;
        geometry::Hit hit = stage_.octree.closest(beyond, visits());
        stage_.settle({&beyond, 1}, {&hit, 1}, scratch_.crossings, visits());
        meet(work, beyond, hit);
    }

    /// All that the ray itself adds, when its children have their terms.
    void contribute(const Work& work, const LinearRgb& light) {
        if constexpr (kFeatures.transmission)
            scratch_.sums.settle(work.sample, work.term, work.weight * light);
        else // one child at most: they come in order
            scratch_.sums.add(work.sample, work.weight * light);
    }

    const material::Material& materialOf(const Encounter& met) const {
        return stage_.world.materials[static_cast<std::uint32_t>(met.material)];
    }

    /// The surface of an encounter, from the wave; its error is the doubled one.
    geometry::Surface surfaceOf(const Front& front, std::size_t i) const {
        const Encounter& met = front.met[i];
        const Wave& wave = front.wave;
        const double side = wave.leaving.at[i] ? -1 : 1;
        geometry::Surface s;
        s.position = at(wave.position, i);
        s.error = wave.error.at[i];
        s.geometricNormal = at(wave.geometric, i) * side;
        s.shadingNormal = at(wave.normal, i) * side;
        s.uv = met.uv;
        s.segment = met.segment;
        s.id = met.hit.id;
        s.object = met.segment->object;
        s.material = met.material;
        s.solid = met.segment->solid;
        s.planar = met.planar;
        return s;
    }

    Facing facingOf(const Front& front, std::size_t i) const {
        return {surfaceOf(front, i), at(front.wave.normal, i), at(front.wave.geometric, i),
                front.wave.leaving.at[i] != 0};
    }

    /// Surfaces and their colors.
    void surface(Front& front) {
        Wave& wave = front.wave;
        kernel_.face(wave, front.met.size());
        for (std::size_t i = 0; i < front.met.size(); ++i) {
            const Encounter& met = front.met[i];
            const material::Material& material = materialOf(met);
            if constexpr (kFeatures.counting != Counting::none)
                ++counts_.hits[static_cast<std::size_t>(met.segment->kind)];
            LinearRgb color = material.color;
            if (material.colorTexture) color = colorAt(stage_.world, material, surfaceOf(front, i));
            put(wave.diffuse, i, color * material.diffuse);
            put(wave.environment, i, material.environment);
            put(wave.specular, i, material.specular);
            put(wave.color, i, color);
            put(wave.weight, i, met.work.weight);
            if constexpr (kFeatures.transmission) put(wave.transmission, i, material.transmission);
            put(wave.light, i, LinearRgb{});
            if constexpr (Observer::kActive)
                observer_.hit(met.work, met.hit, facingOf(front, i), material, color);
        }
    }

    /// Sums the lights up.
    void shine(Front& front) {
        Wave& wave = front.wave;
        const std::size_t count = front.met.size();
        auto& rays = scratch_.shadowRays;
        auto& toLight = scratch_.toLight;
        for (const Light& light : stage_.lights) {
            kernel_.aim(wave, count, &light.position.x);
            rays.resize(count);
            toLight.resize(count);
            std::size_t used = 0;
            for (std::uint32_t i = 0; i < count; ++i) {
                put(wave.visible, i, LinearRgb{});
                wave.power.at[i] = 0;
                toLight[used] = i;
                used += aim(light, front, i, rays[used]);
            }
            rays.resize(used);
            toLight.resize(used);
            counts_.shadow += used;
            occluded();
            if constexpr (kFeatures.counting != Counting::none)
                for (const std::uint8_t blocked : scratch_.occluded) counts_.blocked += blocked;
            for (std::size_t ray = 0; ray < rays.size(); ++ray)
                see(light, front, toLight[ray], ray);
            kernel_.add(wave, count);
            if constexpr (Observer::kActive)
                for (const std::uint32_t i : toLight)
                    observer_.light(front.met[i].work, light, colorAt(wave.visible, i),
                                    colorAt(wave.added, i));
        }
    }

    /// The shadow ray; false where the light cannot matter.
    bool aim(const Light& light, const Front& front, std::uint32_t i, geometry::Ray& ray) const {
        const Wave& wave = front.wave;
        const Encounter& met = front.met[i];
        const double cosine = wave.cosine.at[i];
        const Lit lit = stage_.lit[static_cast<std::uint32_t>(met.material)];
        if (!(cosine > 0 ? lit.front : cosine == 0 && lit.back)) return false;
        const auto& triangles = stage_.world.primitives.triangles;
        if (cosine > 0 && met.segment->kind == geometry::Kind::triangle &&
            !triangles.normalIndices.empty() && at(wave.normal, i) != at(wave.geometric, i)) {
            geometry::Surface smoothed = surfaceOf(front, i);
            smoothed.position = smoothPosition(stage_.world.primitives, smoothed, met.hit,
                                               wave.leaving.at[i] ? -1 : 1);
            ray = geometry::spawnRayTo(smoothed, light.position);
        } else {
            ray = {at(wave.shadowOrigin, i), 1, at(wave.shadowDirection, i),
                   met.planar ? met.hit.id : geometry::kNoPrimitive};
        }
        stage_.box.clipEnd(ray);
        return true;
    }

    /// What is seen of the light along its shadow ray, by number.
    void see(const Light& light, Front& front, std::uint32_t i, std::size_t ray) {
        Wave& wave = front.wave;
        LinearRgb visible = light.color;
        if (scratch_.occluded[ray]) {
            if constexpr (!kFeatures.transmission) return;
            visible = filtered(light, scratch_.shadowRays[ray]);
        }
        const material::Material& material = materialOf(front.met[i]);
        const bool behind = wave.cosine.at[i] == 0;
        if (behind)
            visible *= material.transmission;
        else if (wave.halfway.at[i] > 0 && material.isMirror() && !visible.isBlack())
            wave.power.at[i] = numeric::pow(std::min(wave.halfway.at[i], 1.0), material.shininess);
        put(wave.visible, i, visible);
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

    /// The surfaces are lit: sends off what they reflect and refract.
    void leave(Front& front) {
        Wave& wave = front.wave;
        const std::size_t count = front.met.size();
        bool sends = false, transmits = false;
        for (std::size_t i = 0; i < count; ++i) {
            const material::Material& material = materialOf(front.met[i]);
            sends |= material.isMirror();
            if constexpr (kFeatures.transmission) {
                transmits |= !material.isOpaque();
                prepareToBend(front, i, material);
            }
        }
        if (transmits) kernel_.refract(wave, count);
        if (sends || transmits) kernel_.mirror(wave, count, transmits);
        for (std::size_t i = 0; i < count; ++i) {
            const Encounter& met = front.met[i];
            const material::Material& material = materialOf(met);
            OrderedSums::Term last = met.work.term;
            bool mirrors = material.isMirror();
            if constexpr (kFeatures.transmission)
                if (!material.isOpaque()) {
                    if (wave.passes.at[i])
                        transmit(front, i, last);
                    else
                        mirrors = true;
                }
            if (mirrors) reflect(front, i, last);
            contribute(met.work, colorAt(wave.light, i));
        }
    }

    /// Its term goes behind `last`.
    void reflect(const Front& front, std::size_t i, OrderedSums::Term last) {
        const Encounter& met = front.met[i];
        const Wave& wave = front.wave;
        Work child;
        child.kind = RayKind::reflected;
        child.weight = colorAt(wave.mirroredWeight, i);
        if (!admit(met.work, child)) return;
        if constexpr (kFeatures.transmission) child.term = scratch_.sums.after(last);
        push(child, {at(wave.mirroredOrigin, i), numeric::kInfinity, at(wave.mirrored, i),
                     met.planar ? met.hit.id : geometry::kNoPrimitive});
    }

    /// The ratio of indices at a surface, and what coincides with it.
    void prepareToBend(Front& front, std::size_t i, const material::Material& material) {
        Encounter& met = front.met[i];
        Wave& wave = front.wave;
        met.coincident = kNone;
        wave.ratio.at[i] = 1;
        wave.refractedError.at[i] = wave.error.at[i];
        if (material.isOpaque()) return;
        if (met.segment->solid)
            wave.ratio.at[i] = wave.leaving.at[i] ? material.ior : 1 / material.ior;
        if (!stage_.mayCoincide[static_cast<std::uint32_t>(met.segment->object)]) return;
        met.coincident = scratch_.coincidents++;
        if (met.coincident == scratch_.coincident.size()) scratch_.coincident.emplace_back();
        Coincident& also = scratch_.coincident[met.coincident];
        findCoincident(stage_, met.ray, met.hit, surfaceOf(front, i), scratch_.crossings, also,
                       visits());
        wave.ratio.at[i] *= also.indexRatio;
        if (also.opaque) wave.ratio.at[i] = 1; // in contact: nothing between that could bend it
        wave.refractedError.at[i] += also.error;
    }

    /// `last` becomes the term behind which that of the mirrored ray goes: the refracted ray's own comes
    /// after that and its children's, but the light of an opaque surface in contact comes first.
    void transmit(const Front& front, std::size_t i, OrderedSums::Term& last) {
        const Encounter& met = front.met[i];
        const Wave& wave = front.wave;
        const Coincident* const also =
            met.coincident == kNone ? nullptr : &scratch_.coincident[met.coincident];
        Work child;
        child.kind = RayKind::refracted;
        child.weight = colorAt(wave.refractedWeight, i);
        if (also) child.weight *= also->filter;
        if (!admit(met.work, child)) return;
        const geometry::Ray ray{at(wave.refractedOrigin, i), numeric::kInfinity,
                                at(wave.refracted, i),
                                met.planar ? met.hit.id : geometry::kNoPrimitive};
        child.term = scratch_.sums.after(last);
        if constexpr (Observer::kActive) observer_.transmitted(child, facingOf(front, i), also);
        if (!also || !also->opaque) return push(child, ray);
        if constexpr (Observer::kActive) observer_.starts(child, ray);
        geometry::Surface end = *also->opaque;
        end.error += wave.refractedError.at[i];
        Front& contact = *scratch_.contact;
        contact.met.clear();
        encounter(contact, child, ray, also->opaqueHit, end);
        surface(contact);
        shine(contact);
        leave(contact);
        last = child.term;
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

    void push(const Work& child, geometry::Ray ray) {
        ++(child.kind == RayKind::reflected ? counts_.reflected : counts_.refracted);
        counts_.deepest = std::max(counts_.deepest, child.depth);
        stage_.box.clipEnd(ray);
        if constexpr (Observer::kActive) observer_.starts(child, ray);
        scratch_.pending.push_back(child);
        scratch_.pendingRays.push_back(ray);
    }

    const Stage& stage_;
    Scratch& scratch_;
    RayCounts& counts_;
    Observer& observer_;
    const WaveKernel& kernel_ = waveKernel();
};

} // namespace rt::trace
