// Both ends of a box in one register, the upper ones negated, so that both grow downward.
#include <core/octree/bins.hpp>

namespace rt::octree::avx2 {
namespace {

inline __m256 negatedAbove(__m256 ends) {
    return _mm256_xor_ps(ends, _mm256_setr_ps(0, 0, 0, 0, -0.f, -0.f, -0.f, -0.f));
}

struct Ends {
    __m128 twiceCenter;
    __m256 down;

    explicit Ends(const Reference& r) {
        const __m256 both = _mm256_load_ps(reinterpret_cast<const float*>(&r));
        twiceCenter = _mm_add_ps(_mm256_castps256_ps128(both), _mm256_extractf128_ps(both, 1));
        down = negatedAbove(both);
    }
};

struct Boxes {
    __m256 down;

    void clear() { down = _mm256_set1_ps(__builtin_inff()); }
    template <class Other> void add(const Other& other) { down = _mm256_min_ps(down, other.down); }
    void store(Bin& bin) const {
        const __m256 both = negatedAbove(down);
        bin.lower = _mm256_castps256_ps128(both);
        bin.upper = _mm256_extractf128_ps(both, 1);
    }
};

} // namespace

#include "bins.inl"

} // namespace rt::octree::avx2
