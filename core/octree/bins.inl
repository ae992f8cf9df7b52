// Included by what defines Boxes and Ends: see bins_baseline.cpp. Code compiled for AVX2 may share no inline function with
// the rest, as in kernel.hpp.

namespace {

constexpr std::ptrdiff_t kWorthTwo = 512; // references

struct Sets {
    Boxes boxes[3][kMostBins];
    std::uint32_t count[3][kMostBins];
};

template <int kAxes>
void fill(const Reference* first, const Reference* last, const Scale& scale, const int* axis,
          int count, Bins& bins) {
    // Neighbours often share a bin, and each would wait for the one before it: so every other one has bins of
    // its own (octree_bench: builds take 7 to 16 % less on a Zen5).
    Sets sets[2];
    const int used = last - first >= kWorthTwo ? 2 : 1;
    for (int s = 0; s < used; ++s)
        for (int a = 0; a < kAxes; ++a)
            for (int i = 0; i < count; ++i) {
                sets[s].boxes[a][i].clear();
                sets[s].count[a][i] = 0;
            }
    const __m128 lower = _mm_load_ps(scale.lower), factor = _mm_load_ps(scale.factor);
    const auto add = [&](const Reference& r, Sets& to) {
        const Ends ends(r);
        alignas(16) std::int32_t place[4];
        _mm_store_si128(reinterpret_cast<__m128i*>(place),
                        _mm_cvttps_epi32(_mm_mul_ps(_mm_sub_ps(ends.twiceCenter, lower), factor)));
        for (int a = 0; a < kAxes; ++a) {
            const std::int32_t at = place[axis[a]];
            to.boxes[a][at].add(ends);
            ++to.count[a][at];
        }
    };
    if (used == 2)
        for (; last - first >= 2; first += 2) {
            add(first[0], sets[0]);
            add(first[1], sets[1]);
        }
    for (; first != last; ++first) add(*first, sets[0]);
    for (int a = 0; a < kAxes; ++a)
        for (int i = 0; i < count; ++i) {
            Boxes box = sets[0].boxes[a][i];
            std::uint32_t n = sets[0].count[a][i];
            if (used == 2) {
                box.add(sets[1].boxes[a][i]);
                n += sets[1].count[a][i];
            }
            Bin& bin = bins.of[axis[a]][i];
            box.store(bin);
            bin.count = n;
        }
}

} // namespace

void fillBins(const Reference* first, const Reference* last, const Scale& scale, unsigned axes,
              int count, Bins& bins) {
    int axis[3], n = 0;
    for (int a = 0; a < 3; ++a)
        if (axes >> a & 1) axis[n++] = a;
    switch (n) {
    case 1:
        return fill<1>(first, last, scale, axis, count, bins);
    case 2:
        return fill<2>(first, last, scale, axis, count, bins);
    default:
        return fill<3>(first, last, scale, axis, count, bins);
    }
}
