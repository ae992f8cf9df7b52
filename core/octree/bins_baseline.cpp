#include <core/octree/bins.hpp>

namespace rt::octree::baseline {
namespace {

struct Ends {
    __m128 lower, upper, twiceCenter;

    explicit Ends(const Reference& r)
        : lower(_mm_load_ps(r.lower)), upper(_mm_load_ps(r.upper)),
          twiceCenter(_mm_add_ps(lower, upper)) {}
};

struct Boxes {
    __m128 lower, upper;

    void clear() {
        lower = _mm_set1_ps(__builtin_inff());
        upper = _mm_set1_ps(-__builtin_inff());
    }
    template <class Other> void add(const Other& other) {
        lower = _mm_min_ps(lower, other.lower);
        upper = _mm_max_ps(upper, other.upper);
    }
    void store(Bin& bin) const {
        bin.lower = lower;
        bin.upper = upper;
    }
};

} // namespace

#include "bins.inl"

} // namespace rt::octree::baseline
