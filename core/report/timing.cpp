#include <core/report/timing.hpp>

#include <algorithm>
#include <cmath>
#include <random>

#include <time.h>

namespace rt::report {

namespace {

double medianOf(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    if (values.size() % 2) return *middle;
    return (*middle + *std::max_element(values.begin(), middle)) / 2;
}

} // namespace

Spread spreadOf(std::vector<double> values) {
    Spread spread;
    spread.min = *std::min_element(values.begin(), values.end());
    spread.median = medianOf(values);
    for (double& v : values) v = std::fabs(v - spread.median);
    spread.mad = medianOf(values);
    return spread;
}

Interval ratioOf(const std::vector<double>& a, const std::vector<double>& b) {
    constexpr std::size_t kResamples = 2000, kTail = kResamples / 40;
    std::mt19937 random(1);
    std::uniform_int_distribution<std::size_t> pick(0, a.size() - 1);
    std::vector<double> ratios(kResamples), x(a.size()), y(a.size());
    for (double& ratio : ratios) {
        for (std::size_t i = 0; i < a.size(); ++i) {
            const std::size_t round = pick(random);
            x[i] = a[round], y[i] = b[round];
        }
        ratio = medianOf(x) / medianOf(y);
    }
    std::sort(ratios.begin(), ratios.end());
    return {ratios[kTail], ratios[kResamples - 1 - kTail]};
}

double cpuSeconds() {
    timespec now{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + static_cast<double>(now.tv_nsec) / 1'000'000'000;
}

} // namespace rt::report
