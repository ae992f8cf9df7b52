// The cells of the octree as a binary tree of cuts, before children are merged into nodes.
//
// A level of the octree cuts its cell once in x, once in y and once in z. The first cut may be along
// any axis and halves the cell; each half chooses for itself which of the two other axes is next, and
// where; the quarters take the axis that is left: 7 planes a level, each where the surface area
// heuristic [MacDonald, Booth 1990] finds it cheapest, among 16 or, where few primitives are left, among
// all. A cut with everything on one side makes no cell; its axis counts as cut.
#pragma once
#include <core/octree/layout.hpp>
#include <core/octree/octree.hpp>
#include <core/octree/tree.hpp>

#include <cstdint>
#include <cstring>
#include <memory>

namespace rt::octree {

/// A primitive as the builder sees it: its box in octree space, rounded outward.
struct alignas(32) Reference {
    float lower[3];
    std::uint32_t id;
    float upper[3];
    std::uint32_t kind; // geometry::Kind
};

inline constexpr std::uint32_t kNoCell = 0xFFFFFFFFu;
inline constexpr int kNodeChildren = 8;

// What the surface area heuristic counts, in visits of a node.
inline constexpr float kNodeCost = 1, kBlockCost = 1, kCustomCost = 4;

struct Cell {
    float lower[3];
    std::uint32_t begin; // references begin .. end − 1
    float upper[3];
    std::uint32_t end;
    std::uint32_t below, above; // the two sides of the cut; kNoCell in a cell that is not cut
    std::uint8_t axis;          // of the cut
    std::uint8_t sharesBlock;   // as a leaf it is one shared block
    // In n + 1 or fewer slots of a node, fewer than it has:
    std::uint8_t split[kNodeChildren - 1]; // [n]: how many of them go below; 0: it takes one
    float cost[kNodeChildren - 1];         // [n]
    bool isCut() const { return below != kNoCell; }
};

/// Index of a primitive in the array of its kind.
inline std::uint32_t indexInKind(const geometry::Primitives& primitives, std::uint32_t id) {
    const auto& segment = primitives.segmentOf(geometry::PrimitiveId{id});
    return segment.index + id - static_cast<std::uint32_t>(segment.first);
}

/// Up to 16 different corners, in the order in which they came.
class CornerSet {
public:
    CornerSet() { std::memset(placeOf_, 0xFF, sizeof placeOf_); }

    /// Its place; -1 when it is new and there is none left.
    int add(std::uint32_t corner) {
        // Whether a corner is known nobody can foretell: no branch may depend on it.
        std::uint8_t& entry = placeOf_[corner * 0x9E3779B1u >> 24]; // [Knuth 1973]
        unsigned place = entry;
        bool known = place < size_ && corners_[place] == corner;
        if (place < size_ && !known) {
            place = 0; // another corner has the entry
            while (place < size_ && corners_[place] != corner) ++place;
            known = place < size_;
        }
        place = known ? place : size_;
        if (place == kSharedLanes) return -1;
        entry = static_cast<std::uint8_t>(place);
        corners_[place] = corner;
        size_ += !known;
        return static_cast<int>(place);
    }
    int size() const { return static_cast<int>(size_); }
    std::uint32_t at(int i) const { return corners_[i]; }

private:
    std::uint8_t placeOf_[256]; // by the corner's hash; of one that came last, if any
    std::uint32_t corners_[kSharedLanes];
    unsigned size_ = 0;
};

/// Do these fit one shared block: triangles only, with few enough corners?
bool sharesBlock(const geometry::Primitives& primitives, const Reference* first,
                 const Reference* last);

class Cells {
public:
    /// Sorts `references` into cells. `scale`: octree units per world unit. options.simd: one that the CPU has.
    Cells(const geometry::Primitives& primitives, Array<Reference> references, std::uint32_t count,
          double scale, const BuildOptions& options);
    Cells(const Cells&) = delete;
    Cells& operator=(const Cells&) = delete;

    const Cell& operator[](std::uint32_t i) const { return cells_[i]; }
    const Reference* references() const { return references_.data(); }
    std::uint32_t root() const { return root_; }

    /// A cell that stays whole: its primitives are a leaf.
    bool isLeaf(std::uint32_t cell) const { return cells_[cell].split[0] == 0; }
    /// The cells that the node made of `cell` has as children; returns their number, at most 8.
    int childrenOf(std::uint32_t cell, std::uint32_t children[kNodeChildren]) const;

private:
    class Builder;
    void gather(std::uint32_t cell, int slots, std::uint32_t* children, int& count) const;

    Array<Reference> references_;
    Array<Cell> cells_;
    std::uint32_t root_ = kNoCell;
};

} // namespace rt::octree
