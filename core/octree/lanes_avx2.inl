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
inline F64 widened(const double* p) { return load(p); }
inline F64 widened(const float* p) {
    return {_mm256_cvtps_pd(_mm_load_ps(p)), _mm256_cvtps_pd(_mm_load_ps(p + 4))};
}
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
inline F64 productMinus(F64 x, F64 y, F64 z) {
    return {_mm256_fmsub_pd(x.a, y.a, z.a), _mm256_fmsub_pd(x.b, y.b, z.b)};
}
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
/// By the integers that their bits are: right where not both are negative, and faster.
inline F32 smallerBits(F32 a, F32 b) {
    return {
        _mm256_castsi256_ps(_mm256_min_epi32(_mm256_castps_si256(a.v), _mm256_castps_si256(b.v)))};
}
inline F32 largerBits(F32 a, F32 b) {
    return {
        _mm256_castsi256_ps(_mm256_max_epi32(_mm256_castps_si256(a.v), _mm256_castps_si256(b.v)))};
}
inline unsigned lessEqualBits(F32 a, F32 b) {
    return ~static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(
               _mm256_cmpgt_epi32(_mm256_castps_si256(a.v), _mm256_castps_si256(b.v))))) &
           255;
}
inline F32 productMinus(F32 a, F32 b, F32 c) { return {_mm256_fmsub_ps(a.v, b.v, c.v)}; }
inline unsigned bitsLessEqual(F32 a, F32 b) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LE_OQ)));
}

inline F64 magnitude(F64 x) {
    const __m256d sign = _mm256_set1_pd(-0.0);
    return {_mm256_andnot_pd(sign, x.a), _mm256_andnot_pd(sign, x.b)};
}
inline F64 withSignOf(F64 magnitudes, F64 signs) {
    const __m256d sign = _mm256_set1_pd(-0.0);
    return {_mm256_or_pd(magnitudes.a, _mm256_and_pd(sign, signs.a)),
            _mm256_or_pd(magnitudes.b, _mm256_and_pd(sign, signs.b))};
}
inline unsigned signsOf(F64 x) {
    return static_cast<unsigned>(_mm256_movemask_pd(x.a) | _mm256_movemask_pd(x.b) << 4);
}
inline Mask maskOf(unsigned bits) {
    const __m256i all = _mm256_set1_epi64x(bits);
    const __m256i low = _mm256_setr_epi64x(1, 2, 4, 8), high = _mm256_setr_epi64x(16, 32, 64, 128);
    return {_mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(all, low), low)),
            _mm256_castsi256_pd(_mm256_cmpeq_epi64(_mm256_and_si256(all, high), high))};
}

/// The powers of two at or below normal x, 2^-1022 <= x < 2^1022, and their inverses.
inline F64 powerBelow(F64 x, F64& inverse) {
    const __m256i bits = _mm256_set1_epi64x(0x7FF0000000000000);
    const __m256i two = _mm256_set1_epi64x(0x7FE0000000000000);
    const __m256i a = _mm256_and_si256(_mm256_castpd_si256(x.a), bits);
    const __m256i b = _mm256_and_si256(_mm256_castpd_si256(x.b), bits);
    inverse = {_mm256_castsi256_pd(_mm256_sub_epi64(two, a)),
               _mm256_castsi256_pd(_mm256_sub_epi64(two, b))};
    return {_mm256_castsi256_pd(a), _mm256_castsi256_pd(b)};
}

/// The lanes of `ids` that are `id`.
inline unsigned bitsEqual(const std::uint32_t* ids, std::uint32_t id) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_castsi256_ps(
        _mm256_cmpeq_epi32(_mm256_load_si256(reinterpret_cast<const __m256i*>(ids)),
                           _mm256_set1_epi32(static_cast<int>(id))))));
}
/// The lower halves of 8 doubles' bits.
inline void storeLowWords(std::uint32_t* p, F64 x) {
    const __m256 low = _mm256_shuffle_ps(_mm256_castpd_ps(x.a), _mm256_castpd_ps(x.b), 0x88);
    _mm256_store_si256(reinterpret_cast<__m256i*>(p),
                       _mm256_permute4x64_epi64(_mm256_castps_si256(low), 0xD8));
}
inline void storeWhere(unsigned bits, std::uint32_t* ids, std::uint32_t id) {
    for (; bits; bits &= bits - 1) ids[__builtin_ctz(bits)] = id;
}

/// columns[i]: double i of 8 rays.
inline void transpose(const geometry::Ray* rays, F64 columns[8]) {
    for (int half = 0; half < 2; ++half) {     // of the rays
        for (int four = 0; four < 2; ++four) { // of the columns
            __m256d row[4];
            for (int i = 0; i < 4; ++i)
                row[i] = _mm256_loadu_pd(reinterpret_cast<const double*>(rays + 4 * half + i) +
                                         4 * four);
            const __m256d even01 = _mm256_unpacklo_pd(row[0], row[1]),
                          odd01 = _mm256_unpackhi_pd(row[0], row[1]),
                          even23 = _mm256_unpacklo_pd(row[2], row[3]),
                          odd23 = _mm256_unpackhi_pd(row[2], row[3]);
            const __m256d column[4] = {_mm256_permute2f128_pd(even01, even23, 0x20),
                                       _mm256_permute2f128_pd(odd01, odd23, 0x20),
                                       _mm256_permute2f128_pd(even01, even23, 0x31),
                                       _mm256_permute2f128_pd(odd01, odd23, 0x31)};
            for (int i = 0; i < 4; ++i)
                (half ? columns[4 * four + i].b : columns[4 * four + i].a) = column[i];
        }
    }
}

inline F32 operator-(F32 x, F32 y) { return {_mm256_sub_ps(x.v, y.v)}; }
inline F32 operator*(F32 x, F32 y) { return {_mm256_mul_ps(x.v, y.v)}; }

/// f32 of 16 rays.
struct Wide {
    __m256 a, b;
};

#define RT_WIDE_BINARY(name, op)                                                                   \
    inline Wide name(Wide x, Wide y) { return {op(x.a, y.a), op(x.b, y.b)}; }
#define RT_WIDE_COMPARE(name, predicate)                                                           \
    inline unsigned name(Wide x, Wide y) {                                                         \
        return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(x.a, y.a, predicate)) |      \
                                     _mm256_movemask_ps(_mm256_cmp_ps(x.b, y.b, predicate)) << 8); \
    }

inline Wide loadWide(const float* p) { return {_mm256_load_ps(p), _mm256_load_ps(p + 8)}; }
inline Wide allWide(float x) {
    const __m256 v = _mm256_set1_ps(x);
    return {v, v};
}
inline void store(float* p, Wide x) {
    _mm256_store_ps(p, x.a);
    _mm256_store_ps(p + 8, x.b);
}
RT_WIDE_BINARY(operator+, _mm256_add_ps)
RT_WIDE_BINARY(operator-, _mm256_sub_ps)
RT_WIDE_BINARY(operator*, _mm256_mul_ps)
RT_WIDE_BINARY(smaller, _mm256_min_ps)
RT_WIDE_BINARY(larger, _mm256_max_ps)
RT_WIDE_COMPARE(bitsLess, _CMP_LT_OQ)
RT_WIDE_COMPARE(bitsLessEqual, _CMP_LE_OQ)
inline Wide productMinus(Wide x, Wide y, Wide z) {
    return {_mm256_fmsub_ps(x.a, y.a, z.a), _mm256_fmsub_ps(x.b, y.b, z.b)};
}
inline Wide minusProduct(Wide x, Wide y, Wide z) {
    return {_mm256_fnmadd_ps(y.a, z.a, x.a), _mm256_fnmadd_ps(y.b, z.b, x.b)};
}
inline Wide magnitude(Wide x) {
    const __m256 sign = _mm256_set1_ps(-0.0f);
    return {_mm256_andnot_ps(sign, x.a), _mm256_andnot_ps(sign, x.b)};
}
inline Wide largerMagnitude(Wide x, Wide y) { return larger(magnitude(x), magnitude(y)); }
inline Wide smallerBits(Wide x, Wide y) {
    const F32 a = smallerBits(F32{x.a}, F32{y.a}), b = smallerBits(F32{x.b}, F32{y.b});
    return {a.v, b.v};
}
inline Wide largerBits(Wide x, Wide y) {
    const F32 a = largerBits(F32{x.a}, F32{y.a}), b = largerBits(F32{x.b}, F32{y.b});
    return {a.v, b.v};
}
inline unsigned lessEqualBits(Wide x, Wide y) {
    return lessEqualBits(F32{x.a}, F32{y.a}) | lessEqualBits(F32{x.b}, F32{y.b}) << 8;
}
inline float smallestOf(Wide x) {
    const __m256 v = _mm256_min_ps(x.a, x.b);
    __m128 w = _mm_min_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
    w = _mm_min_ps(w, _mm_movehl_ps(w, w));
    return _mm_cvtss_f32(_mm_min_ss(w, _mm_movehdup_ps(w)));
}
inline float largestOf(Wide x) {
    const __m256 v = _mm256_max_ps(x.a, x.b);
    __m128 w = _mm_max_ps(_mm256_castps256_ps128(v), _mm256_extractf128_ps(v, 1));
    w = _mm_max_ps(w, _mm_movehl_ps(w, w));
    return _mm_cvtss_f32(_mm_max_ss(w, _mm_movehdup_ps(w)));
}
inline Wide narrow(F64 low, F64 high) {
    return {_mm256_set_m128(_mm256_cvtpd_ps(low.b), _mm256_cvtpd_ps(low.a)),
            _mm256_set_m128(_mm256_cvtpd_ps(high.b), _mm256_cvtpd_ps(high.a))};
}

#undef RT_WIDE_BINARY
#undef RT_WIDE_COMPARE

// For Precision::f32.

inline F32 operator+(F32 x, F32 y) { return {_mm256_add_ps(x.v, y.v)}; }
inline F32 operator/(F32 x, F32 y) { return {_mm256_div_ps(x.v, y.v)}; }
inline F32 squareRoot(F32 x) { return {_mm256_sqrt_ps(x.v)}; }
inline unsigned bitsLess(F32 x, F32 y) {
    return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(x.v, y.v, _CMP_LT_OQ)));
}
inline void store(float* p, F32 x) { _mm256_store_ps(p, x.v); }
inline Wide operator/(Wide x, Wide y) { return {_mm256_div_ps(x.a, y.a), _mm256_div_ps(x.b, y.b)}; }
inline Wide squareRoot(Wide x) { return {_mm256_sqrt_ps(x.a), _mm256_sqrt_ps(x.b)}; }
using Fused = F32; // productMinus() is contracted anyway

/// Which of 16 lanes.
struct Indices {
    __m256i a, b;
};
inline __m256i eightIndices(const std::uint8_t* p) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)));
}
inline Indices indices(const std::uint8_t* p) { return {eightIndices(p), eightIndices(p + 8)}; }
inline __m256 eightPicked(__m256 low, __m256 high, __m256i i) {
    // Bit 3 of the index, moved to the sign, chooses the half.
    return _mm256_blendv_ps(_mm256_permutevar8x32_ps(low, i), _mm256_permutevar8x32_ps(high, i),
                            _mm256_castsi256_ps(_mm256_slli_epi32(i, 28)));
}
inline Wide picked(Wide x, Indices i) {
    return {eightPicked(x.a, x.b, i.a), eightPicked(x.a, x.b, i.b)};
}

/// x, y, z and a fourth.
struct Quad {
    __m256d v;
};

inline Quad loadQuad(const double* p) { return {_mm256_loadu_pd(p)}; }
inline Quad allQuad(double x) { return {_mm256_set1_pd(x)}; }
inline void store(double* p, Quad a) { _mm256_store_pd(p, a.v); }
inline Quad operator+(Quad a, Quad b) { return {_mm256_add_pd(a.v, b.v)}; }
inline Quad operator-(Quad a, Quad b) { return {_mm256_sub_pd(a.v, b.v)}; }
inline Quad operator*(Quad a, Quad b) { return {_mm256_mul_pd(a.v, b.v)}; }
inline Quad operator/(Quad a, Quad b) { return {_mm256_div_pd(a.v, b.v)}; }
inline Quad larger(Quad a, Quad b) { return {_mm256_max_pd(a.v, b.v)}; }
inline Quad magnitude(Quad a) { return {_mm256_andnot_pd(_mm256_set1_pd(-0.0), a.v)}; }
inline Quad withSignOf(Quad magnitudes, Quad signs) {
    return {_mm256_or_pd(magnitudes.v, _mm256_and_pd(_mm256_set1_pd(-0.0), signs.v))};
}
inline Quad withFourth(Quad a, double x) { return {_mm256_blend_pd(a.v, _mm256_set1_pd(x), 8)}; }
inline unsigned signsOf(Quad a) { return static_cast<unsigned>(_mm256_movemask_pd(a.v)) & 7; }
inline unsigned bitsLessEqual(Quad a, Quad b) {
    return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a.v, b.v, _CMP_LE_OQ)));
}
/// Bit 0: x > y; 1: x > z; 2: y > z.
inline unsigned orderOfSizes(Quad a) {
    return static_cast<unsigned>(_mm256_movemask_pd(
               _mm256_cmp_pd(_mm256_permute4x64_pd(a.v, 0b010000),
                             _mm256_permute4x64_pd(a.v, 0b101001), _CMP_GT_OQ))) &
           7;
}
inline double productPlus(double a, double b, double c) { return __builtin_fma(a, b, c); }
inline Four narrow(Quad a) { return {_mm256_cvtpd_ps(a.v)}; }
/// Number i of four.
template <int i> inline F32 all(Four a) {
    return {_mm256_broadcastss_ps(_mm_permute_ps(a.v, 0x55 * i))};
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

/// The slots in `mask`, farthest first.
[[gnu::always_inline]] inline __m256i inOrder(const Order& order, unsigned mask) {
    const __m256i wanted = _mm256_and_si256(order.bit, _mm256_set1_epi32(static_cast<int>(mask)));
    const unsigned m = static_cast<unsigned>(
        _mm256_movemask_ps(_mm256_castsi256_ps(_mm256_cmpeq_epi32(wanted, order.bit))));
    return _mm256_permutevar8x32_epi32(order.slots, compressing(m));
}

/// Puts the children in `mask` on the stack, farthest first.
[[gnu::always_inline]] inline void pushAll(const Order& order, const Node& node, F32 enter,
                                           unsigned mask, std::uint32_t* references, float* enters,
                                           std::size_t& top) {
    const __m256i from = inOrder(order, mask);
    const __m256i child = _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_permutevar8x32_epi32(child, from));
    _mm256_storeu_ps(enters + top, _mm256_permutevar8x32_ps(enter.v, from));
    top += static_cast<unsigned>(__builtin_popcount(mask));
}

/// Puts slots of a node on the stack, farthest first, as base + slot.
[[gnu::always_inline]] inline void pushSlots(const Order& order, std::uint32_t base, F32 enter,
                                             unsigned mask, std::uint32_t* references,
                                             float* enters, std::size_t& top) {
    const __m256i from = inOrder(order, mask);
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_or_si256(from, _mm256_set1_epi32(static_cast<int>(base))));
    _mm256_storeu_ps(enters + top, _mm256_permutevar8x32_ps(enter.v, from));
    top += static_cast<unsigned>(__builtin_popcount(mask));
}

/// Puts the children in `mask` on the stack in any order.
[[gnu::always_inline]] inline void pushAny(const Node& node, unsigned mask,
                                           std::uint32_t* references, std::size_t& top) {
    const __m256i child = _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_permutevar8x32_epi32(child, compressing(mask)));
    top += static_cast<unsigned>(__builtin_popcount(mask));
}

/// 16 sheared corners in the order of SharedBlock::corner.
struct SharedCorners {
    F64 x0, x1, y0, y1, z0, z1;
};

inline __m256 narrowed(F64 a, double scale) {
    const __m256d s = _mm256_set1_pd(scale);
    return _mm256_set_m128(_mm256_cvtpd_ps(_mm256_mul_pd(a.b, s)),
                           _mm256_cvtpd_ps(_mm256_mul_pd(a.a, s)));
}

/// Triangles of a shared block whose f32 edge functions do not rule them out: see kernel.inl.
template <class Block>
[[gnu::always_inline]] inline unsigned ruledIn(const Block& block, const SharedCorners& c,
                                               double scale) {
    const __m256 x0 = narrowed(c.x0, scale), x1 = narrowed(c.x1, scale);
    const __m256 y0 = narrowed(c.y0, scale), y1 = narrowed(c.y1, scale);
    unsigned in = 0;
    for (int half = 0; half < 2; ++half) {
        const auto pick = [&](int corner, __m256 low, __m256 high) {
            return eightPicked(low, high, eightIndices(block.index[corner] + 8 * half));
        };
        const __m256 ax = pick(0, x0, x1), ay = pick(0, y0, y1), bx = pick(1, x0, x1),
                     by = pick(1, y0, y1), cx = pick(2, x0, x1), cy = pick(2, y0, y1);
        const __m256 u = _mm256_fmsub_ps(cx, by, _mm256_mul_ps(cy, bx));
        const __m256 v = _mm256_fmsub_ps(ax, cy, _mm256_mul_ps(ay, cx));
        const __m256 w = _mm256_fmsub_ps(bx, ay, _mm256_mul_ps(by, ax));
        const auto size = [](__m256 p, __m256 q) {
            const __m256 sign = _mm256_set1_ps(-0.0f);
            return _mm256_max_ps(_mm256_andnot_ps(sign, p), _mm256_andnot_ps(sign, q));
        };
        const __m256 m = _mm256_max_ps(_mm256_max_ps(size(ax, ay), size(bx, by)), size(cx, cy));
        const __m256 bound = _mm256_fmadd_ps(_mm256_mul_ps(_mm256_set1_ps(kFilterBound), m), m,
                                             _mm256_set1_ps(kFilterUnderflow));
        const __m256 least = _mm256_min_ps(_mm256_min_ps(u, v), w);
        const __m256 most = _mm256_max_ps(_mm256_max_ps(u, v), w);
        const __m256 out = _mm256_and_ps(
            _mm256_cmp_ps(_mm256_add_ps(least, bound), _mm256_setzero_ps(), _CMP_LT_OQ),
            _mm256_cmp_ps(most, bound, _CMP_GT_OQ));
        in |= (~static_cast<unsigned>(_mm256_movemask_ps(out)) & 255) << (8 * half);
    }
    return block.valid & in;
}
