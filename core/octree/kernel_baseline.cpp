// The queries for baseline; see kernel.hpp.
#include <core/octree/kernel.hpp>
#include <core/octree/octree.hpp>
#include <core/octree/tables.hpp>

#include <immintrin.h>

namespace rt::octree::baseline {
namespace {
#include "filter.inl"

#include "lanes_baseline.inl"

#include "kernel.inl"
} // namespace

const Kernel kernel = {"baseline", closest, occluded, crossings, scan};

} // namespace rt::octree::baseline
