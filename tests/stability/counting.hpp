// Many random trials over threads, with the same result for any number of them.
#pragma once
#include <tests/octree/scenes.hpp>

#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace rt::stability {

using test::Random;

/// Sum of `body(random, sum)` over `trials`; Sum is default-constructed, and += joins two.
/// Each batch of trials has random numbers of its own.
template <class Sum, class Body>
Sum sumOver(std::uint64_t trials, std::uint64_t seed, const Body& body) {
    constexpr std::uint64_t kBatch = 4096;
    const std::uint64_t batches = (trials + kBatch - 1) / kBatch;
    constexpr std::uint64_t kRound = 1 << 14; // batches whose sums are kept at a time
    Sum all{};
    for (std::uint64_t from = 0; from < batches; from += kRound) {
        std::vector<Sum> sums(std::min(kRound, batches - from));
        parallel::forEach(sums.size(), 0, [&](std::size_t i) {
            const std::uint64_t batch = from + i;
            Random random(seed * 0x9E3779B97F4A7C15u + batch * 0xD1B54A32D192ED03u);
            const std::uint64_t end = std::min(trials, (batch + 1) * kBatch);
            for (std::uint64_t trial = batch * kBatch; trial < end; ++trial) body(random, sums[i]);
        });
        for (const Sum& s : sums) all += s;
    }
    return all;
}

/// What a case counts and measures.
struct Tally {
    std::uint64_t of = 0, wrong = 0;
    double worst = 0;

    void add(bool isWrong) { ++of, wrong += isWrong; }
    void error(double e) { ++of, worst = e <= worst ? worst : e; } // a NaN stays
    Tally& operator+=(const Tally& o) {
        of += o.of, wrong += o.wrong;
        worst = o.worst <= worst ? worst : o.worst;
        return *this;
    }
};

template <class Body> Tally tally(std::uint64_t trials, std::uint64_t seed, const Body& body) {
    return sumOver<Tally>(trials, seed, body);
}

} // namespace rt::stability
