#include <core/octree/references.hpp>

#include <core/geometry/intersect.hpp>
#include <core/numeric/box.hpp>
#include <core/parallel/parallel.hpp>

#include <emmintrin.h>

#include <algorithm>
#include <cmath>

namespace rt::octree {
namespace {

using geometry::Kind;
using geometry::Primitives;
using numeric::Box3d;
using numeric::Vec3;

constexpr std::uint32_t kChunk = 16384; // primitives that one task takes

/// A box as the least (x, y), (z, −z) and (−x, −y) in it: both sides are rounded by the same instructions.
struct Least {
    __m128d of[3];

    static Least ofPoint(__m128d xy, __m128d z) {
        const __m128d sign = _mm_set1_pd(-0.0);
        return {{xy, _mm_unpacklo_pd(z, _mm_xor_pd(z, sign)), _mm_xor_pd(xy, sign)}};
    }
    static Least ofPoint(const Vec3& p) { return ofPoint(_mm_loadu_pd(&p.x), _mm_load_sd(&p.z)); }
    static Least ofBox(const Box3d& box) {
        return {{_mm_setr_pd(box.min.x, box.min.y), _mm_setr_pd(box.min.z, -box.max.z),
                 _mm_setr_pd(-box.max.x, -box.max.y)}};
    }
    static Least empty() { return ofBox({}); }

    void add(const Least& other) {
        for (int i = 0; i < 3; ++i) of[i] = _mm_min_pd(of[i], other.of[i]);
    }
    Box3d box() const {
        alignas(16) double x[6];
        for (int i = 0; i < 3; ++i) _mm_store_pd(x + 2 * i, of[i]);
        return {{x[0], x[1], x[2]}, {-x[4], -x[5], -x[3]}};
    }
};

/// Are the numbers in it all finite?
class Finite {
public:
    void also(const Least& least) {
        for (const __m128d v : least.of) zero_ = _mm_add_pd(zero_, _mm_sub_pd(v, v));
    }
    explicit operator bool() const { return _mm_movemask_pd(_mm_cmpunord_pd(zero_, zero_)) == 0; }

private:
    __m128d zero_ = _mm_setzero_pd(); // or NaN
};

/// Next f64 below, of finite numbers.
__m128d nextDown(__m128d x) {
    const __m128d zero = _mm_setzero_pd();
    x = _mm_or_pd(x, _mm_and_pd(_mm_cmpeq_pd(x, zero), _mm_set1_pd(-0.0)));
    const __m128i step = _mm_or_si128(_mm_castpd_si128(_mm_cmpgt_pd(x, zero)), _mm_set1_epi64x(1));
    return _mm_castsi128_pd(_mm_add_epi64(_mm_castpd_si128(x), step));
}

/// False without finite bounds. What has a NaN coordinate is met by no ray, or decides that for itself.
bool boundsOf(const Primitives& primitives, Kind kind, std::uint32_t index, Least& least) {
    Finite finite;
    switch (kind) {
    case Kind::triangle: {
        const auto& corners = primitives.triangles.indices[index];
        const Vec3* const positions = primitives.triangles.positions.data();
        least = Least::ofPoint(positions[corners[0]]);
        finite.also(least);
        for (std::size_t c = 1; c < 3; ++c) {
            const Least corner = Least::ofPoint(positions[corners[c]]);
            finite.also(corner);
            least.add(corner);
        }
        return static_cast<bool>(finite);
    }
    case Kind::sphere: {
        const auto& sphere = primitives.spheres[index];
        const __m128d radius = _mm_set1_pd(std::fabs(sphere.radius));
        least = Least::ofPoint(sphere.center);
        for (__m128d& v : least.of) v = _mm_sub_pd(v, radius);
        finite.also(least);
        // The differences were rounded; the box may not be too small.
        for (__m128d& v : least.of) v = nextDown(v);
        return static_cast<bool>(finite);
    }
    case Kind::parallelogram:
        least = Least::empty();
        for (const Vec3& p : geometry::cornersOf(primitives.parallelograms[index])) {
            const Least corner = Least::ofPoint(p);
            finite.also(corner);
            least.add(corner);
        }
        return static_cast<bool>(finite);
    case Kind::custom:
        break;
    }
    const Box3d& box = primitives.customs.primitives[index].bounds;
    least = Least::ofBox(box);
    finite.also(least);
    return finite && !box.empty();
}

/// From world to octree space.
class Space {
public:
    Space(const double center[3], double scale)
        : center_(Least::ofPoint({center[0], center[1], center[2]})), scale_(_mm_set1_pd(scale)) {}

    /// Boxes rounded outward.
    void convert(const Least& least, __m128& lower, __m128& upper) const {
        const __m128 xy = down(least.of[0], center_.of[0]), z = down(least.of[1], center_.of[1]),
                     negativeXy = down(least.of[2], center_.of[2]), sign = _mm_set1_ps(-0.0f);
        lower = _mm_movelh_ps(xy, z);
        upper = _mm_xor_ps(_mm_shuffle_ps(negativeXy, z, _MM_SHUFFLE(0, 1, 1, 0)), sign);
    }

private:
    /// The largest f32 at or below the exact (x − center) · scale.
    __m128 down(__m128d x, __m128d center) const {
        const __m128d d = _mm_sub_pd(x, center), t = _mm_sub_pd(d, x);
        const __m128d rest = _mm_sub_pd(_mm_sub_pd(x, _mm_sub_pd(d, t)),
                                        _mm_add_pd(center, t)); // d + rest is exact [Knuth 1969]
        const __m128d scaled = _mm_mul_pd(d, scale_);
        const __m128 f = _mm_cvtpd_ps(scaled), zero = _mm_setzero_ps();
        const __m128d back = _mm_cvtps_pd(f);
        const __m128d above =
            _mm_or_pd(_mm_cmpgt_pd(back, scaled),
                      _mm_and_pd(_mm_cmpeq_pd(back, scaled), _mm_cmplt_pd(rest, _mm_setzero_pd())));
        const __m128 isAbove = _mm_shuffle_ps(_mm_castpd_ps(above), zero, _MM_SHUFFLE(0, 0, 2, 0));
        // To the next f32 below; from either zero to the least negative one.
        const __m128 from = _mm_or_ps(f, _mm_and_ps(_mm_cmpeq_ps(f, zero), _mm_set1_ps(-0.0f)));
        const __m128i step =
            _mm_or_si128(_mm_castps_si128(_mm_cmpgt_ps(from, zero)), _mm_set1_epi32(1));
        const __m128 next = _mm_castsi128_ps(_mm_add_epi32(_mm_castps_si128(from), step));
        return _mm_or_ps(_mm_and_ps(isAbove, next), _mm_andnot_ps(isAbove, f));
    }

    const Least center_; // of[i]: subtracted from a box's
    const __m128d scale_;
};

void fill(Reference& reference, std::uint32_t id, Kind kind, const Least& least,
          const Space& space) {
    __m128 lower, upper;
    space.convert(least, lower, upper);
    _mm_store_ps(reference.lower, lower);
    _mm_store_ps(reference.upper, upper);
    reference.id = id;
    reference.kind = static_cast<std::uint32_t>(kind);
}

bool isInside(const Reference& r) {
    bool inside = true;
    for (int i = 0; i < 3; ++i) inside = inside && r.lower[i] >= -1 && r.upper[i] <= 1;
    return inside;
}

} // namespace

References referencesOf(const Primitives& primitives, bool movable) {
    References result;
    const std::uint32_t count = primitives.count();
    const std::size_t chunks = (count + kChunk - 1) / kChunk;
    struct Chunk {
        Least bounds = Least::empty();
        std::uint32_t bounded = 0;
        std::vector<Reference> unbounded;
    };
    std::vector<Chunk> parts(chunks);
    // Calls visit(id, kind, bounded, bounds) for the chunk's primitives.
    const auto overChunk = [&](std::size_t chunk, const auto& visit) {
        std::uint32_t id = static_cast<std::uint32_t>(chunk) * kChunk;
        const std::uint32_t last = std::min(id + kChunk, count);
        const auto* segment = &primitives.segmentOf(geometry::PrimitiveId{id});
        for (; id < last; ++id) {
            while (id >= static_cast<std::uint32_t>(segment->first) + segment->count) ++segment;
            const auto index = segment->index + id - static_cast<std::uint32_t>(segment->first);
            Least least;
            const bool bounded = boundsOf(primitives, segment->kind, index, least);
            visit(id, segment->kind, bounded, least);
        }
    };
    parallel::forEach(chunks, 0, [&](std::size_t chunk) {
        Chunk& part = parts[chunk];
        overChunk(chunk, [&](std::uint32_t id, Kind kind, bool bounded, const Least& least) {
            if (bounded) {
                part.bounds.add(least);
                ++part.bounded;
            } else {
                part.unbounded.push_back({{}, id, {}, static_cast<std::uint32_t>(kind)});
            }
        });
    });
    Least least = Least::empty();
    for (const Chunk& part : parts) {
        least.add(part.bounds);
        result.boundedCount += part.bounded;
        result.unbounded.insert(result.unbounded.end(), part.unbounded.begin(),
                                part.unbounded.end());
    }
    if (result.boundedCount == 0) return result;
    const Box3d bounds = least.box();
    const Vec3 center = bounds.min * 0.5 + bounds.max * 0.5;
    const double half =
        numeric::maxComponent(numeric::componentMax(bounds.max - center, center - bounds.min));
    if (!(half < 0x1p1000)) { // no power of two brings this into range
        result.boundedCount = 0;
        result.unbounded.clear();
        for (std::size_t chunk = 0; chunk < chunks; ++chunk)
            overChunk(chunk, [&](std::uint32_t id, Kind kind, bool, const Least&) {
                result.unbounded.push_back({{}, id, {}, static_cast<std::uint32_t>(kind)});
            });
        return result;
    }
    for (int i = 0; i < 3; ++i) result.center[i] = center[i];
    if (half > numeric::powerOfTwo(-1000))
        result.scale = std::ldexp(1.0, -(std::ilogb(half) + (movable ? 2 : 1)));
    const Space space(result.center, result.scale);
    result.bounded.resize(result.boundedCount);
    std::uint32_t at = 0;
    std::vector<std::uint32_t> start(chunks);
    for (std::size_t chunk = 0; chunk < chunks; ++chunk) {
        start[chunk] = at;
        at += parts[chunk].bounded;
    }
    parallel::forEach(chunks, 0, [&](std::size_t chunk) {
        Reference* out = result.bounded.data() + start[chunk];
        overChunk(chunk, [&](std::uint32_t id, Kind kind, bool bounded, const Least& box) {
            if (bounded) fill(*out++, id, kind, box, space);
        });
    });
    return result;
}

bool inOctreeSpace(const Box3d& box, const double center[3], double scale, float lower[3],
                   float upper[3]) {
    Reference reference;
    fill(reference, 0, Kind::triangle, Least::ofBox(box), Space(center, scale));
    for (int i = 0; i < 3; ++i) {
        lower[i] = reference.lower[i];
        upper[i] = reference.upper[i];
    }
    return isInside(reference);
}

bool referenceOf(const Primitives& primitives, std::uint32_t id, const double center[3],
                 double scale, Reference& reference) {
    const auto& segment = primitives.segmentOf(geometry::PrimitiveId{id});
    const std::uint32_t index = segment.index + id - static_cast<std::uint32_t>(segment.first);
    Least least;
    if (!boundsOf(primitives, segment.kind, index, least)) return false;
    fill(reference, id, segment.kind, least, Space(center, scale));
    return isInside(reference);
}

} // namespace rt::octree
