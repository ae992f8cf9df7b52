// The shading for avx512; see wave.hpp.
#include <core/numeric/elementary.hpp>
#include <core/numeric/elementary_tables.hpp>
#include <core/numeric/rounding.hpp>
#include <core/trace/wave.hpp>

#include <immintrin.h>

namespace rt::trace::avx512 {
namespace {
#include "lanes.inl"
#include "power.inl"
#include "wave.inl"
} // namespace

const WaveKernel waveKernel = {through, gather, face, aim, add, bend, leave};

} // namespace rt::trace::avx512
