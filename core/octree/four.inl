// x, y, z and a fourth in f32: SSE at every SIMD level.

struct Four {
    __m128 v;
};

inline void store(float* p, Four a) { _mm_store_ps(p, a.v); }

/// a, or 0 for NaN and what is negative.
inline float notNegative(float a) {
    return _mm_cvtss_f32(_mm_max_ss(_mm_set_ss(a), _mm_setzero_ps()));
}
