// Subtrees whose cost has drifted are built anew, and what that gains says how good the tree still is.
#pragma once
#include <core/octree/free_places.hpp>

namespace rt::octree {

class Upkeep {
public:
    /// Keeps references to all of them.
    Upkeep(Tree& tree, UpdateState& state, const double center[3], double scale,
           const geometry::Primitives& primitives, const BuildOptions& options, FreePlaces& places,
           UpdateReport& report)
        : tree_(tree), state_(state), center_(center), scale_(scale), primitives_(primitives),
          options_(options), places_(places), report_(report) {}

    /// Boxes that have grown cost more than new ones would, by how much is not known: so as many
    /// primitives are built anew as keeps any motion in bounds, those first that cost most. Of the `moved` ones,
    /// `singles` moved without their neighbours. False: the tree cannot follow.
    bool followDrift(std::uint64_t moved, std::uint64_t singles);

    /// A new tree would have more nodes than when this was new, too: what was built anew lately tells how many.
    bool hasTooManyNodes() const;

private:
    /// Subtrees to build anew: what has drifted by itself as a whole, and candidates, a few primitives each.
    struct Drifted {
        std::vector<std::uint32_t> whole, few;
    };
    void findDrifted(std::uint32_t index, Drifted& found) const;
    std::size_t liveNodes() const { return tree_.nodes.size() - state_.free[kNodes].size(); }
    void release(std::uint32_t reference);
    void prefetchAhead(std::size_t i) const;
    bool rebuild(std::uint32_t index);

    Tree& tree_;
    UpdateState& state_;
    const double* const center_;
    const double scale_;
    const geometry::Primitives& primitives_;
    const BuildOptions& options_;
    FreePlaces& places_;
    UpdateReport& report_;
    std::vector<std::uint32_t> members_; // scratch
};

} // namespace rt::octree
