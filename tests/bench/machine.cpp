#include "machine.hpp"

#include "clock.hpp"

#include <immintrin.h>

#include <cstdint>
#include <vector>

namespace rt::bench {
namespace {

/// Bytes per second, the best of several passes.
double readRate(std::size_t bytes, int passes) {
    const std::vector<float> data(bytes / sizeof(float), 1);
    double best = 0;
    for (int i = 0; i < passes; ++i) {
        __m128 sums[8] = {};
        const double seconds = cpuSecondsOf([&] {
            for (std::size_t k = 0; k + 32 <= data.size(); k += 32)
                for (std::size_t lane = 0; lane < 8; ++lane)
                    sums[lane] = _mm_or_ps(sums[lane], _mm_loadu_ps(&data[k + 4 * lane]));
            asm volatile("" : : "r"(sums) : "memory");
        });
        best = std::max(best, static_cast<double>(bytes) / seconds);
    }
    return best;
}

} // namespace

Machine measureMachine() {
    Machine machine{};
    machine.l2Bandwidth = readRate(512u << 10, 2000);
    machine.memoryBandwidth = readRate(256u << 20, 5);
    return machine;
}

} // namespace rt::bench
