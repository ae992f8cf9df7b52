// 8 lanes on AVX-512: f64 in one register, f32 in half a one.

struct F64 {
    __m512d v;
};
using Mask = __mmask8;

inline F64 load(const double* p) { return {_mm512_load_pd(p)}; }
inline F64 all(double x) { return {_mm512_set1_pd(x)}; }
inline void store(double* p, F64 a) { _mm512_store_pd(p, a.v); }
inline F64 operator+(F64 a, F64 b) { return {_mm512_add_pd(a.v, b.v)}; }
inline F64 operator-(F64 a, F64 b) { return {_mm512_sub_pd(a.v, b.v)}; }
inline F64 operator*(F64 a, F64 b) { return {_mm512_mul_pd(a.v, b.v)}; }
inline F64 operator/(F64 a, F64 b) { return {_mm512_div_pd(a.v, b.v)}; }
inline F64 squareRoot(F64 a) { return {_mm512_sqrt_pd(a.v)}; }
inline F64 smaller(F64 a, F64 b) { return {_mm512_min_pd(a.v, b.v)}; } // a < b ? a : b
inline F64 larger(F64 a, F64 b) { return {_mm512_max_pd(a.v, b.v)}; }  // a > b ? a : b
inline Mask operator<(F64 a, F64 b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_LT_OQ); }
inline Mask operator<=(F64 a, F64 b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_LE_OQ); }
inline Mask operator>(F64 a, F64 b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_GT_OQ); }
inline Mask operator>=(F64 a, F64 b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_GE_OQ); }
inline Mask operator!=(F64 a, F64 b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_NEQ_OQ); }
inline Mask operator==(F64 a, F64 b) { return _mm512_cmp_pd_mask(a.v, b.v, _CMP_EQ_OQ); }
inline F64 select(Mask m, F64 a, F64 b) { return {_mm512_mask_blend_pd(m, b.v, a.v)}; }
inline Mask both(Mask a, Mask b) { return static_cast<Mask>(a & b); }
inline Mask either(Mask a, Mask b) { return static_cast<Mask>(a | b); }
inline unsigned bits(Mask m) { return m; }

struct F32 {
    __m256 v;
};

inline F32 load(const float* p) { return {_mm256_load_ps(p)}; }
inline F32 all(float x) { return {_mm256_set1_ps(x)}; }
inline F32 smaller(F32 a, F32 b) { return {_mm256_min_ps(a.v, b.v)}; }
inline F32 larger(F32 a, F32 b) { return {_mm256_max_ps(a.v, b.v)}; }
inline F32 productMinus(F32 a, F32 b, F32 c) { return {_mm256_fmsub_ps(a.v, b.v, c.v)}; }
inline unsigned bitsLessEqual(F32 a, F32 b) { return _mm256_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ); }

/// Visiting order of a ray: far slots first.
struct Order {
    __m256i slots, bit;
    unsigned mirror;
};

inline Order orderOf(unsigned mirror) {
    const __m256i down = _mm256_setr_epi32(7, 6, 5, 4, 3, 2, 1, 0);
    const __m256i slots = _mm256_xor_si256(down, _mm256_set1_epi32(static_cast<int>(mirror)));
    return {slots, _mm256_sllv_epi32(_mm256_set1_epi32(1), slots), mirror};
}

/// Puts all children in `mask` but the nearest on the stack, farthest first; returns the nearest.
inline std::uint32_t pushFar(const Order& order, const Node& node, F32 enter, unsigned mask,
                             std::uint32_t* references, float* enters, int& top) {
    const unsigned nearest = kTables.nearest[order.mirror][mask];
    const std::uint32_t next = node.child[nearest];
    mask &= ~(1u << nearest);
    if (!mask) return next;
    const __m256i child = _mm256_permutevar8x32_epi32(
        _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)), order.slots);
    const __m256 t = _mm256_permutevar8x32_ps(enter.v, order.slots);
    const __mmask8 m = _mm256_test_epi32_mask(order.bit, _mm256_set1_epi32(static_cast<int>(mask)));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_maskz_compress_epi32(m, child));
    _mm256_storeu_ps(enters + top, _mm256_maskz_compress_ps(m, t));
    top += __builtin_popcount(mask);
    return next;
}

/// Puts all children in `mask` but the first on the stack in any order; returns the first.
inline std::uint32_t pushAny(const Node& node, unsigned mask, std::uint32_t* references, int& top) {
    const std::uint32_t next = node.child[__builtin_ctz(mask)];
    mask &= mask - 1;
    if (!mask) return next;
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_maskz_compress_epi32(
                            static_cast<__mmask8>(mask),
                            _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child))));
    top += __builtin_popcount(mask);
    return next;
}
