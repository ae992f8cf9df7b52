#include <core/trace/sampler.hpp>

#include <core/trace/tone.hpp>

#include <algorithm>
#include <cmath>

namespace rt::trace {
namespace {

bool isFinite(const LinearRgb& c) {
    return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}

/// Calls trace(rays, colors of the points) for batches of the points' rays; what never enters the
/// scene's box is black.
template <class Trace>
void forEachBatch(const View& view, std::span<const PicturePoint> points, LinearRgb* colors,
                  Scratch& scratch, const Trace& trace) {
    constexpr std::size_t kBatch = 4096; // bounds the memory, and what waits in the caches
    for (std::size_t first = 0; first < points.size(); first += kBatch) {
        const std::size_t last = std::min(first + kBatch, points.size());
        const auto rays = room(scratch.camera.rays, last - first);
        const auto colorOf = room(scratch.camera.colorOf, last - first);
        view.camera.through(points.subspan(first, last - first), rays);
        std::size_t used = 0;
        for (std::size_t i = first; i < last; ++i) {
            colors[i] = {};
            colorOf[used] = colors + i;
            if (!view.stage.box.unbounded()) rays[used] = rays[i - first];
            used += view.stage.box.clip(rays[used]);
        }
        trace(rays.first(used), colorOf.first(used));
    }
}

template <Features kFeatures>
void sampleLight(const View& view, std::span<const PicturePoint> points, LinearRgb* colors,
                 Scratch& scratch, RayCounts& counts) {
    NoObserver nobody;
    Whitted<kFeatures> whitted(view.stage, scratch, counts, nobody);
    forEachBatch(view, points, colors, scratch, [&](auto rays, auto colorOf) {
        const std::span<const LinearRgb> light = whitted.radiance(rays);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (isFinite(light[i]))
                *colorOf[i] = toned(light[i], view.tone);
            else
                *colorOf[i] = view.notFinite, ++counts.notFinite;
        }
    });
}

/// Nodes and primitives that all rays of the sample visited.
template <bool kTransmission>
void sampleCost(const View& view, std::span<const PicturePoint> points, LinearRgb* colors,
                Scratch& scratch, RayCounts& counts) {
    for (std::size_t i = 0; i < points.size(); ++i) {
        RayCounts one;
        sampleLight<Features{kTransmission, Counting::rays}>(view, points.subspan(i, 1), colors + i,
                                                             scratch, one);
        const octree::Visits& v = one.visits;
        colors[i] = LinearRgb::grey(
            static_cast<double>(v.nodes + v.triangles + v.spheres + v.parallelograms + v.customs));
        counts += one;
    }
}

LinearRgb normalColor(const geometry::Surface& surface, double) {
    const Vec3& n = surface.shadingNormal;
    return {(n.x + 1) / 2, (n.y + 1) / 2, (n.z + 1) / 2};
}

LinearRgb depthColor(const geometry::Surface&, double distance) {
    return LinearRgb::grey(distance);
}

/// Well spread and never black; the same for the same object in every picture.
LinearRgb idColor(const geometry::Surface& surface, double) {
    auto h = static_cast<std::uint32_t>(surface.object) + 1;
    h = (h ^ (h >> 16)) * 0x7feb352du; // [Wellons, hash-prospector, 2018]
    h = (h ^ (h >> 15)) * 0x846ca68bu;
    h ^= h >> 16;
    const auto channel = [&](unsigned shift) { return (64 + ((h >> shift) & 0xFF) * 0.75) / 256; };
    return {channel(0), channel(8), channel(16)};
}

/// Something of the first surface; black where there is none.
template <LinearRgb (*kColor)(const geometry::Surface&, double distance)>
void sampleFirstHit(const View& view, std::span<const PicturePoint> points, LinearRgb* colors,
                    Scratch& scratch, RayCounts& counts) {
    forEachBatch(view, points, colors, scratch, [&](auto rays, auto colorOf) {
        counts.primary += rays.size();
        auto& hits = scratch.hits;
        hits.resize(rays.size());
        view.stage.octree.closest(rays, hits, octree::Coherence::coherent);
        view.stage.settle(rays, hits, scratch.crossings, nullptr);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (!hits[i]) continue;
            const auto surface = geometry::surfaceAt(view.stage.world.primitives, rays[i], hits[i]);
            const Vec3 fromEye = surface.position - view.camera.eye();
            const LinearRgb color = kColor(surface, std::sqrt(dot(fromEye, fromEye)));
            if (isFinite(color))
                *colorOf[i] = color;
            else
                *colorOf[i] = view.notFinite, ++counts.notFinite;
        }
    });
}

} // namespace

Sampler samplerFor(const Stage& stage, const Options& options) {
    switch (options.shade) {
    case Shade::full:
        break;
    case Shade::normals:
        return sampleFirstHit<normalColor>;
    case Shade::depth:
        return sampleFirstHit<depthColor>;
    case Shade::id:
        return sampleFirstHit<idColor>;
    case Shade::cost:
        return stage.transmits ? sampleCost<true> : sampleCost<false>;
    }
    if (options.count)
        return stage.transmits ? sampleLight<Features{true, Counting::batches}>
                               : sampleLight<Features{false, Counting::batches}>;
    return stage.transmits ? sampleLight<Features{true, Counting::none}>
                           : sampleLight<Features{false, Counting::none}>;
}

} // namespace rt::trace
