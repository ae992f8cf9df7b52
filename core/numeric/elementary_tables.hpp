// The tables of elementary.cpp, for code that evaluates several arguments at once. Plain data only.
#pragma once
#include <cstdint>

namespace rt::numeric {

inline constexpr int kExpSteps = 128;

struct ExpTable {
    double stepHi, stepLo; // ln 2 / kExpSteps; hi has 34 bits
    struct Step {
        double hi, lo; // 2^(j / kExpSteps), unevaluated sum
    } at[kExpSteps];
};
extern const ExpTable kExp;

inline constexpr std::uint64_t kLogStart =
    0x3fe6000000000000; // 0.6875: 128 steps to 1.375, 1.0 begins step 80

struct LogTable {
    double ln2Hi, ln2Lo; // hi is a multiple of 2^-41
    struct Step {
        double inverse; // about 1 / m for the m of this step, at most 10 bits
        double hi, lo;  // -log(inverse); hi is a multiple of 2^-41, so that k ln2Hi + hi is exact
    } at[128];
};
extern const LogTable kLog;

} // namespace rt::numeric
