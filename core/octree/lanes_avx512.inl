// 8 lanes on AVX-512: f64 in one register, f32 in half a one.

struct F64 {
    __m512d v;
};
using Mask = __mmask8;

inline F64 load(const double* p) { return {_mm512_load_pd(p)}; }
inline F64 widened(const double* p) { return load(p); }
inline F64 widened(const float* p) { return {_mm512_cvtps_pd(_mm256_load_ps(p))}; }
inline F64 all(double x) { return {_mm512_set1_pd(x)}; }
inline void store(double* p, F64 a) { _mm512_store_pd(p, a.v); }
inline F64 operator+(F64 a, F64 b) { return {_mm512_add_pd(a.v, b.v)}; }
inline F64 operator-(F64 a, F64 b) { return {_mm512_sub_pd(a.v, b.v)}; }
inline F64 operator*(F64 a, F64 b) { return {_mm512_mul_pd(a.v, b.v)}; }
inline F64 operator/(F64 a, F64 b) { return {_mm512_div_pd(a.v, b.v)}; }
inline F64 productMinus(F64 a, F64 b, F64 c) { return {_mm512_fmsub_pd(a.v, b.v, c.v)}; }
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
    return _mm256_cmple_epi32_mask(_mm256_castps_si256(a.v), _mm256_castps_si256(b.v));
}
inline F32 productMinus(F32 a, F32 b, F32 c) { return {_mm256_fmsub_ps(a.v, b.v, c.v)}; }
inline unsigned bitsLessEqual(F32 a, F32 b) { return _mm256_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ); }

inline F64 magnitude(F64 a) { return {_mm512_abs_pd(a.v)}; }
inline F64 withSignOf(F64 magnitudes, F64 signs) {
    return {_mm512_or_pd(magnitudes.v, _mm512_and_pd(_mm512_set1_pd(-0.0), signs.v))};
}
inline unsigned signsOf(F64 a) { return _mm512_movepi64_mask(_mm512_castpd_si512(a.v)); }
inline Mask maskOf(unsigned bits) { return static_cast<Mask>(bits); }

/// The powers of two at or below normal a, 2^-1022 <= a < 2^1022, and their inverses.
inline F64 powerBelow(F64 a, F64& inverse) {
    const __m512i exponent =
        _mm512_and_si512(_mm512_castpd_si512(a.v), _mm512_set1_epi64(0x7FF0000000000000));
    inverse.v =
        _mm512_castsi512_pd(_mm512_sub_epi64(_mm512_set1_epi64(0x7FE0000000000000), exponent));
    return {_mm512_castsi512_pd(exponent)};
}

/// The lanes of `ids` that are `id`.
inline unsigned bitsEqual(const std::uint32_t* ids, std::uint32_t id) {
    return _mm256_cmpeq_epi32_mask(_mm256_load_si256(reinterpret_cast<const __m256i*>(ids)),
                                   _mm256_set1_epi32(static_cast<int>(id)));
}
/// The lower halves of 8 doubles' bits.
inline void storeLowWords(std::uint32_t* p, F64 a) {
    _mm256_store_si256(reinterpret_cast<__m256i*>(p),
                       _mm512_cvtepi64_epi32(_mm512_castpd_si512(a.v)));
}
inline void storeWhere(unsigned bits, std::uint32_t* ids, std::uint32_t id) {
    _mm256_mask_store_epi32(ids, static_cast<__mmask8>(bits),
                            _mm256_set1_epi32(static_cast<int>(id)));
}

/// columns[i]: double i of 8 rays.
inline void transpose(const geometry::Ray* rays, F64 columns[8]) {
    const auto* const p = reinterpret_cast<const double*>(rays);
    const auto row = [&](int i) { return _mm512_loadu_pd(p + 8 * i); };
    const auto four = [](__m512d a, __m512d b, __m512d c, __m512d d, F64* low, F64* high) {
        const __m512d ab04 = _mm512_shuffle_f64x2(a, b, 0x88),
                      cd04 = _mm512_shuffle_f64x2(c, d, 0x88);
        const __m512d ab26 = _mm512_shuffle_f64x2(a, b, 0xDD),
                      cd26 = _mm512_shuffle_f64x2(c, d, 0xDD);
        low[0].v = _mm512_shuffle_f64x2(ab04, cd04, 0x88);
        high[0].v = _mm512_shuffle_f64x2(ab04, cd04, 0xDD);
        low[2].v = _mm512_shuffle_f64x2(ab26, cd26, 0x88);
        high[2].v = _mm512_shuffle_f64x2(ab26, cd26, 0xDD);
    };
    const __m512d r0 = row(0), r1 = row(1), r2 = row(2), r3 = row(3), r4 = row(4), r5 = row(5),
                  r6 = row(6), r7 = row(7);
    four(_mm512_unpacklo_pd(r0, r1), _mm512_unpacklo_pd(r2, r3), _mm512_unpacklo_pd(r4, r5),
         _mm512_unpacklo_pd(r6, r7), columns, columns + 4);
    four(_mm512_unpackhi_pd(r0, r1), _mm512_unpackhi_pd(r2, r3), _mm512_unpackhi_pd(r4, r5),
         _mm512_unpackhi_pd(r6, r7), columns + 1, columns + 5);
}

inline F32 operator-(F32 a, F32 b) { return {_mm256_sub_ps(a.v, b.v)}; }
inline F32 operator*(F32 a, F32 b) { return {_mm256_mul_ps(a.v, b.v)}; }

/// f32 of 16 rays.
struct Wide {
    __m512 v;
};

inline Wide loadWide(const float* p) { return {_mm512_load_ps(p)}; }
inline Wide allWide(float x) { return {_mm512_set1_ps(x)}; }
inline void store(float* p, Wide a) { _mm512_store_ps(p, a.v); }
inline Wide operator+(Wide a, Wide b) { return {_mm512_add_ps(a.v, b.v)}; }
inline Wide operator-(Wide a, Wide b) { return {_mm512_sub_ps(a.v, b.v)}; }
inline Wide operator*(Wide a, Wide b) { return {_mm512_mul_ps(a.v, b.v)}; }
inline Wide productMinus(Wide a, Wide b, Wide c) { return {_mm512_fmsub_ps(a.v, b.v, c.v)}; }
inline Wide minusProduct(Wide a, Wide b, Wide c) { return {_mm512_fnmadd_ps(b.v, c.v, a.v)}; }
inline Wide smaller(Wide a, Wide b) { return {_mm512_min_ps(a.v, b.v)}; }
inline Wide larger(Wide a, Wide b) { return {_mm512_max_ps(a.v, b.v)}; }
inline Wide magnitude(Wide a) { return {_mm512_abs_ps(a.v)}; }
inline Wide largerMagnitude(Wide a, Wide b) {
    constexpr int kLargest = 0b0011, kPositive = 0b1000; // of the immediate
    return {_mm512_range_ps(a.v, b.v, kLargest | kPositive)};
}
inline unsigned bitsLess(Wide a, Wide b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ); }
inline unsigned bitsLessEqual(Wide a, Wide b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LE_OQ); }
inline Wide smallerBits(Wide a, Wide b) {
    return {
        _mm512_castsi512_ps(_mm512_min_epi32(_mm512_castps_si512(a.v), _mm512_castps_si512(b.v)))};
}
inline Wide largerBits(Wide a, Wide b) {
    return {
        _mm512_castsi512_ps(_mm512_max_epi32(_mm512_castps_si512(a.v), _mm512_castps_si512(b.v)))};
}
inline unsigned lessEqualBits(Wide a, Wide b) {
    return _mm512_cmple_epi32_mask(_mm512_castps_si512(a.v), _mm512_castps_si512(b.v));
}
inline float smallestOf(Wide a) { return _mm512_reduce_min_ps(a.v); }
inline float largestOf(Wide a) { return _mm512_reduce_max_ps(a.v); }
inline Wide narrow(F64 low, F64 high) {
    return {_mm512_insertf32x8(_mm512_castps256_ps512(_mm512_cvtpd_ps(low.v)),
                               _mm512_cvtpd_ps(high.v), 1)};
}

// For Precision::f32.

inline F32 operator+(F32 a, F32 b) { return {_mm256_add_ps(a.v, b.v)}; }
inline F32 operator/(F32 a, F32 b) { return {_mm256_div_ps(a.v, b.v)}; }
inline F32 squareRoot(F32 a) { return {_mm256_sqrt_ps(a.v)}; }
inline unsigned bitsLess(F32 a, F32 b) { return _mm256_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ); }
inline void store(float* p, F32 a) { _mm256_store_ps(p, a.v); }
inline Wide operator/(Wide a, Wide b) { return {_mm512_div_ps(a.v, b.v)}; }
inline Wide squareRoot(Wide a) { return {_mm512_sqrt_ps(a.v)}; }
using Fused = F32; // productMinus() is contracted anyway

/// Which of 16 lanes.
struct Indices {
    __m512i v;
};
inline Indices indices(const std::uint8_t* p) {
    return {_mm512_cvtepu8_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(p)))};
}
inline Wide picked(Wide a, Indices i) { return {_mm512_permutexvar_ps(i.v, a.v)}; }

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
inline unsigned bitsLessEqual(Quad a, Quad b) { return _mm256_cmp_pd_mask(a.v, b.v, _CMP_LE_OQ); }
/// Bit 0: x > y; 1: x > z; 2: y > z.
inline unsigned orderOfSizes(Quad a) {
    return _mm256_cmp_pd_mask(_mm256_permute4x64_pd(a.v, 0b010000),
                              _mm256_permute4x64_pd(a.v, 0b101001), _CMP_GT_OQ) &
           7;
}
inline double productPlus(double a, double b, double c) { return __builtin_fma(a, b, c); }
inline Four narrow(Quad a) { return {_mm256_cvtpd_ps(a.v)}; }
/// Number i of four.
template <int i> inline F32 all(Four a) {
    return {_mm256_permutevar8x32_ps(_mm256_castps128_ps256(a.v), _mm256_set1_epi32(i))};
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

/// Puts the children in `mask` on the stack, farthest first.
inline void pushAll(const Order& order, const Node& node, F32 enter, unsigned mask,
                    std::uint32_t* references, float* enters, std::size_t& top) {
    const __m256i child = _mm256_permutevar8x32_epi32(
        _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child)), order.slots);
    const __m256 t = _mm256_permutevar8x32_ps(enter.v, order.slots);
    const __mmask8 m = _mm256_test_epi32_mask(order.bit, _mm256_set1_epi32(static_cast<int>(mask)));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_maskz_compress_epi32(m, child));
    _mm256_storeu_ps(enters + top, _mm256_maskz_compress_ps(m, t));
    top += static_cast<unsigned>(__builtin_popcount(mask));
}

/// Puts slots of a node on the stack, farthest first, as base + slot.
inline void pushSlots(const Order& order, std::uint32_t base, F32 enter, unsigned mask,
                      std::uint32_t* references, float* enters, std::size_t& top) {
    const __mmask8 m = _mm256_test_epi32_mask(order.bit, _mm256_set1_epi32(static_cast<int>(mask)));
    _mm256_storeu_si256(
        reinterpret_cast<__m256i*>(references + top),
        _mm256_maskz_compress_epi32(
            m, _mm256_or_si256(order.slots, _mm256_set1_epi32(static_cast<int>(base)))));
    _mm256_storeu_ps(enters + top,
                     _mm256_maskz_compress_ps(m, _mm256_permutevar8x32_ps(enter.v, order.slots)));
    top += static_cast<unsigned>(__builtin_popcount(mask));
}

/// Puts the children in `mask` on the stack in any order.
inline void pushAny(const Node& node, unsigned mask, std::uint32_t* references, std::size_t& top) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(references + top),
                        _mm256_maskz_compress_epi32(
                            static_cast<__mmask8>(mask),
                            _mm256_load_si256(reinterpret_cast<const __m256i*>(node.child))));
    top += static_cast<unsigned>(__builtin_popcount(mask));
}

/// 16 sheared corners in the order of SharedBlock::corner.
struct SharedCorners {
    F64 x0, x1, y0, y1, z0, z1;
};

/// Edge functions of one triangle.
struct OneEdges {
    double u, v, w;
    bool areInside;
};

/// What is left to do for the triangles that candidates() returns, one by one.
struct alignas(64) SharedArray {
    double u[kSharedLanes], v[kSharedLanes], w[kSharedLanes]; // edge functions, by triangle
    double z[kSharedLanes];                                   // by corner
};

/// An edge function is the difference of two products, and has the sign of their comparison.
struct Products {
    F64 plus, minus;
};

/// Triangles of a shared block that the ray's line meets: their f64 edge functions agree in sign. 16 at once
/// cost no more than an f32 filter of them (octree_bench, bunny, Xeon with AVX-512: 4 % faster), and comparing products
/// takes less long than subtracting them and comparing what is least and most with 0 (1 to 3 % faster).
template <class Block>
[[gnu::always_inline]] inline unsigned candidates(const Block& block, const SharedCorners& corners,
                                                  double, SharedArray& to) {
    Products u[2], v[2], w[2];
    unsigned in = 0;
    for (int half = 0; half < 2; ++half) {
        const auto indices = [&](int corner) {
            return _mm512_cvtepu8_epi64(_mm_loadl_epi64(
                reinterpret_cast<const __m128i*>(block.index[corner] + kLanes * half)));
        };
        const __m512i a = indices(0), b = indices(1), c = indices(2);
        const auto x = [&](__m512i i) -> F64 {
            return {_mm512_permutex2var_pd(corners.x0.v, i, corners.x1.v)};
        };
        const auto y = [&](__m512i i) -> F64 {
            return {_mm512_permutex2var_pd(corners.y0.v, i, corners.y1.v)};
        };
        u[half] = {x(c) * y(b), y(c) * x(b)};
        v[half] = {x(a) * y(c), y(a) * x(c)};
        w[half] = {x(b) * y(a), y(b) * x(a)};
        const Mask noneAbove =
            both(both(u[half].plus <= u[half].minus, v[half].plus <= v[half].minus),
                 w[half].plus <= w[half].minus);
        const Mask noneBelow =
            both(both(u[half].plus >= u[half].minus, v[half].plus >= v[half].minus),
                 w[half].plus >= w[half].minus);
        in |= bits(either(noneAbove, noneBelow)) << (kLanes * half);
    }
    in &= block.valid;
    if (!in) return 0;
    for (int half = 0; half < 2; ++half) {
        store(to.u + kLanes * half, u[half].plus - u[half].minus);
        store(to.v + kLanes * half, v[half].plus - v[half].minus);
        store(to.w + kLanes * half, w[half].plus - w[half].minus);
    }
    store(to.z, corners.z0);
    store(to.z + kLanes, corners.z1);
    return in;
}

template <class Block>
[[gnu::always_inline]] inline OneEdges edgesAt(const SharedArray& p, const Block&, int lane) {
    return {p.u[lane], p.v[lane], p.w[lane], true};
}
