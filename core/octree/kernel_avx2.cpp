// The queries for avx2; see kernel.hpp.
#include <core/octree/kernel.hpp>
#include <core/octree/octree.hpp>
#include <core/octree/tables.hpp>

#include <immintrin.h>

namespace rt::octree::avx2 {
namespace {
#include "filter.inl"

#include "four.inl"

#include "lanes_avx2.inl"

#include "shared_filtered.inl"

#include "kernel.inl"

#include "bundle.inl"

#include "interleave.inl"

#include "queries.inl"

#include "f32.inl"
} // namespace

const Kernel kernel = {"avx2", closest, occluded, crossings, closestBatch, occludedBatch, scan};
const Kernel kernelF32 = {"avx2",         f32::closest,      f32::occluded,
                          f32::crossings, f32::closestBatch, f32::occludedBatch,
                          nullptr};

} // namespace rt::octree::avx2
