#include <core/trace/wave.hpp>

#include <core/octree/octree.hpp>

namespace rt::trace {

const WaveKernel& waveKernel() {
    const std::string_view level = octree::Octree::simdLevel();
    return level == "avx512" ? avx512::waveKernel
           : level == "avx2" ? avx2::waveKernel
                             : baseline::waveKernel;
}

} // namespace rt::trace
