#include "clock.hpp"
#include "measure.hpp"

#include <core/numeric/box.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>

namespace rt::bench {
namespace {

using geometry::PrimitiveId;
using geometry::Primitives;
using octree::Octree;

/// Triangles with corners of their own, so that each can move alone.
void separate(Primitives& p) {
    std::vector<Vec3> positions;
    for (auto& corners : p.triangles.indices)
        for (std::uint32_t& c : corners) {
            positions.push_back(p.triangles.positions[c]);
            c = static_cast<std::uint32_t>(positions.size() - 1);
        }
    p.triangles.positions = std::move(positions);
}

void moveTriangle(Primitives& p, std::uint32_t triangle, const Vec3& by) {
    for (const std::uint32_t c : p.triangles.indices[triangle]) p.triangles.positions[c] += by;
}

} // namespace

void measureMoves(const Subject& subject, const Options& options) {
    octree::BuildOptions build = options.build;
    build.threads = 1;
    build.movable = true;
    numeric::Box3d box;
    for (const Vec3& p : subject.primitives.triangles.positions) box.add(p);
    const double diagonal = numeric::length(box.diagonal());
    const std::uint32_t count = subject.primitives.count();
    std::mt19937 bits(17);
    const auto unit = [&] { return (bits() + 0.5) / 4294967296.0; };
    const auto step = [&](double reach) {
        return Vec3(2 * unit() - 1, 2 * unit() - 1, 2 * unit() - 1) * reach;
    };

    /// Each kind of motion starts from the mesh at rest; `move` changes the primitives and names them.
    const auto kind = [&](const char* name, bool apart, const auto& move) {
        Primitives p = subject.primitives;
        if (apart) separate(p);
        Octree tree = Octree::build(p, build);
        std::vector<double> updates, builds;
        std::uint64_t rebuilt = 0, moved = 0;
        int whole = 0;
        double cost = 0, nodes = 0;
        for (int round = 0; round < options.rounds; ++round) {
            const std::vector<PrimitiveId> ids = move(p, round);
            moved += ids.size();
            updates.push_back(cpuSecondsOf([&] {
                const auto report = tree.update(p, ids);
                rebuilt += report.rebuilt;
                whole += report.whole;
            }));
            Octree fresh;
            builds.push_back(cpuSecondsOf([&] { fresh = Octree::build(p, build); }));
            const auto ours = tree.statistics(), theirs = fresh.statistics();
            cost = std::max(cost, ours.cost / theirs.cost);
            nodes = std::max(nodes,
                             static_cast<double>(ours.nodes) / static_cast<double>(theirs.nodes));
        }
        double sum = 0;
        for (const double s : updates) sum += s;
        std::printf(
            "%-26s %9.4f %9.4f %7.2f %% %7.2f %% %8.1f %9.1f %6d %6.3f %6.3f\n", name,
            median(updates), median(builds), 100 * median(updates) / median(builds),
            100 * sum / options.rounds / median(builds), 1e9 * sum / static_cast<double>(moved),
            100.0 * static_cast<double>(rebuilt) / count / options.rounds, whole, cost, nodes);
        std::fflush(stdout);
    };
    std::printf("%s: %u triangles, %d updates of each kind, one thread\n%-26s %9s %9s %9s %9s %8s "
                "%9s %6s %6s %6s\n",
                subject.name.c_str(), count, options.rounds, "what moves", "median s", "build s",
                "median", "mean", "ns/moved", "rebuilt %", "whole", "cost", "nodes");

    for (const double reach : {0.01, 0.1})
        kind(reach < 0.05 ? "1 % at random, by 1 %" : "1 % at random, by 10 %", true,
             [&](Primitives& p, int) {
                 std::vector<PrimitiveId> ids;
                 for (std::uint32_t i = 0; i < count / 100; ++i) {
                     ids.push_back(PrimitiveId{static_cast<std::uint32_t>(unit() * count)});
                     moveTriangle(p, static_cast<std::uint32_t>(ids.back()),
                                  step(reach * diagonal / std::sqrt(3.0)));
                 }
                 return ids;
             });
    kind("1 % in one place, by 1 %", true, [&](Primitives& p, int) {
        const auto center = p.triangles.positions[p.triangles.indices[count / 3][0]];
        std::vector<std::pair<double, std::uint32_t>> near(count);
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec3 d = p.triangles.positions[p.triangles.indices[i][0]] - center;
            near[i] = {numeric::dot(d, d), i};
        }
        std::nth_element(near.begin(), near.begin() + count / 100, near.end());
        std::vector<PrimitiveId> ids;
        for (std::uint32_t i = 0; i < count / 100; ++i) {
            ids.push_back(PrimitiveId{near[i].second});
            moveTriangle(p, near[i].second, step(0.01 * diagonal / std::sqrt(3.0)));
        }
        return ids;
    });
    if (subject.mesh.firstOfBody == 0) return;
    kind("a rigid body", false, [&](Primitives& p, int round) {
        const std::uint32_t first = subject.mesh.firstOfBody;
        std::vector<PrimitiveId> ids;
        for (std::uint32_t i = first; i < count; ++i) ids.push_back(PrimitiveId{i});
        const double angle = 0.05 * (round + 1), c = std::cos(angle), s = std::sin(angle);
        const auto& rest = subject.mesh.positions;
        for (std::size_t i = subject.mesh.firstVertexOfBody; i < rest.size(); ++i)
            p.triangles.positions[i] = {c * rest[i].x - s * rest[i].z, rest[i].y,
                                        s * rest[i].x + c * rest[i].z};
        return ids;
    });
}

} // namespace rt::bench
