// 8 lanes on AVX2: f64 in two registers, f32 in one.

struct F64 {
    __m256d a, b;
};
struct Mask {
    __m256d a, b;
};

#define RT_LANES_UNARY(name, op)                                                                   \
    inline F64 name(F64 x) { return {op(x.a), op(x.b)}; }
#define RT_LANES_BINARY(name, op)                                                                  \
    inline F64 name(F64 x, F64 y) { return {op(x.a, y.a), op(x.b, y.b)}; }
#define RT_LANES_COMPARE(name, predicate)                                                          \
    inline Mask name(F64 x, F64 y) {                                                               \
        return {_mm256_cmp_pd(x.a, y.a, predicate), _mm256_cmp_pd(x.b, y.b, predicate)};           \
    }

inline F64 load(const double* p) { return {_mm256_load_pd(p), _mm256_load_pd(p + 4)}; }
inline F64 all(double x) {
    const __m256d v = _mm256_set1_pd(x);
    return {v, v};
}
inline void store(double* p, F64 x) {
    _mm256_store_pd(p, x.a);
    _mm256_store_pd(p + 4, x.b);
}
RT_LANES_BINARY(operator+, _mm256_add_pd)
RT_LANES_BINARY(operator-, _mm256_sub_pd)
RT_LANES_BINARY(operator*, _mm256_mul_pd)
RT_LANES_BINARY(operator/, _mm256_div_pd)
RT_LANES_UNARY(squareRoot, _mm256_sqrt_pd)
RT_LANES_BINARY(smaller, _mm256_min_pd) // a < b ? a : b
RT_LANES_BINARY(larger, _mm256_max_pd)  // a > b ? a : b
RT_LANES_COMPARE(operator<, _CMP_LT_OQ)
RT_LANES_COMPARE(operator<=, _CMP_LE_OQ)
RT_LANES_COMPARE(operator>, _CMP_GT_OQ)
RT_LANES_COMPARE(operator>=, _CMP_GE_OQ)
RT_LANES_COMPARE(operator!=, _CMP_NEQ_OQ)
RT_LANES_COMPARE(operator==, _CMP_EQ_OQ)
inline F64 select(Mask m, F64 x, F64 y) {
    return {_mm256_blendv_pd(y.a, x.a, m.a), _mm256_blendv_pd(y.b, x.b, m.b)};
}
inline Mask both(Mask x, Mask y) { return {_mm256_and_pd(x.a, y.a), _mm256_and_pd(x.b, y.b)}; }
inline Mask either(Mask x, Mask y) { return {_mm256_or_pd(x.a, y.a), _mm256_or_pd(x.b, y.b)}; }
inline unsigned bits(Mask m) {
    return static_cast<unsigned>(_mm256_movemask_pd(m.a) | _mm256_movemask_pd(m.b) << 4);
}

#undef RT_LANES_UNARY
#undef RT_LANES_BINARY
#undef RT_LANES_COMPARE

struct F32 {
    __m256 v;
};

inline F32 load(const float* p) { return {_mm256_load_ps(p)}; }
inline F32 all(float x) { return {_mm256_set1_ps(x)}; }
inline F32 smaller(F32 a, F32 b) { return {_mm256_min_ps(a.v, b.v)}; }
inline F32 larger(F32 a, F32 b) { return {_mm256_max_ps(a.v, b.v)}; }
inline F32 productMinus(F32 a, F32 b, F32 c) { return {_mm256_fmsub_ps(a.v, b.v, c.v)}; }
inline unsigned bitsLessEqual(F32 a, F32 b) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)));
}

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

inline __m256i compressing(unsigned mask) {
    return _mm256_cvtepu8_epi32(
        _mm_loadl_epi64(reinterpret_cast<const __m128i*>(kTables.compress[mask])));
}

/// Puts all children in `mask` but the nearest on the stack, farthest first; returns the nearest.
inline std::uint32_t pushFar(const Order& order, const Node& node, F32 enter, unsigned mask,
                             std::uint32_t* references, float* enters, int& top) {
    const unsigned nearest = kTables.nearest[order.mirror][mask];
    const std::uint32_t next = node.child[nearest];
    mask &= ~(1u << nearest);
    if (!mask) return next;
    const __m256i wanted = _mm256_and_si256(order.bit, _mm256_set1_epi32(static_cast<int>(mask)));
    const unsigned m = static_cast<unsigned>(
        _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(wanted, order.bit))));
    const __m256i from = _mm256_permutevar8x32_epi32(order.slots, compressing(m));
    const __m256i child = _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_permutevar8x32_epi32(child, from));
    _mm256_storeu_ps(enters + top, _mm256_permutevar8x32_ps(enter.v, from));
    top += __builtin_popcount(mask);
    return next;
}

/// Puts all children in `mask` but the first on the stack in any order; returns the first.
inline std::uint32_t pushAny(const Node& node, unsigned mask, std::uint32_t* references, int& top) {
    const std::uint32_t next = node.child[__builtin_ctz(mask)];
    mask &= mask - 1;
    if (!mask) return next;
    const __m256i child = _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_permutevar8x32_epi32(child, compressing(mask)));
    top += __builtin_popcount(mask);
    return next;
}
