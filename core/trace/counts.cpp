#include <core/trace/counts.hpp>

#include <algorithm>

namespace rt::trace {

RayCounts& RayCounts::operator+=(const RayCounts& o) {
    primary += o.primary, reflected += o.reflected, refracted += o.refracted, shadow += o.shadow;
    cutByDepth += o.cutByDepth, cutByContribution += o.cutByContribution, notFinite += o.notFinite;
    lostByDepth += o.lostByDepth;
    deepest = std::max(deepest, o.deepest);
    for (std::size_t kind = 0; kind < hits.size(); ++kind) hits[kind] += o.hits[kind];
    blocked += o.blocked;
    visits.nodes += o.visits.nodes;
    visits.triangles += o.visits.triangles, visits.spheres += o.visits.spheres;
    visits.parallelograms += o.visits.parallelograms, visits.customs += o.visits.customs;
    return *this;
}

} // namespace rt::trace
