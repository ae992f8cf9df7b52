#include "bench_rays.hpp"
#include "clock.hpp"
#include "measure.hpp"

#include <core/numeric/box.hpp>
#include <core/numeric/transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace rt::bench {
namespace {

using geometry::Hit;
using geometry::PrimitiveId;
using geometry::Primitives;
using geometry::Ray;
using numeric::AffineTransform;
using octree::Coherence;
using octree::Octree;

using Rows = std::vector<Ray>;
using Hits = std::vector<Hit>;
using Answers = std::vector<std::uint8_t>;

/// Those of the triangles [first, last).
Primitives partOf(const Primitives& whole, std::uint32_t first, std::uint32_t last) {
    Primitives part = whole;
    const auto& indices = whole.triangles.indices;
    part.triangles.indices.assign(indices.begin() + first, indices.begin() + last);
    part.segments[0].count = last - first;
    return part;
}

void closest(const Octree& tree, const Rows& rays, Hits& hits, bool bundled) {
    if (bundled) return tree.closest(rays, hits, Coherence::coherent);
    for (std::size_t i = 0; i < rays.size(); ++i) hits[i] = tree.closest(rays[i]);
}

void occluded(const Octree& tree, const Rows& rays, Answers& answers, bool bundled) {
    if (bundled) return tree.occluded(rays, answers, Coherence::coherent);
    for (std::size_t i = 0; i < rays.size(); ++i) answers[i] = tree.occluded(rays[i]);
}

/// The body at rest in a tree of its own, to which rays are carried, beside the tree of all else.
class Instance {
public:
    Instance(const Primitives& rest, std::uint32_t firstOfBody, const octree::BuildOptions& build,
             const AffineTransform& restFromWorld, const numeric::Box3d& worldBox)
        : firstOfBody_(firstOfBody), still_(partOf(rest, 0, firstOfBody)),
          body_(partOf(rest, firstOfBody, rest.count())), stillTree_(Octree::build(still_, build)),
          bodyTree_(Octree::build(body_, build)), restFromWorld_(restFromWorld),
          worldBox_(worldBox) {}

    void closest(const Rows& rays, Hits& hits, bool bundled) {
        if (firstOfBody_ == 0)
            hits.assign(rays.size(), Hit());
        else
            bench::closest(stillTree_, rays, hits, bundled);
        gather(rays, [&](std::size_t i) { return std::fmin(hits[i].t, rays[i].tMax); });
        bodyHits_.resize(carried_.size());
        bench::closest(bodyTree_, carried_, bodyHits_, bundled);
        for (std::size_t i = 0; i < carried_.size(); ++i) {
            if (!bodyHits_[i]) continue;
            hits[from_[i]] = bodyHits_[i];
            hits[from_[i]].id =
                PrimitiveId{firstOfBody_ + static_cast<std::uint32_t>(bodyHits_[i].id)};
        }
    }

    void occluded(const Rows& rays, Answers& answers, bool bundled) {
        if (firstOfBody_ == 0)
            answers.assign(rays.size(), 0);
        else
            bench::occluded(stillTree_, rays, answers, bundled);
        gather(rays, [&](std::size_t i) { return answers[i] ? 0 : rays[i].tMax; });
        bodyAnswers_.resize(carried_.size());
        bench::occluded(bodyTree_, carried_, bodyAnswers_, bundled);
        for (std::size_t i = 0; i < carried_.size(); ++i) answers[from_[i]] = bodyAnswers_[i];
    }

private:
    /// Carries the rays that meet the body's box up to tMaxOf(i).
    template <class Limit> void gather(const Rows& rays, const Limit& tMaxOf) {
        carried_.clear();
        from_.clear();
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Ray& ray = rays[i];
            const double tMax = tMaxOf(i);
            const Vec3 inverse = Vec3(1.0) / ray.direction;
            const Vec3 a = (worldBox_.min - ray.origin) * inverse,
                       b = (worldBox_.max - ray.origin) * inverse;
            const Vec3 enter = numeric::componentMin(a, b), leave = numeric::componentMax(a, b);
            if (!(std::max({enter.x, enter.y, enter.z, 0.0}) <=
                  std::min({leave.x, leave.y, leave.z, tMax})))
                continue;
            carried_.push_back({restFromWorld_.point(ray.origin), tMax,
                                restFromWorld_.direction(ray.direction), geometry::kNoPrimitive});
            from_.push_back(static_cast<std::uint32_t>(i));
        }
    }

    const std::uint32_t firstOfBody_;
    const Primitives still_, body_; // nothing is still where all is the body
    const Octree stillTree_, bodyTree_;
    const AffineTransform restFromWorld_;
    const numeric::Box3d worldBox_;
    Rows carried_;
    std::vector<std::uint32_t> from_; // of each carried ray
    Hits bodyHits_;
    Answers bodyAnswers_;
};

} // namespace

void measureInstance(const Subject& subject, const Options& options) {
    octree::BuildOptions build = options.build;
    build.threads = 1;
    build.movable = true;
    Primitives p = subject.primitives;
    const auto& rest = subject.mesh.positions;
    const std::uint32_t first = subject.mesh.firstOfBody;
    std::vector<PrimitiveId> ids;
    for (std::uint32_t i = first; i < p.count(); ++i) ids.push_back(PrimitiveId{i});
    Octree tree = Octree::build(p, build);
    AffineTransform worldFromRest;
    std::vector<double> poses, updates;
    for (int round = 1; round <= options.rounds; ++round) {
        worldFromRest = numeric::rotation({0, 1, 0}, {0.05 * round});
        poses.push_back(cpuSecondsOf([&] {
            for (std::size_t i = subject.mesh.firstVertexOfBody; i < rest.size(); ++i)
                p.triangles.positions[i] = worldFromRest.point(rest[i]);
        }));
        updates.push_back(cpuSecondsOf([&] { tree.update(p, ids); }));
    }
    numeric::Box3d worldBox;
    for (std::size_t i = subject.mesh.firstVertexOfBody; i < rest.size(); ++i)
        worldBox.add(p.triangles.positions[i]);

    Instance instance(subject.primitives, first, build, worldFromRest.inverse(), worldBox);
    const Rays all =
        makeRays(tree, p, subject.eye, subject.target, subject.light, subject.fieldOfView);
    std::printf("%s: %zu of %u triangles turn: corners %.2f ms a frame, update %.2f ms\n"
                "%-20s %9s %9s %9s %12s %14s\n",
                subject.name.c_str(), ids.size(), p.count(), 1e3 * median(poses),
                1e3 * median(updates), "ns per ray", "one tree", "instance", "more", "other bits %",
                "to break even");
    for (const bool bundled : {false, true})
        for (const RayClass c : {kPrimary, kShadow, kMirror, kRandom}) {
            if (bundled && c != kPrimary && c != kShadow) continue;
            const Rows& rays = all.of[c];
            Hits hits(rays.size()), ofInstance(rays.size());
            Answers answers(rays.size()), answersOfInstance(rays.size());
            std::vector<double> one, two, more;
            for (int round = 0; round < options.rounds; ++round) {
                one.push_back(cpuSecondsOf([&] {
                    c == kShadow ? occluded(tree, rays, answers, bundled)
                                 : closest(tree, rays, hits, bundled);
                }));
                two.push_back(cpuSecondsOf([&] {
                    c == kShadow ? instance.occluded(rays, answersOfInstance, bundled)
                                 : instance.closest(rays, ofInstance, bundled);
                }));
                more.push_back(two.back() - one.back());
            }
            std::size_t differing = 0;
            for (std::size_t i = 0; i < rays.size(); ++i)
                differing += answers[i] != answersOfInstance[i] || hits[i].id != ofInstance[i].id ||
                             hits[i].t != ofInstance[i].t;
            const auto n = static_cast<double>(rays.size());
            const double slower = median(more) / n;
            std::printf("%-20s %9.1f %9.1f %9.1f %12.2f ",
                        (std::string(kClassNames[c]) + (bundled ? ", 16 at once" : "")).c_str(),
                        1e9 * median(one) / n, 1e9 * median(two) / n, 1e9 * slower,
                        100 * static_cast<double>(differing) / n);
            if (slower > 0)
                std::printf("%10.0f rays\n", (median(poses) + median(updates)) / slower);
            else
                std::printf("%14s\n", "no ray slower");
        }
    std::fflush(stdout);
}

} // namespace rt::bench
