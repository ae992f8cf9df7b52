// Precision::f32: rays against everything in f32, in octree space, where t is t · scale.
//
// Triangles that share corners are sheared as in kernel.inl; others and parallelograms are tested as in
// [Möller, Trumbore 1997], spheres by the textbook's quadratic. Boxes have no slack. Only the products of the
// boxes are contracted, and those at every SIMD level, so that all levels give the same bits.

using ExactBundle = Bundle;
using ExactLimits = Limits;
using ExactBest = Best;

namespace f32 {

// Of a direction's component, and of an origin's. So no product with a plane overflows.
constexpr float kSmallest = static_cast<float>(numeric::powerOfTwo(-90)), kLargest = 0x1p90f,
                kFarthest = 0x1p36f;
/// Hits nearer than this, in octree space and along the largest component, are those of the surface that a ray
/// starts on: f32 knows a point there to about 2^-24.
constexpr float kStart = static_cast<float>(numeric::powerOfTwo(-18));

struct Frame {
    alignas(16) float origin[4], direction[4]; // [3]: unused
    int kx, ky, kz;
    float ox, oy, oz; // origin[kx] and so on
    float shearX, shearY, shearZ;
    float start; // hits are after this
};

/// As the other Best.
struct Best {
    float t, u, v;
    const std::uint32_t* id;
};

inline ExactBest inWorld(const TreeView& tree, const Best& best) {
    return {best.t * tree.inverseScale, best.u, best.v, best.id};
}

/// t of a hit limits the boxes as it is.
struct Limits {};
inline float limitOf(Limits, float t) { return t; }

inline float limitOf(const TreeView& tree, double t) { return static_cast<float>(t * tree.scale); }

[[gnu::always_inline]] inline BoxRay start(const TreeView& tree, const Ray& ray, Frame& f) {
    const Quad quad = withFourth(loadQuad(&ray.direction.x), 1);
    const __m128 origin = narrow(originOf(tree, ray)).v, direction = narrow(quad).v;
    const __m128 sign = _mm_set1_ps(-0.0f), size = _mm_andnot_ps(sign, direction);
    const __m128 clamped =
        _mm_or_ps(_mm_max_ps(size, _mm_set1_ps(kSmallest)), _mm_and_ps(sign, direction));
    const __m128 inverse = _mm_div_ps(_mm_set1_ps(1), clamped);
    const Four from{_mm_mul_ps(origin, inverse)};
    BoxRay b{{inverse}, from, from, static_cast<unsigned>(_mm_movemask_ps(direction)) & 7,
             {},        false};
    b.misses = _mm_movemask_ps(_mm_and_ps(
                   _mm_cmple_ps(size, _mm_set1_ps(kLargest)),
                   _mm_cmple_ps(_mm_andnot_ps(sign, origin), _mm_set1_ps(kFarthest)))) != 15;
    _mm_store_ps(f.origin, origin);
    _mm_store_ps(f.direction, clamped);
    f.kz = largestAxis(magnitude(quad));
    f.kx = kNextAxis[f.kz];
    f.ky = kAxisAfter[f.kz];
    alignas(16) float inverses[4];
    _mm_store_ps(inverses, inverse);
    f.ox = f.origin[f.kx];
    f.oy = f.origin[f.ky];
    f.oz = f.origin[f.kz];
    f.shearZ = inverses[f.kz];
    f.shearX = f.direction[f.kx] * f.shearZ;
    f.shearY = f.direction[f.ky] * f.shearZ;
    f.start = kStart * __builtin_fabsf(f.shearZ);
    return b;
}

template <class V> inline V every(float x);
template <> inline F32 every<F32>(float x) { return all(x); }
template <> inline Wide every<Wide>(float x) { return allWide(x); }

template <class V> struct Vector { V x, y, z; };

template <class V> inline Vector<V> operator-(const Vector<V>& a, const Vector<V>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class V> inline V dot(const Vector<V>& a, const Vector<V>& b) {
    return (a.x * b.x + a.y * b.y) + a.z * b.z;
}
template <class V> inline Vector<V> cross(const Vector<V>& a, const Vector<V>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Where lanes may meet.
template <class V> struct Met { V t, u, v; };

template <class V> inline unsigned between(V start, V t, V limit) {
    return bitsLess(start, t) & bitsLess(t, limit);
}

/// ab, ac: edges from a.
template <bool kWhole, class V>
[[gnu::always_inline]] inline unsigned
meetPlanar(const Vector<V>& origin, const Vector<V>& direction, const Vector<V>& a,
           const Vector<V>& ab, const Vector<V>& ac, V start, V limit, Met<V>& met) {
    const V zero = every<V>(0), one = every<V>(1);
    const Vector<V> p = cross(direction, ac), s = origin - a, q = cross(s, ab);
    const V inverse = one / dot(ab, p);
    met.u = dot(s, p) * inverse;
    met.v = dot(direction, q) * inverse;
    met.t = dot(ac, q) * inverse;
    return bitsLessEqual(zero, met.u) & bitsLessEqual(zero, met.v) &
           (kWhole ? bitsLessEqual(met.u, one) & bitsLessEqual(met.v, one)
                   : bitsLessEqual(met.u + met.v, one)) &
           between(start, met.t, limit);
}

/// Both parameters; NaN where the line passes by.
template <class V>
[[gnu::always_inline]] inline void meetSphere(const Vector<V>& origin, const Vector<V>& direction,
                                              const Vector<V>& center, V radius, V& t0, V& t1) {
    const Vector<V> f = center - origin;
    const V a = dot(direction, direction), b = dot(f, direction), c = dot(f, f) - radius * radius;
    const V root = squareRoot(b * b - a * c);
    t0 = (b - root) / a;
    t1 = (b + root) / a;
}

[[gnu::always_inline]] inline unsigned meetShared(const NarrowSharedBlock& block, const Frame& f,
                                                  float limit, Met<Wide>& met) {
    const Wide z = loadWide(block.corner[f.kz]) - allWide(f.oz);
    const Wide x = (loadWide(block.corner[f.kx]) - allWide(f.ox)) - allWide(f.shearX) * z;
    const Wide y = (loadWide(block.corner[f.ky]) - allWide(f.oy)) - allWide(f.shearY) * z;
    const Indices a = indices(block.index[0]), b = indices(block.index[1]),
                  c = indices(block.index[2]);
    const Wide ax = picked(x, a), ay = picked(y, a), bx = picked(x, b), by = picked(y, b),
               cx = picked(x, c), cy = picked(y, c);
    const Wide u = cx * by - cy * bx, v = ax * cy - ay * cx, w = bx * ay - by * ax;
    const unsigned lanes = block.valid & ~(bitsLess(smaller(smaller(u, v), w), allWide(0)) &
                                           bitsLess(allWide(0), larger(larger(u, v), w)));
    // Whether any is left nobody can foretell, and a branch less is worth the division.
    const Wide inverse = allWide(1) / ((u + v) + w);
    met.u = v * inverse;
    met.v = w * inverse;
    met.t =
        allWide(f.shearZ) * ((u * picked(z, a) + v * picked(z, b)) + w * picked(z, c)) * inverse;
    return lanes & between(allWide(f.start), met.t, allWide(limit));
}

inline Vector<F32> row(const NarrowTriangleBlock& block, int i) {
    return {load(block.corner[i][0]), load(block.corner[i][1]), load(block.corner[i][2])};
}
inline Vector<F32> every(const float (&v)[4]) { return {all(v[0]), all(v[1]), all(v[2])}; }

/// Takes the nearest.
struct Nearest {
    static constexpr bool kStops = false;
    const TreeView& tree;
    const Ray& ray;
    std::uint32_t exclude;
    Best& best;

    float limit() const { return best.t; }
    template <class V>
    bool take(unsigned lanes, const Met<V>& met, const std::uint32_t* id, bool isPlanar) {
        alignas(64) float t[kSharedLanes], u[kSharedLanes], v[kSharedLanes];
        store(t, met.t);
        store(u, met.u);
        store(v, met.v);
        bool better = false;
        for (; lanes; lanes &= lanes - 1) {
            const int i = __builtin_ctz(lanes);
            if (!(t[i] < best.t)) continue;
            if (isPlanar && exclude != 0xFFFFFFFFu && id[i] == exclude) continue;
            best = {t[i], u[i], v[i], id + i};
            better = true;
        }
        return better;
    }
    bool takeRun(const CustomRun& run) {
        double t;
        const std::uint32_t* const id = closestOfRun(tree, run, ray, best.t * tree.inverseScale, t);
        if (!id || !(limitOf(tree, t) < best.t)) return false;
        best = {limitOf(tree, t), 0, 0, id};
        return true;
    }
};

/// Stops at any.
struct Any {
    static constexpr bool kStops = true;
    const TreeView& tree;
    const Ray& ray;
    std::uint32_t exclude;
    float last;

    float limit() const { return last; }
    template <class V>
    bool take(unsigned lanes, const Met<V>&, const std::uint32_t* id, bool isPlanar) {
        if (!isPlanar || exclude == 0xFFFFFFFFu) return lanes;
        for (; lanes; lanes &= lanes - 1)
            if (id[__builtin_ctz(lanes)] != exclude) return true;
        return false;
    }
    bool takeRun(const CustomRun& run) {
        double t;
        return closestOfRun(tree, run, ray, below(ray.tMax), t);
    }
};

/// Takes all, until one is opaque.
struct All {
    static constexpr bool kStops = true;
    const TreeView& tree;
    std::uint32_t exclude;
    float last;
    const Crosser& to;

    float limit() const { return last; }
    template <class V>
    bool take(unsigned lanes, const Met<V>& met, const std::uint32_t* id, bool isPlanar) {
        alignas(64) float t[kSharedLanes];
        store(t, met.t);
        for (; lanes; lanes &= lanes - 1) {
            const int i = __builtin_ctz(lanes);
            if (isPlanar && id[i] == exclude) continue;
            if (!to.take(t[i] * tree.inverseScale, id[i], false)) return true;
        }
        return false;
    }
    bool takeRun(const CustomRun& run) { return !to.sink.custom(to.sink, to.ray, run); }
};

template <bool kWhole, class Taker>
[[gnu::always_inline]] inline bool inPlanar(const NarrowTriangleBlock& block, const Frame& f,
                                            Taker& taker) {
    Met<F32> met;
    const unsigned lanes =
        meetPlanar<kWhole>(every(f.origin), every(f.direction), row(block, 0), row(block, 1),
                           row(block, 2), all(f.start), all(taker.limit()), met);
    return lanes && taker.take(lanes, met, block.id, true);
}

template <class Taker>
[[gnu::always_inline]] inline bool inSpheres(const NarrowTriangleBlock& block, const Frame& f,
                                             Taker& taker) {
    Met<F32> first, second;
    meetSphere(every(f.origin), every(f.direction), row(block, 0), load(block.corner[1][0]),
               first.t, second.t);
    first.u = first.v = second.u = second.v = all(0.0f);
    const unsigned in = between(all(f.start), first.t, all(taker.limit())),
                   out = between(all(f.start), second.t, all(taker.limit()));
    bool result = in && taker.take(in, first, block.id, false);
    if (result && Taker::kStops) return true;
    const unsigned rest = out & ~(Taker::kStops ? 0 : in); // the nearest is the first of the two
    if (rest) result |= taker.take(rest, second, block.id, false);
    return result;
}

template <bool kCount, class Taker>
[[gnu::noinline]] bool inRecord(const TreeView& tree, const LeafRecord& leaf, const Frame& f,
                                Taker& taker, Visits* visits) {
    bool result = false;
    const auto blocks = [&](std::uint32_t first, std::uint32_t count, std::uint64_t Visits::*seen,
                            auto test) {
        for (std::uint32_t i = first; i < first + count; ++i) {
            if (Taker::kStops && result) return;
            const NarrowTriangleBlock& block = tree.narrowTriangles[i];
            if (kCount) visits->*seen += lanesInUse(block.id);
            result |= test(block, f, taker);
        }
    };
    blocks(leaf.triangles, leaf.triangleBlocks, &Visits::triangles, inPlanar<false, Taker>);
    blocks(leaf.spheres, leaf.sphereBlocks, &Visits::spheres, inSpheres<Taker>);
    blocks(leaf.parallelograms, leaf.parallelogramBlocks, &Visits::parallelograms,
           inPlanar<true, Taker>);
    for (std::uint32_t i = leaf.runs; i < leaf.runs + leaf.runCount; ++i) {
        if (Taker::kStops && result) return true;
        if (kCount) visits->customs += tree.runs[i].count;
        result |= taker.takeRun(tree.runs[i]);
    }
    return result;
}

/// A call, so that the loop over nodes keeps its registers: as closestInTriangles().
template <bool kCount, class Taker>
[[gnu::noinline]] bool inOther(const TreeView& tree, std::uint32_t reference, const Frame& f,
                               Taker& taker, Visits* visits) {
    const std::uint32_t index = reference & kLeafIndex;
    switch (reference >> kLeafKindShift & 7) {
    case kNarrowTriangleLeaf:
        if (kCount) visits->triangles += lanesInUse(tree.narrowTriangles[index].id);
        return inPlanar<false>(tree.narrowTriangles[index], f, taker);
    case kSphereLeaf:
        if (kCount) visits->spheres += lanesInUse(tree.narrowTriangles[index].id);
        return inSpheres(tree.narrowTriangles[index], f, taker);
    case kParallelogramLeaf:
        if (kCount) visits->parallelograms += lanesInUse(tree.narrowTriangles[index].id);
        return inPlanar<true>(tree.narrowTriangles[index], f, taker);
    default:
        return inRecord<kCount>(tree, tree.records[index], f, taker, visits);
    }
}

template <bool kCount, class Taker>
[[gnu::always_inline]] inline bool inLeaf(const TreeView& tree, std::uint32_t reference,
                                          const Frame& f, Taker taker, Visits* visits) {
    if ((reference >> kLeafKindShift & 7) != kNarrowSharedLeaf)
        return inOther<kCount>(tree, reference, f, taker, visits);
    const NarrowSharedBlock& block = tree.narrowShared[reference & kLeafIndex];
    if (kCount) visits->triangles += trianglesOf(block);
    Met<Wide> met;
    const unsigned lanes = meetShared(block, f, taker.limit(), met);
    return lanes && taker.take(lanes, met, block.id, true);
}

// What closestFrom(), anyFrom() and crossFrom() ask of a leaf.

template <bool kCount>
[[gnu::always_inline]] inline bool
closestInLeaf(const TreeView& tree, std::uint32_t reference, const Ray& ray, const Frame& f,
              std::uint32_t exclude, Best& best, Visits* visits) {
    return inLeaf<kCount>(tree, reference, f, Nearest{tree, ray, exclude, best}, visits);
}

template <bool kCount>
[[gnu::always_inline]] inline bool anyInLeaf(const TreeView& tree, std::uint32_t reference,
                                             const Ray& ray, const Frame& f, std::uint32_t exclude,
                                             float last, Visits* visits) {
    return inLeaf<kCount>(tree, reference, f, Any{tree, ray, exclude, last}, visits);
}

template <bool kCount>
[[gnu::always_inline]] inline bool crossInLeaf(const TreeView& tree, std::uint32_t reference,
                                               const Frame& f, std::uint32_t exclude, float last,
                                               const Crosser& to, Visits* visits) {
    return !inLeaf<kCount>(tree, reference, f, All{tree, exclude, last, to}, visits);
}

template <bool kCount>
inline void closestImpl(const TreeView& tree, const Ray& ray, Hit* hit, Visits* visits) {
    Frame f;
    const BoxRay box = start(tree, ray, f);
    const auto exclude = static_cast<std::uint32_t>(ray.exclude);
    Best best{limitOf(tree, ray.tMax), 0, 0, nullptr};
    Nearest taker{tree, ray, exclude, best};
    if (tree.hasUnbounded) inRecord<kCount>(tree, tree.unbounded, f, taker, visits);
    if (tree.nodes && !box.misses)
        closestFrom<kCount>(tree, 0, ray, lanesOf<Fused>(tree, box), orderOf(box.mirror), Limits(),
                            f, exclude, best, visits);
    answer(inWorld(tree, best), hit);
}

template <bool kCount>
inline bool occludedImpl(const TreeView& tree, const Ray& ray, Visits* visits) {
    Frame f;
    const BoxRay box = start(tree, ray, f);
    const auto exclude = static_cast<std::uint32_t>(ray.exclude);
    const float last = limitOf(tree, ray.tMax);
    Any taker{tree, ray, exclude, last};
    if (tree.hasUnbounded && inRecord<kCount>(tree, tree.unbounded, f, taker, visits)) return true;
    return tree.nodes && !box.misses &&
           anyFrom<kCount>(tree, 0, ray, lanesOf<Fused>(tree, box), box.mirror, last, f, exclude,
                           last, visits);
}

template <bool kCount>
inline bool crossingsImpl(const TreeView& tree, const Ray& ray, const Crosser& to, Visits* visits) {
    Frame f;
    const BoxRay box = start(tree, ray, f);
    const auto exclude = static_cast<std::uint32_t>(ray.exclude);
    const float last = limitOf(tree, ray.tMax);
    All taker{tree, exclude, last, to};
    if (tree.hasUnbounded && inRecord<kCount>(tree, tree.unbounded, f, taker, visits)) return false;
    return !tree.nodes || box.misses ||
           crossFrom<kCount>(tree, 0, lanesOf<Fused>(tree, box), box.mirror, last, f, exclude, last,
                             to, visits);
}

void closest(const TreeView& tree, const Ray& ray, Hit* hit, Visits* visits) {
    visits ? closestImpl<true>(tree, ray, hit, visits)
           : closestImpl<false>(tree, ray, hit, nullptr);
}

bool occluded(const TreeView& tree, const Ray& ray, Visits* visits) {
    return visits ? occludedImpl<true>(tree, ray, visits) : occludedImpl<false>(tree, ray, nullptr);
}

// Bundles: those of bundle.inl with their f64 set-up and boxes. The coordinates of its filter are the rays here, and
// what it lets through is the answer: there is no second, f64 pass.

struct Bundle : ExactBundle {};

inline bool setUp(const TreeView& tree, const Ray* rays, unsigned count, Bundle& b) {
    return setUp(tree, rays, count, static_cast<ExactBundle&>(b)) && !b.isMoved;
}

/// 16 rays relative to Bundle::reference, axes as kx, ky, kz. Directions have a length of 1 along z, toward where
/// they go: t there is t · scale / |shearZ|.
struct SixteenRays {
    Vector<Wide> origin, direction;
};

inline SixteenRays sixteenOf(const Bundle& b) {
    const Wide sign = allWide(b.mirror >> b.kz & 1 ? -1.0f : 1.0f);
    return {{loadWide(b.filterX), loadWide(b.filterY), loadWide(b.filterZ)},
            {loadWide(b.filterShearX) * sign, loadWide(b.filterShearY) * sign, sign}};
}

/// Row of a block as `axis` of all rays sees it, relative to the reference where it is a position.
inline Vector<Wide> spread(const Bundle& b, const NarrowTriangleBlock& block, int row, int lane,
                           bool isPosition) {
    const auto one = [&](int axis) {
        const float x = block.corner[row][axis][lane];
        return allWide(isPosition ? x - static_cast<float>(b.reference[axis]) : x);
    };
    return {one(b.kx), one(b.ky), one(b.kz)};
}

/// Takes over what rays found in one primitive; as the other take() and cross().
template <Query kQuery, bool kPlanar>
inline unsigned taken(const TreeView& tree, Bundle& b, unsigned rays, const Met<Wide>& met,
                      std::uint32_t id) {
    if (!rays) return 0;
    alignas(64) float t[kRays], u[kRays], v[kRays];
    store(t, met.t);
    store(u, met.u);
    store(v, met.v);
    unsigned result = 0;
    for (int at = 0; at < kRays; at += kLanes) {
        const unsigned some = rays >> at & 0xFF;
        if (!some) continue;
        const F64 world = widened(t + at) * magnitude(load(b.shearZ + at)) * all(tree.inverseScale);
        if (kQuery == Query::crossings)
            result |= cross<kPlanar>(b, at, maskOf(some), maskOf(0), world, id);
        else
            result |= take<kQuery, kPlanar>(b, at, maskOf(some), world, widened(u + at),
                                            widened(v + at), id);
    }
    return result;
}

template <Query kQuery>
[[gnu::noinline]] unsigned bundleInShared(const TreeView& tree, const NarrowSharedBlock& block,
                                          Bundle& b, unsigned active) {
    const SixteenRays rays = sixteenOf(b);
    const Wide shearX = loadWide(b.filterShearX), shearY = loadWide(b.filterShearY);
    alignas(64) float x[kSharedLanes][kRays], y[kSharedLanes][kRays], z[kSharedLanes][kRays];
    const auto *const cx = block.corner[b.kx], *const cy = block.corner[b.ky],
                      *const cz = block.corner[b.kz];
    const auto rx = static_cast<float>(b.reference[b.kx]),
               ry = static_cast<float>(b.reference[b.ky]),
               rz = static_cast<float>(b.reference[b.kz]);
    for (int i = 0; i < kSharedLanes; ++i) {
        const Wide pz = allWide(cz[i] - rz) - rays.origin.z;
        store(z[i], pz);
        store(x[i], (allWide(cx[i] - rx) - rays.origin.x) - shearX * pz);
        store(y[i], (allWide(cy[i] - ry) - rays.origin.y) - shearY * pz);
    }
    unsigned result = 0;
    for (unsigned lanes = block.valid; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        const int p = block.index[0][i], q = block.index[1][i], r = block.index[2][i];
        const Wide ax = loadWide(x[p]), ay = loadWide(y[p]), bx = loadWide(x[q]),
                   by = loadWide(y[q]), cornerX = loadWide(x[r]), cornerY = loadWide(y[r]);
        const Wide u = cornerX * by - cornerY * bx, v = ax * cornerY - ay * cornerX,
                   w = bx * ay - by * ax;
        unsigned in = active & ~(bitsLess(smaller(smaller(u, v), w), allWide(0)) &
                                 bitsLess(allWide(0), larger(larger(u, v), w)));
        if (ends(kQuery)) in &= ~result;
        if (!in) continue;
        const Wide inverse = allWide(1) / ((u + v) + w);
        const Met<Wide> met{rays.direction.z *
                                ((u * loadWide(z[p]) + v * loadWide(z[q])) + w * loadWide(z[r])) *
                                inverse,
                            v * inverse, w * inverse};
        result |=
            taken<kQuery, true>(tree, b, in & bitsLess(allWide(kStart), met.t), met, block.id[i]);
    }
    return result;
}

template <Query kQuery, bool kWhole>
[[gnu::noinline]] unsigned bundleInPlanar(const TreeView& tree, const NarrowTriangleBlock& block,
                                          Bundle& b, unsigned active) {
    const SixteenRays rays = sixteenOf(b);
    unsigned result = 0;
    for (int i = 0; i < kLanes && block.id[i] != kEmptyChild; ++i) {
        Met<Wide> met;
        unsigned in =
            meetPlanar<kWhole>(rays.origin, rays.direction, spread(b, block, 0, i, true),
                               spread(b, block, 1, i, false), spread(b, block, 2, i, false),
                               allWide(kStart), allWide(__builtin_inff()), met);
        in &= ends(kQuery) ? active & ~result : active;
        result |= taken<kQuery, true>(tree, b, in, met, block.id[i]);
    }
    return result;
}

template <Query kQuery>
[[gnu::noinline]] unsigned bundleInSpheres(const TreeView& tree, const NarrowTriangleBlock& block,
                                           Bundle& b, unsigned active) {
    const SixteenRays rays = sixteenOf(b);
    const Wide least = allWide(kStart), most = allWide(__builtin_inff());
    unsigned result = 0;
    for (int i = 0; i < kLanes && block.id[i] != kEmptyChild; ++i) {
        Met<Wide> first, second;
        meetSphere(rays.origin, rays.direction, spread(b, block, 0, i, true),
                   allWide(block.corner[1][0][i]), first.t, second.t);
        first.u = first.v = second.u = second.v = allWide(0);
        const unsigned going = ends(kQuery) ? active & ~result : active;
        const unsigned in = going & between(least, first.t, most);
        const unsigned out = going & between(least, second.t, most);
        result |= taken<kQuery, false>(tree, b, in, first, block.id[i]);
        result |= taken<kQuery, false>(tree, b, kQuery == Query::crossings ? out : out & ~in,
                                       second, block.id[i]);
    }
    return result;
}

inline Frame frameAt(const TreeView& tree, const Bundle& b, const Ray& ray, int i) {
    Frame f;
    for (int axis = 0; axis < 3; ++axis) {
        f.origin[axis] = static_cast<float>((b.origin[axis][i] - tree.center[axis]) * tree.scale);
        f.direction[axis] = static_cast<float>((&ray.direction.x)[axis]);
    }
    f.kx = b.kx;
    f.ky = b.ky;
    f.kz = b.kz;
    f.ox = f.origin[f.kx];
    f.oy = f.origin[f.ky];
    f.oz = f.origin[f.kz];
    f.shearX = b.filterShearX[i];
    f.shearY = b.filterShearY[i];
    f.shearZ = static_cast<float>(b.shearZ[i]);
    f.start = kStart * __builtin_fabsf(f.shearZ);
    return f;
}

inline Best bestAt(const TreeView& tree, const Bundle& b, int i) {
    return {limitOf(tree, b.t[i]), static_cast<float>(b.u[i]), static_cast<float>(b.v[i]),
            b.found >> i & 1 ? b.id + i : nullptr};
}
inline unsigned take(const TreeView& tree, Bundle& b, int i, const Best& best) {
    return take(b, i, inWorld(tree, best));
}

template <bool kCount, Query kQuery>
[[gnu::noinline]] unsigned aloneFrom(const TreeView& tree, std::uint32_t reference, const Ray& ray,
                                     const Order& order, Bundle& b, unsigned i, Visits* visits) {
    const Frame f = frameAt(tree, b, ray, static_cast<int>(i));
    const BoxLanes lanes = lanesAt(tree, b, static_cast<int>(i));
    const float last = limitOf(tree, b.t[i]);
    if (kQuery == Query::crossings)
        return static_cast<unsigned>(!crossFrom<kCount>(tree, reference, lanes, b.mirror,
                                                        b.limit[i], f, b.exclude[i], last,
                                                        Crosser{*b.sink, b.first + i}, visits))
               << i;
    if (kQuery == Query::any)
        return static_cast<unsigned>(anyFrom<kCount>(tree, reference, ray, lanes, b.mirror,
                                                     b.limit[i], f, b.exclude[i], last, visits))
               << i;
    Best best = bestAt(tree, b, static_cast<int>(i));
    // The bundle's boxes are met by directions that are brought to a length.
    closestFrom<kCount>(tree, reference, ray, lanes, order,
                        ExactLimits{b.limitFactor[i] * tree.inverseScale, b.limitOffset[i]}, f,
                        b.exclude[i], best, visits);
    return take(tree, b, static_cast<int>(i), best);
}

template <bool kCount, Query kQuery>
[[gnu::noinline]] unsigned aloneInRecord(const TreeView& tree, const LeafRecord& leaf,
                                         const Ray* rays, Bundle& b, unsigned active,
                                         Visits* visits) {
    unsigned result = 0;
    for (; active; active &= active - 1) {
        const int i = __builtin_ctz(active);
        const Frame f = frameAt(tree, b, rays[i], i);
        const auto last = limitOf(tree, b.t[i]);
        if (kQuery == Query::closest) {
            Best best = bestAt(tree, b, i);
            Nearest taker{tree, rays[i], b.exclude[i], best};
            inRecord<kCount>(tree, leaf, f, taker, visits);
            result |= take(tree, b, i, best);
            continue;
        }
        bool isEnded;
        if (kQuery == Query::any) {
            Any any{tree, rays[i], b.exclude[i], last};
            isEnded = inRecord<kCount>(tree, leaf, f, any, visits);
        } else {
            All all{tree, b.exclude[i], last, {*b.sink, b.first + static_cast<unsigned>(i)}};
            isEnded = inRecord<kCount>(tree, leaf, f, all, visits);
        }
        result |= static_cast<unsigned>(isEnded) << i;
    }
    return result;
}

template <bool kCount, Query kQuery>
inline unsigned bundleInLeaf(const TreeView& tree, std::uint32_t reference, const Ray* rays,
                             Bundle& b, unsigned active, Visits* visits) {
    const std::uint32_t index = reference & kLeafIndex;
    const LeafKind kind = static_cast<LeafKind>(reference >> kLeafKindShift & 7);
    if (kind == kNarrowSharedLeaf) {
        if (kCount) visits->triangles += trianglesOf(tree.narrowShared[index]);
        return bundleInShared<kQuery>(tree, tree.narrowShared[index], b, active);
    }
    if (kind == kMixedLeaf)
        return aloneInRecord<kCount, kQuery>(tree, tree.records[index], rays, b, active, visits);
    const NarrowTriangleBlock& block = tree.narrowTriangles[index];
    const unsigned used = kCount ? lanesInUse(block.id) : 0;
    if (kind == kSphereLeaf) {
        if (kCount) visits->spheres += used;
        return bundleInSpheres<kQuery>(tree, block, b, active);
    }
    if (kind == kParallelogramLeaf) {
        if (kCount) visits->parallelograms += used;
        return bundleInPlanar<kQuery, true>(tree, block, b, active);
    }
    if (kCount) visits->triangles += used;
    return bundleInPlanar<kQuery, false>(tree, block, b, active);
}

template <bool kCount>
inline void alone(const Bundle&, const TreeView& tree, const Ray& ray, Hit* hit, Visits* visits) {
    f32::closestImpl<kCount>(tree, ray, hit, visits);
}
template <bool kCount>
inline void alone(const Bundle&, const TreeView& tree, const Ray& ray, std::uint8_t* occluded,
                  Visits* visits) {
    *occluded = f32::occludedImpl<kCount>(tree, ray, visits);
}
template <bool kCount>
inline bool alone(const Bundle&, const TreeView& tree, const Ray& ray, const Crosser& to,
                  Visits* visits) {
    return f32::crossingsImpl<kCount>(tree, ray, to, visits);
}

void crossings(const TreeView& tree, const Ray* rays, std::size_t count, CrossingSink& sink,
               std::uint8_t* ended, Visits* visits) {
    visits ? crossBundles<true, Bundle>(tree, rays, count, sink, ended, visits)
           : crossBundles<false, Bundle>(tree, rays, count, sink, ended, nullptr);
}

using Walk = WalkOf<Fused, float, Limits, Frame, Best>;

template <bool kCount, bool kAny>
[[gnu::always_inline]] inline BoxRay setOut(const TreeView& tree, const Ray& ray, Walk& w,
                                            Visits* visits) {
    const BoxRay box = start(tree, ray, w.frame);
    w.last = limitOf(tree, ray.tMax);
    w.best = {w.last, 0, 0, nullptr};
    Any any{tree, ray, w.exclude, w.last};
    Nearest nearest{tree, ray, w.exclude, w.best};
    if (tree.hasUnbounded) {
        if (kAny)
            w.any = inRecord<kCount>(tree, tree.unbounded, w.frame, any, visits);
        else
            inRecord<kCount>(tree, tree.unbounded, w.frame, nearest, visits);
    }
    w.limit = w.best.t;
    return box;
}

inline void conclude(const TreeView& tree, const Walk& w, Hit* hit) {
    answer(inWorld(tree, w.best), hit);
}

void closestBatch(const TreeView& tree, const Ray* rays, std::size_t count, bool coherent,
                  Hit* hits, Visits* visits) {
    visits ? closestOfAll<true, Bundle, Walk>(tree, rays, count, coherent, hits, visits)
           : closestOfAll<false, Bundle, Walk>(tree, rays, count, coherent, hits, nullptr);
}

void occludedBatch(const TreeView& tree, const Ray* rays, std::size_t count, bool coherent,
                   std::uint8_t* answers, Visits* visits) {
    visits ? occludedOfAll<true, Bundle, Walk>(tree, rays, count, coherent, answers, visits)
           : occludedOfAll<false, Bundle, Walk>(tree, rays, count, coherent, answers, nullptr);
}

} // namespace f32
