// The kernels of wave.hpp, in terms of the lanes of the compiler's target. Every expression repeats one
// of direction.hpp, whitted.hpp or geometry/surface.cpp operation by operation.
//
// Nothing here may call an inline function of another header: see octree/kernel.inl.

#if defined __AVX512F__
constexpr std::size_t kLanes = 8;
#elif defined __AVX2__
constexpr std::size_t kLanes = 4;
#else
constexpr std::size_t kLanes = 2;
#endif

using F64 = double __attribute__((vector_size(8 * kLanes)));
using I64 = long long __attribute__((vector_size(8 * kLanes))); // a mask: 0 or -1 in each lane

inline F64 load(const Column& c, std::size_t i) { return *reinterpret_cast<const F64*>(c.at + i); }
inline void store(Column& c, std::size_t i, F64 v) { *reinterpret_cast<F64*>(c.at + i) = v; }
inline I64 load(const MaskColumn& c, std::size_t i) {
    I64 v;
    __builtin_memcpy(&v, c.at + i, sizeof v);
    return v;
}
inline void store(MaskColumn& c, std::size_t i, I64 v) { __builtin_memcpy(c.at + i, &v, sizeof v); }
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
    long long m = 0;
    for (std::size_t i = 0; i < kLanes; ++i) m |= mask[i];
    return m;
}

struct V3 {
    F64 x, y, z;
};

inline V3 load(const Columns& c, std::size_t i) {
    return {load(c.x, i), load(c.y, i), load(c.z, i)};
}
inline void store(Columns& c, std::size_t i, V3 v) {
    store(c.x, i, v.x);
    store(c.y, i, v.y);
    store(c.z, i, v.z);
}
inline V3 operator+(V3 a, V3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline V3 operator-(V3 a, V3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline V3 operator*(V3 a, V3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
inline V3 operator-(V3 a) { return {-a.x, -a.y, -a.z}; }
inline V3 operator*(V3 a, F64 s) { return {a.x * s, a.y * s, a.z * s}; }
inline V3 operator/(V3 a, F64 s) { return {a.x / s, a.y / s, a.z / s}; }
inline V3 select(I64 mask, V3 a, V3 b) {
    return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
inline V3 magnitude(V3 a) { return {magnitude(a.x), magnitude(a.y), magnitude(a.z)}; }
inline F64 dot(V3 a, V3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// numeric::bits::larger, of numbers.
inline F64 larger(F64 a, F64 b) { return select(a >= b, a, b); }

/// numeric::bits::nextUp.
inline F64 nextUp(F64 x) {
    const I64 b = bitsOf(x);
    const I64 next = x > 0 ? b + 1 : b - 1;
    const I64 least = b - b + 1; // of the denormals
    return select(x < __builtin_inf(), ofBits(x == 0 ? least : next), x);
}

inline F64 awayFrom(F64 from, F64 offset) {
    const F64 moved = from + offset;
    const F64 up = nextUp(offset < 0 ? -moved : moved);
    return select(offset > 0, up, select(offset < 0, -up, moved));
}

/// Where geometry::spawnRay and spawnRayTo start toward `direction`. geometric: turned toward the viewer.
inline V3 spawnOrigin(V3 position, V3 geometric, I64 leaving, F64 error, V3 direction) {
    const V3 outside = select(leaving, -geometric, geometric);
    const V3 offset = outside * select(dot(direction, outside) >= 0, error, -error);
    return {awayFrom(position.x, offset.x), awayFrom(position.y, offset.y),
            awayFrom(position.z, offset.z)};
}

inline V3 intoHemisphere(V3 direction, V3 normal) {
    const F64 height = dot(direction, normal);
    return select(height < 0, direction - normal * (2 * height), direction);
}

/// Of vectors about as long as 1.
inline V3 unit(V3 v) { return v / squareRoot(dot(v, v)); }

void face(Wave& w, std::size_t count) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        V3 geometric = load(w.geometric, i), normal = load(w.normal, i);
        F64 error = load(w.error, i), beside = load(w.errorBeside, i);
        const I64 isSphere = load(w.isSphere, i);
        if (any(isSphere)) {
            const V3 size = magnitude(geometric);
            const I64 exponent = bitsOf(larger(size.x, larger(size.y, size.z))) >> 52;
            const V3 scaled = geometric * ofBits((2046 - exponent) << 52);
            const V3 n = scaled * (1 / squareRoot(dot(scaled, scaled)));
            const V3 center = load(w.center, i);
            const F64 radius = load(w.radius, i);
            store(w.position, i, select(isSphere, center + n * radius, load(w.position, i)));
            geometric = select(isSphere, n, geometric);
            normal = select(isSphere, n, normal);
            constexpr double kOfCenter = numeric::gamma(2), kOfRadius = numeric::gamma(12);
            error = select(isSphere,
                           kOfCenter * dot(magnitude(n), magnitude(center)) + kOfRadius * radius,
                           error);
            beside = select(isSphere, error, beside);
        }
        const I64 leaving = dot(load(w.direction, i), geometric) > 0;
        store(w.leaving, i, leaving);
        store(w.geometric, i, select(leaving, -geometric, geometric));
        store(w.normal, i, select(leaving, -normal, normal));
        // Rays leave from beyond a second surface that coincides with this one: its bound too.
        store(w.error, i, error + beside);
    }
}

void aim(Wave& w, std::size_t count, const double light[3]) {
    const V3 at = {all(light[0]), all(light[1]), all(light[2])};
    for (std::size_t i = 0; i < count; i += kLanes) {
        const V3 position = load(w.position, i), normal = load(w.normal, i);
        const V3 toLight = at - position;
        const F64 squared = dot(toLight, toLight);
        const V3 direction = toLight / squareRoot(squared);
        const F64 cosine = dot(direction, normal);
        store(w.cosine, i, select(squared > 0, select(cosine > 0, cosine, all(0.0)), all(-1.0)));
        const V3 halfway = direction - load(w.direction, i);
        store(w.halfway, i, dot(halfway, normal) / squareRoot(dot(halfway, halfway)));
        const V3 origin = spawnOrigin(position, load(w.geometric, i), load(w.leaving, i),
                                      load(w.error, i), toLight);
        store(w.shadowOrigin, i, origin);
        store(w.shadowDirection, i, at - origin);
    }
}

void add(Wave& w, std::size_t count) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        const V3 visible = load(w.visible, i);
        const V3 added =
            (load(w.environment, i) * visible + load(w.diffuse, i) * load(w.cosine, i) * visible) +
            load(w.specular, i) * load(w.power, i) * visible;
        store(w.added, i, added);
        store(w.light, i, load(w.light, i) + added);
    }
}

void refract(Wave& w, std::size_t count) {
    for (std::size_t i = 0; i < count; i += kLanes) {
        const V3 direction = load(w.direction, i), geometric = load(w.geometric, i);
        const F64 ratio = load(w.ratio, i);
        // An interpolated normal may point away from the viewer.
        const V3 shading = load(w.normal, i);
        const V3 normal = select(dot(direction, shading) < 0, shading, geometric);
        const V3 tangential = (direction - normal * dot(direction, normal)) * ratio;
        const F64 sineSquared = dot(tangential, tangential);
        const V3 bent = unit(tangential - normal * squareRoot(1 - sineSquared));
        const I64 straight = ratio == 1;
        const V3 out = select(straight, direction, -intoHemisphere(-bent, geometric));
        const V3 transmission = load(w.transmission, i);
        store(w.passes, i, straight | (sineSquared < 1));
        store(w.refracted, i, out);
        store(w.refractedOrigin, i,
              spawnOrigin(load(w.position, i), geometric, load(w.leaving, i),
                          load(w.refractedError, i), out));
        store(w.refractedWeight, i, load(w.weight, i) * (load(w.color, i) * transmission));
    }
}

void mirror(Wave& w, std::size_t count, bool transmits) {
    const V3 none = {all(0.0), all(0.0), all(0.0)};
    for (std::size_t i = 0; i < count; i += kLanes) {
        const V3 direction = load(w.direction, i), normal = load(w.normal, i);
        const V3 geometric = load(w.geometric, i);
        const V3 out =
            intoHemisphere(unit(direction - normal * (2 * dot(direction, normal))), geometric);
        V3 share = load(w.specular, i);
        if (transmits) share = share + select(load(w.passes, i), none, load(w.transmission, i));
        store(w.mirrored, i, out);
        store(
            w.mirroredOrigin, i,
            spawnOrigin(load(w.position, i), geometric, load(w.leaving, i), load(w.error, i), out));
        store(w.mirroredWeight, i, load(w.weight, i) * (load(w.color, i) * share));
    }
}
