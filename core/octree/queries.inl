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

bool crossings(const TreeView& tree, const Ray& ray, const CrossingSink& sink, Visits* visits) {
    return visits ? crossingsImpl<true>(tree, ray, sink, visits)
                  : crossingsImpl<false>(tree, ray, sink, nullptr);
}

void scan(const TreeView& tree, const BlockCounts& counts, const Ray& ray, Hit* hit) {
    alignas(32) double inverses[4];
    const Normalized n = normalized(ray);
    boxRayOf(tree, ray, n, inverses);
    const Frame f = frameOf(tree, ray, n, inverses);
    const auto exclude = static_cast<std::uint32_t>(ray.exclude);
    Best best{ray.tMax, 0, 0, 0, false};
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

void closestBatch(const TreeView& tree, const Ray* rays, std::size_t count, bool coherent,
                  Hit* hits, Visits* visits) {
    if (!coherent)
        for (std::size_t i = 0; i < count; ++i) closest(tree, rays[i], hits + i, visits);
    else if (visits)
        closestBundles<true>(tree, rays, count, hits, visits);
    else
        closestBundles<false>(tree, rays, count, hits, nullptr);
}

void occludedBatch(const TreeView& tree, const Ray* rays, std::size_t count, bool coherent,
                   std::uint8_t* answers, Visits* visits) {
    if (!coherent)
        for (std::size_t i = 0; i < count; ++i) answers[i] = occluded(tree, rays[i], visits);
    else if (visits)
        occludedBundles<true>(tree, rays, count, answers, visits);
    else
        occludedBundles<false>(tree, rays, count, answers, nullptr);
}
