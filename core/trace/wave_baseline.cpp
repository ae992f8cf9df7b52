// The shading for baseline; see wave.hpp.
#include <core/numeric/rounding.hpp>
#include <core/trace/wave.hpp>

#include <immintrin.h>

namespace rt::trace::baseline {
namespace {
#include "wave.inl"
} // namespace

const WaveKernel waveKernel = {face, aim, add, refract, mirror};

} // namespace rt::trace::baseline
