// 16 rays that start and point alike, traced together: lanes are rays here, children or primitives
// elsewhere. The answers are those of kernel.inl, because every answer comes from the same f64
// expressions, and what is left out before them (boxes, the f32 filter) is left out only where they
// would find nothing. In which order primitives are met does not matter: the smallest t wins, then the
// lowest id.
//
// The rays must agree in the signs of their directions and in the largest component; others go one by
// one.

constexpr int kRays = 16;

// So many rays or fewer go on one by one below a node, and in a leaf. 2 below a node: shadow rays of a soup take 7 %
// longer, others up to 1 % less; 4 in a leaf: 5 % longer (octree_bench).
constexpr int kFewInNode = 3;
constexpr int kFewInLeaf = 3; // >= kFewInNode
constexpr std::size_t kWorthBundle = 4;
// The leaves that stopped shadow rays last are asked before the root, as they often stop the next ones, too, until one
// stops none. With 2, shadow rays of scans take 5 to 16 % less, others as long; 1 gains less, 3 and 4 no more
// (octree_bench).
constexpr int kBlockers = 2;
constexpr std::uint32_t kNoBlocker = ~0u;

/// All boxes that any of the rays may meet, at once for the 8 children of a node.
///
/// The enter parameter of ray i at a plane p is (p − oᵢ)/dᵢ; all directions have one sign along the
/// axis. Let O be the largest oᵢ + sᵢ where directions are positive and the smallest oᵢ − sᵢ where they
/// are negative, and R the interval of the fl(1/dᵢ). Then fl(fl(p − O)·r), r an end of R, whichever
/// makes it smaller, is for no ray later than (p − oᵢ)/dᵢ − sᵢ/|dᵢ| plus roundings: of r, the
/// difference and the product, each u = 2^-24 of (1 + |oᵢ| + sᵢ)/|dᵢ|, and of O to f32, u(|oᵢ| + sᵢ)/|dᵢ|. So
/// sᵢ = 5u(1 + |oᵢ|) makes it no later than the exact one and leaves 1u/|dᵢ| for what the leaf tests
/// round, as BoxRay does. Leave parameters likewise, mirrored. Products smaller than 2^-126 lose at
/// most 2^-149, which kLeastLimit and the 1u outweigh: |r| >= 1/2.
struct BundleBoxes {
    F32 enterOrigin[3], leaveOrigin[3], low[3], high[3];
    std::uintptr_t near[3]; // offsets of rows of Node::planes, bytes
};

constexpr double kBundleSlack = 5 * numeric::powerOfTwo(-24); // derived above

struct alignas(64) Bundle {
    // as BoxRay, [axis][ray]; in octree space
    float inverse[3][kRays], enter[3][kRays], leave[3][kRays];
    float limit[kRays]; // as limitOf; -1: the ray meets no box any more
    float cap[kRays];   // of limit: -1 or infinity
    double limitFactor[kRays], limitOffset[kRays];
    // as Frame
    double origin[3][kRays];
    double shearX[kRays], shearY[kRays], shearZ[kRays];
    double direction[3][kRays], squared[kRays], inverseSquared[kRays]; // where there are spheres
    // as Best; t of an occlusion query is the last that counts
    double t[kRays], u[kRays], v[kRays];
    std::uint32_t id[kRays], exclude[kRays];
    unsigned found;  // bit per ray: it met something; of a crossing query: something opaque
    unsigned active; // bit per ray that may still meet a box
    bool excludes;   // any ray excludes a primitive
    bool isMoved;    // some origin was far and is now in the cube
    int kx, ky, kz;
    unsigned mirror;
    BundleBoxes boxes;
    std::uint32_t blockers[kBlockers]; // of occlusion queries: 8 · node + slot, the latest first
    CrossingSink* sink;                // of a crossing query
    std::uint32_t first;               // number of the first ray there
    // for the f32 filter, where there are triangles: octree space, relative to `reference`, axes as kx, ky, kz
    alignas(64) float filterX[kRays], filterY[kRays], filterZ[kRays], filterShearX[kRays],
        filterShearY[kRays];
    double reference[3]; // [axis]
    float filterError;   // of a sheared coordinate
};

/// False if the rays do not go together. rays: 16, of which `count` matter.
inline bool setUp(const TreeView& tree, const Ray* rays, unsigned count, Bundle& b) {
    static_assert(sizeof(Ray) == 8 * sizeof(double) && __builtin_offsetof(Ray, origin) == 0 &&
                  __builtin_offsetof(Ray, tMax) == 3 * sizeof(double) &&
                  __builtin_offsetof(Ray, direction) == 4 * sizeof(double));
    static_assert(__builtin_offsetof(Ray, exclude) == 7 * sizeof(double));
    enum { kOrigin = 0, kTMax = 3, kDirection = 4, kExclude = 7 };
    F64 column[2][8];
    transpose(rays, column[0]);
    transpose(rays + kLanes, column[1]);
    b.mirror = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const unsigned negative =
            signsOf(column[0][kDirection + axis]) | signsOf(column[1][kDirection + axis]) << kLanes;
        if (negative != 0 && negative != 0xFFFF) return false;
        b.mirror |= (negative & 1) << axis;
    }
    unsigned xy = 0, xz = 0, yz = 0, good = 0;
    F64 power[2], factor[2];
    for (int g = 0; g < 2; ++g) {
        const F64 x = magnitude(column[g][kDirection]), y = magnitude(column[g][kDirection + 1]),
                  z = magnitude(column[g][kDirection + 2]);
        const int at = g * kLanes;
        xy |= bits(x > y) << at;
        xz |= bits(x > z) << at;
        yz |= bits(y > z) << at;
        // Neither infinite nor NaN nor subnormal.
        const F64 largest = larger(larger(x, y), z);
        good |= bits(both((x + y) + z < all(0x1p1021), largest >= all(0x1p-1022))) << at;
        power[g] = powerBelow(largest, factor[g]);
    }
    if (good != 0xFFFF) return false;
    if ((xy & xz) == 0xFFFF)
        b.kz = 0;
    else if ((~xy & yz) == 0xFFFF)
        b.kz = 1;
    else if (((xy & xz) | (~xy & yz)) == 0)
        b.kz = 2;
    else
        return false;
    b.kx = b.kz == 2 ? 0 : b.kz + 1;
    b.ky = b.kx == 2 ? 0 : b.kx + 1;

    alignas(64) double moved[3][kRays], inverse[3][kRays], extra[kRays];
    unsigned isNear = 0xFFFF, excludesNothing = 0xFF;
    for (int g = 0; g < 2; ++g) {
        const int at = g * kLanes;
        for (int axis = 0; axis < 3; ++axis) {
            const F64 o = column[g][kOrigin + axis], d = column[g][kDirection + axis];
            store(b.origin[axis] + at, o);
            const F64 n = d * factor[g];
            const F64 clamped = withSignOf(larger(magnitude(n), all(kSmallestDirection)), n);
            store(inverse[axis] + at, all(1.0) / clamped);
            const F64 scaled = (o - all(tree.center[axis])) * all(tree.scale);
            store(moved[axis] + at, scaled);
            isNear &= bits(magnitude(scaled) <= all(kNear)) << at | 0xFF00u >> at;
        }
        const F64 perT = all(tree.scale) * power[g];
        store(b.limitFactor + at, select(perT > all(kLeastScale), perT, all(__builtin_inf())) *
                                      all((1 + kLimitSlack) * (1 + kLimitSlackF32)));
        store(b.limitOffset + at, all(kLeastLimit));
        store(extra + at, all(0.0));
        store(b.t + at, column[g][kTMax]);
        store(b.u + at, all(0.0));
        store(b.v + at, all(0.0));
        storeLowWords(b.id + at, all(0.0));
        storeLowWords(b.exclude + at, column[g][kExclude]);
        excludesNothing &= bitsEqual(b.exclude + at, 0xFFFFFFFFu);
        const F64 shearZ = load(inverse[b.kz] + at) * factor[g];
        store(b.shearZ + at, shearZ);
        store(b.shearX + at, column[g][kDirection + b.kx] * shearZ);
        store(b.shearY + at, column[g][kDirection + b.ky] * shearZ);
        if (tree.hasSpheres) {
            const F64 x = column[g][kDirection], y = column[g][kDirection + 1],
                      z = column[g][kDirection + 2];
            store(b.direction[0] + at, x);
            store(b.direction[1] + at, y);
            store(b.direction[2] + at, z);
            const F64 squared = (x * x + y * y) + z * z;
            store(b.squared + at, squared);
            store(b.inverseSquared + at, all(1.0) / squared);
        }
    }
    b.found = 0;
    b.active = 0xFFFFu >> (kRays - count);
    b.isMoved = isNear != 0xFFFF;
    double mostExtra = 0;
    for (unsigned far = ~isNear & 0xFFFF; far; far &= far - 1) {
        const int i = __builtin_ctz(far);
        double at[3], distance = 0;
        for (int axis = 0; axis < 3; ++axis) {
            at[axis] = moved[axis][i];
            if (!(absolute(at[axis]) <= distance)) distance = absolute(at[axis]);
        }
        if (!(distance <= kTooFar)) return false; // or NaN
        const double inverses[3] = {inverse[0][i], inverse[1][i], inverse[2][i]};
        alignas(32) double direction[4];
        store(direction, clampedDirection(normalized(rays[i])));
        double shift;
        if (!moveNear(inverses, direction, distance, at, shift, extra[i])) b.active &= ~(1u << i);
        b.limitOffset[i] = limitsOf(tree.scale, shift).offset;
        if (extra[i] > mostExtra) mostExtra = extra[i];
        for (int axis = 0; axis < 3; ++axis) moved[axis][i] = at[axis];
    }
    b.excludes = excludesNothing != 0xFF;
    store(b.cap, allWide(__builtin_inff()));
    for (unsigned out = ~b.active & 0xFFFF; out; out &= out - 1) b.cap[__builtin_ctz(out)] = -1;

    Wide reach = allWide(0);
    double reference = 0;
    for (int axis = 0; axis < 3; ++axis) {
        F64 enter[2], leave[2], low[2], high[2];
        for (int g = 0; g < 2; ++g) {
            const int at = g * kLanes;
            const F64 o = load(moved[axis] + at), r = load(inverse[axis] + at);
            const F64 size = all(1.0) + magnitude(o), more = load(extra + at);
            const F64 slack = (all(kSlack) * size + more) * magnitude(r), t = o * r;
            enter[g] = t + slack;
            leave[g] = t - slack;
            const F64 wider = all(kBundleSlack) * size + more;
            low[g] = o - wider;
            high[g] = o + wider;
        }
        const Wide inverses = narrow(load(inverse[axis]), load(inverse[axis] + kLanes));
        store(b.inverse[axis], inverses);
        store(b.enter[axis], narrow(enter[0], enter[1]));
        store(b.leave[axis], narrow(leave[0], leave[1]));
        const F32 least = all(smallestOf(narrow(low[0], low[1]))),
                  most = all(largestOf(narrow(high[0], high[1])));
        const bool negative = b.mirror >> axis & 1;
        b.boxes.enterOrigin[axis] = negative ? least : most;
        b.boxes.leaveOrigin[axis] = negative ? most : least;
        b.boxes.low[axis] = all(smallestOf(inverses));
        b.boxes.high[axis] = all(largestOf(inverses));
        b.boxes.near[axis] = kRow * (2 * static_cast<unsigned>(axis) + negative);
        if (!tree.hasTriangles) continue;
        const double first = moved[axis][0];
        b.reference[axis] = first;
        if (absolute(first) > reference) reference = absolute(first);
        const Wide offset =
            narrow(load(moved[axis]) - all(first), load(moved[axis] + kLanes) - all(first));
        store(axis == b.kx ? b.filterX : axis == b.ky ? b.filterY : b.filterZ, offset);
        reach = larger(reach, magnitude(offset));
    }
    if (!tree.hasTriangles) return true;
    store(b.filterShearX, narrow(load(b.shearX), load(b.shearX + kLanes)));
    store(b.filterShearY, narrow(load(b.shearY), load(b.shearY + kLanes)));
    b.filterError = tree.scale < kFilterLargestScale
                        ? kShearError * (1 + static_cast<float>(reference) + largestOf(reach)) +
                              2 * static_cast<float>(mostExtra)
                        : __builtin_inff();
    return true;
}

/// As limitOf, for all rays; returns the largest.
inline float setLimits(Bundle& b) {
    const auto eight = [&](int at) {
        return load(b.t + at) * load(b.limitFactor + at) + load(b.limitOffset + at);
    };
    const Wide limit =
        smaller(larger(narrow(eight(0), eight(kLanes)), allWide(0)), loadWide(b.cap));
    store(b.limit, limit);
    return largestOf(limit);
}

inline F32 row(const Node& node, std::uintptr_t offset) {
    return load(reinterpret_cast<const float*>(reinterpret_cast<const char*>(&node) + offset));
}

/// The children whose boxes any ray may meet in [0, limit].
inline unsigned mayMeet(const Node& node, const BundleBoxes& b, F32 limit, F32& enter) {
    const auto earlier = [&](int axis) {
        const F32 p = row(node, b.near[axis]) - b.enterOrigin[axis];
        return smaller(p * b.low[axis], p * b.high[axis]);
    };
    const auto later = [&](int axis) {
        const F32 p = row(node, b.near[axis] ^ kRow) - b.leaveOrigin[axis];
        return larger(p * b.low[axis], p * b.high[axis]);
    };
    enter = largerBits(largerBits(earlier(0), earlier(1)), largerBits(earlier(2), all(0.0f)));
    return lessEqualBits(
        enter, smallerBits(smallerBits(later(0), later(1)), smallerBits(later(2), limit)));
}

/// The rays that meet the box of one child: as meets().
inline unsigned meetChild(const Node& node, unsigned slot, const Bundle& b) {
    const auto plane = [&](std::uintptr_t offset) {
        return allWide(*(
            reinterpret_cast<const float*>(reinterpret_cast<const char*>(&node) + offset) + slot));
    };
    const auto enter = [&](int axis) {
        return productMinus(plane(b.boxes.near[axis]), loadWide(b.inverse[axis]),
                            loadWide(b.enter[axis]));
    };
    const auto leave = [&](int axis) {
        return productMinus(plane(b.boxes.near[axis] ^ kRow), loadWide(b.inverse[axis]),
                            loadWide(b.leave[axis]));
    };
    return lessEqualBits(
        largerBits(largerBits(enter(0), enter(1)), largerBits(enter(2), allWide(0))),
        smallerBits(smallerBits(leave(0), leave(1)), smallerBits(leave(2), loadWide(b.limit))));
}

enum class Query { closest, any, crossings };

/// Do rays leave the bundle when they have found something?
constexpr bool ends(Query query) { return query != Query::closest; }

/// Takes over what 8 rays found in one primitive; returns the rays for which it is better, or that end.
template <Query kQuery, bool kPlanar>
inline unsigned take(Bundle& b, int at, Mask met, F64 t, F64 u, F64 v, std::uint32_t id) {
    const F64 best = load(b.t + at);
    unsigned lanes = bits(both(met, both(t > all(0.0), t <= best)));
    if (!lanes) return 0;
    if (kPlanar && b.excludes) lanes &= ~bitsEqual(b.exclude + at, id);
    if (kQuery == Query::any) return lanes << at;
    unsigned better = bits(t < best) & lanes;
    for (unsigned equal = lanes & ~better; equal; equal &= equal - 1) {
        const int i = __builtin_ctz(equal);
        if (id < b.id[at + i]) better |= 1u << i;
    }
    const Mask m = maskOf(better);
    store(b.t + at, select(m, t, best));
    store(b.u + at, select(m, u, load(b.u + at)));
    store(b.v + at, select(m, v, load(b.v + at)));
    storeWhere(better, b.id + at, id);
    b.found |= better << at;
    return better << at;
}

/// Adds what 8 rays cross at t; returns those that end there.
template <bool kPlanar>
inline unsigned cross(Bundle& b, int at, Mask met, Mask touches, F64 t, std::uint32_t id) {
    unsigned lanes =
        bits(both(met, both(t > all(0.0), t <= load(b.t + at)))) & b.active >> at & 0xFF;
    if (kPlanar && b.excludes) lanes &= ~bitsEqual(b.exclude + at, id);
    if (!lanes) return 0;
    if (b.sink->isOpaque(*b.sink, id)) return lanes << at;
    const unsigned touched = kPlanar ? bits(touches) : 0;
    LaneArray ts;
    store(ts.at, t);
    for (; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        const std::uint32_t ray = b.first + static_cast<unsigned>(at + i);
        touched >> i & 1 ? b.sink->touch(*b.sink, ray, id) : add(*b.sink, ray, ts.at[i], id);
    }
    return 0;
}

/// What 8 rays of a bundle need for a planar test.
struct EightRays {
    F64 ox, oy, oz, shearX, shearY, shearZ;
};

inline EightRays eightOf(const Bundle& b, int at) {
    return {load(b.origin[b.kx] + at), load(b.origin[b.ky] + at), load(b.origin[b.kz] + at),
            load(b.shearX + at),       load(b.shearY + at),       load(b.shearZ + at)};
}

inline Sheared shear(const EightRays& r, double x, double y, double z) {
    const F64 pz = all(z) - r.oz;
    return {(all(x) - r.ox) - r.shearX * pz, (all(y) - r.oy) - r.shearY * pz, pz};
}

/// Sheared f32 corners of a block: [corner][ray].
template <int kCorners> struct alignas(64) FilterCorners {
    float x[kCorners][kRays], y[kCorners][kRays];
};

/// x, y, z: of the corners, as Bundle::filterX, of which the first `count` are needed, in fours where there are
/// more than three; returns what an edge function may be off: see filter.inl.
template <int kCorners>
inline Wide shearForFilter(const Bundle& b, const float* x, const float* y, const float* z,
                           unsigned count, FilterCorners<kCorners>& to) {
    constexpr unsigned kAtOnce = kCorners < 4 ? kCorners : 4;
    const Wide ox = loadWide(b.filterX), oy = loadWide(b.filterY), oz = loadWide(b.filterZ);
    const Wide shearX = loadWide(b.filterShearX), shearY = loadWide(b.filterShearY);
    Wide most = allWide(0);
    for (unsigned first = 0; first < count; first += kAtOnce) {
        Wide larger[kAtOnce];
#pragma GCC unroll 4
        for (unsigned k = 0; k < kAtOnce; ++k) {
            const unsigned i = first + k;
            const Wide pz = allWide(z[i]) - oz;
            const Wide px = minusProduct(allWide(x[i]) - ox, shearX, pz);
            const Wide py = minusProduct(allWide(y[i]) - oy, shearY, pz);
            store(to.x[i], px);
            store(to.y[i], py);
            larger[k] = largerMagnitude(px, py);
        }
        // Not one after the other: each would wait for the one before.
        for (unsigned k = kAtOnce; k > 1; k = (k + 1) / 2)
#pragma GCC unroll 2
            for (unsigned i = 0; i < k / 2; ++i)
                larger[i] = largerMagnitude(larger[i], larger[k - 1 - i]);
        most = largerMagnitude(most, larger[0]);
    }
    return (most + allWide(b.filterError)) * allWide(kEdgeError * b.filterError);
}

/// The rays that one triangle is not ruled out for.
template <int kCorners>
inline unsigned filterTriangle(const FilterCorners<kCorners>& p, unsigned a, unsigned b, unsigned c,
                               Wide bound) {
    const Wide ax = loadWide(p.x[a]), ay = loadWide(p.y[a]), bx = loadWide(p.x[b]),
               by = loadWide(p.y[b]), cx = loadWide(p.x[c]), cy = loadWide(p.y[c]);
    const Wide u = productMinus(cx, by, cy * bx), v = productMinus(ax, cy, ay * cx),
               w = productMinus(bx, ay, by * ax);
    return ~(bitsLess(smaller(smaller(u, v), w), allWide(0) - bound) &
             bitsLess(bound, larger(larger(u, v), w)));
}

/// Corners of a block, brought to where Bundle::filterX is. Products with the scale round nothing.
template <class Float>
inline Wide filterCoordinates(const TreeView& tree, const Bundle& b, int axis, const Float* low,
                              const Float* high) {
    const F64 scale = all(tree.scale), center = all(tree.center[axis] * tree.scale),
              from = all(b.reference[axis]);
    return narrow(productMinus(widened(low), scale, center) - from,
                  productMinus(widened(high), scale, center) - from);
}

/// Pairs of a triangle and 8 rays that the filter leaves, bit per triangle.
struct Candidates {
    unsigned rays[kSharedLanes]; // bit per ray
    unsigned triangles[2];
};

inline void note(Candidates& c, int triangle, unsigned rays) {
    c.rays[triangle] = rays;
    c.triangles[0] |= static_cast<unsigned>((rays & 0xFF) != 0) << triangle;
    c.triangles[1] |= static_cast<unsigned>((rays & 0xFF00) != 0) << triangle;
}

/// One triangle against 8 rays: geometry::intersectTriangle.
template <Query kQuery>
inline unsigned testTriangle(Bundle& b, const EightRays& rays, int at, const Sheared& p,
                             const Sheared& q, const Sheared& r, std::uint32_t id) {
    const Edges e = edgesOf(p, q, r);
    const Mask in = inside(e);
    if (!bits(in)) return 0;
    const Solution s = solve(rays.shearZ, e, p, q, r);
    if (kQuery == Query::crossings)
        return cross<true>(b, at, both(in, s.exists), touching(e), s.t, id);
    return take<kQuery, true>(b, at, both(in, s.exists), s.t, s.b, s.c, id);
}

/// How many of a block's corners its triangles name, or a few more.
template <class Block> inline unsigned cornersOf(const Block& block) {
    const auto row = [&](int i) {
        return _mm_load_si128(reinterpret_cast<const __m128i*>(block.index[i]));
    };
    __m128i most = _mm_max_epu8(_mm_max_epu8(row(0), row(1)), row(2));
    most = _mm_max_epu8(most, _mm_srli_si128(most, 8));
    most = _mm_max_epu8(most, _mm_srli_si128(most, 4));
    most = _mm_max_epu8(most, _mm_srli_si128(most, 2));
    most = _mm_max_epu8(most, _mm_srli_si128(most, 1));
    return 1 + (static_cast<unsigned>(_mm_cvtsi128_si32(most)) & 0xFF);
}

template <Query kQuery, class Block>
[[gnu::noinline]] unsigned bundleInShared(const TreeView& tree, const Block& block, Bundle& b,
                                          unsigned active) {
    alignas(64) float x[kSharedLanes], y[kSharedLanes], z[kSharedLanes];
    const auto *const cx = block.corner[b.kx], *const cy = block.corner[b.ky],
                      *const cz = block.corner[b.kz];
    store(x, filterCoordinates(tree, b, b.kx, cx, cx + kLanes));
    store(y, filterCoordinates(tree, b, b.ky, cy, cy + kLanes));
    store(z, filterCoordinates(tree, b, b.kz, cz, cz + kLanes));
    FilterCorners<kSharedLanes> sheared;
    const Wide bound = shearForFilter(b, x, y, z, cornersOf(block), sheared);
    Candidates c;
    c.triangles[0] = c.triangles[1] = 0;
    for (unsigned lanes = block.valid; lanes; lanes &= lanes - 1) {
        const int i = __builtin_ctz(lanes);
        note(c, i,
             active & filterTriangle(sheared, block.index[0][i], block.index[1][i],
                                     block.index[2][i], bound));
    }
    unsigned result = 0;
    for (int g = 0; g < 2; ++g) {
        const int at = g * kLanes;
        if (!c.triangles[g]) continue;
        const EightRays rays = eightOf(b, at);
        for (unsigned triangles = c.triangles[g]; triangles; triangles &= triangles - 1) {
            const int i = __builtin_ctz(triangles);
            if (ends(kQuery) && !(c.rays[i] & 0xFFu << at & ~result)) continue;
            const int p = block.index[0][i], q = block.index[1][i], r = block.index[2][i];
            result |= testTriangle<kQuery>(b, rays, at, shear(rays, cx[p], cy[p], cz[p]),
                                           shear(rays, cx[q], cy[q], cz[q]),
                                           shear(rays, cx[r], cy[r], cz[r]), block.id[i]);
        }
    }
    return result;
}

template <Query kQuery, class Block>
[[gnu::noinline]] unsigned bundleInTriangles(const TreeView& tree, const Block& block, Bundle& b,
                                             unsigned active) {
    constexpr int kCorners = 3 * kLanes;
    alignas(64) float coordinates[3][kCorners + kLanes];
    const int axes[3] = {b.kx, b.ky, b.kz};
    for (int i = 0; i < 3; ++i) {
        const int axis = axes[i];
        store(coordinates[i],
              filterCoordinates(tree, b, axis, block.corner[0][axis], block.corner[1][axis]));
        store(coordinates[i] + 2 * kLanes,
              filterCoordinates(tree, b, axis, block.corner[2][axis], block.corner[2][axis]));
    }
    const unsigned count = lanesInUse(block.id);
    Candidates c;
    c.triangles[0] = c.triangles[1] = 0;
    for (unsigned i = 0; i < count; ++i) {
        const float x[3] = {coordinates[0][i], coordinates[0][i + kLanes],
                            coordinates[0][i + 2 * kLanes]},
                    y[3] = {coordinates[1][i], coordinates[1][i + kLanes],
                            coordinates[1][i + 2 * kLanes]},
                    z[3] = {coordinates[2][i], coordinates[2][i + kLanes],
                            coordinates[2][i + 2 * kLanes]};
        FilterCorners<3> one;
        const Wide off = shearForFilter(b, x, y, z, 3, one);
        note(c, static_cast<int>(i), active & filterTriangle(one, 0, 1, 2, off));
    }
    unsigned result = 0;
    for (int g = 0; g < 2; ++g) {
        const int at = g * kLanes;
        if (!c.triangles[g]) continue;
        const EightRays rays = eightOf(b, at);
        for (unsigned triangles = c.triangles[g]; triangles; triangles &= triangles - 1) {
            const int i = __builtin_ctz(triangles);
            if (ends(kQuery) && !(c.rays[i] & 0xFFu << at & ~result)) continue;
            const auto corner = [&](int k) {
                return shear(rays, block.corner[k][b.kx][i], block.corner[k][b.ky][i],
                             block.corner[k][b.kz][i]);
            };
            result |=
                testTriangle<kQuery>(b, rays, at, corner(0), corner(1), corner(2), block.id[i]);
        }
    }
    return result;
}

template <Query kQuery>
[[gnu::noinline]] unsigned bundleInParallelograms(const ParallelogramBlock& block, Bundle& b,
                                                  unsigned active) {
    const unsigned count = lanesInUse(block.id);
    unsigned result = 0;
    for (int at = 0; at < kRays; at += kLanes) {
        if (!(active >> at & 0xFF)) continue;
        const EightRays rays = eightOf(b, at);
        for (unsigned i = 0; i < count; ++i) {
            const auto corner = [&](int k) {
                return shear(rays, block.corner[k][b.kx][i], block.corner[k][b.ky][i],
                             block.corner[k][b.kz][i]);
            };
            const Sheared p = corner(0), q = corner(1), r = corner(2), s = corner(3);
            const Edges e1 = edgesOf(p, q, r), e2 = edgesOf(p, r, s);
            const Mask in1 = inside(e1), in2 = inside(e2);
            if (!bits(either(in1, in2))) continue;
            const Solution s1 = solve(rays.shearZ, e1, p, q, r),
                           s2 = solve(rays.shearZ, e2, p, r, s);
            const Mask first = both(in1, s1.exists), second = both(in2, s2.exists);
            const F64 hit = select(first, s1.t, s2.t);
            if (kQuery == Query::crossings)
                result |= cross<true>(b, at, either(first, second),
                                      either(both(in1, touching(e1)), both(in2, touching(e2))), hit,
                                      block.id[i]);
            else
                result |= take<kQuery, true>(b, at, either(first, second), hit,
                                             select(first, s1.b + s1.c, s2.b),
                                             select(first, s1.c, s2.b + s2.c), block.id[i]);
        }
    }
    return result;
}

template <Query kQuery>
[[gnu::noinline]] unsigned bundleInSpheres(const SphereBlock& block, Bundle& b, unsigned active) {
    const unsigned count = lanesInUse(block.id);
    unsigned result = 0;
    for (int at = 0; at < kRays; at += kLanes) {
        if (!(active >> at & 0xFF)) continue;
        const F64 ox = load(b.origin[0] + at), oy = load(b.origin[1] + at),
                  oz = load(b.origin[2] + at);
        const F64 dx = load(b.direction[0] + at), dy = load(b.direction[1] + at),
                  dz = load(b.direction[2] + at);
        const F64 squared = load(b.squared + at), inverseSquared = load(b.inverseSquared + at);
        for (unsigned i = 0; i < count; ++i) {
            const SphereLines s = sphereLines(
                all(block.center[0][i]) - ox, all(block.center[1][i]) - oy,
                all(block.center[2][i]) - oz, dx, dy, dz, inverseSquared, all(block.radius[i]));
            if (!bits(s.met)) continue;
            const F64 root =
                squareRoot(select(s.within, s.b * s.b - squared * s.c, squared * s.discriminant));
            const F64 q = select(s.b < all(0.0), s.b - root, s.b + root);
            const F64 ta = s.c / q, tb = q * inverseSquared;
            const F64 t0 = smaller(ta, tb), t1 = larger(ta, tb);
            if (kQuery == Query::crossings)
                result |= cross<false>(b, at, s.met, s.met, t0, block.id[i]) |
                          cross<false>(b, at, s.met, s.met, t1, block.id[i]);
            else
                result |= take<kQuery, false>(b, at, s.met, select(t0 > all(0.0), t0, t1), all(0.0),
                                              all(0.0), block.id[i]);
        }
    }
    return result;
}

inline Frame frameAt(const Bundle& b, const Ray& ray, int i) {
    Frame f;
    for (int axis = 0; axis < 3; ++axis) {
        f.origin[axis] = (&ray.origin.x)[axis];
        f.direction[axis] = (&ray.direction.x)[axis];
    }
    f.kx = b.kx;
    f.ky = b.ky;
    f.kz = b.kz;
    f.ox = b.origin[b.kx][i];
    f.oy = b.origin[b.ky][i];
    f.oz = b.origin[b.kz][i];
    f.shearX = b.shearX[i];
    f.shearY = b.shearY[i];
    f.shearZ = b.shearZ[i];
    f.squared = b.squared[i];
    f.inverseSquared = b.inverseSquared[i];
    return f;
}

inline BoxLanes lanesAt(const TreeView& tree, const Bundle& b, int i) {
    return {all(b.inverse[0][i]),       all(b.inverse[1][i]),       all(b.inverse[2][i]),
            all(b.enter[0][i]),         all(b.enter[1][i]),         all(b.enter[2][i]),
            all(b.leave[0][i]),         all(b.leave[1][i]),         all(b.leave[2][i]),
            nearRow(tree, b.mirror, 0), nearRow(tree, b.mirror, 1), nearRow(tree, b.mirror, 2)};
}

inline Best bestAt(const Bundle& b, int i) {
    return {b.t[i], b.u[i], b.v[i], b.found >> i & 1 ? b.id + i : nullptr};
}

/// Takes over what a ray found alone; is it better?
inline unsigned take(Bundle& b, int i, const Best& best) {
    if (!best.id || best.id == b.id + i) return 0;
    b.t[i] = best.t;
    b.u[i] = best.u;
    b.v[i] = best.v;
    b.id[i] = *best.id;
    b.found |= 1u << i;
    return 1u << i;
}

/// One ray of the bundle alone below a reference.
template <bool kCount, Query kQuery>
[[gnu::noinline]] unsigned aloneFrom(const TreeView& tree, std::uint32_t reference, const Ray& ray,
                                     const Order& order, Bundle& b, unsigned i, Visits* visits) {
    const Frame f = frameAt(b, ray, i);
    if (kQuery == Query::crossings)
        return static_cast<unsigned>(!crossFrom<kCount>(tree, reference, lanesAt(tree, b, i),
                                                        b.mirror, b.limit[i], f, b.exclude[i],
                                                        b.t[i], {*b.sink, b.first + i}, visits))
               << i;
    if (kQuery == Query::any)
        return static_cast<unsigned>(anyFrom<kCount>(tree, reference, ray, lanesAt(tree, b, i),
                                                     b.mirror, b.limit[i], f, b.exclude[i], b.t[i],
                                                     visits))
               << i;
    Best best = bestAt(b, i);
    closestFrom<kCount>(tree, reference, ray, lanesAt(tree, b, i), order,
                        Limits{b.limitFactor[i], b.limitOffset[i]}, f, b.exclude[i], best, visits);
    return take(b, i, best);
}

template <bool kCount, Query kQuery>
[[gnu::noinline]] unsigned aloneInRecord(const TreeView& tree, const LeafRecord& leaf,
                                         const Ray* rays, Bundle& b, unsigned active,
                                         Visits* visits) {
    unsigned result = 0;
    for (; active; active &= active - 1) {
        const int i = __builtin_ctz(active);
        const Frame f = frameAt(b, rays[i], i);
        if (kQuery == Query::crossings) {
            result |= static_cast<unsigned>(!crossRecord<kCount>(
                          tree, leaf, f, b.exclude[i], b.t[i], {*b.sink, b.first + i}, visits))
                      << i;
            continue;
        }
        if (kQuery == Query::any) {
            result |= static_cast<unsigned>(
                          anyInRecord<kCount>(tree, leaf, rays[i], f, b.exclude[i], b.t[i], visits))
                      << i;
            continue;
        }
        Best best = bestAt(b, i);
        closestInRecord<kCount>(tree, leaf, rays[i], f, b.exclude[i], best, visits);
        result |= take(b, i, best);
    }
    return result;
}

template <bool kCount, Query kQuery>
inline unsigned bundleInLeaf(const TreeView& tree, std::uint32_t reference, const Ray* rays,
                             Bundle& b, unsigned active, Visits* visits) {
    const std::uint32_t index = reference & kLeafIndex;
    switch (reference >> kLeafKindShift & 7) {
    case kSharedLeaf:
        if (kCount) visits->triangles += trianglesOf(tree.shared[index]);
        return bundleInShared<kQuery>(tree, tree.shared[index], b, active);
    case kNarrowSharedLeaf:
        if (kCount) visits->triangles += trianglesOf(tree.narrowShared[index]);
        return bundleInShared<kQuery>(tree, tree.narrowShared[index], b, active);
    case kNarrowTriangleLeaf:
        if (kCount) visits->triangles += lanesInUse(tree.narrowTriangles[index].id);
        return bundleInTriangles<kQuery>(tree, tree.narrowTriangles[index], b, active);
    case kTriangleLeaf:
        if (kCount) visits->triangles += lanesInUse(tree.triangles[index].id);
        return bundleInTriangles<kQuery>(tree, tree.triangles[index], b, active);
    case kSphereLeaf:
        if (kCount) visits->spheres += lanesInUse(tree.spheres[index].id);
        return bundleInSpheres<kQuery>(tree.spheres[index], b, active);
    case kParallelogramLeaf:
        if (kCount) visits->parallelograms += lanesInUse(tree.parallelograms[index].id);
        return bundleInParallelograms<kQuery>(tree.parallelograms[index], b, active);
    default:
        break;
    }
    const LeafRecord& leaf = tree.records[index];
    unsigned result = 0;
    for (std::uint32_t i = 0; i < leaf.triangleBlocks; ++i) {
        const TriangleBlock& block = tree.triangles[leaf.triangles + i];
        if (kCount) visits->triangles += lanesInUse(block.id);
        result |= bundleInTriangles<kQuery>(tree, block, b, active);
    }
    for (std::uint32_t i = 0; i < leaf.sphereBlocks; ++i) {
        const SphereBlock& block = tree.spheres[leaf.spheres + i];
        if (kCount) visits->spheres += lanesInUse(block.id);
        result |= bundleInSpheres<kQuery>(block, b, active);
    }
    for (std::uint32_t i = 0; i < leaf.parallelogramBlocks; ++i) {
        const ParallelogramBlock& block = tree.parallelograms[leaf.parallelograms + i];
        if (kCount) visits->parallelograms += lanesInUse(block.id);
        result |= bundleInParallelograms<kQuery>(block, b, active);
    }
    if (leaf.runCount) {
        const LeafRecord customs{0, 0, 0, 0, 0, 0, leaf.runs, leaf.runCount};
        result |= aloneInRecord<kCount, kQuery>(tree, customs, rays, b,
                                                ends(kQuery) ? active & ~result : active, visits);
    }
    return result;
}

/// Takes rays that end out of the bundle; returns the largest limit of the others.
inline float leave(Bundle& b, unsigned rays) {
    b.found |= rays;
    b.active &= ~rays;
    for (; rays; rays &= rays - 1) b.limit[__builtin_ctz(rays)] = -1;
    return largestOf(loadWide(b.limit));
}

/// Answers in b.t, b.u, b.v, b.id and b.found.
template <bool kCount, Query kQuery, class Bundle>
inline void trace(const TreeView& tree, const Ray* rays, unsigned count, Bundle& b,
                  Visits* visits) {
    const unsigned valid = 0xFFFFu >> (kRays - count);
    if (tree.hasUnbounded) {
        const unsigned result =
            aloneInRecord<kCount, kQuery>(tree, tree.unbounded, rays, b, valid, visits);
        if (ends(kQuery)) {
            b.found |= result;
            b.active &= ~result;
            for (unsigned r = result; r; r &= r - 1) b.cap[__builtin_ctz(r)] = -1;
        }
    }
    if (!tree.nodes || !b.active) return;
    // What any hit ends is looked for from the other end: see anyFrom().
    const Order order = orderOf(kQuery == Query::closest ? b.mirror : b.mirror ^ 7);
    float limit = setLimits(b); // the largest of all rays
    if (kQuery == Query::any)
        for (std::uint32_t& blocker : b.blockers) {
            if (blocker == kNoBlocker) continue;
            const Node& node = tree.nodes[blocker >> 3];
            const unsigned slot = blocker & 7, met = meetChild(node, slot, b) & b.active;
            if (__builtin_popcount(met) <= kFewInLeaf) continue;
            const unsigned stopped =
                bundleInLeaf<kCount, kQuery>(tree, node.child[slot], rays, b, met, visits);
            if (!stopped) blocker = kNoBlocker;
            limit = leave(b, stopped);
            if (!b.active) return;
        }
    std::uint32_t slots[kStackSize]; // 8 · node + slot
    float enters[kStackSize];
    std::size_t top = 0;
    std::uint32_t current = 0;
    bool entersNode = true;
    for (;;) {
        std::uint32_t child; // 8 · node + slot
        unsigned mask = 0;
        F32 enter;
        if (entersNode) {
            if (kCount) ++visits->nodes;
            mask = mayMeet(tree.nodes[current], b.boxes, all(limit), enter);
        }
        if (mask) {
            const unsigned nearest = foretold(kTables.nearest[order.mirror][mask]);
            fetch(tree, tree.nodes[current].child[nearest]);
            pushSlots(order, current << 3, enter, mask & ~(1u << nearest), slots, enters, top);
            child = current << 3 | nearest;
        } else {
            do {
                if (top == 0) return;
                --top;
            } while (enters[top] > limit);
            child = slots[top];
        }
        const Node& node = tree.nodes[child >> 3];
        const unsigned slot = child & 7;
        unsigned met = meetChild(node, slot, b) & b.active;
        const std::uint32_t reference = node.child[slot];
        const int rayCount = __builtin_popcount(met);
        const bool isLeaf = reference & kLeaf;
        entersNode = rayCount > kFewInNode && !isLeaf;
        if (entersNode) {
            current = reference;
            continue;
        }
        unsigned result = 0;
        if (rayCount > kFewInLeaf)
            result = bundleInLeaf<kCount, kQuery>(tree, reference, rays, b, met, visits);
        else
            for (; met; met &= met - 1) {
                const int i = __builtin_ctz(met);
                result |= aloneFrom<kCount, kQuery>(tree, reference, rays[i], order, b, i, visits);
            }
        if (!result) continue;
        if (ends(kQuery)) {
            if (kQuery == Query::any && rayCount > kFewInLeaf) {
                for (int i = kBlockers - 1; i > 0; --i) b.blockers[i] = b.blockers[i - 1];
                b.blockers[0] = child;
            }
            limit = leave(b, result);
            if (!b.active) return;
        } else {
            limit = setLimits(b);
        }
    }
}

// A ray that joins no bundle.
template <bool kCount>
inline void alone(const Bundle&, const TreeView& tree, const Ray& ray, Hit* hit, Visits* visits) {
    closestImpl<kCount>(tree, ray, hit, visits);
}
template <bool kCount>
inline void alone(const Bundle&, const TreeView& tree, const Ray& ray, std::uint8_t* occluded,
                  Visits* visits) {
    *occluded = occludedImpl<kCount>(tree, ray, visits);
}
template <bool kCount>
inline bool alone(const Bundle&, const TreeView& tree, const Ray& ray, const Crosser& to,
                  Visits* visits) {
    return crossingsImpl<kCount>(tree, ray, to, visits);
}

/// Asks for the sixteen rays after the first ones of a batch, to have them when these are done.
inline void fetchNext(const Ray* rays, std::size_t count) {
    if (count < 2 * kRays) return;
    for (int i = 0; i < kRays; ++i)
        _mm_prefetch(reinterpret_cast<const char*>(rays + kRays + i), _MM_HINT_T0);
}

/// Sixteen rays from the next of a batch; those beyond its end repeat the last.
inline const Ray* sixteen(const Ray* rays, unsigned count, unsigned char* padded) {
    if (count == kRays) return rays;
    for (unsigned i = 0; i < kRays; ++i)
        __builtin_memcpy(padded + i * sizeof(Ray), rays + (i < count ? i : count - 1), sizeof(Ray));
    return reinterpret_cast<const Ray*>(padded);
}

template <bool kCount, class Bundle>
inline void closestBundles(const TreeView& tree, const Ray* rays, std::size_t count, Hit* hits,
                           Visits* visits) {
    alignas(64) unsigned char padded[kRays * sizeof(Ray)];
    Bundle b;
    for (std::size_t first = 0; first < count; first += kRays) {
        const auto n = static_cast<unsigned>(count - first < kRays ? count - first : kRays);
        const Ray* const batch = n < kWorthBundle ? rays + first : sixteen(rays + first, n, padded);
        Hit* const to = hits + first;
        fetchNext(rays + first, count - first);
        if (n < kWorthBundle || !setUp(tree, batch, n, b)) {
            for (unsigned i = 0; i < n; ++i) alone<kCount>(b, tree, batch[i], to + i, visits);
            continue;
        }
        trace<kCount, Query::closest>(tree, batch, n, b, visits);
        for (int g = 0; g < 2; ++g) {
            double* const t = b.t + g * kLanes;
            store(t, select(maskOf(b.found >> (g * kLanes) & 0xFF), load(t), all(__builtin_inf())));
        }
        for (unsigned i = 0; i < n; ++i) {
            to[i].t = b.t[i];
            to[i].u = b.u[i];
            to[i].v = b.v[i];
            to[i].id = b.found >> i & 1 ? static_cast<geometry::PrimitiveId>(b.id[i])
                                        : geometry::kNoPrimitive;
        }
    }
}

template <bool kCount, class Bundle>
inline void occludedBundles(const TreeView& tree, const Ray* rays, std::size_t count,
                            std::uint8_t* answers, Visits* visits) {
    alignas(64) unsigned char padded[kRays * sizeof(Ray)];
    Bundle b;
    for (std::uint32_t& blocker : b.blockers) blocker = kNoBlocker;
    for (std::size_t first = 0; first < count; first += kRays) {
        const auto n = static_cast<unsigned>(count - first < kRays ? count - first : kRays);
        const Ray* const batch = n < kWorthBundle ? rays + first : sixteen(rays + first, n, padded);
        std::uint8_t* const to = answers + first;
        fetchNext(rays + first, count - first);
        if (n < kWorthBundle || !setUp(tree, batch, n, b)) {
            for (unsigned i = 0; i < n; ++i) alone<kCount>(b, tree, batch[i], to + i, visits);
            continue;
        }
        for (unsigned i = 0; i < n; ++i) b.t[i] = below(b.t[i]);
        trace<kCount, Query::any>(tree, batch, n, b, visits);
        for (unsigned i = 0; i < n; ++i) to[i] = b.found >> i & 1;
    }
}

template <bool kCount, class Bundle>
inline void crossBundles(const TreeView& tree, const Ray* rays, std::size_t count,
                         CrossingSink& sink, std::uint8_t* ended, Visits* visits) {
    alignas(64) unsigned char padded[kRays * sizeof(Ray)];
    Bundle b;
    b.sink = &sink;
    for (std::size_t first = 0; first < count; first += kRays) {
        const auto n = static_cast<unsigned>(count - first < kRays ? count - first : kRays);
        const Ray* const batch = n < kWorthBundle ? rays + first : sixteen(rays + first, n, padded);
        std::uint8_t* const to = ended + first;
        fetchNext(rays + first, count - first);
        b.first = static_cast<std::uint32_t>(first);
        if (n < kWorthBundle || !setUp(tree, batch, n, b)) {
            for (unsigned i = 0; i < n; ++i)
                to[i] = !alone<kCount>(b, tree, batch[i], Crosser{sink, b.first + i}, visits);
            continue;
        }
        for (unsigned i = 0; i < n; ++i) b.t[i] = below(b.t[i]);
        trace<kCount, Query::crossings>(tree, batch, n, b, visits);
        for (unsigned i = 0; i < n; ++i) to[i] = b.found >> i & 1;
    }
}
