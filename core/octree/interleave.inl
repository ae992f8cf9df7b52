// Rays without order in a tree that the caches cannot hold: several walk in turns. Where the next node
// or leaf of one is likely to be far away, it is asked for and another ray goes on meanwhile.

// octree_bench, ico, random rays; the prototype had 4: 2.0, 8: 2.4, 12: 2.45 times a single ray's speed.
constexpr int kWalks = 8;

/// A ray on its way.
struct alignas(64) Walk {
    BoxLanes lanes;
    Order order;
    Frame frame;
    Best best;
    double last; // of an occlusion query
    bool hasEnded, any;
    Limits limits;
    float limit;
    std::uint32_t exclude, current;
    std::size_t top, ray; // ray: index in the batch; count: none
    std::uint32_t references[kStackSize];
    float enters[kStackSize];
};

/// Asks for what `reference` is of, unless it is one of the first nodes, which are in use all the time.
inline bool fetch(const TreeView& tree, std::uint32_t reference) {
    if (reference < tree.hotNodes) return false;
    const TreeView::Place& place = tree.places[reference >> kLeafKindShift];
    const char* const from =
        static_cast<const char*>(place.first) + (reference & kLeafIndex) * place.size;
    for (std::size_t at = 0; at < place.size; at += 64) _mm_prefetch(from + at, _MM_HINT_T0);
    return true;
}

inline void conclude(const Best& best, bool, Hit* hit) { answer(best, hit); }
inline void conclude(const Best&, bool any, std::uint8_t* occluded) { *occluded = any; }

/// Lets the next ray that meets the cube start; false if there is none.
template <bool kCount, class Answer>
inline bool start(const TreeView& tree, const Ray* rays, std::size_t count, std::size_t& next,
                  Answer* answers, Walk& w, Visits* visits) {
    constexpr bool kAny = sizeof(Answer) == 1;
    for (; next < count; ++next) {
        const Ray& ray = rays[next];
        const BoxRay box = boxRayOf(tree, ray);
        w.frame = frameOf(tree, ray);
        w.exclude = static_cast<std::uint32_t>(ray.exclude);
        w.best = {ray.tMax, 0, 0, nullptr};
        w.last = below(ray.tMax);
        bool any = false;
        if (tree.hasUnbounded) {
            if (kAny)
                any = anyInRecord<kCount>(tree, tree.unbounded, ray, w.frame, w.exclude, w.last,
                                          visits);
            else
                closestInRecord<kCount>(tree, tree.unbounded, ray, w.frame, w.exclude, w.best,
                                        visits);
        }
        if (any || !tree.nodes || box.misses) {
            conclude(w.best, any, answers + next);
            continue;
        }
        w.lanes = lanesOf(tree, box);
        w.order = orderOf(box.mirror);
        w.limits = box.limits;
        w.limit = limitOf(box.limits, w.best.t);
        w.current = 0;
        w.top = 0;
        w.ray = next++;
        w.hasEnded = false;
        return true;
    }
    w.ray = count;
    return false;
}

/// Goes on until something far is next; false at the end of the walk.
template <bool kCount, bool kAny>
inline bool walk(const TreeView& tree, const Ray& ray, Walk& w, Visits* visits) {
    const BoxLanes lanes = w.lanes;
    const Order order = w.order;
    std::uint32_t current = w.current;
    std::size_t top = w.top;
    float limit = w.limit;
    w.any = false;
    for (;;) {
        unsigned mask = 0;
        if (!(current & kLeaf)) {
            const Node& node = tree.nodes[current];
            if (kCount) ++visits->nodes;
            F32 enter;
            mask = meets(current, lanes, all(limit), enter);
            if (mask)
                current = kAny ? pushAny(order.mirror, node, mask, w.references, top)
                               : pushFar(order, node, enter, mask, w.references, w.enters, top);
        } else if (kAny) {
            w.any = anyInLeaf<kCount>(tree, current, ray, w.frame, w.exclude, w.last, visits);
            if (w.any) return false;
        } else if (closestInLeaf<kCount>(tree, current, ray, w.frame, w.exclude, w.best, visits)) {
            limit = w.limit = limitOf(w.limits, w.best.t);
        }
        if (!mask) {
            do {
                if (top == 0) return false;
                --top;
            } while (!kAny && w.enters[top] > limit);
            current = w.references[top];
        }
        if (fetch(tree, current)) {
            w.current = current;
            w.top = top;
            return true;
        }
    }
}

template <bool kCount, class Answer>
inline void inTurns(const TreeView& tree, const Ray* rays, std::size_t count, Answer* answers,
                    Visits* visits) {
    Walk walks[kWalks];
    std::size_t next = 0;
    int under = 0; // way
    for (Walk& w : walks) under += start<kCount>(tree, rays, count, next, answers, w, visits);
    while (under)
        for (Walk& w : walks) {
            if (w.ray == count) continue;
            if (!w.hasEnded) {
                w.hasEnded = !walk<kCount, sizeof(Answer) == 1>(tree, rays[w.ray], w, visits);
                continue; // the id of the hit may be on its way
            }
            conclude(w.best, w.any, answers + w.ray);
            under -= !start<kCount>(tree, rays, count, next, answers, w, visits);
        }
}
