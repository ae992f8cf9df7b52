// The queries, in terms of the 8 lanes of the including file. Every expression on f64 lanes repeats
// core/geometry/intersect.cpp operation by operation.
//
// Nothing here may call an inline function of another header: it would be compiled with this file's
// flags and could replace everybody's copy.

using geometry::Hit;
using geometry::Ray;

struct alignas(64) LaneArray {
    double at[kLanes];
};

/// How far along a ray boxes matter, in octree space: t · factor + offset is no less than the parameter of t.
struct Limits {
    double factor, offset;
};

/// A ray against f32 boxes, in octree space.
///
/// For a plane p the test computes fl(p·r − n) with r = fl(1/d) and n = fl(o/d + s), all in f32 but the
/// division and o/d. Roundings, u = 2^-24, |p| <= 1: of r: u|p/d|; of n: u|o/d|; of the product (where
/// it is not fused): u|p/d|; of the difference: u(|p| + |o|)/|d|. Together at most
/// u(3 + 2|o|)/|d|, so a slack s = 4u(1 + |o|)/|d| makes an entering plane no later and, with −s, a
/// leaving plane no earlier than the exact one, and leaves 1u/|d|, 10^8 f64 roundings, for what the
/// f64 part and the leaf tests round. Origins farther than kNear are first moved along the ray to the
/// cube [−1, 1]³; what that rounds grows with the distance and is added to s.
struct BoxRay {
    Four inverse, enter, leave; // [3]: unused
    unsigned mirror;            // bit per axis: direction is negative
    Limits limits;
    bool misses; // the whole cube
};

constexpr double kNear = 8;                             // half sides of the cube
constexpr double kSlack = 4 * numeric::powerOfTwo(-24); // 4u of f32, derived above
constexpr double kFarSlack =
    numeric::powerOfTwo(-46);       // 128 u of f64: moving the origin, and the leaf tests
constexpr double kTooFar = 0x1p100; // beyond, f32 would overflow: boxes are not tested
constexpr double kSmallestDirection =
    numeric::powerOfTwo(-60); // of a largest component in [1, 2): moves a ray by
                              // less than 2^-56 within the cube

// Directions whose largest component lies between these need no normalising: the smallest component that
// is then left is at most 2^-60 of the largest, as above, and no inverse leaves the range of f32.
constexpr double kShort = numeric::powerOfTwo(-30), kLong = numeric::powerOfTwo(30),
                 kSmallestOrdinary = numeric::powerOfTwo(-90);

constexpr double kLeastPower = numeric::powerOfTwo(-1023), kLeastScale = numeric::powerOfTwo(-900);
// Of a limit: 16 u of f64 for what shifts and limitOf round, 4 u of f32 for what is rounded to f32.
constexpr double kLimitSlack = numeric::powerOfTwo(-49);
constexpr double kLimitSlackF32 = numeric::powerOfTwo(-22);
constexpr double kLeastLimit = numeric::powerOfTwo(-120);

inline double absolute(double x) { return __builtin_fabs(x); }

inline std::uint64_t bitsOf(double x) {
    std::uint64_t b;
    __builtin_memcpy(&b, &x, sizeof b);
    return b;
}

inline double fromBits(std::uint64_t b) {
    double x;
    __builtin_memcpy(&x, &b, sizeof x);
    return x;
}

/// Directions of `ray` brought to a largest component in [1, 2), and what that takes.
struct Normalized {
    Quad direction;
    double factor, inverse; // powers of two
    bool isFinite;
};

[[gnu::always_inline]] inline Normalized normalized(const Ray& ray) {
    const double* const d = &ray.direction.x;
    double largest = absolute(d[0]);
    largest = absolute(d[1]) > largest ? absolute(d[1]) : largest;
    largest = absolute(d[2]) > largest ? absolute(d[2]) : largest;
    std::uint64_t exponent = bitsOf(largest) >> 52; // 2^(exponent - 1023) <= largest
    exponent = exponent < 2046 ? exponent : 2045;
    const double factor = fromBits((2046 - exponent) << 52);
    return {withFourth(loadQuad(d), 1) * allQuad(factor), factor,
            exponent ? fromBits(exponent << 52) : kLeastPower,
            absolute(d[0]) < __builtin_inf() && absolute(d[1]) < __builtin_inf() &&
                absolute(d[2]) < __builtin_inf()};
}

inline Quad clampedDirection(const Normalized& n) {
    return withSignOf(larger(magnitude(n.direction), allQuad(kSmallestDirection)), n.direction);
}

/// Moves a far origin along its ray to the cube; false if the ray misses that. `distance`: the largest
/// |at|; `shift`: how far, in lengths of direction; `extra`: what to add to the slack.
[[gnu::noinline]] bool moveNear(const double* inverses, const double* direction, double distance,
                                double* at, double& shift, double& extra) {
    extra = kFarSlack * distance;
    double in = 0, out = __builtin_inf();
    for (int i = 0; i < 3; ++i) {
        const double side = inverses[i] < 0 ? -(1 + extra) : 1 + extra;
        const double near = (-side - at[i]) * inverses[i], far = (side - at[i]) * inverses[i];
        const double margin = kFarSlack * absolute(at[i] * inverses[i]);
        if (near - margin > in) in = near - margin;
        if (far + margin < out) out = far + margin;
    }
    for (int i = 0; i < 3; ++i) at[i] = at[i] + in * direction[i];
    shift = in;
    return in <= out;
}

/// Octree-space parameter = t · perT − shift.
inline Limits limitsOf(double perT, double shift) {
    if (!(perT > kLeastScale)) perT = __builtin_inf(); // underflow: t prunes nothing
    return {perT * ((1 + kLimitSlack) * (1 + kLimitSlackF32)),
            kLeastLimit - shift * (1 + kLimitSlackF32)};
}

/// An f32 parameter of the boxes at or after t.
inline float limitOf(const Limits& limits, double t) {
    return notNegative(static_cast<float>(productPlus(t, limits.factor, limits.offset)));
}

inline Quad originOf(const TreeView& tree, const Ray& ray) {
    return withFourth((loadQuad(&ray.origin.x) - loadQuad(tree.center)) * allQuad(tree.scale), 0);
}

/// A ray in octree space, close to the cube.
struct Start {
    alignas(32) double origin[4], direction[4];
    double extra; // slack for what moving the origin rounds
    Limits limits;
    bool misses;
};

/// For rays that start far away or have very short or long directions.
[[gnu::noinline]] void moveStart(const TreeView& tree, const Ray& ray, Start& s) {
    const Normalized n = normalized(ray);
    const Quad direction = clampedDirection(n);
    store(s.origin, originOf(tree, ray));
    store(s.direction, direction);
    s.extra = 0;
    s.misses = !n.isFinite;
    double distance = 0, shift = 0;
    for (int i = 0; i < 3; ++i)
        if (!(absolute(s.origin[i]) <= distance)) distance = absolute(s.origin[i]);
    if (!(distance <= kTooFar)) { // or NaN
        // Every box is met; the planes of empty slots stay infinite.
        store(s.origin, allQuad(0));
        store(s.direction, allQuad(1));
        s.extra = 0x1p120;
        s.limits = limitsOf(__builtin_inf(), 0);
        return;
    }
    if (!(distance <= kNear)) {
        alignas(32) double inverses[4];
        store(inverses, allQuad(1.0) / direction);
        if (!moveNear(inverses, s.direction, distance, s.origin, shift, s.extra)) s.misses = true;
        s.origin[3] = 0;
    }
    s.limits = limitsOf(tree.scale * n.inverse, shift);
}

[[gnu::always_inline]] inline BoxRay boxRayOf(const TreeView& tree, const Ray& ray) {
    Quad direction = withFourth(loadQuad(&ray.direction.x), 1), origin = originOf(tree, ray);
    const Quad size = magnitude(direction);
    BoxRay b;
    double extra = 0;
    const unsigned ordinary =
        bitsLessEqual(size, allQuad(kLong)) & bitsLessEqual(magnitude(origin), allQuad(kNear)) & 7;
    if (ordinary == 7 && bitsLessEqual(allQuad(kShort), size) & 7) [[likely]] {
        direction = withSignOf(larger(size, allQuad(kSmallestOrdinary)), direction);
        b.misses = false;
        b.limits = limitsOf(tree.scale, 0);
    } else {
        Start s;
        moveStart(tree, ray, s);
        origin = loadQuad(s.origin);
        direction = loadQuad(s.direction);
        extra = s.extra;
        b.misses = s.misses;
        b.limits = s.limits;
    }
    b.mirror = signsOf(direction);
    const Quad inverse = allQuad(1.0) / direction, t = origin * inverse;
    const Quad slack = (allQuad(kSlack) * (allQuad(1.0) + magnitude(origin)) + allQuad(extra)) *
                       magnitude(inverse);
    b.inverse = narrow(inverse);
    b.enter = narrow(t + slack);
    b.leave = narrow(t - slack);
    return b;
}

/// A BoxRay as the 8 boxes of a node meet it. Lanes: F32, or Fused where the products with planes have to be
/// contracted at every SIMD level.
template <class Lanes> struct BoxLanesOf {
    Lanes inverseX, inverseY, inverseZ, enterX, enterY, enterZ, leaveX, leaveY, leaveZ;
    std::uintptr_t nearX, nearY, nearZ; // addresses of rows of the first Node::planes
};
using BoxLanes = BoxLanesOf<F32>;

constexpr std::uintptr_t kRow = kLanes * sizeof(float);

/// The row of the first node where a ray enters boxes along an axis.
inline std::uintptr_t nearRow(const TreeView& tree, unsigned mirror, unsigned axis) {
    return reinterpret_cast<std::uintptr_t>(tree.nodes) + kRow * (2 * axis + (mirror >> axis & 1));
}

template <class Lanes = F32>
[[gnu::always_inline]] inline BoxLanesOf<Lanes> lanesOf(const TreeView& tree, const BoxRay& b) {
    return {Lanes{all<0>(b.inverse)},   Lanes{all<1>(b.inverse)},   Lanes{all<2>(b.inverse)},
            Lanes{all<0>(b.enter)},     Lanes{all<1>(b.enter)},     Lanes{all<2>(b.enter)},
            Lanes{all<0>(b.leave)},     Lanes{all<1>(b.leave)},     Lanes{all<2>(b.leave)},
            nearRow(tree, b.mirror, 0), nearRow(tree, b.mirror, 1), nearRow(tree, b.mirror, 2)};
}

/// The children of a node whose boxes the ray meets in [0, limit].
template <class Lanes>
[[gnu::always_inline]] inline unsigned meets(std::uint32_t node, const BoxLanesOf<Lanes>& ray,
                                             F32 limit, F32& enter) {
    const auto row = [&](std::uintptr_t ofFirst) {
        return load(reinterpret_cast<const float*>(ofFirst + std::uintptr_t{node} * sizeof(Node)));
    };
    const F32 nx = productMinus(row(ray.nearX), ray.inverseX, ray.enterX);
    const F32 ny = productMinus(row(ray.nearY), ray.inverseY, ray.enterY);
    const F32 nz = productMinus(row(ray.nearZ), ray.inverseZ, ray.enterZ);
    const F32 fx = productMinus(row(ray.nearX ^ kRow), ray.inverseX, ray.leaveX);
    const F32 fy = productMinus(row(ray.nearY ^ kRow), ray.inverseY, ray.leaveY);
    const F32 fz = productMinus(row(ray.nearZ ^ kRow), ray.inverseZ, ray.leaveZ);
    // `enter` is not negative. Where the other is, its bits still are the smaller integer.
    enter = largerBits(largerBits(nx, ny), largerBits(nz, all(0.0f)));
    return lessEqualBits(enter, smallerBits(smallerBits(fx, fy), smallerBits(fz, limit)));
}

constexpr std::uint8_t kNextAxis[3] = {1, 2, 0}, kAxisAfter[3] = {2, 0, 1};

/// As geometry::frameOf chooses it, without a branch.
[[gnu::always_inline]] inline int largestAxis(Quad sizes) {
    static constexpr std::uint8_t kAxis[8] = {2, 2, 2, 0, 1, 2, 1, 0};
    return kAxis[orderOfSizes(sizes)];
}

/// geometry::RayFrame of this ray.
struct Frame {
    alignas(32) double origin[4], direction[4]; // [3]: unused
    int kx, ky, kz;
    double ox, oy, oz; // origin[kx] and so on
    double shearX, shearY, shearZ;
    double squared, inverseSquared;
};

[[gnu::always_inline]] inline Frame frameOf(const TreeView& tree, const Ray& ray) {
    Frame f;
    const double *const o = &ray.origin.x, *const d = &ray.direction.x;
    const Quad direction = loadQuad(d);
    store(f.origin, loadQuad(o));
    store(f.direction, direction);
    f.kz = largestAxis(magnitude(direction));
    f.kx = kNextAxis[f.kz];
    f.ky = kAxisAfter[f.kz];
    f.ox = o[f.kx];
    f.oy = o[f.ky];
    f.oz = o[f.kz];
    f.shearZ = 1 / d[f.kz];
    f.shearX = d[f.kx] * f.shearZ;
    f.shearY = d[f.ky] * f.shearZ;
    if (tree.hasSpheres) {
        f.squared = (d[0] * d[0] + d[1] * d[1]) + d[2] * d[2];
        f.inverseSquared = 1 / f.squared;
    }
    return f;
}

struct Sheared {
    F64 x, y, z;
};

template <class Float> inline Sheared shear(const Frame& f, const Float corner[3][kLanes]) {
    const F64 z = widened(corner[f.kz]) - all(f.oz);
    return {(widened(corner[f.kx]) - all(f.ox)) - all(f.shearX) * z,
            (widened(corner[f.ky]) - all(f.oy)) - all(f.shearY) * z, z};
}

struct Edges {
    F64 u, v, w;
};

inline Edges edgesOf(const Sheared& a, const Sheared& b, const Sheared& c) {
    return {c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x};
}

/// A NaN among u, v, w may pass here, but not the test of t that follows.
inline Mask inside(const Edges& e) {
    const F64 least = smaller(smaller(e.u, e.v), e.w), most = larger(larger(e.u, e.v), e.w);
    return either(least >= all(0.0), most <= all(0.0));
}

inline Mask touching(const Edges& e) {
    return either(either(e.u == all(0.0), e.v == all(0.0)), e.w == all(0.0));
}

struct Solution {
    F64 b, c, t; // weights of the second and third corner
    Mask exists;
};

inline Solution solve(F64 shearZ, const Edges& e, const Sheared& a, const Sheared& b,
                      const Sheared& c) {
    const F64 determinant = (e.u + e.v) + e.w;
    const F64 inverse = all(1.0) / determinant;
    const F64 wb = e.v * inverse, wc = e.w * inverse;
    return {wb, wc, shearZ * (a.z + (wb * (b.z - a.z) + wc * (c.z - a.z))),
            determinant != all(0.0)};
}

inline unsigned excluded(const std::uint32_t* id, std::uint32_t exclude) {
    unsigned lanes = 0;
    for (unsigned i = 0; i < kLanes; ++i) lanes |= static_cast<unsigned>(id[i] == exclude) << i;
    return lanes;
}

/// The lanes that the ray hits in (0, limit], but the excluded one.
template <class Block>
inline unsigned hitTriangles(const Block& block, const Frame& f, double limit,
                             std::uint32_t exclude, Solution& s, Edges& e) {
    const Sheared a = shear(f, block.corner[0]), b = shear(f, block.corner[1]),
                  c = shear(f, block.corner[2]);
    e = edgesOf(a, b, c);
    const Mask in = inside(e);
    if (!bits(in)) return 0;
    s = solve(all(f.shearZ), e, a, b, c);
    unsigned lanes = bits(both(both(in, s.exists), both(s.t > all(0.0), s.t <= all(limit))));
    if (lanes && exclude != 0xFFFFFFFFu) lanes &= ~excluded(block.id, exclude);
    return lanes;
}

/// The best hit so far. t starts as tMax, which no hit reaches.
struct Best {
    double t, u, v;
    /// Where the tree holds the id of the hit; null: none yet. In a large tree that is a cache miss,
    /// which may thus last until the ray has ended (octree_bench, ico, random: 20 % faster).
    const std::uint32_t* id;
};

/// Is a hit at `t` <= best.t, of an id at `id`, better?
inline bool isBetter(double t, const std::uint32_t* id, const Best& best) {
    return t < best.t || (best.id && *id < *best.id);
}

template <class Block>
[[gnu::always_inline]] inline SharedCorners shearShared(const Frame& f, const Block& block) {
    const F64 ox = all(f.ox), oy = all(f.oy), oz = all(f.oz);
    const F64 sx = all(f.shearX), sy = all(f.shearY);
    const auto *const x = block.corner[f.kx], *const y = block.corner[f.ky],
                      *const z = block.corner[f.kz];
    SharedCorners c;
    c.z0 = widened(z) - oz;
    c.z1 = widened(z + kLanes) - oz;
    c.x0 = (widened(x) - ox) - sx * c.z0;
    c.x1 = (widened(x + kLanes) - ox) - sx * c.z1;
    c.y0 = (widened(y) - oy) - sy * c.z0;
    c.y1 = (widened(y + kLanes) - oy) - sy * c.z1;
    return c;
}

struct Solved {
    double t, u, v;
    bool touches;
};

/// One triangle of a shared block: geometry::intersectTriangle from the sheared corners on.
template <class Block>
[[gnu::always_inline]] inline bool solveShared(const Frame& f, const Block& block,
                                               const SharedArray& p, int lane, double limit,
                                               Solved& s) {
    const OneEdges e = edgesAt(p, block, lane);
    if (!e.areInside) return false;
    const double determinant = (e.u + e.v) + e.w;
    if (!(determinant != 0)) return false;
    const double inverse = 1 / determinant;
    const double a = p.z[block.index[0][lane]], b = p.z[block.index[1][lane]],
                 c = p.z[block.index[2][lane]];
    s.u = e.v * inverse;
    s.v = e.w * inverse;
    s.t = f.shearZ * (a + (s.u * (b - a) + s.v * (c - a)));
    s.touches = e.u == 0 || e.v == 0 || e.w == 0;
    return s.t > 0 && s.t <= limit;
}

template <class Block>
[[gnu::always_inline]] inline bool closestInShared(const TreeView& tree, const Block& block,
                                                   const Frame& f, std::uint32_t exclude,
                                                   Best& best) {
    const SharedCorners corners = shearShared(f, block);
    SharedArray p;
    unsigned lanes = candidates(block, corners, tree.scale, p);
    if (!lanes) return false;
    bool better = false;
    for (; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        Solved s;
        if (!solveShared(f, block, p, i, best.t, s)) continue;
        const std::uint32_t* const id = block.id + i;
        if ((exclude != 0xFFFFFFFFu && *id == exclude) || !isBetter(s.t, id, best)) continue;
        _mm_prefetch(reinterpret_cast<const char*>(id), _MM_HINT_T0);
        best.t = s.t;
        best.u = s.u;
        best.v = s.v;
        best.id = id;
        better = true;
    }
    return better;
}

template <class Block>
[[gnu::always_inline]] inline bool anyInShared(const TreeView& tree, const Block& block,
                                               const Frame& f, std::uint32_t exclude,
                                               double limit) {
    const SharedCorners corners = shearShared(f, block);
    SharedArray p;
    unsigned lanes = candidates(block, corners, tree.scale, p);
    if (!lanes) return false;
    for (; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        Solved s;
        if (solveShared(f, block, p, i, limit, s) && block.id[i] != exclude) return true;
    }
    return false;
}

inline void add(CrossingSink& sink, std::uint32_t ray, double t, std::uint32_t id) {
    if (sink.count == sink.room) sink.grow(sink);
    sink.found[sink.count++] = {t, id, ray};
}

/// Where a ray's crossings go.
struct Crosser {
    CrossingSink& sink;
    std::uint32_t ray;

    /// False: the ray ends.
    bool take(double t, std::uint32_t id, bool touches) const {
        if (sink.isOpaque(sink, id)) return false;
        touches ? sink.touch(sink, ray, id) : add(sink, ray, t, id);
        return true;
    }
};

template <class Block>
inline bool crossShared(const TreeView& tree, const Block& block, const Frame& f,
                        std::uint32_t exclude, double last, const Crosser& to) {
    const SharedCorners corners = shearShared(f, block);
    SharedArray p;
    unsigned lanes = candidates(block, corners, tree.scale, p);
    if (!lanes) return true;
    for (; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        Solved s;
        if (!solveShared(f, block, p, i, last, s)) continue;
        const std::uint32_t id = block.id[i];
        if (id == exclude) continue;
        if (!to.take(s.t, id, s.touches)) return false;
    }
    return true;
}

inline unsigned hitParallelograms(const ParallelogramBlock& block, const Frame& f, double limit,
                                  std::uint32_t exclude, Solution& s, unsigned& touched) {
    const Sheared a = shear(f, block.corner[0]), b = shear(f, block.corner[1]),
                  c = shear(f, block.corner[2]), d = shear(f, block.corner[3]);
    const Edges e1 = edgesOf(a, b, c), e2 = edgesOf(a, c, d);
    const Mask in1 = inside(e1), in2 = inside(e2);
    if (!bits(either(in1, in2))) return 0;
    const Solution s1 = solve(all(f.shearZ), e1, a, b, c), s2 = solve(all(f.shearZ), e2, a, c, d);
    const Mask first = both(in1, s1.exists), second = both(in2, s2.exists);
    touched = bits(both(in1, touching(e1))) | bits(both(in2, touching(e2)));
    s.b = select(first, s1.b + s1.c, s2.b);
    s.c = select(first, s1.c, s2.b + s2.c);
    s.t = select(first, s1.t, s2.t);
    unsigned lanes = bits(both(either(first, second), both(s.t > all(0.0), s.t <= all(limit))));
    if (lanes && exclude != 0xFFFFFFFFu) lanes &= ~excluded(block.id, exclude);
    return lanes;
}

/// Lines against spheres: what their two parameters follow from.
struct SphereLines {
    F64 b, c, discriminant;
    Mask within; // the ray starts inside
    Mask met;    // a tangent passes by
};

/// f: from the origins to the centres.
inline SphereLines sphereLines(F64 fx, F64 fy, F64 fz, F64 dx, F64 dy, F64 dz, F64 inverseSquared,
                               F64 r) {
    SphereLines s;
    s.b = (fx * dx + fy * dy) + fz * dz;
    const F64 k = s.b * inverseSquared;
    const F64 lx = fx - k * dx, ly = fy - k * dy, lz = fz - k * dz;
    const F64 r2 = r * r;
    s.discriminant = r2 - ((lx * lx + ly * ly) + lz * lz);
    s.c = ((fx * fx + fy * fy) + fz * fz) - r2;
    s.within = s.c < all(0.0);
    s.met = either(s.within, s.discriminant > all(0.0));
    return s;
}

/// The spheres of a block that a ray may hit, for hitSphere(): one by one, since there is seldom a second
/// one and two roots and divisions of 8 lanes take longer.
struct alignas(64) SphereArray {
    double b[kLanes], c[kLanes], discriminant[kLanes];
};

inline unsigned meetSpheres(const SphereBlock& block, const Frame& f, SphereArray& to) {
    const SphereLines s = sphereLines(
        load(block.center[0]) - all(f.origin[0]), load(block.center[1]) - all(f.origin[1]),
        load(block.center[2]) - all(f.origin[2]), all(f.direction[0]), all(f.direction[1]),
        all(f.direction[2]), all(f.inverseSquared), load(block.radius));
    // A ray that starts outside and points away has both parameters behind it.
    const unsigned lanes = bits(both(s.met, either(s.within, s.b >= all(0.0))));
    if (!lanes) return 0;
    store(to.b, s.b);
    store(to.c, s.c);
    store(to.discriminant, s.discriminant);
    return lanes;
}

/// Both parameters of one of them: geometry::intersectSphereLine.
inline void hitSphere(const SphereArray& s, const Frame& f, int lane, double& t0, double& t1) {
    const double b = s.b[lane], c = s.c[lane];
    const double root =
        __builtin_sqrt(c < 0 ? b * b - f.squared * c : f.squared * s.discriminant[lane]);
    const double q = b < 0 ? b - root : b + root;
    const double ta = c / q, tb = q * f.inverseSquared;
    t0 = ta < tb ? ta : tb;
    t1 = ta > tb ? ta : tb;
}

inline bool takeBest(unsigned lanes, const LaneArray& t, const LaneArray& u, const LaneArray& v,
                     const std::uint32_t* id, Best& best) {
    bool better = false;
    for (; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        if (t.at[i] <= best.t && isBetter(t.at[i], id + i, best)) {
            best.t = t.at[i];
            best.u = u.at[i];
            best.v = v.at[i];
            best.id = id + i;
            better = true;
        }
    }
    return better;
}

// Leaves of other kinds are calls: inlined beside the shared blocks' they would push what the loop over
// nodes needs out of the registers (octree_bench, bunny, primary rays: 14 % faster so).
template <class Block>
[[gnu::noinline]] bool closestInTriangles(const Block& block, const Frame& f, std::uint32_t exclude,
                                          Best& best) {
    Solution s;
    Edges e;
    const unsigned lanes = hitTriangles(block, f, best.t, exclude, s, e);
    if (!lanes) return false;
    LaneArray t, u, v;
    store(t.at, s.t);
    store(u.at, s.b);
    store(v.at, s.c);
    return takeBest(lanes, t, u, v, block.id, best);
}

[[gnu::noinline]] bool closestInParallelograms(const ParallelogramBlock& block, const Frame& f,
                                               std::uint32_t exclude, Best& best) {
    Solution s;
    unsigned touched;
    const unsigned lanes = hitParallelograms(block, f, best.t, exclude, s, touched);
    if (!lanes) return false;
    LaneArray t, u, v;
    store(t.at, s.t);
    store(u.at, s.b);
    store(v.at, s.c);
    return takeBest(lanes, t, u, v, block.id, best);
}

[[gnu::noinline]] bool closestInSpheres(const SphereBlock& block, const Frame& f, Best& best) {
    SphereArray spheres;
    bool better = false;
    for (unsigned lanes = meetSpheres(block, f, spheres); lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        double t0, t1;
        hitSphere(spheres, f, i, t0, t1);
        const double t = t0 > 0 ? t0 : t1;
        if (!(t > 0 && t <= best.t) || !isBetter(t, block.id + i, best)) continue;
        best = {t, 0, 0, block.id + i};
        better = true;
    }
    return better;
}

inline bool closestInRun(const TreeView& tree, const CustomRun& run, const Ray& ray, Best& best) {
    double t;
    const std::uint32_t* const id = closestOfRun(tree, run, ray, best.t, t);
    if (!id || !(t <= best.t && isBetter(t, id, best))) return false;
    best.t = t;
    best.u = best.v = 0;
    best.id = id;
    return true;
}

/// Primitives of a block: lanes in use come first.
inline unsigned lanesInUse(const std::uint32_t* id) {
    return static_cast<unsigned>(__builtin_ctz(bitsEqual(id, 0xFFFFFFFFu) | 1u << kLanes));
}

template <class Block> inline unsigned trianglesOf(const Block& block) {
    return static_cast<unsigned>(__builtin_popcount(block.valid));
}

template <bool kCount>
[[gnu::noinline]] bool closestInRecord(const TreeView& tree, const LeafRecord& leaf, const Ray& ray,
                                       const Frame& f, std::uint32_t exclude, Best& best,
                                       Visits* visits) {
    bool better = false;
    for (std::uint32_t i = 0; i < leaf.triangleBlocks; ++i) {
        const TriangleBlock& block = tree.triangles[leaf.triangles + i];
        if (kCount) visits->triangles += lanesInUse(block.id);
        better |= closestInTriangles(block, f, exclude, best);
    }
    for (std::uint32_t i = 0; i < leaf.sphereBlocks; ++i) {
        const SphereBlock& block = tree.spheres[leaf.spheres + i];
        if (kCount) visits->spheres += lanesInUse(block.id);
        better |= closestInSpheres(block, f, best);
    }
    for (std::uint32_t i = 0; i < leaf.parallelogramBlocks; ++i) {
        const ParallelogramBlock& block = tree.parallelograms[leaf.parallelograms + i];
        if (kCount) visits->parallelograms += lanesInUse(block.id);
        better |= closestInParallelograms(block, f, exclude, best);
    }
    for (std::uint32_t i = 0; i < leaf.runCount; ++i) {
        const CustomRun& run = tree.runs[leaf.runs + i];
        if (kCount) visits->customs += run.count;
        better |= closestInRun(tree, run, ray, best);
    }
    return better;
}

template <bool kCount>
[[gnu::always_inline]] inline bool
closestInLeaf(const TreeView& tree, std::uint32_t reference, const Ray& ray, const Frame& f,
              std::uint32_t exclude, Best& best, Visits* visits) {
    const std::uint32_t index = reference & kLeafIndex;
    switch (reference >> kLeafKindShift & 7) {
    case kSharedLeaf:
        if (kCount) visits->triangles += trianglesOf(tree.shared[index]);
        return closestInShared(tree, tree.shared[index], f, exclude, best);
    case kNarrowSharedLeaf:
        if (kCount) visits->triangles += trianglesOf(tree.narrowShared[index]);
        return closestInShared(tree, tree.narrowShared[index], f, exclude, best);
    case kNarrowTriangleLeaf:
        if (kCount) visits->triangles += lanesInUse(tree.narrowTriangles[index].id);
        return closestInTriangles(tree.narrowTriangles[index], f, exclude, best);
    case kTriangleLeaf:
        if (kCount) visits->triangles += lanesInUse(tree.triangles[index].id);
        return closestInTriangles(tree.triangles[index], f, exclude, best);
    case kSphereLeaf:
        if (kCount) visits->spheres += lanesInUse(tree.spheres[index].id);
        return closestInSpheres(tree.spheres[index], f, best);
    case kParallelogramLeaf:
        if (kCount) visits->parallelograms += lanesInUse(tree.parallelograms[index].id);
        return closestInParallelograms(tree.parallelograms[index], f, exclude, best);
    default:
        return closestInRecord<kCount>(tree, tree.records[index], ray, f, exclude, best, visits);
    }
}

/// Where a node or leaf lies.
inline const char* placeOf(const TreeView& tree, std::uint32_t reference) {
    const TreeView::Place& place = tree.places[reference >> kLeafKindShift];
    return static_cast<const char*>(place.first) + (reference & kLeafIndex) * place.size;
}

constexpr std::size_t kLine = 64, kFirstLines = 4 * kLine; // bytes

/// Asks memory for a node, or the first lines of a leaf.
inline void fetch(const TreeView& tree, std::uint32_t reference) {
    const char* const from = placeOf(tree, reference);
    for (std::size_t at = 0; at < kFirstLines; at += kLine) _mm_prefetch(from + at, _MM_HINT_T0);
}

/// Asks for the rest.
inline void fetchRest(const TreeView& tree, std::uint32_t leaf) {
    const char* const from = placeOf(tree, leaf);
    const std::size_t size = tree.places[leaf >> kLeafKindShift].size;
    for (std::size_t at = kFirstLines; at < size; at += kLine) _mm_prefetch(from + at, _MM_HINT_T0);
}

/// `slot`, by a jump for each value. CPUs foretell jumps: what is read with the result need not wait for the test of the
/// boxes that chose it (octree_bench, Xeon with AVX-512, rays alone: primary, shadow and mirrored ones 8 to 44 % faster;
/// random ones, whose way nobody can foretell, 2 to 17 % slower).
[[gnu::always_inline]] inline unsigned foretold(unsigned slot) {
    // Opaque, or the compiler would see through it.
    const auto exactly = [](unsigned s) {
        __asm__ volatile("" : "+r"(s));
        return s;
    };
    switch (slot) {
    case 0:
        return exactly(0);
    case 1:
        return exactly(1);
    case 2:
        return exactly(2);
    case 3:
        return exactly(3);
    case 4:
        return exactly(4);
    case 5:
        return exactly(5);
    case 6:
        return exactly(6);
    default:
        return exactly(7);
    }
}

/// Goes on with `best` below one node or leaf.
template <bool kCount, class Lanes, class Limits, class Frame, class Best>
[[gnu::always_inline]] inline void
closestFrom(const TreeView& tree, std::uint32_t current, const Ray& ray,
            const BoxLanesOf<Lanes>& lanes, const Order& order, const Limits& limits,
            const Frame& f, std::uint32_t exclude, Best& best, Visits* visits) {
    std::uint32_t references[kStackSize];
    float enters[kStackSize];
    std::size_t top = 0;
    references[0] = current;
    const std::uint8_t* const nearest = kTables.nearest[order.mirror];
    float limit = limitOf(limits, best.t);
    for (;;) {
        if (!(current & kLeaf)) {
            const Node& node = tree.nodes[current];
            if (kCount) ++visits->nodes;
            F32 enter;
            const unsigned mask = meets(current, lanes, all(limit), enter);
            if (mask) {
                const unsigned next = foretold(nearest[mask]);
                pushAll(order, node, enter, mask & ~(1u << next), references, enters, top);
                current = node.child[next];
                // Costs primary and mirrored rays 2 to 4 %; random ones of large trees gain 7 to 8.
                fetch(tree, references[top - (top != 0)]); // comes after `current`
                continue;
            }
        } else if (closestInLeaf<kCount>(tree, current, ray, f, exclude, best, visits)) {
            limit = limitOf(limits, best.t);
        }
        do {
            if (top == 0) return;
            --top;
        } while (enters[top] > limit);
        current = references[top];
    }
}

inline void answer(const Best& best, Hit* hit) {
    hit->t = best.id ? best.t : __builtin_inf();
    hit->u = best.id ? best.u : 0;
    hit->v = best.id ? best.v : 0;
    hit->id = best.id ? static_cast<geometry::PrimitiveId>(*best.id) : geometry::kNoPrimitive;
}

template <bool kCount>
inline void closestImpl(const TreeView& tree, const Ray& ray, Hit* hit, Visits* visits) {
    const BoxRay box = boxRayOf(tree, ray);
    const Frame f = frameOf(tree, ray);
    const auto exclude = static_cast<std::uint32_t>(ray.exclude);
    Best best{ray.tMax, 0, 0, nullptr};
    if (tree.hasUnbounded)
        closestInRecord<kCount>(tree, tree.unbounded, ray, f, exclude, best, visits);
    if (!tree.nodes || box.misses) return answer(best, hit);
    closestFrom<kCount>(tree, 0, ray, lanesOf(tree, box), orderOf(box.mirror), box.limits, f,
                        exclude, best, visits);
    answer(best, hit);
}

template <class Block>
[[gnu::noinline]] bool anyInTriangles(const Block& block, const Frame& f, double limit,
                                      std::uint32_t exclude) {
    Solution s;
    Edges e;
    return hitTriangles(block, f, limit, exclude, s, e);
}

[[gnu::noinline]] bool anyInParallelograms(const ParallelogramBlock& block, const Frame& f,
                                           double limit, std::uint32_t exclude) {
    Solution s;
    unsigned touched;
    return hitParallelograms(block, f, limit, exclude, s, touched);
}

[[gnu::noinline]] bool anyInSpheres(const SphereBlock& block, const Frame& f, double limit) {
    SphereArray spheres;
    for (unsigned lanes = meetSpheres(block, f, spheres); lanes; lanes &= lanes - 1) {
        double t0, t1;
        hitSphere(spheres, f, __builtin_ctz(lanes), t0, t1);
        const double t = t0 > 0 ? t0 : t1;
        if (t > 0 && t <= limit) return true;
    }
    return false;
}

template <bool kCount>
[[gnu::noinline]] bool anyInRecord(const TreeView& tree, const LeafRecord& leaf, const Ray& ray,
                                   const Frame& f, std::uint32_t exclude, double limit,
                                   Visits* visits) {
    for (std::uint32_t i = 0; i < leaf.triangleBlocks; ++i) {
        const TriangleBlock& block = tree.triangles[leaf.triangles + i];
        if (kCount) visits->triangles += lanesInUse(block.id);
        if (anyInTriangles(block, f, limit, exclude)) return true;
    }
    for (std::uint32_t i = 0; i < leaf.sphereBlocks; ++i) {
        const SphereBlock& block = tree.spheres[leaf.spheres + i];
        if (kCount) visits->spheres += lanesInUse(block.id);
        if (anyInSpheres(block, f, limit)) return true;
    }
    for (std::uint32_t i = 0; i < leaf.parallelogramBlocks; ++i) {
        const ParallelogramBlock& block = tree.parallelograms[leaf.parallelograms + i];
        if (kCount) visits->parallelograms += lanesInUse(block.id);
        if (anyInParallelograms(block, f, limit, exclude)) return true;
    }
    for (std::uint32_t i = 0; i < leaf.runCount; ++i) {
        const CustomRun& run = tree.runs[leaf.runs + i];
        if (kCount) visits->customs += run.count;
        double at;
        if (closestOfRun(tree, run, ray, limit, at)) return true;
    }
    return false;
}

template <bool kCount>
[[gnu::always_inline]] inline bool anyInLeaf(const TreeView& tree, std::uint32_t reference,
                                             const Ray& ray, const Frame& f, std::uint32_t exclude,
                                             double limit, Visits* visits) {
    const std::uint32_t index = reference & kLeafIndex;
    switch (reference >> kLeafKindShift & 7) {
    case kSharedLeaf:
        if (kCount) visits->triangles += trianglesOf(tree.shared[index]);
        return anyInShared(tree, tree.shared[index], f, exclude, limit);
    case kNarrowSharedLeaf:
        if (kCount) visits->triangles += trianglesOf(tree.narrowShared[index]);
        return anyInShared(tree, tree.narrowShared[index], f, exclude, limit);
    case kNarrowTriangleLeaf:
        if (kCount) visits->triangles += lanesInUse(tree.narrowTriangles[index].id);
        return anyInTriangles(tree.narrowTriangles[index], f, limit, exclude);
    case kTriangleLeaf:
        if (kCount) visits->triangles += lanesInUse(tree.triangles[index].id);
        return anyInTriangles(tree.triangles[index], f, limit, exclude);
    case kSphereLeaf:
        if (kCount) visits->spheres += lanesInUse(tree.spheres[index].id);
        return anyInSpheres(tree.spheres[index], f, limit);
    case kParallelogramLeaf:
        if (kCount) visits->parallelograms += lanesInUse(tree.parallelograms[index].id);
        return anyInParallelograms(tree.parallelograms[index], f, limit, exclude);
    default:
        return anyInRecord<kCount>(tree, tree.records[index], ray, f, exclude, limit, visits);
    }
}

/// The largest double below x > 0: the limits of the leaf tests are inclusive, tMax is not.
inline double below(double x) {
    return x > 0 && x < __builtin_inf() ? fromBits(bitsOf(x) - 1)
           : x > 0                      ? 0x1.fffffffffffffp1023
                                        : 0;
}

/// Is there a hit up to `last` below one node or leaf? Far children come first: such rays start on a surface, near it are
/// many boxes that they meet in vain, and what stops them is seldom there (octree_bench, shadow rays, Xeon with AVX-512:
/// 14 to 27 % faster than by slot on scans, 0 to 6 % on the others; near ones first were 0 to 8 % slower).
template <bool kCount, class Lanes, class Frame, class Real>
[[gnu::always_inline]] inline bool anyFrom(const TreeView& tree, std::uint32_t current,
                                           const Ray& ray, const BoxLanesOf<Lanes>& lanes,
                                           unsigned mirror, float boxLimit, const Frame& f,
                                           std::uint32_t exclude, Real last, Visits* visits) {
    const F32 limit = all(boxLimit);
    std::uint32_t references[kStackSize];
    std::size_t top = 0;
    const std::uint8_t* const farthest = kTables.nearest[mirror ^ 7];
    for (;;) {
        if (!(current & kLeaf)) {
            const Node& node = tree.nodes[current];
            if (kCount) ++visits->nodes;
            F32 enter;
            const unsigned mask = meets(current, lanes, limit, enter);
            if (mask) {
                const unsigned next = foretold(farthest[mask]);
                pushAny(node, mask & ~(1u << next), references, top);
                current = node.child[next];
                continue;
            }
        } else if (anyInLeaf<kCount>(tree, current, ray, f, exclude, last, visits)) {
            return true;
        }
        if (top == 0) return false;
        current = references[--top];
    }
}

template <bool kCount>
inline bool occludedImpl(const TreeView& tree, const Ray& ray, Visits* visits) {
    const BoxRay box = boxRayOf(tree, ray);
    const Frame f = frameOf(tree, ray);
    const auto exclude = static_cast<std::uint32_t>(ray.exclude);
    const double last = below(ray.tMax);
    if (tree.hasUnbounded &&
        anyInRecord<kCount>(tree, tree.unbounded, ray, f, exclude, last, visits))
        return true;
    if (!tree.nodes || box.misses) return false;
    return anyFrom<kCount>(tree, 0, ray, lanesOf(tree, box), box.mirror,
                           limitOf(box.limits, ray.tMax), f, exclude, last, visits);
}

inline bool addAll(unsigned lanes, unsigned touched, const LaneArray& t, const std::uint32_t* id,
                   const Crosser& to) {
    for (; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        if (!to.take(t.at[i], id[i], touched >> i & 1)) return false;
    }
    return true;
}

template <bool kCount, class Block>
inline bool crossTriangles(const Block& block, const Frame& f, std::uint32_t exclude, double last,
                           const Crosser& to, Visits* visits) {
    if (kCount) visits->triangles += lanesInUse(block.id);
    Solution s;
    Edges e;
    const unsigned lanes = hitTriangles(block, f, last, exclude, s, e);
    if (!lanes) return true;
    LaneArray t;
    store(t.at, s.t);
    return addAll(lanes, bits(touching(e)), t, block.id, to);
}

template <bool kCount>
inline bool crossParallelograms(const ParallelogramBlock& block, const Frame& f,
                                std::uint32_t exclude, double last, const Crosser& to,
                                Visits* visits) {
    if (kCount) visits->parallelograms += lanesInUse(block.id);
    Solution s;
    unsigned touched;
    const unsigned lanes = hitParallelograms(block, f, last, exclude, s, touched);
    if (!lanes) return true;
    LaneArray t;
    store(t.at, s.t);
    return addAll(lanes, touched, t, block.id, to);
}

template <bool kCount>
inline bool crossSpheres(const SphereBlock& block, const Frame& f, double last, const Crosser& to,
                         Visits* visits) {
    if (kCount) visits->spheres += lanesInUse(block.id);
    SphereArray spheres;
    for (unsigned lanes = meetSpheres(block, f, spheres); lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        double t[2];
        hitSphere(spheres, f, i, t[0], t[1]);
        for (const double at : t)
            if (at > 0 && at <= last && !to.take(at, block.id[i], false)) return false;
    }
    return true;
}

template <bool kCount>
inline bool crossRecord(const TreeView& tree, const LeafRecord& leaf, const Frame& f,
                        std::uint32_t exclude, double last, const Crosser& to, Visits* visits) {
    for (std::uint32_t i = 0; i < leaf.triangleBlocks; ++i)
        if (!crossTriangles<kCount>(tree.triangles[leaf.triangles + i], f, exclude, last, to,
                                    visits))
            return false;
    for (std::uint32_t i = 0; i < leaf.sphereBlocks; ++i)
        if (!crossSpheres<kCount>(tree.spheres[leaf.spheres + i], f, last, to, visits))
            return false;
    for (std::uint32_t i = 0; i < leaf.parallelogramBlocks; ++i)
        if (!crossParallelograms<kCount>(tree.parallelograms[leaf.parallelograms + i], f, exclude,
                                         last, to, visits))
            return false;
    for (std::uint32_t i = 0; i < leaf.runCount; ++i) {
        const CustomRun& run = tree.runs[leaf.runs + i];
        if (kCount) visits->customs += run.count;
        if (!to.sink.custom(to.sink, to.ray, run)) return false;
    }
    return true;
}

/// False: the ray ends in the leaf.
template <bool kCount>
[[gnu::always_inline]] inline bool crossInLeaf(const TreeView& tree, std::uint32_t reference,
                                               const Frame& f, std::uint32_t exclude, double last,
                                               const Crosser& to, Visits* visits) {
    const std::uint32_t index = reference & kLeafIndex;
    switch (reference >> kLeafKindShift & 7) {
    case kSharedLeaf:
        if (kCount) visits->triangles += trianglesOf(tree.shared[index]);
        return crossShared(tree, tree.shared[index], f, exclude, last, to);
    case kNarrowSharedLeaf:
        if (kCount) visits->triangles += trianglesOf(tree.narrowShared[index]);
        return crossShared(tree, tree.narrowShared[index], f, exclude, last, to);
    case kNarrowTriangleLeaf:
        return crossTriangles<kCount>(tree.narrowTriangles[index], f, exclude, last, to, visits);
    case kTriangleLeaf:
        return crossTriangles<kCount>(tree.triangles[index], f, exclude, last, to, visits);
    case kSphereLeaf:
        return crossSpheres<kCount>(tree.spheres[index], f, last, to, visits);
    case kParallelogramLeaf:
        return crossParallelograms<kCount>(tree.parallelograms[index], f, exclude, last, to,
                                           visits);
    default:
        return crossRecord<kCount>(tree, tree.records[index], f, exclude, last, to, visits);
    }
}

/// False: the ray ends below one node or leaf.
template <bool kCount, class Lanes, class Frame, class Real>
[[gnu::always_inline]] inline bool crossFrom(const TreeView& tree, std::uint32_t current,
                                             const BoxLanesOf<Lanes>& lanes, unsigned mirror,
                                             float boxLimit, const Frame& f, std::uint32_t exclude,
                                             Real last, const Crosser& to, Visits* visits) {
    const F32 limit = all(boxLimit);
    std::uint32_t references[kStackSize];
    std::size_t top = 0;
    const std::uint8_t* const farthest = kTables.nearest[mirror ^ 7];
    for (;;) {
        if (!(current & kLeaf)) {
            const Node& node = tree.nodes[current];
            if (kCount) ++visits->nodes;
            F32 enter;
            const unsigned mask = meets(current, lanes, limit, enter);
            if (mask) {
                const unsigned next = foretold(farthest[mask]);
                pushAny(node, mask & ~(1u << next), references, top);
                current = node.child[next];
                continue;
            }
        } else if (!crossInLeaf<kCount>(tree, current, f, exclude, last, to, visits)) {
            return false;
        }
        if (top == 0) return true;
        current = references[--top];
    }
}

template <bool kCount>
inline bool crossingsImpl(const TreeView& tree, const Ray& ray, const Crosser& to, Visits* visits) {
    const BoxRay box = boxRayOf(tree, ray);
    const Frame f = frameOf(tree, ray);
    const auto exclude = static_cast<std::uint32_t>(ray.exclude);
    const double last = below(ray.tMax);
    if (!crossRecord<kCount>(tree, tree.unbounded, f, exclude, last, to, visits)) return false;
    if (!tree.nodes || box.misses) return true;
    return crossFrom<kCount>(tree, 0, lanesOf(tree, box), box.mirror, limitOf(box.limits, ray.tMax),
                             f, exclude, last, to, visits);
}
