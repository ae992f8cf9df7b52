// The queries for avx512; see kernel.hpp.
#include <core/octree/kernel.hpp>
#include <core/octree/octree.hpp>
#include <core/octree/tables.hpp>

#include <immintrin.h>

namespace rt::octree::avx512 {
namespace {
#include "filter.inl"

#include "lanes_avx512.inl"

#include "kernel.inl"
} // namespace

const Kernel kernel = {"avx512", closest, occluded, crossings, scan};

} // namespace rt::octree::avx512
