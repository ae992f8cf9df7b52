#include <core/octree/bins.hpp>

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

namespace rt::octree {
namespace {

TEST(Bins, AreTheSameWithBothEndsInOneRegister) {
    if (!Octree::supports(Simd::avx2)) GTEST_SKIP() << "this CPU has no AVX2";
    std::mt19937 bits(1);
    std::uniform_real_distribution<float> anywhere(-1, 1), size(0, 0.1f);
    for (const std::size_t count : {1u, 17u, 511u, 512u, 513u, 5000u}) {
        std::vector<Reference> references(count);
        for (Reference& r : references) {
            for (int a = 0; a < 3; ++a) {
                r.lower[a] = anywhere(bits);
                r.upper[a] = r.lower[a] + size(bits);
            }
            r.id = static_cast<std::uint32_t>(bits());
            r.kind = 0x7FC00000; // as f32: NaN
        }
        Scale scale{{-2, -2, -2, 0}, {7, 7, 7, 0}, 7};
        for (unsigned axes = 1; axes < 8; ++axes) {
            Bins one, two;
            const Reference *const first = references.data(), *const last = first + count;
            constexpr int kBins = 32;
            baseline::fillBins(first, last, scale, axes, kBins, one);
            avx2::fillBins(first, last, scale, axes, kBins, two);
            for (int a = 0; a < 3; ++a) {
                if (!(axes >> a & 1)) continue;
                std::size_t sum = 0;
                for (int i = 0; i < kBins; ++i) {
                    const Bin &b = one.of[a][i], &c = two.of[a][i];
                    EXPECT_EQ(std::memcmp(&b.lower, &c.lower, 3 * sizeof(float)), 0);
                    EXPECT_EQ(std::memcmp(&b.upper, &c.upper, 3 * sizeof(float)), 0);
                    EXPECT_EQ(b.count, c.count);
                    sum += b.count;
                }
                EXPECT_EQ(sum, count);
            }
        }
    }
}

} // namespace
} // namespace rt::octree
