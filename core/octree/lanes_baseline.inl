// 8 lanes on SSE2, which every x86-64 has: f64 in four registers, f32 in two.

struct F64 {
    __m128d a, b, c, d;
};
struct Mask {
    __m128d a, b, c, d;
};

#define RT_LANES_BINARY(type, name, op)                                                            \
    inline type name(F64 x, F64 y) {                                                               \
        return {op(x.a, y.a), op(x.b, y.b), op(x.c, y.c), op(x.d, y.d)};                           \
    }

inline F64 load(const double* p) {
    return {_mm_load_pd(p), _mm_load_pd(p + 2), _mm_load_pd(p + 4), _mm_load_pd(p + 6)};
}
inline F64 widened(const double* p) { return load(p); }
inline F64 widened(const float* p) {
    const __m128 l = _mm_load_ps(p), h = _mm_load_ps(p + 4);
    return {_mm_cvtps_pd(l), _mm_cvtps_pd(_mm_movehl_ps(l, l)), _mm_cvtps_pd(h),
            _mm_cvtps_pd(_mm_movehl_ps(h, h))};
}
inline F64 all(double x) {
    const __m128d v = _mm_set1_pd(x);
    return {v, v, v, v};
}
inline void store(double* p, F64 x) {
    _mm_store_pd(p, x.a);
    _mm_store_pd(p + 2, x.b);
    _mm_store_pd(p + 4, x.c);
    _mm_store_pd(p + 6, x.d);
}
RT_LANES_BINARY(F64, operator+, _mm_add_pd)
RT_LANES_BINARY(F64, operator-, _mm_sub_pd)
RT_LANES_BINARY(F64, operator*, _mm_mul_pd)
RT_LANES_BINARY(F64, operator/, _mm_div_pd)
RT_LANES_BINARY(F64, smaller, _mm_min_pd) // a < b ? a : b
RT_LANES_BINARY(F64, larger, _mm_max_pd)  // a > b ? a : b
RT_LANES_BINARY(Mask, operator<, _mm_cmplt_pd)
RT_LANES_BINARY(Mask, operator<=, _mm_cmple_pd)
RT_LANES_BINARY(Mask, operator>, _mm_cmpgt_pd)
RT_LANES_BINARY(Mask, operator>=, _mm_cmpge_pd)
RT_LANES_BINARY(Mask, operator==, _mm_cmpeq_pd)
inline __m128d notEqualOrdered(__m128d x, __m128d y) {
    return _mm_and_pd(_mm_cmpneq_pd(x, y), _mm_cmpord_pd(x, y));
}
RT_LANES_BINARY(Mask, operator!=, notEqualOrdered)
inline F64 productMinus(F64 x, F64 y, F64 z) { return x * y - z; }
inline F64 squareRoot(F64 x) {
    return {_mm_sqrt_pd(x.a), _mm_sqrt_pd(x.b), _mm_sqrt_pd(x.c), _mm_sqrt_pd(x.d)};
}
inline __m128d choose(__m128d m, __m128d x, __m128d y) {
    return _mm_or_pd(_mm_and_pd(m, x), _mm_andnot_pd(m, y));
}
inline F64 select(Mask m, F64 x, F64 y) {
    return {choose(m.a, x.a, y.a), choose(m.b, x.b, y.b), choose(m.c, x.c, y.c),
            choose(m.d, x.d, y.d)};
}
inline Mask both(Mask x, Mask y) {
    return {_mm_and_pd(x.a, y.a), _mm_and_pd(x.b, y.b), _mm_and_pd(x.c, y.c), _mm_and_pd(x.d, y.d)};
}
inline Mask either(Mask x, Mask y) {
    return {_mm_or_pd(x.a, y.a), _mm_or_pd(x.b, y.b), _mm_or_pd(x.c, y.c), _mm_or_pd(x.d, y.d)};
}
inline unsigned bits(Mask m) {
    return static_cast<unsigned>(_mm_movemask_pd(m.a) | _mm_movemask_pd(m.b) << 2 |
                                 _mm_movemask_pd(m.c) << 4 | _mm_movemask_pd(m.d) << 6);
}

#undef RT_LANES_BINARY

struct F32 {
    __m128 a, b;
};

inline F32 load(const float* p) { return {_mm_load_ps(p), _mm_load_ps(p + 4)}; }
inline F32 all(float x) {
    const __m128 v = _mm_set1_ps(x);
    return {v, v};
}
inline F32 smaller(F32 x, F32 y) { return {_mm_min_ps(x.a, y.a), _mm_min_ps(x.b, y.b)}; }
inline F32 larger(F32 x, F32 y) { return {_mm_max_ps(x.a, y.a), _mm_max_ps(x.b, y.b)}; }
inline F32 productMinus(F32 x, F32 y, F32 z) {
    return {_mm_sub_ps(_mm_mul_ps(x.a, y.a), z.a), _mm_sub_ps(_mm_mul_ps(x.b, y.b), z.b)};
}
inline unsigned bitsLessEqual(F32 x, F32 y) {
    return static_cast<unsigned>(_mm_movemask_ps(_mm_cmple_ps(x.a, y.a)) |
                                 _mm_movemask_ps(_mm_cmple_ps(x.b, y.b)) << 4);
}

inline F32 smallerBits(F32 x, F32 y) { return smaller(x, y); }
inline F32 largerBits(F32 x, F32 y) { return larger(x, y); }
inline unsigned lessEqualBits(F32 x, F32 y) { return bitsLessEqual(x, y); }

inline F64 magnitude(F64 x) {
    const __m128d sign = _mm_set1_pd(-0.0);
    return {_mm_andnot_pd(sign, x.a), _mm_andnot_pd(sign, x.b), _mm_andnot_pd(sign, x.c),
            _mm_andnot_pd(sign, x.d)};
}
inline F64 withSignOf(F64 m, F64 s) {
    const __m128d sign = _mm_set1_pd(-0.0);
    return {_mm_or_pd(m.a, _mm_and_pd(sign, s.a)), _mm_or_pd(m.b, _mm_and_pd(sign, s.b)),
            _mm_or_pd(m.c, _mm_and_pd(sign, s.c)), _mm_or_pd(m.d, _mm_and_pd(sign, s.d))};
}
inline unsigned signsOf(F64 x) { return bits({x.a, x.b, x.c, x.d}); }
inline Mask maskOf(unsigned bits) {
    alignas(16) std::uint64_t m[kLanes];
    for (unsigned i = 0; i < kLanes; ++i) m[i] = 0 - static_cast<std::uint64_t>(bits >> i & 1);
    const auto pair = [&](int i) {
        return _mm_castsi128_pd(_mm_load_si128(reinterpret_cast<const __m128i*>(m + i)));
    };
    return {pair(0), pair(2), pair(4), pair(6)};
}

/// The powers of two at or below normal x, 2^-1022 <= x < 2^1022, and their inverses.
inline F64 powerBelow(F64 x, F64& inverse) {
    const __m128i bits = _mm_set1_epi64x(0x7FF0000000000000);
    const __m128i two = _mm_set1_epi64x(0x7FE0000000000000);
    const auto power = [&](__m128d v, __m128d& other) {
        const __m128i p = _mm_and_si128(_mm_castpd_si128(v), bits);
        other = _mm_castsi128_pd(_mm_sub_epi64(two, p));
        return _mm_castsi128_pd(p);
    };
    return {power(x.a, inverse.a), power(x.b, inverse.b), power(x.c, inverse.c),
            power(x.d, inverse.d)};
}

/// The lanes of `ids` that are `id`.
inline unsigned bitsEqual(const std::uint32_t* ids, std::uint32_t id) {
    const auto four = [&](int i) {
        return _mm_movemask_ps(_mm_castsi128_ps(
            _mm_cmpeq_epi32(_mm_load_si128(reinterpret_cast<const __m128i*>(ids + i)),
                            _mm_set1_epi32(static_cast<int>(id)))));
    };
    return static_cast<unsigned>(four(0) | four(4) << 4);
}
/// The lower halves of 8 doubles' bits.
inline void storeLowWords(std::uint32_t* p, F64 x) {
    const auto four = [](__m128d a, __m128d b) {
        return _mm_shuffle_ps(_mm_castpd_ps(a), _mm_castpd_ps(b), 0x88);
    };
    _mm_store_ps(reinterpret_cast<float*>(p), four(x.a, x.b));
    _mm_store_ps(reinterpret_cast<float*>(p + 4), four(x.c, x.d));
}
inline void storeWhere(unsigned bits, std::uint32_t* ids, std::uint32_t id) {
    for (; bits; bits &= bits - 1) ids[__builtin_ctz(bits)] = id;
}

/// columns[i]: double i of 8 rays.
inline void transpose(const geometry::Ray* rays, F64 columns[8]) {
    const auto* const p = reinterpret_cast<const double*>(rays);
    const auto column = [&](int c, int row) {
        return _mm_set_pd(p[8 * (row + 1) + c], p[8 * row + c]);
    };
    for (int c = 0; c < 8; ++c)
        columns[c] = {column(c, 0), column(c, 2), column(c, 4), column(c, 6)};
}

inline F32 operator-(F32 x, F32 y) { return {_mm_sub_ps(x.a, y.a), _mm_sub_ps(x.b, y.b)}; }
inline F32 operator*(F32 x, F32 y) { return {_mm_mul_ps(x.a, y.a), _mm_mul_ps(x.b, y.b)}; }

/// f32 of 16 rays.
struct Wide {
    __m128 a, b, c, d;
};

#define RT_WIDE_BINARY(name, op)                                                                   \
    inline Wide name(Wide x, Wide y) {                                                             \
        return {op(x.a, y.a), op(x.b, y.b), op(x.c, y.c), op(x.d, y.d)};                           \
    }
#define RT_WIDE_COMPARE(name, op)                                                                  \
    inline unsigned name(Wide x, Wide y) {                                                         \
        return static_cast<unsigned>(                                                              \
            _mm_movemask_ps(op(x.a, y.a)) | _mm_movemask_ps(op(x.b, y.b)) << 4 |                   \
            _mm_movemask_ps(op(x.c, y.c)) << 8 | _mm_movemask_ps(op(x.d, y.d)) << 12);             \
    }

inline Wide loadWide(const float* p) {
    return {_mm_load_ps(p), _mm_load_ps(p + 4), _mm_load_ps(p + 8), _mm_load_ps(p + 12)};
}
inline Wide allWide(float x) {
    const __m128 v = _mm_set1_ps(x);
    return {v, v, v, v};
}
inline void store(float* p, Wide x) {
    _mm_store_ps(p, x.a);
    _mm_store_ps(p + 4, x.b);
    _mm_store_ps(p + 8, x.c);
    _mm_store_ps(p + 12, x.d);
}
RT_WIDE_BINARY(operator+, _mm_add_ps)
RT_WIDE_BINARY(operator-, _mm_sub_ps)
RT_WIDE_BINARY(operator*, _mm_mul_ps)
RT_WIDE_BINARY(smaller, _mm_min_ps)
RT_WIDE_BINARY(larger, _mm_max_ps)
RT_WIDE_COMPARE(bitsLess, _mm_cmplt_ps)
RT_WIDE_COMPARE(bitsLessEqual, _mm_cmple_ps)
inline Wide productMinus(Wide x, Wide y, Wide z) { return x * y - z; }
inline Wide minusProduct(Wide x, Wide y, Wide z) { return x - y * z; }
inline Wide magnitude(Wide x) {
    const __m128 sign = _mm_set1_ps(-0.0f);
    return {_mm_andnot_ps(sign, x.a), _mm_andnot_ps(sign, x.b), _mm_andnot_ps(sign, x.c),
            _mm_andnot_ps(sign, x.d)};
}
inline Wide largerMagnitude(Wide x, Wide y) { return larger(magnitude(x), magnitude(y)); }
inline Wide smallerBits(Wide x, Wide y) { return smaller(x, y); }
inline Wide largerBits(Wide x, Wide y) { return larger(x, y); }
inline unsigned lessEqualBits(Wide x, Wide y) { return bitsLessEqual(x, y); }
inline float smallestOf(Wide x) {
    alignas(16) float v[4];
    _mm_store_ps(v, _mm_min_ps(_mm_min_ps(x.a, x.b), _mm_min_ps(x.c, x.d)));
    float least = v[0];
    for (const float f : v) least = f < least ? f : least;
    return least;
}
inline float largestOf(Wide x) {
    alignas(16) float v[4];
    _mm_store_ps(v, _mm_max_ps(_mm_max_ps(x.a, x.b), _mm_max_ps(x.c, x.d)));
    float most = v[0];
    for (const float f : v) most = f > most ? f : most;
    return most;
}
inline Wide narrow(F64 low, F64 high) {
    const auto four = [](__m128d x, __m128d y) {
        return _mm_movelh_ps(_mm_cvtpd_ps(x), _mm_cvtpd_ps(y));
    };
    return {four(low.a, low.b), four(low.c, low.d), four(high.a, high.b), four(high.c, high.d)};
}

#undef RT_WIDE_BINARY
#undef RT_WIDE_COMPARE

// For Precision::f32.

inline F32 operator+(F32 x, F32 y) { return {_mm_add_ps(x.a, y.a), _mm_add_ps(x.b, y.b)}; }
inline F32 operator/(F32 x, F32 y) { return {_mm_div_ps(x.a, y.a), _mm_div_ps(x.b, y.b)}; }
inline F32 squareRoot(F32 x) { return {_mm_sqrt_ps(x.a), _mm_sqrt_ps(x.b)}; }
inline unsigned bitsLess(F32 x, F32 y) {
    return static_cast<unsigned>(_mm_movemask_ps(_mm_cmplt_ps(x.a, y.a)) |
                                 _mm_movemask_ps(_mm_cmplt_ps(x.b, y.b)) << 4);
}
inline void store(float* p, F32 x) {
    _mm_store_ps(p, x.a);
    _mm_store_ps(p + 4, x.b);
}
inline Wide operator/(Wide x, Wide y) {
    return {_mm_div_ps(x.a, y.a), _mm_div_ps(x.b, y.b), _mm_div_ps(x.c, y.c), _mm_div_ps(x.d, y.d)};
}

inline Wide squareRoot(Wide x) {
    return {_mm_sqrt_ps(x.a), _mm_sqrt_ps(x.b), _mm_sqrt_ps(x.c), _mm_sqrt_ps(x.d)};
}

/// Lanes whose productMinus() is contracted.
struct Fused : F32 {};

/// x·y − z rounded once. The product is exact in f64; the difference is rounded to odd, so that rounding it again
/// to f32 changes nothing [Boldo, Melquiond 2008].
inline __m128 fused(__m128d x, __m128d y, __m128d z) {
    const __m128d p = _mm_mul_pd(x, y), s = _mm_sub_pd(p, z);
    const __m128d back = _mm_sub_pd(s, p); // [Knuth 1997, 4.2.2]
    const __m128d error = _mm_sub_pd(_mm_sub_pd(p, _mm_sub_pd(s, back)), _mm_add_pd(z, back));
    const __m128i raw = _mm_castpd_si128(s), one = _mm_set1_epi64x(1);
    const __m128i isEven = _mm_sub_epi64(_mm_and_si128(raw, one), one);
    const __m128i signs = _mm_castpd_si128(_mm_xor_pd(s, error));
    const __m128i outward = _mm_or_si128( // 1, or −1 where the error points to 0
        _mm_shuffle_epi32(_mm_srai_epi32(signs, 31), 0xF5), one);
    const __m128i isInexact = _mm_castpd_si128(notEqualOrdered(error, _mm_setzero_pd()));
    return _mm_cvtpd_ps(_mm_castsi128_pd(
        _mm_add_epi64(raw, _mm_and_si128(outward, _mm_and_si128(isEven, isInexact)))));
}
inline __m128 fused(__m128 x, __m128 y, __m128 z) {
    const auto high = [](__m128 v) { return _mm_cvtps_pd(_mm_movehl_ps(v, v)); };
    return _mm_movelh_ps(fused(_mm_cvtps_pd(x), _mm_cvtps_pd(y), _mm_cvtps_pd(z)),
                         fused(high(x), high(y), high(z)));
}
inline F32 productMinus(F32 x, Fused y, Fused z) {
    return {fused(x.a, y.a, z.a), fused(x.b, y.b, z.b)};
}

/// Which of 16 lanes.
struct Indices {
    const std::uint8_t* of;
};
inline Indices indices(const std::uint8_t* p) { return {p}; }
inline Wide picked(Wide x, Indices i) {
    alignas(16) float from[kSharedLanes], to[kSharedLanes];
    store(from, x);
    for (int k = 0; k < kSharedLanes; ++k) to[k] = from[i.of[k]];
    return loadWide(to);
}

/// x, y, z and a fourth.
struct Quad {
    __m128d a, b;
};

inline Quad loadQuad(const double* p) { return {_mm_loadu_pd(p), _mm_loadu_pd(p + 2)}; }
inline Quad allQuad(double x) {
    const __m128d v = _mm_set1_pd(x);
    return {v, v};
}
inline void store(double* p, Quad x) {
    _mm_store_pd(p, x.a);
    _mm_store_pd(p + 2, x.b);
}
inline Quad operator+(Quad x, Quad y) { return {_mm_add_pd(x.a, y.a), _mm_add_pd(x.b, y.b)}; }
inline Quad operator-(Quad x, Quad y) { return {_mm_sub_pd(x.a, y.a), _mm_sub_pd(x.b, y.b)}; }
inline Quad operator*(Quad x, Quad y) { return {_mm_mul_pd(x.a, y.a), _mm_mul_pd(x.b, y.b)}; }
inline Quad operator/(Quad x, Quad y) { return {_mm_div_pd(x.a, y.a), _mm_div_pd(x.b, y.b)}; }
inline Quad larger(Quad x, Quad y) { return {_mm_max_pd(x.a, y.a), _mm_max_pd(x.b, y.b)}; }
inline Quad magnitude(Quad x) {
    const __m128d sign = _mm_set1_pd(-0.0);
    return {_mm_andnot_pd(sign, x.a), _mm_andnot_pd(sign, x.b)};
}
inline Quad withSignOf(Quad magnitudes, Quad signs) {
    const __m128d sign = _mm_set1_pd(-0.0);
    return {_mm_or_pd(magnitudes.a, _mm_and_pd(sign, signs.a)),
            _mm_or_pd(magnitudes.b, _mm_and_pd(sign, signs.b))};
}
inline Quad withFourth(Quad x, double y) { return {x.a, _mm_unpacklo_pd(x.b, _mm_set1_pd(y))}; }
inline unsigned signsOf(Quad x) {
    return static_cast<unsigned>(_mm_movemask_pd(x.a) | _mm_movemask_pd(x.b) << 2) & 7;
}
inline unsigned bitsLessEqual(Quad x, Quad y) {
    return static_cast<unsigned>(_mm_movemask_pd(_mm_cmple_pd(x.a, y.a)) |
                                 _mm_movemask_pd(_mm_cmple_pd(x.b, y.b)) << 2);
}
/// Bit 0: x > y; 1: x > z; 2: y > z.
inline unsigned orderOfSizes(Quad q) {
    const __m128d xx = _mm_unpacklo_pd(q.a, q.a), yz = _mm_shuffle_pd(q.a, q.b, 1);
    return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(xx, yz)) |
                                 _mm_comigt_sd(_mm_unpackhi_pd(q.a, q.a), q.b) << 2);
}
inline double productPlus(double x, double y, double z) { return x * y + z; }
inline Four narrow(Quad x) { return {_mm_movelh_ps(_mm_cvtpd_ps(x.a), _mm_cvtpd_ps(x.b))}; }
/// Number i of four.
template <int i> inline F32 all(Four x) {
    const __m128 v = _mm_shuffle_ps(x.v, x.v, 0x55 * i);
    return {v, v};
}

struct Order {
    unsigned mirror;
};

inline Order orderOf(unsigned mirror) { return {mirror}; }

/// Puts the children in `mask` on the stack, farthest first.
inline void pushAll(const Order& order, const Node& node, F32 enter, unsigned mask,
                    std::uint32_t* references, float* enters, std::size_t& top) {
    alignas(16) float t[kLanes];
    _mm_store_ps(t, enter.a);
    _mm_store_ps(t + 4, enter.b);
    for (unsigned j = kLanes; j-- > 0;) {
        const unsigned slot = j ^ order.mirror;
        if (!(mask >> slot & 1)) continue;
        references[top] = node.child[slot];
        enters[top++] = t[slot];
    }
}

/// Puts slots of a node on the stack, farthest first, as base + slot.
inline void pushSlots(const Order& order, std::uint32_t base, F32 enter, unsigned mask,
                      std::uint32_t* references, float* enters, std::size_t& top) {
    alignas(16) float t[kLanes];
    _mm_store_ps(t, enter.a);
    _mm_store_ps(t + 4, enter.b);
    for (unsigned j = kLanes; j-- > 0;) {
        const unsigned slot = j ^ order.mirror;
        if (!(mask >> slot & 1)) continue;
        references[top] = base + slot;
        enters[top++] = t[slot];
    }
}

/// Puts the children in `mask` on the stack in any order.
inline void pushAny(const Node& node, unsigned mask, std::uint32_t* references, std::size_t& top) {
    for (; mask; mask &= mask - 1) references[top++] = node.child[__builtin_ctz(mask)];
}

/// 16 sheared corners in the order of SharedBlock::corner.
struct SharedCorners {
    F64 x0, x1, y0, y1, z0, z1;
};

/// Without permutations an f32 filter would gain nothing.
template <class Block> inline unsigned ruledIn(const Block& block, const SharedCorners&, double) {
    return block.valid;
}
