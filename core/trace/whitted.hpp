// The light along a ray, after T. Whitted, An Improved Illumination Model for Shaded Display, CACM 23(6), 1980.
//
//   C = sum over lights of color diffuse max(0, L.N) S + specular (H.N)^s S + environment S
//       + color transmission T + color specular R
//
// L unit to the light, N the normal toward the viewer, H halfway between L and the viewer, S the
// light's color times the transmission of every surface between; R and T what the mirrored and the
// refracted ray see. On total reflection transmission joins specular. A light on the far side of the
// surface reaches the viewer through it: opaque, S is 0; otherwise the surface itself is one of those
// between, and only the environment term is left. S is not asked for where it could show nothing but
// a highlight below 2^-53.
//
// ior is a ratio at each surface, inside over outside. So a ray needs no memory of what it is in:
// nested solids refract as the product of the ratios that were crossed, in whatever order.
//
// Rays are traced in generations: all camera rays of a batch, then all their shadow rays to one light,
// then what they reflect and refract. What a ray contributes does not depend on its batch, and
// PathSums adds it up in an order that does not either.
#pragma once
#include <core/numeric/bits.hpp>
#include <core/numeric/elementary.hpp>
#include <core/trace/coincident.hpp>
#include <core/trace/counts.hpp>
#include <core/trace/direction.hpp>
#include <core/trace/front.hpp>
#include <core/trace/shadow_terminator.hpp>
#include <core/trace/stage.hpp>
#include <core/trace/wave.hpp>

#include <algorithm>
#include <span>
#include <tuple>

namespace rt::trace {

/// Are visits of the octree counted, and of what? Rays that are traced together visit together; `rays`
/// traces each alone, so that the sum over them is what each costs.
enum class Counting : std::uint8_t { none, batches, rays };

/// What the rays of a render can meet; one kernel is compiled for each.
struct Features {
    bool transmission; // some surface lets light through
    Counting counting;
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

    /// The linear light along each ray, of unit direction and clipped to the scene's box; until the
    /// next call. Fastest for many, of which neighbours in the span are neighbours in the picture.
    /// A ray that starts on a face is moved to its other side.
    std::span<const LinearRgb> radiance(std::span<geometry::Ray> primaries) {
        start(primaries);
        for (std::size_t traced = 0;;) {
            // Full waves as long as there are rays for them.
            if (traced < primaries.size() && scratch_.pending.size() < kWave) {
                const std::size_t count = std::min(kWave, primaries.size() - traced);
                tracePrimaries(primaries.subspan(traced, count), traced);
                traced += count;
            } else if (!scratch_.pending.empty()) {
                tracePending();
            } else {
                return scratch_.sums.sums();
            }
            Front& front = *scratch_.front;
            scratch_.coincidents = 0;
            room(scratch_.children, 2 * front.count);
            scratch_.childCount = 0;
            scratch_.childrenByDirection.start();
            surface(front);
            shine(front);
            leave(front);
            sendOff(front);
            scratch_.sums.foldTo(std::max(static_cast<PathSums::Term>(primaries.size()),
                                          scratch_.pending.termsEnd()));
        }
    }

private:
    octree::Visits* visits() const {
        return kFeatures.counting != Counting::none ? &counts_.visits : nullptr;
    }

    void start(std::span<const geometry::Ray> primaries) {
        counts_.primary += primaries.size();
        scratch_.pending.clear();
        scratch_.sums.start(primaries.size());
        auto& works = scratch_.primaries;
        while (works.size() < primaries.size()) {
            Work work;
            work.term = static_cast<std::uint32_t>(works.size());
            works.push_back(work);
        }
        if constexpr (Observer::kActive)
            for (std::size_t i = 0; i < primaries.size(); ++i)
                works[i].node = observer_.primary(works[i], primaries[i]);
    }

    /// `rays` are those of the samples from `first` on.
    void tracePrimaries(std::span<geometry::Ray> rays, std::size_t first) {
        const auto hits = room(scratch_.hits, rays.size());
        closest(rays, hits);
        meet({std::span(scratch_.primaries).subspan(first, rays.size()), rays, hits});
    }

    void tracePending() {
        const auto [rays, works, groups] = scratch_.pending.take();
        const auto hits = room(scratch_.hits, rays.size());
        forEachRun(
            rays.size(), [groups = groups](std::size_t i) { return groups[i]; },
            [&, rays = rays](std::size_t first, std::size_t count) {
                closest(rays.subspan(first, count), hits.subspan(first, count));
            });
        meet({works, rays, hits});
    }

    void closest(std::span<const geometry::Ray> rays, std::span<geometry::Hit> hits) {
        if constexpr (kFeatures.counting == Counting::rays) {
            for (std::size_t i = 0; i < rays.size(); ++i)
                hits[i] = stage_.octree.closest(rays[i], visits());
        } else {
            stage_.octree.closest(rays, hits, octree::Coherence::coherent, visits());
        }
    }

    void occluded(std::span<const geometry::Ray> rays, std::span<std::uint8_t> answers) {
        if constexpr (kFeatures.counting == Counting::rays) {
            for (std::size_t i = 0; i < rays.size(); ++i)
                answers[i] = stage_.octree.occluded(rays[i], visits());
        } else {
            stage_.octree.occluded(rays, answers, octree::Coherence::coherent, visits());
        }
    }

    /// The front of a batch. Rays to which the same happens come together: what the code below asks of
    /// each is then foretold.
    void meet(const Batch& batch) {
        stage_.settle(batch.rays, batch.hits, scratch_.crossings, visits());
        const auto& primitives = stage_.world.primitives;
        geometry::prefetchSurfaces(primitives, batch.hits);
        const std::size_t count = batch.rays.size();
        const geometry::Hit* const hits = batch.hits.data();
        const geometry::Segment** const segments = room(scratch_.segments, count).data();
        std::uint8_t* const ranks = room(scratch_.ranks, count).data();
        std::uint32_t* const sorted = room(scratch_.sorted, count).data();
        Groups<kRanks> byRank;
        byRank.start();
        for (std::size_t i = 0; i < count; ++i) {
            std::uint8_t rank = kRankOfMisses;
            if (hits[i]) {
                segments[i] = &primitives.segmentOf(hits[i].id);
                rank = stage_.rankOf(*segments[i], hits[i].id);
            }
            ranks[i] = rank;
            byRank.note(rank);
        }
        byRank.order();
        for (std::uint32_t i = 0; i < count; ++i) sorted[byRank.placeIn(ranks[i])] = i;

        Front& front = *scratch_.front;
        front.start(batch);
        byRank.forEachGroup([&](std::size_t rank, std::size_t first, std::size_t size) {
            const std::span rays(sorted + first, size);
            const auto kind = static_cast<geometry::Kind>(rank & kKindOfRank);
            if (rank == kRankOfMisses)
                for (const std::uint32_t i : rays) miss(batch, i);
            else if (kind == geometry::Kind::sphere)
                for (const std::uint32_t i : rays) meetSphere(front, i, *segments[i]);
            else if (kind == geometry::Kind::parallelogram && !stage_.planes.empty())
                for (const std::uint32_t i : rays) meetParallelogram(front, i, *segments[i]);
            else
                for (const std::uint32_t i : rays) meetOther(front, i, *segments[i]);
        });
    }

    void miss(const Batch& batch, std::uint32_t i) {
        const LinearRgb seen = stage_.background.seenBy(batch.rays[i]);
        if constexpr (Observer::kActive) observer_.miss(batch.works[i], seen);
        contribute(batch.works.data()[i], seen);
    }

    void meetSphere(Front& front, std::uint32_t i, const geometry::Segment& segment) {
        const geometry::PrimitiveId id = front.batch.hits.data()[i].id;
        front.wave.sphere[front.count] = &geometry::sphereOf(stage_.world.primitives, segment, id);
        add(front, i, segment, segment.material, geometry::kNoPrimitive);
    }

    /// As meetOther, faster.
    void meetParallelogram(Front& front, std::uint32_t i, const geometry::Segment& segment) {
        const geometry::Ray& ray = front.batch.rays.data()[i];
        const geometry::Hit& hit = front.batch.hits.data()[i];
        const std::uint32_t index = segment.index + static_cast<std::uint32_t>(hit.id) -
                                    static_cast<std::uint32_t>(segment.first);
        const geometry::Plane& plane = stage_.planes.data()[index];
        const double height = std::fabs(hit.t * dot(ray.direction, plane.normal));
        if (!(height > plane.error)) return meetOther(front, i, segment); // see startsOn
        Wave& wave = front.wave;
        const std::size_t at = front.count;
        put(wave.position, at,
            geometry::pointOn(stage_.world.primitives.parallelograms.data()[index], hit));
        put(wave.geometric, at, plane.normal);
        put(wave.normal, at, plane.normal);
        wave.error.at[at] = plane.error;
        wave.errorBeside.at[at] = std::max(plane.error, stage_.ties.errorBesideOf(hit.id));
        wave.sphere[at] = &kNoSphere;
        front.met[at].uv = {hit.u, hit.v};
        add(front, i, segment, segment.material, hit.id);
    }

    void meetOther(Front& front, std::uint32_t i, const geometry::Segment& segment) {
        const geometry::Ray& ray = front.batch.rays[i];
        const geometry::Hit& hit = front.batch.hits[i];
        const geometry::Surface surface =
            geometry::surfaceAt(stage_.world.primitives, ray, hit, segment);
        if (front.batch.works[i].depth == 0 && startsOn(surface, ray, hit))
            meetBeyond(front, i, surface);
        else
            encounter(front, i, surface);
    }

    void encounter(Front& front, std::uint32_t i, const geometry::Surface& surface) {
        putSurface(front, front.count, surface);
        add(front, i, *surface.segment, surface.material,
            surface.planar ? surface.id : geometry::kNoPrimitive);
    }

    void putSurface(Front& front, std::size_t at, const geometry::Surface& surface) {
        Wave& wave = front.wave;
        put(wave.position, at, surface.position);
        put(wave.geometric, at, surface.geometricNormal);
        put(wave.normal, at, surface.shadingNormal);
        wave.error.at[at] = surface.error;
        wave.errorBeside.at[at] = std::max(surface.error, stage_.ties.errorBesideOf(surface.id));
        wave.sphere[at] = &kNoSphere;
        front.met[at].uv = surface.uv;
    }

    /// The rest of an encounter.
    void add(Front& front, std::uint32_t i, const geometry::Segment& segment,
             geometry::MaterialId id, geometry::PrimitiveId exclude) {
        const std::size_t at = front.count++;
        const material::Material& material =
            stage_.world.materials.data()[static_cast<std::uint32_t>(id)];
        Encounter& met = front.met[at];
        met.segment = &segment;
        met.material = id;
        met.coincident = kNoCoincident;
        Wave& wave = front.wave;
        wave.ray[at] = i;
        wave.material[at] = &material;
        wave.exclude.at[at] = static_cast<std::uint32_t>(exclude);
        const bool transmits = !material.isOpaque();
        wave.bends.at[at] = -static_cast<std::int64_t>(transmits && segment.solid);
        if (transmits) front.transmitters = std::min(front.transmitters, at);
        if (transmits || material.isMirror()) front.senders = std::min(front.senders, at);
        if constexpr (kFeatures.counting != Counting::none)
            ++counts_.hits[static_cast<std::size_t>(segment.kind)];
    }

    /// An eye in the plane of a face, by its error bound, does not see that face. (A ray that was slid into the scene's
    /// box does see what lies in the box's side.)
    bool startsOn(const geometry::Surface& surface, const geometry::Ray& ray,
                  const geometry::Hit& hit) const {
        return surface.planar && stage_.box.unbounded() &&
               hit.t * std::fabs(dot(ray.direction, surface.geometricNormal)) <= surface.error;
    }

    void meetBeyond(Front& front, std::uint32_t i, const geometry::Surface& surface) {
        geometry::Ray& ray = front.batch.rays[i];
        geometry::Hit& hit = front.batch.hits[i];
        const double tMax = ray.tMax;
        ray = geometry::spawnRay(surface, ray.direction);
        ray.tMax = tMax;
        hit = stage_.octree.closest(ray, visits());
        stage_.settle({&ray, 1}, {&hit, 1}, scratch_.crossings, visits());
        if (!hit) return miss(front.batch, i);
        meetOther(front, i, stage_.world.primitives.segmentOf(hit.id));
    }

    /// All that the ray itself adds.
    void contribute(const Work& work, const LinearRgb& light) {
        scratch_.sums.add(work.term, work.weight * light);
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
        s.id = front.hitOf(i).id;
        s.object = met.segment->object;
        s.material = met.material;
        s.solid = met.segment->solid;
        s.planar = excludeOf(front, i) != geometry::kNoPrimitive;
        return s;
    }

    static geometry::PrimitiveId excludeOf(const Front& front, std::size_t i) {
        return static_cast<geometry::PrimitiveId>(front.wave.exclude.at[i]);
    }

    Facing facingOf(const Front& front, std::size_t i) const {
        return {surfaceOf(front, i), at(front.wave.normal, i), at(front.wave.geometric, i),
                front.wave.leaving.at[i] != 0};
    }

    /// Surfaces and their colors.
    void surface(Front& front) {
        Wave& wave = front.wave;
        for (std::size_t i = front.count; i % kMostLanes != 0; ++i) {
            wave.ray[i] = wave.ray[front.count - 1];
            wave.material[i] = wave.material[front.count - 1];
            wave.sphere[i] = wave.sphere[front.count - 1];
        }
        const Batch& batch = front.batch;
        if (kernel_.gather(wave, front.count, batch.rays.data(), batch.hits.data(),
                           batch.works.data()))
            meetExtremeSpheres(front);
        kernel_.face(wave, front.count);
        texture(front);
        if constexpr (Observer::kActive)
            for (std::size_t i = 0; i < front.count; ++i)
                observer_.hit(front.workOf(i), front.hitOf(i), facingOf(front, i),
                              *front.wave.material[i], colorAt(front.wave.color, i));
    }

    /// Spheres that the kernels cannot deal with become surfaces like any other.
    void meetExtremeSpheres(Front& front) {
        const Wave& wave = front.wave;
        for (std::size_t i = 0; i < front.count; ++i) {
            if (wave.sphere[i] == &kNoSphere) continue;
            const Vec3 fromCenter = at(wave.geometric, i);
            if (numeric::bits::isModerate(numeric::bits::maxComponent(numeric::abs(fromCenter))))
                continue;
            putSurface(front, i,
                       geometry::surfaceAt(stage_.world.primitives, front.rayOf(i), front.hitOf(i),
                                           *front.met[i].segment));
        }
    }

    rt_surface_point texturePoint(const Front& front, std::size_t i) const {
        const Encounter& met = front.met[i];
        const Vec3 position = at(front.wave.position, i);
        const Vec3 object = stage_.world.objectPoint(met.segment->object, position);
        const geometry::Vec2 uv = met.segment->kind == geometry::Kind::sphere
                                      ? geometry::uvOf(surfaceOf(front, i))
                                      : met.uv;
        return {{uv.x, uv.y}, {object.x, object.y, object.z}, {position.x, position.y, position.z}};
    }

    /// The colors of those that have a texture, run by run.
    void texture(Front& front) {
        const material::Material* const* const materials = front.wave.material;
        const auto materialOf = [materials](std::size_t i) { return materials[i]; };
        forEachRun(front.count, materialOf, [&](std::size_t first, std::size_t count) {
            const material::Material& material = *materials[first];
            const material::Texture* const texture = material.colorTexture;
            if (!texture) return;
            const auto points = room(scratch_.texturePoints, count);
            const auto colors = room(scratch_.textureColors, 3 * count);
            for (std::size_t k = 0; k < count; ++k) points[k] = texturePoint(front, first + k);
            std::fill(colors.begin(), colors.end(), 0.0);
            texture->type->evaluate(texture->state, points.data(),
                                    static_cast<std::uint32_t>(count), colors.data());
            for (std::size_t k = 0; k < count; ++k) {
                const double* const rgb = &colors[3 * k];
                put(front.wave.color, first + k,
                    material.color * LinearRgb{rgb[0], rgb[1], rgb[2]});
            }
        });
    }

    /// Sums the lights up.
    void shine(Front& front) {
        Wave& wave = front.wave;
        for (const Light& light : stage_.lights) {
            kernel_.aim(wave, front.count, &light.position.x);
            aim(light, front);
            see(light, front);
            kernel_.add(wave, front.count, kFeatures.transmission);
            if constexpr (Observer::kActive)
                for (const std::uint32_t i : room(scratch_.toLight, scratch_.shadowCount))
                    observer_.light(front.workOf(i), light, colorAt(wave.visible, i),
                                    colorAt(wave.added, i));
        }
    }

    /// The shadow rays, sorted by direction, of the encounters where the light can matter.
    void aim(const Light& light, const Front& front) {
        const Wave& wave = front.wave;
        const auto wanted = room(scratch_.sorted, front.count);
        auto& byDirection = scratch_.shadowsByDirection;
        byDirection.start();
        std::size_t count = 0;
        for (std::uint32_t i = 0; i < front.count; ++i) {
            const double cosine = wave.cosine.at[i];
            const Lit lit = stage_.lit.data()[static_cast<std::uint32_t>(front.met[i].material)];
            const bool highlit = wave.halfway.at[i] >= lit.highlight;
            const bool matters =
                ((cosine > 0) & (lit.front | highlit)) | ((cosine == 0) & lit.back);
            wanted[count] = i;
            count += matters;
            byDirection.note(static_cast<std::size_t>(wave.shadow.group.at[i]), matters);
        }
        counts_.shadow += count;
        scratch_.shadowCount = count;
        byDirection.order();
        geometry::Ray* const rays = room(scratch_.shadowRays, count).data();
        std::uint32_t* const toLight = room(scratch_.toLight, count).data();
        const bool anySmooth = !stage_.world.primitives.triangles.normalIndices.empty();
        for (std::size_t k = 0; k < count; ++k) {
            const std::uint32_t i = wanted[k];
            const std::uint32_t to =
                byDirection.placeIn(static_cast<std::size_t>(wave.shadow.group.at[i]));
            toLight[to] = i;
            rays[to] = wave.shadow.ray[i];
            if (anySmooth && front.met[i].segment->kind == geometry::Kind::triangle)
                aimSmooth(light, front, i, rays[to]);
            stage_.box.clipEnd(rays[to]);
        }
    }

    /// The shadow ray of a surface that is flat but shaded as if it were not.
    void aimSmooth(const Light& light, const Front& front, std::uint32_t i,
                   geometry::Ray& ray) const {
        const Wave& wave = front.wave;
        const auto& primitives = stage_.world.primitives;
        if (!(wave.cosine.at[i] > 0) || at(wave.normal, i) == at(wave.geometric, i)) return;
        geometry::Surface smoothed = surfaceOf(front, i);
        smoothed.position =
            smoothPosition(primitives, smoothed, front.hitOf(i), wave.leaving.at[i] ? -1 : 1);
        ray = geometry::spawnRayTo(smoothed, light.position);
    }

    /// What is seen of the light along its shadow rays.
    void see(const Light& light, Front& front) {
        const std::span<const geometry::Ray> rays = room(scratch_.shadowRays, scratch_.shadowCount);
        const auto blocked = room(scratch_.occluded, rays.size());
        scratch_.shadowsByDirection.forEachGroup(
            [&](std::size_t, std::size_t first, std::size_t count) {
                const auto some = rays.subspan(first, count);
                if constexpr (kFeatures.transmission)
                    seeThrough(light, front, first, some);
                else
                    occluded(some, blocked.subspan(first, count));
            });
        if constexpr (kFeatures.transmission) return;
        const LinearRgb seen[2] = {light.color, {}};
        for (std::size_t k = 0; k < rays.size(); ++k) {
            if constexpr (kFeatures.counting != Counting::none) counts_.blocked += blocked[k];
            put(front.wave.visible, scratch_.toLight.data()[k], seen[blocked[k]]);
        }
    }

    /// The light's color after all that some shadow rays, from number `first` on, cross.
    void seeThrough(const Light& light, Front& front, std::size_t first,
                    std::span<const geometry::Ray> rays) {
        if constexpr (kFeatures.counting == Counting::rays)
            if (rays.size() > 1) {
                for (std::size_t i = 0; i < rays.size(); ++i)
                    seeThrough(light, front, first + i, rays.subspan(i, 1));
                return;
            }
        octree::CrossingLists& crossed = scratch_.crossed;
        stage_.octree.crossings(rays, stage_.opaque, crossed, visits());
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const bool ended = crossed.isEnded(i);
            LinearRgb visible = ended ? LinearRgb{} : light.color;
            for (const geometry::Crossing& crossing : crossed.of(i)) {
                const auto id = geometry::materialOf(stage_.world.primitives, crossing.id);
                visible *=
                    stage_.world.materials.data()[static_cast<std::uint32_t>(id)].transmission;
            }
            if constexpr (kFeatures.counting != Counting::none)
                counts_.blocked += ended || !crossed.of(i).empty();
            put(front.wave.visible, scratch_.toLight.data()[first + i], visible);
        }
    }

    /// The surfaces are lit: notes what they reflect and refract.
    void leave(Front& front) {
        Wave& wave = front.wave;
        const std::size_t count = front.count;
        if constexpr (kFeatures.transmission)
            if (front.transmitters < count) {
                kernel_.bend(wave, front.transmitters, count);
                if (stage_.anyMayCoincide)
                    for (std::size_t i = front.transmitters; i < count; ++i) coincide(front, i);
            }
        if (front.senders < count) kernel_.leave(wave, front.senders, front.transmitters, count);
        for (std::size_t i = front.senders; i < count; ++i) {
            const std::int64_t sends = wave.sends.at[i];
            if constexpr (kFeatures.transmission)
                if (sends & Sends::kRefracts) transmit(front, i, sends);
            if (sends & Sends::kReflects) reflect(front, i, sends);
        }
        for (std::size_t i = 0; i < count; ++i) {
            const LinearRgb light = colorAt(wave.light, i);
            if (!light.isBlack()) contribute(front.workOf(i), light); // clear ones mostly are
        }
    }

    void reflect(const Front& front, std::size_t i, std::int64_t sends) {
        Child* const child = admit(front, i, RayKind::reflected, sends & Sends::kReflectedBlack);
        if (!child) return;
        ++counts_.reflected;
        note(front, *child);
    }

    /// What coincides with a surface that may let light through.
    void coincide(Front& front, std::size_t i) {
        Encounter& met = front.met[i];
        Wave& wave = front.wave;
        if (wave.material[i]->isOpaque() ||
            !stage_.mayCoincide[static_cast<std::uint32_t>(met.segment->object)])
            return;
        met.coincident = scratch_.coincidents++;
        if (met.coincident == scratch_.coincident.size()) scratch_.coincident.emplace_back();
        Coincident& also = scratch_.coincident[met.coincident];
        findCoincident(stage_, front.rayOf(i), front.hitOf(i), surfaceOf(front, i),
                       scratch_.crossings, also, visits());
        wave.ratio.at[i] *= also.indexRatio;
        if (also.opaque) wave.ratio.at[i] = 1; // in contact: nothing between that could bend it
        wave.refractedError.at[i] += also.error;
    }

    void transmit(Front& front, std::size_t i, std::int64_t sends) {
        const std::uint32_t number = front.met[i].coincident;
        const Coincident* const also =
            number == kNoCoincident ? nullptr : &scratch_.coincident[number];
        Columns& weights = front.wave.refractedWeight;
        bool black = sends & Sends::kRefractedBlack;
        if (also) {
            const LinearRgb weight = colorAt(weights, i) * also->filter;
            put(weights, i, weight);
            black = weight.isBlack();
        }
        Child* const child = admit(front, i, RayKind::refracted, black);
        if (!child) return;
        // There may be a mirrored ray beside it.
        if (sends & Sends::kMirrors) child->term = scratch_.sums.branch(child->term);
        if constexpr (Observer::kActive)
            observer_.transmitted(child->node, facingOf(front, i), also);
        if (also && also->opaque) return touch(front, *child, *also);
        ++counts_.refracted;
        note(front, *child);
    }

    /// Sees the opaque surface that a transparent one touches.
    [[gnu::noinline]] void touch(const Front& front, const Child& child, const Coincident& also) {
        Work work;
        geometry::Ray ray;
        write(front, child, work, ray);
        if constexpr (Observer::kActive) observer_.starts(work.node, ray);
        geometry::Surface end = *also.opaque;
        end.error += front.wave.refractedError.at[child.encounter];
        geometry::Hit hit = also.opaqueHit;
        if (!scratch_.contact) scratch_.contact = std::make_unique_for_overwrite<Front>();
        Front& contact = *scratch_.contact;
        contact.start({{&work, 1}, {&ray, 1}, {&hit, 1}});
        encounter(contact, 0, end);
        surface(contact);
        shine(contact);
        leave(contact);
    }

    /// The next child, if it is worth a ray.
    Child* admit(const Front& front, std::size_t i, RayKind kind, bool black) {
        const Work& parent = front.workOf(i);
        const std::uint32_t depth = parent.depth + 1;
        Fate fate = Fate::traced;
        if (black) {
            fate = Fate::nothingToAdd;
        } else if (depth > stage_.depth) {
            fate = Fate::cutByDepth;
            ++counts_.cutByDepth;
            counts_.lostByDepth += weightOf(front, kind, i).maxComponent();
        } else if (stage_.cutoff > 0 && weightOf(front, kind, i).maxComponent() < stage_.cutoff) {
            fate = Fate::cutByContribution;
            ++counts_.cutByContribution;
        }
        Child& child = scratch_.children.data()[scratch_.childCount];
        child.encounter = static_cast<std::uint32_t>(i);
        child.depth = depth;
        child.term = parent.term;
        child.kind = kind;
        child.ofContact = false;
        if constexpr (Observer::kActive)
            child.node = observer_.child(parent, depth, weightOf(front, kind, i), kind, fate);
        return fate == Fate::traced ? &child : nullptr;
    }

    /// It will be sent off.
    void note(const Front& front, Child& child) {
        counts_.deepest = std::max(counts_.deepest, child.depth);
        child.group = static_cast<std::uint8_t>(leavingOf(front, child).group.at[child.encounter]);
        scratch_.childrenByDirection.note(child.group);
        if (&front == scratch_.contact.get()) {
            auto& [work, ray] = scratch_.ofContacts.emplace_back();
            write(front, child, work, ray);
            child.encounter = static_cast<std::uint32_t>(scratch_.ofContacts.size() - 1);
            child.ofContact = true;
        }
        ++scratch_.childCount;
    }

    static const Leaving& leavingOf(const Front& front, const Child& child) {
        return child.kind == RayKind::reflected ? front.wave.mirrored : front.wave.refracted;
    }
    static LinearRgb weightOf(const Front& front, RayKind kind, std::size_t i) {
        return colorAt(
            kind == RayKind::reflected ? front.wave.mirroredWeight : front.wave.refractedWeight, i);
    }

    static void write(const Front& front, const Child& child, Work& work, geometry::Ray& ray) {
        work.weight = weightOf(front, child.kind, child.encounter);
        work.depth = child.depth;
        work.term = child.term;
        work.node = child.node;
        ray = leavingOf(front, child).ray[child.encounter];
    }

    /// What was noted. The batch is gone then: its rays' places are taken.
    void sendOff(const Front& front) {
        const Child* const children = scratch_.children.data();
        scratch_.pending.push(
            scratch_.childCount, scratch_.childrenByDirection, scratch_.sums.end(),
            [&](std::size_t k) { return children[k].group; },
            [&](std::size_t k, Work& work, geometry::Ray& ray) {
                if (children[k].ofContact) [[unlikely]]
                    std::tie(work, ray) = scratch_.ofContacts[children[k].encounter];
                else
                    write(front, children[k], work, ray);
                stage_.box.clipEnd(ray);
                if constexpr (Observer::kActive) observer_.starts(work.node, ray);
            });
        scratch_.ofContacts.clear();
    }

    const Stage& stage_;
    Scratch& scratch_;
    RayCounts& counts_;
    Observer& observer_;
    const WaveKernel& kernel_ = waveKernel();
};

} // namespace rt::trace
