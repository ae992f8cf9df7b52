// Lanes of f64: as many as the compiler's target has in one register.

#if defined __AVX512F__
constexpr std::size_t kLanes = 8;
#elif defined __AVX2__
constexpr std::size_t kLanes = 4;
#else
constexpr std::size_t kLanes = 2;
#endif

using F64 = double __attribute__((vector_size(8 * kLanes)));
using I64 =
    long long __attribute__((vector_size(8 * kLanes), may_alias)); // a mask: 0 or -1 in each lane

inline F64 load(const Column& c, std::size_t i) { return *reinterpret_cast<const F64*>(c.at + i); }
inline void store(Column& c, std::size_t i, F64 v) { *reinterpret_cast<F64*>(c.at + i) = v; }
inline I64 load(const IntegerColumn& c, std::size_t i) {
    return *reinterpret_cast<const I64*>(c.at + i);
}
inline void store(IntegerColumn& c, std::size_t i, I64 v) { *reinterpret_cast<I64*>(c.at + i) = v; }
/// At any address. (memcpy would go by way of the stack, in halves; clang ignores the alignment of a vector's alias.)
struct __attribute__((packed, may_alias)) Anywhere {
    F64 lanes;
};
inline F64 loadFrom(const void* p) { return static_cast<const Anywhere*>(p)->lanes; }
inline void storeTo(void* p, F64 v) { static_cast<Anywhere*>(p)->lanes = v; }
inline F64 all(double x) { return x - F64{}; }
inline F64 select(I64 mask, F64 a, F64 b) { return mask ? a : b; }
inline I64 bitsOf(F64 x) { return reinterpret_cast<I64>(x); }
inline F64 ofBits(I64 x) { return reinterpret_cast<F64>(x); }
inline F64 magnitude(F64 x) { return ofBits(bitsOf(x) & 0x7FFFFFFFFFFFFFFF); }
inline F64 squareRoot(F64 x) {
#if defined __AVX512F__
    return _mm512_sqrt_pd(x);
#elif defined __AVX2__
    return _mm256_sqrt_pd(x);
#else
    return _mm_sqrt_pd(x);
#endif
}
inline bool any(I64 mask) {
#if defined __AVX512F__
    return _mm512_test_epi64_mask(reinterpret_cast<__m512i>(mask), reinterpret_cast<__m512i>(mask));
#elif defined __AVX2__
    return _mm256_movemask_pd(reinterpret_cast<__m256d>(mask));
#else
    return _mm_movemask_pd(reinterpret_cast<__m128d>(mask));
#endif
}

/// Exchanges parts of rows r[i] and r[i + step], for each i without that bit.
template <std::size_t kRows, class Low, class High>
inline void exchange(F64* r, std::size_t step, const Low& low, const High& high) {
    for (std::size_t i = 0; i < kRows; ++i) {
        if (i & step) continue;
        const F64 a = r[i], b = r[i + step];
        r[i] = low(a, b);
        r[i + step] = high(a, b);
    }
}
#define RT_PICK(...) [](F64 a, F64 b) { return __builtin_shufflevector(a, b, __VA_ARGS__); }

/// Rows become columns, in each square of up to 4 x 4 doubles; two lie side by side where there are 8 lanes.
template <std::size_t kRows> inline void transposeSquares(F64* r) {
#if defined __AVX512F__
    exchange<kRows>(r, 1, RT_PICK(0, 8, 2, 10, 4, 12, 6, 14), RT_PICK(1, 9, 3, 11, 5, 13, 7, 15));
    exchange<kRows>(r, 2, RT_PICK(0, 1, 8, 9, 4, 5, 12, 13), RT_PICK(2, 3, 10, 11, 6, 7, 14, 15));
#elif defined __AVX2__
    exchange<kRows>(r, 1, RT_PICK(0, 4, 2, 6), RT_PICK(1, 5, 3, 7));
    exchange<kRows>(r, 2, RT_PICK(0, 1, 4, 5), RT_PICK(2, 3, 6, 7));
#else
    exchange<kRows>(r, 1, RT_PICK(0, 2), RT_PICK(1, 3));
#endif
}

/// Rows of a square of doubles become its columns.
inline void transpose(F64* r) {
    transposeSquares<kLanes>(r);
#if defined __AVX512F__
    exchange<kLanes>(r, 4, RT_PICK(0, 1, 2, 3, 8, 9, 10, 11), RT_PICK(4, 5, 6, 7, 12, 13, 14, 15));
#endif
}
#undef RT_PICK

/// The four doubles at each address, as columns.
inline void loadFours(const void* const (&at)[kLanes], F64 (&column)[4]) {
    for (std::size_t i = 0; i < 4; ++i)
#if defined __AVX512F__
        column[i] = _mm512_insertf64x4(
            _mm512_castpd256_pd512(_mm256_loadu_pd(static_cast<const double*>(at[i]))),
            _mm256_loadu_pd(static_cast<const double*>(at[i + 4])), 1);
#else
        column[i] = loadFrom(static_cast<const double*>(at[i % kLanes]) + i / kLanes * kLanes);
#endif
#if defined __AVX2__
    transposeSquares<4>(column);
#else
    transposeSquares<2>(column);
    transposeSquares<2>(column + 2);
#endif
}
