// What one SIMD level offers: see kernel.hpp.

void closest(const TreeView& tree, const Ray& ray, Hit* hit, Visits* visits) {
    if (visits)
        closestImpl<true>(tree, ray, hit, visits);
    else
        closestImpl<false>(tree, ray, hit, nullptr);
}

bool occluded(const TreeView& tree, const Ray& ray, Visits* visits) {
    return visits ? occludedImpl<true>(tree, ray, visits) : occludedImpl<false>(tree, ray, nullptr);
}

void crossings(const TreeView& tree, const Ray* rays, std::size_t count, CrossingSink& sink,
               std::uint8_t* ended, Visits* visits) {
    visits ? crossBundles<true, Bundle>(tree, rays, count, sink, ended, visits)
           : crossBundles<false, Bundle>(tree, rays, count, sink, ended, nullptr);
}

void scan(const TreeView& tree, const BlockCounts& counts, const Ray& ray, Hit* hit) {
    const Frame f = frameOf(tree, ray);
    const auto exclude = static_cast<std::uint32_t>(ray.exclude);
    Best best{ray.tMax, 0, 0, nullptr};
    for (std::uint32_t i = 0; i < counts.shared; ++i)
        closestInShared(tree, tree.shared[i], f, exclude, best);
    for (std::uint32_t i = 0; i < counts.narrowShared; ++i)
        closestInShared(tree, tree.narrowShared[i], f, exclude, best);
    for (std::uint32_t i = 0; i < counts.narrowTriangles; ++i)
        closestInTriangles(tree.narrowTriangles[i], f, exclude, best);
    const LeafRecord everything{0, counts.triangles,      0, counts.spheres,
                                0, counts.parallelograms, 0, counts.runs};
    closestInRecord<false>(tree, everything, ray, f, exclude, best, nullptr);
    answer(best, hit);
}

template <bool kCount, class Bundle, class Walk>
inline void closestOfAll(const TreeView& tree, const Ray* rays, std::size_t count, bool coherent,
                         Hit* hits, Visits* visits) {
    coherent ? closestBundles<kCount, Bundle>(tree, rays, count, hits, visits)
             : inTurns<kCount, Walk>(tree, rays, count, hits, visits);
}

template <bool kCount, class Bundle, class Walk>
inline void occludedOfAll(const TreeView& tree, const Ray* rays, std::size_t count, bool coherent,
                          std::uint8_t* answers, Visits* visits) {
    coherent ? occludedBundles<kCount, Bundle>(tree, rays, count, answers, visits)
             : inTurns<kCount, Walk>(tree, rays, count, answers, visits);
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
