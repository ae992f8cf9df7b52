// The queries for baseline; see kernel.hpp.
#include <core/octree/kernel.hpp>
#include <core/octree/octree.hpp>
#include <core/octree/tables.hpp>

#include <immintrin.h>

namespace rt::octree::baseline {
namespace {
#include "filter.inl"

#include "four.inl"

#include "lanes_baseline.inl"

#include "shared_filtered.inl"

#include "kernel.inl"

#include "bundle.inl"

#include "interleave.inl"

#include "queries.inl"

#include "f32.inl"
} // namespace

const Kernel kernel = {"baseline", closest, occluded, crossings, closestBatch, occludedBatch, scan};
const Kernel kernelF32 = {"baseline",        f32::closest,       f32::occluded, f32::crossings,
                          f32::closestBatch, f32::occludedBatch, nullptr};

} // namespace rt::octree::baseline
