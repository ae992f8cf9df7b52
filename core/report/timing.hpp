// Times of repeated runs on a machine that others use, too: medians, their spread, and when a difference means anything.
#pragma once
#include <vector>

namespace rt::report {

struct Spread {
    double median = 0, mad = 0, min = 0; // mad: median absolute deviation
};
/// Of at least one value.
Spread spreadOf(std::vector<double> values);

struct Interval {
    double low = 1, high = 1;

    bool holds(double value) const { return low <= value && value <= high; }
};
/// 95 % of median(a) / median(b), by resampling the rounds in which both were run [Efron 1979]. Same size, at least one.
Interval ratioOf(const std::vector<double>& a, const std::vector<double>& b);

/// More than this share of deviation from the median, and a run is called noisy.
inline constexpr double kNoisy = 0.05;

/// Processor time of this process, all threads, seconds.
double cpuSeconds();

} // namespace rt::report
