// Prints one FNV-1a checksum over the bits of every elementary function on a fixed sweep.
#include <core/numeric/elementary.hpp>

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <initializer_list>

using namespace rt;

int main() {
    std::uint64_t hash = 0xcbf29ce484222325, state = 1;
    const auto add = [&](double value) {
        hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3;
    };
    const auto draw = [&] { // splitmix64
        std::uint64_t z = state += 0x9e3779b97f4a7c15;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
        z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
        return z ^ (z >> 31);
    };
    for (int i = 0; i < 200000; ++i) {
        const double unit = static_cast<double>(draw() >> 11) / 0x1p53, signedUnit = 2 * unit - 1;
        const double any = std::bit_cast<double>(draw());
        for (const double x : {signedUnit, 700 * signedUnit, 1e6 * signedUnit, any}) {
            add(numeric::exp(x)), add(numeric::log(std::fabs(x)));
            add(numeric::sin(x)), add(numeric::cos(x)), add(numeric::tan(x));
            add(numeric::asin(x)), add(numeric::acos(x));
            add(numeric::atan2(x, unit)), add(numeric::pow(unit, x));
        }
    }
    std::printf("%016llx\n", static_cast<unsigned long long>(hash));
}
