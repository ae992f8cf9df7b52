// Blocks and records of leaves: from primitives to bytes, and back to their ids.
#pragma once
#include <core/octree/cells.hpp>
#include <core/octree/tree.hpp>

#include <algorithm>
#include <vector>

namespace rt::octree {

using numeric::Vec3;

/// A leaf's primitives, by kind and within a kind by id; customs by shape.
struct LeafContents {
    std::vector<std::uint32_t> ids[3];
    struct Custom {
        std::uint32_t shape, primitive, id;
    };
    std::vector<Custom> customs;

    void fill(const Reference* first, std::uint32_t count, const geometry::Primitives& primitives);
    /// Of the record and what belongs to it.
    Extent extent() const;
};

struct LeafFormat {
    Storage storage = Storage::narrowest;
    Precision precision = Precision::exact;
    double center[3] = {0, 0, 0}; // of octree space, where leaves of Precision::f32 are
    double scale = 1;
};

class LeafWriter {
public:
    LeafWriter(const geometry::Primitives& primitives, const LeafFormat& format)
        : primitives_(primitives), format_(format) {}

    /// What write() takes. `shares`: sharesBlock() of these.
    Extent measure(const Reference* first, std::uint32_t count, bool shares,
                   LeafContents& scratch) const;
    /// Likewise, of a record.
    Extent measure(const LeafContents& contents) const { return inFormat(contents.extent()); }
    /// Stores a leaf; returns the reference to it.
    std::uint32_t write(Tree& tree, Places& places, const Reference* first, std::uint32_t count,
                        bool shares, LeafContents& scratch) const;
    LeafRecord writeRecord(Tree& tree, Places& places, const LeafContents& contents) const;

private:
    Extent inFormat(Extent extent) const;
    bool isNarrow(const Reference* first, std::uint32_t count) const;
    void fetchCorners(const std::uint32_t* ids, std::uint32_t count) const;
    template <class Block>
    void fillShared(Block& block, const Reference* first, std::uint32_t count) const;
    template <class Block>
    void fillTriangles(Block& block, const std::uint32_t* ids, std::uint32_t count) const;
    void fillSpheres(SphereBlock& block, const std::uint32_t* ids, std::uint32_t count) const;
    void fillParallelograms(ParallelogramBlock& block, const std::uint32_t* ids,
                            std::uint32_t count) const;
    /// Of Precision::f32; ids of one kind.
    void fillF32(NarrowTriangleBlock& block, geometry::Kind kind, const std::uint32_t* ids,
                 std::uint32_t count) const;
    bool isF32() const { return format_.precision == Precision::f32; }
    Vec3 inOctreeSpace(const Vec3& p) const {
        const auto& c = format_.center;
        return (p - Vec3(c[0], c[1], c[2])) * format_.scale;
    }
    std::uint32_t indexOf(std::uint32_t id) const { return indexInKind(primitives_, id); }

    const geometry::Primitives& primitives_;
    const LeafFormat format_;
};

/// Appends the ids of a leaf's primitives.
void idsOfLeaf(const Tree& tree, std::uint32_t reference, std::vector<std::uint32_t>& ids);

/// How many primitives a leaf holds.
std::uint32_t sizeOfLeaf(const Tree& tree, std::uint32_t reference);

/// As Node::Links::leafSize holds it.
inline std::uint8_t leafSizeOf(std::size_t count) {
    return static_cast<std::uint8_t>(std::min<std::size_t>(count, 255));
}

/// Cost of testing a leaf once, in node visits.
float costOfLeaf(const Tree& tree, std::uint32_t reference);

} // namespace rt::octree
