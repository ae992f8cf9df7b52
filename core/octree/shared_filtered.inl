// Shared blocks without a cheap way to put 8 pairs of f64 corners side by side: f32 edge functions rule out
// most triangles, and what they leave is tested one by one.

/// Edge functions of one triangle.
struct OneEdges {
    double u, v, w;
    bool areInside;
};

struct alignas(64) SharedArray {
    double x[kSharedLanes], y[kSharedLanes], z[kSharedLanes];
};

/// Triangles of a shared block that the ray's line may meet, and what edgesAt() needs of them.
template <class Block>
[[gnu::always_inline]] inline unsigned candidates(const Block& block, const SharedCorners& c,
                                                  double scale, SharedArray& to) {
    const unsigned lanes = ruledIn(block, c, scale);
    if (!lanes) return 0;
    store(to.x, c.x0);
    store(to.x + kLanes, c.x1);
    store(to.y, c.y0);
    store(to.y + kLanes, c.y1);
    store(to.z, c.z0);
    store(to.z + kLanes, c.z1);
    return lanes;
}

template <class Block>
[[gnu::always_inline]] inline OneEdges edgesAt(const SharedArray& p, const Block& block, int lane) {
    const int a = block.index[0][lane], b = block.index[1][lane], c = block.index[2][lane];
    OneEdges e;
    e.u = p.x[c] * p.y[b] - p.y[c] * p.x[b];
    e.v = p.x[a] * p.y[c] - p.y[a] * p.x[c];
    e.w = p.x[b] * p.y[a] - p.y[b] * p.x[a];
    e.areInside = (e.u >= 0 && e.v >= 0 && e.w >= 0) || (e.u <= 0 && e.v <= 0 && e.w <= 0);
    return e;
}
