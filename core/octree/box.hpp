// Boxes in octree space, f32.
#pragma once
#include <core/octree/layout.hpp>

#include <immintrin.h>

#include <limits>

namespace rt::octree {

/// The fourth components mean nothing.
struct Box {
    __m128 lower = _mm_set1_ps(std::numeric_limits<float>::infinity()),
           upper = _mm_set1_ps(-std::numeric_limits<float>::infinity());

    void add(__m128 l, __m128 u) {
        lower = _mm_min_ps(lower, l);
        upper = _mm_max_ps(upper, u);
    }
    void add(const Box& b) { add(b.lower, b.upper); }
    bool holds(const Box& b) const {
        return (_mm_movemask_ps(
                    _mm_and_ps(_mm_cmple_ps(lower, b.lower), _mm_cmpge_ps(upper, b.upper))) &
                7) == 7;
    }
    /// Half of the surface; 0 if empty.
    float area() const {
        const __m128 d = _mm_max_ps(_mm_sub_ps(upper, lower), _mm_setzero_ps());
        const __m128 p = _mm_mul_ps(d, _mm_shuffle_ps(d, d, _MM_SHUFFLE(3, 0, 2, 1)));
        return _mm_cvtss_f32(
            _mm_add_ss(_mm_add_ss(p, _mm_shuffle_ps(p, p, _MM_SHUFFLE(1, 1, 1, 1))),
                       _mm_shuffle_ps(p, p, _MM_SHUFFLE(2, 2, 2, 2))));
    }
};

/// Of one child.
inline Box boxOf(const Node& node, int slot) {
    Box box;
    box.lower = _mm_setr_ps(node.planes[0][slot], node.planes[2][slot], node.planes[4][slot], 0);
    box.upper = _mm_setr_ps(node.planes[1][slot], node.planes[3][slot], node.planes[5][slot], 0);
    return box;
}

inline void setBox(Node& node, int slot, const Box& box) {
    alignas(16) float lower[4], upper[4];
    _mm_store_ps(lower, box.lower);
    _mm_store_ps(upper, box.upper);
    for (int a = 0; a < 3; ++a) {
        node.planes[2 * a][slot] = lower[a];
        node.planes[2 * a + 1][slot] = upper[a];
    }
}

/// Of all children: empty slots hold the empty box.
inline Box boxOf(const Node& node) {
    __m128 least[4], most[4];
    for (int a = 0; a < 3; ++a) {
        least[a] = _mm_min_ps(_mm_load_ps(node.planes[2 * a]), _mm_load_ps(node.planes[2 * a] + 4));
        most[a] = _mm_max_ps(_mm_load_ps(node.planes[2 * a + 1]),
                             _mm_load_ps(node.planes[2 * a + 1] + 4));
    }
    least[3] = most[3] = _mm_setzero_ps();
    _MM_TRANSPOSE4_PS(least[0], least[1], least[2], least[3]);
    _MM_TRANSPOSE4_PS(most[0], most[1], most[2], most[3]);
    Box box;
    box.lower = _mm_min_ps(_mm_min_ps(least[0], least[1]), _mm_min_ps(least[2], least[3]));
    box.upper = _mm_max_ps(_mm_max_ps(most[0], most[1]), _mm_max_ps(most[2], most[3]));
    return box;
}

} // namespace rt::octree
