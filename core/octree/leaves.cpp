#include <core/octree/leaves.hpp>

#include <core/geometry/intersect.hpp>
#include <core/octree/prefetch.hpp>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

namespace rt::octree {
namespace {

using geometry::Kind;
using geometry::PrimitiveId;
using geometry::Primitives;
using geometry::Vec3;

constexpr double kUnused = std::numeric_limits<double>::quiet_NaN();

std::uint32_t blocksFor(std::size_t count) {
    return static_cast<std::uint32_t>((count + kLanes - 1) / kLanes);
}

bool sameKind(const Reference* first, std::uint32_t count) {
    if (first->kind == static_cast<std::uint32_t>(Kind::custom)) return false;
    for (std::uint32_t i = 1; i < count; ++i)
        if (first[i].kind != first->kind) return false;
    return true;
}

void clearSpare(TriangleBlock& block) {
    for (auto& word : block.spare) word = 0;
}
void clearSpare(NarrowTriangleBlock&) {}

} // namespace

void LeafContents::fill(const Reference* first, std::uint32_t count, const Primitives& primitives) {
    for (auto& list : ids) list.clear();
    customs.clear();
    for (const Reference* r = first; r != first + count; ++r) {
        if (r->kind != static_cast<std::uint32_t>(Kind::custom)) {
            ids[r->kind].push_back(r->id);
            continue;
        }
        const auto& custom = primitives.customs.primitives[indexInKind(primitives, r->id)];
        customs.push_back({custom.shape, custom.primitive, r->id});
    }
    for (auto& list : ids) std::sort(list.begin(), list.end());
    std::sort(customs.begin(), customs.end(), [](const Custom& a, const Custom& b) {
        return a.shape != b.shape ? a.shape < b.shape : a.id < b.id;
    });
}

Extent LeafContents::extent() const {
    Extent e;
    e.of[kTriangles] = blocksFor(ids[0].size());
    e.of[kSpheres] = blocksFor(ids[1].size());
    e.of[kParallelograms] = blocksFor(ids[2].size());
    e.of[kCustoms] = static_cast<std::uint32_t>(customs.size());
    for (std::size_t i = 0; i < customs.size(); ++i)
        e.of[kRuns] += i == 0 || customs[i].shape != customs[i - 1].shape;
    e.of[kRecords] = 1;
    return e;
}

/// Does f32 hold all corners of these triangles exactly?
bool LeafWriter::isNarrow(const Reference* first, std::uint32_t count) const {
    if (isF32()) return true;
    if (format_.storage == Storage::f64) return false;
    const auto& triangles = primitives_.triangles;
    for (std::uint32_t i = 0; i < count; ++i)
        for (const std::uint32_t corner : triangles.indices[indexOf(first[i].id)])
            if (!numeric::fitsF32(triangles.positions[corner])) return false;
    return true;
}

Extent LeafWriter::measure(const Reference* first, std::uint32_t count, bool shares,
                           LeafContents& scratch) const {
    Extent e;
    if (shares) {
        e.of[isNarrow(first, count) ? kNarrowShared : kShared] = 1;
    } else if (count <= kLanes && sameKind(first, count)) {
        switch (static_cast<Kind>(first->kind)) {
        case Kind::triangle:
            e.of[isNarrow(first, count) ? kNarrowTriangles : kTriangles] = 1;
            break;
        case Kind::sphere:
            e.of[kSpheres] = 1;
            break;
        default:
            e.of[kParallelograms] = 1;
        }
    } else {
        scratch.fill(first, count, primitives_);
        e = scratch.extent();
    }
    return inFormat(e);
}

Extent LeafWriter::inFormat(Extent extent) const {
    if (isF32())
        for (const Part part : {kTriangles, kSpheres, kParallelograms})
            extent.of[kNarrowTriangles] += std::exchange(extent.of[part], 0);
    return extent;
}

std::uint32_t LeafWriter::write(Tree& tree, Places& places, const Reference* first,
                                std::uint32_t count, bool shares, LeafContents& scratch) const {
    if (shares) {
        if (isNarrow(first, count)) {
            const std::uint32_t at = places.take(kNarrowShared);
            fillShared(tree.narrowShared[at], first, count);
            return leafReference(kNarrowSharedLeaf, at);
        }
        const std::uint32_t at = places.take(kShared);
        fillShared(tree.shared[at], first, count);
        return leafReference(kSharedLeaf, at);
    }
    if (count <= kLanes && sameKind(first, count)) {
        std::uint32_t ids[kLanes];
        for (std::uint32_t i = 0; i < count; ++i) ids[i] = first[i].id;
        std::sort(ids, ids + count);
        const auto kind = static_cast<Kind>(first->kind);
        if (isF32()) {
            const std::uint32_t at = places.take(kNarrowTriangles);
            fillF32(tree.narrowTriangles[at], kind, ids, count);
            return leafReference(kind == Kind::triangle ? kNarrowTriangleLeaf
                                 : kind == Kind::sphere ? kSphereLeaf
                                                        : kParallelogramLeaf,
                                 at);
        }
        if (kind == Kind::triangle && isNarrow(first, count)) {
            const std::uint32_t at = places.take(kNarrowTriangles);
            fillTriangles(tree.narrowTriangles[at], ids, count);
            return leafReference(kNarrowTriangleLeaf, at);
        }
        if (kind == Kind::triangle) {
            const std::uint32_t at = places.take(kTriangles);
            fillTriangles(tree.triangles[at], ids, count);
            return leafReference(kTriangleLeaf, at);
        }
        if (kind == Kind::sphere) {
            const std::uint32_t at = places.take(kSpheres);
            fillSpheres(tree.spheres[at], ids, count);
            return leafReference(kSphereLeaf, at);
        }
        const std::uint32_t at = places.take(kParallelograms);
        fillParallelograms(tree.parallelograms[at], ids, count);
        return leafReference(kParallelogramLeaf, at);
    }
    scratch.fill(first, count, primitives_);
    const std::uint32_t at = places.take(kRecords);
    tree.records[at] = writeRecord(tree, places, scratch);
    return leafReference(kMixedLeaf, at);
}

LeafRecord LeafWriter::writeRecord(Tree& tree, Places& places, const LeafContents& contents) const {
    const Extent extent = contents.extent();
    LeafRecord record{};
    using Ids = const std::uint32_t*;
    const auto blocks = [&](Kind kind, Part part, std::uint32_t& first, std::uint32_t& number,
                            const auto& fill) {
        const std::vector<std::uint32_t>& ids = contents.ids[static_cast<std::size_t>(kind)];
        number = blocksFor(ids.size());
        first = places.take(isF32() ? kNarrowTriangles : part, number);
        for (std::uint32_t i = 0; i < number; ++i) {
            const Ids some = ids.data() + kLanes * i;
            const auto count = std::min<std::uint32_t>(
                kLanes, static_cast<std::uint32_t>(ids.size()) - kLanes * i);
            if (isF32())
                fillF32(tree.narrowTriangles[first + i], kind, some, count);
            else
                fill(first + i, some, count);
        }
    };
    blocks(Kind::triangle, kTriangles, record.triangles, record.triangleBlocks,
           [&](std::uint32_t at, Ids ids, std::uint32_t count) {
               fillTriangles(tree.triangles[at], ids, count);
           });
    blocks(Kind::sphere, kSpheres, record.spheres, record.sphereBlocks,
           [&](std::uint32_t at, Ids ids, std::uint32_t count) {
               fillSpheres(tree.spheres[at], ids, count);
           });
    blocks(Kind::parallelogram, kParallelograms, record.parallelograms, record.parallelogramBlocks,
           [&](std::uint32_t at, Ids ids, std::uint32_t count) {
               fillParallelograms(tree.parallelograms[at], ids, count);
           });
    record.runCount = extent.of[kRuns];
    record.runs = places.take(kRuns, record.runCount);
    std::uint32_t run = record.runs, at = places.take(kCustoms, extent.of[kCustoms]);
    for (std::size_t i = 0; i < contents.customs.size(); ++i) {
        const auto& custom = contents.customs[i];
        if (i == 0 || custom.shape != contents.customs[i - 1].shape)
            tree.runs[run++] = {custom.shape, at, 0};
        ++tree.runs[run - 1].count;
        tree.customPrimitives[at] = custom.primitive;
        tree.customIds[at++] = custom.id;
    }
    return record;
}

/// Asks for the corners of triangles, all at once: else each waits for those before it.
void LeafWriter::fetchCorners(const std::uint32_t* ids, std::uint32_t count) const {
    const auto& triangles = primitives_.triangles;
    for (std::uint32_t i = 0; i < count; ++i) prefetchLines(triangles.indices[indexOf(ids[i])]);
    for (std::uint32_t i = 0; i < count; ++i)
        for (const std::uint32_t corner : triangles.indices[indexOf(ids[i])])
            prefetchLines(triangles.positions[corner]);
}

template <class Block>
void LeafWriter::fillShared(Block& block, const Reference* first, std::uint32_t count) const {
    using Float = std::remove_reference_t<decltype(block.corner[0][0])>;
    std::uint32_t ids[kSharedLanes];
    for (std::uint32_t i = 0; i < count; ++i) ids[i] = first[i].id;
    std::sort(ids, ids + count);
    for (std::uint32_t i = 0; i < kSharedLanes; ++i) block.id[i] = i < count ? ids[i] : kEmptyChild;
    fetchCorners(ids, count);
    CornerSet corners;
    block.valid = (1u << count) - 1;
    for (auto& word : block.spare) word = 0;
    std::memset(block.index, 0, sizeof block.index);
    for (std::uint32_t lane = 0; lane < count; ++lane) {
        const auto& triangle = primitives_.triangles.indices[indexOf(ids[lane])];
        for (std::size_t c = 0; c < 3; ++c)
            block.index[c][lane] = static_cast<std::uint8_t>(corners.add(triangle[c]));
    }
    for (int i = 0; i < kSharedLanes; ++i) {
        // Unused corners repeat the first: lanes must not meet NaN where none is needed.
        Vec3 p = primitives_.triangles.positions[corners.at(i < corners.size() ? i : 0)];
        if (isF32()) p = inOctreeSpace(p);
        for (int a = 0; a < 3; ++a) block.corner[a][i] = static_cast<Float>(p[a]);
    }
}

template <class Block>
void LeafWriter::fillTriangles(Block& block, const std::uint32_t* ids, std::uint32_t count) const {
    using Float = std::remove_reference_t<decltype(block.corner[0][0][0])>;
    const auto& triangles = primitives_.triangles;
    fetchCorners(ids, count);
    clearSpare(block);
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        block.id[lane] = lane < count ? ids[lane] : kEmptyChild;
        if (lane < count) {
            const auto& corners = triangles.indices[indexOf(ids[lane])];
            for (std::size_t c = 0; c < 3; ++c)
                for (int a = 0; a < 3; ++a)
                    block.corner[c][a][lane] =
                        static_cast<Float>(triangles.positions[corners[c]][a]);
        } else {
            for (auto& corner : block.corner)
                for (auto& row : corner) row[lane] = std::numeric_limits<Float>::quiet_NaN();
        }
    }
}

void LeafWriter::fillSpheres(SphereBlock& block, const std::uint32_t* ids,
                             std::uint32_t count) const {
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        block.id[lane] = lane < count ? ids[lane] : kEmptyChild;
        block.spare[lane] = 0;
        const geometry::Sphere sphere = lane < count ? primitives_.spheres[indexOf(ids[lane])]
                                                     : geometry::Sphere{Vec3(kUnused), kUnused};
        block.center[0][lane] = sphere.center.x;
        block.center[1][lane] = sphere.center.y;
        block.center[2][lane] = sphere.center.z;
        block.radius[lane] = sphere.radius;
    }
}

void LeafWriter::fillParallelograms(ParallelogramBlock& block, const std::uint32_t* ids,
                                    std::uint32_t count) const {
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        block.id[lane] = lane < count ? ids[lane] : kEmptyChild;
        block.spare[lane] = 0;
        std::array<Vec3, 4> corners;
        corners.fill(Vec3(kUnused));
        if (lane < count)
            corners = geometry::cornersOf(primitives_.parallelograms[indexOf(ids[lane])]);
        for (std::size_t c = 0; c < 4; ++c) {
            block.corner[c][0][lane] = corners[c].x;
            block.corner[c][1][lane] = corners[c].y;
            block.corner[c][2][lane] = corners[c].z;
        }
    }
}

void LeafWriter::fillF32(NarrowTriangleBlock& block, Kind kind, const std::uint32_t* ids,
                         std::uint32_t count) const {
    for (auto& corner : block.corner)
        for (auto& row : corner) std::ranges::fill(row, static_cast<float>(kUnused));
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
        block.id[lane] = lane < count ? ids[lane] : kEmptyChild;
        if (lane >= count) continue;
        const std::uint32_t index = indexOf(ids[lane]);
        std::array<Vec3, 3> rows{};
        if (kind == Kind::triangle) {
            const auto& positions = primitives_.triangles.positions;
            const auto& corners = primitives_.triangles.indices[index];
            const Vec3& origin = positions[corners[0]];
            rows = {inOctreeSpace(origin), (positions[corners[1]] - origin) * format_.scale,
                    (positions[corners[2]] - origin) * format_.scale};
        } else if (kind == Kind::sphere) {
            const geometry::Sphere& sphere = primitives_.spheres[index];
            rows = {inOctreeSpace(sphere.center), Vec3(sphere.radius * format_.scale), Vec3(0.0)};
        } else {
            const geometry::Parallelogram& g = primitives_.parallelograms[index];
            rows = {inOctreeSpace(g.origin), g.edgeU * format_.scale, g.edgeV * format_.scale};
        }
        for (std::size_t i = 0; i < 3; ++i)
            for (int a = 0; a < 3; ++a) block.corner[i][a][lane] = static_cast<float>(rows[i][a]);
    }
}

namespace {

void addIds(const std::uint32_t* id, int lanes, std::vector<std::uint32_t>& ids) {
    for (int i = 0; i < lanes && id[i] != kEmptyChild; ++i) ids.push_back(id[i]);
}

std::uint32_t countIds(const std::uint32_t (&id)[kLanes]) {
    std::uint32_t count = 0;
    while (count < kLanes && id[count] != kEmptyChild) ++count;
    return count;
}

} // namespace

void idsOfLeaf(const Tree& tree, std::uint32_t reference, std::vector<std::uint32_t>& ids) {
    const std::uint32_t index = reference & kLeafIndex;
    const auto addBlock = [&](const auto& blocks, std::uint32_t at) {
        addIds(tree.isF32 ? tree.narrowTriangles[at].id : blocks[at].id, kLanes, ids);
    };
    switch (kindOfLeaf(reference)) {
    case kSharedLeaf:
        return addIds(tree.shared[index].id, kSharedLanes, ids);
    case kNarrowSharedLeaf:
        return addIds(tree.narrowShared[index].id, kSharedLanes, ids);
    case kTriangleLeaf:
        return addIds(tree.triangles[index].id, kLanes, ids);
    case kNarrowTriangleLeaf:
        return addIds(tree.narrowTriangles[index].id, kLanes, ids);
    case kSphereLeaf:
        return addBlock(tree.spheres, index);
    case kParallelogramLeaf:
        return addBlock(tree.parallelograms, index);
    default: {
        const LeafRecord& leaf = tree.records[index];
        for (std::uint32_t i = 0; i < leaf.triangleBlocks; ++i)
            addBlock(tree.triangles, leaf.triangles + i);
        for (std::uint32_t i = 0; i < leaf.sphereBlocks; ++i)
            addBlock(tree.spheres, leaf.spheres + i);
        for (std::uint32_t i = 0; i < leaf.parallelogramBlocks; ++i)
            addBlock(tree.parallelograms, leaf.parallelograms + i);
        for (std::uint32_t i = 0; i < leaf.runCount; ++i) {
            const CustomRun& run = tree.runs[leaf.runs + i];
            ids.insert(ids.end(), tree.customIds.data() + run.first,
                       tree.customIds.data() + run.first + run.count);
        }
    }
    }
}

std::uint32_t sizeOfLeaf(const Tree& tree, std::uint32_t reference) {
    const std::uint32_t index = reference & kLeafIndex;
    switch (kindOfLeaf(reference)) {
    case kSharedLeaf:
        return static_cast<std::uint32_t>(__builtin_popcount(tree.shared[index].valid));
    case kNarrowSharedLeaf:
        return static_cast<std::uint32_t>(__builtin_popcount(tree.narrowShared[index].valid));
    case kTriangleLeaf:
        return countIds(tree.triangles[index].id);
    case kNarrowTriangleLeaf:
        return countIds(tree.narrowTriangles[index].id);
    case kSphereLeaf:
        return countIds(tree.spheres[index].id);
    case kParallelogramLeaf:
        return countIds(tree.parallelograms[index].id);
    default:
        std::vector<std::uint32_t> ids;
        idsOfLeaf(tree, reference, ids);
        return static_cast<std::uint32_t>(ids.size());
    }
}

float costOfLeaf(const Tree& tree, std::uint32_t reference) {
    if (kindOfLeaf(reference) != kMixedLeaf) return kBlockCost;
    const LeafRecord& leaf = tree.records[reference & kLeafIndex];
    float cost = kBlockCost * static_cast<float>(leaf.triangleBlocks + leaf.sphereBlocks +
                                                 leaf.parallelogramBlocks);
    for (std::uint32_t i = 0; i < leaf.runCount; ++i)
        cost += kCustomCost * static_cast<float>(tree.runs[leaf.runs + i].count);
    return cost;
}

} // namespace rt::octree
