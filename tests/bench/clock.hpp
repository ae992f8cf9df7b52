// Time and medians of the benchmarks.
#pragma once
#include <algorithm>
#include <cstddef>
#include <ctime>
#include <vector>

namespace rt::bench {

/// CPU time of this thread: what others on the machine do does not count.
inline double cpuSeconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) / 1e9;
}

template <class Call> double cpuSecondsOf(const Call& call) {
    const double start = cpuSeconds();
    call();
    return cpuSeconds() - start;
}

inline double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

} // namespace rt::bench
