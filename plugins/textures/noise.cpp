// Gradient noise [Perlin 2002, Improving Noise], summed over octaves. Its hash is of integers, so the same bits everywhere.
#include <rt/plugin.hpp>

struct Noise {
    enum class Space { object, world };

    rt::Color a, b;
    rt::Vector3 scale;
    std::int64_t octaves;
    double gain;
    std::int64_t seed;
    Space space;

    rt::Color at(const rt_surface_point& p) const {
        const double* x = space == Space::object ? p.object : p.world;
        double sum = 0, weight = 1, weights = 0, frequency = 1;
        for (std::int64_t i = 0; i < octaves; ++i) {
            sum += weight * lattice({x[0] * scale.x * frequency, x[1] * scale.y * frequency,
                                     x[2] * scale.z * frequency},
                                    i);
            weights += weight;
            weight *= gain;
            frequency *= 2;
        }
        const double share = 0.5 + 0.5 * sum / weights; // lattice() lies in [-1, 1]
        const double t = share > 0 ? share < 1 ? share : 1 : 0;
        return a * (1 - t) + b * t;
    }

private:
    /// Mixes all bits [Steele, Lea, Flood 2014, SplitMix64].
    static std::uint64_t mix(std::uint64_t z) {
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }

    /// Dot product of the offset with one of the twelve edge directions of a cube, drawn for the lattice point.
    double edge(const std::int64_t cell[3], std::int64_t octave, double x, double y,
                double z) const {
        std::uint64_t hash =
            static_cast<std::uint64_t>(seed) * 64 + static_cast<std::uint64_t>(octave);
        for (int i = 0; i < 3; ++i)
            hash = mix(hash + 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(cell[i]));
        const auto pick = static_cast<unsigned>(hash % 12);
        const double u = pick < 8 ? x : y, v = pick < 4 ? y : z;
        return (pick & 1 ? -u : u) + (pick & 2 ? -v : v);
    }

    static double fade(double t) { return t * t * t * (t * (t * 6 - 15) + 10); }

    double lattice(rt::Vector3 p, std::int64_t octave) const {
        // Beyond this the lattice's numbers and their neighbours are no longer all whole and exact.
        constexpr double kReach = 1e15;
        if (!(std::fabs(p.x) < kReach && std::fabs(p.y) < kReach && std::fabs(p.z) < kReach))
            return 0;
        const rt::Vector3 low{std::floor(p.x), std::floor(p.y), std::floor(p.z)}, f = p - low;
        const std::int64_t base[3] = {static_cast<std::int64_t>(low.x),
                                      static_cast<std::int64_t>(low.y),
                                      static_cast<std::int64_t>(low.z)};
        const double weights[3] = {fade(f.x), fade(f.y), fade(f.z)};
        double sum = 0;
        for (int corner = 0; corner < 8; ++corner) {
            const int i = corner & 1, j = corner >> 1 & 1, k = corner >> 2;
            const std::int64_t cell[3] = {base[0] + i, base[1] + j, base[2] + k};
            sum += (i ? weights[0] : 1 - weights[0]) * (j ? weights[1] : 1 - weights[1]) *
                   (k ? weights[2] : 1 - weights[2]) *
                   edge(cell, octave, f.x - i, f.y - j, f.z - k);
        }
        return sum;
    }
};

constexpr std::array kParameters{
    rt::parameter<&Noise::a>("a", "0", "Color where the noise is lowest."),
    rt::parameter<&Noise::b>("b", "1", "Color where the noise is highest."),
    rt::parameter<&Noise::scale>("scale", RT_UNIT_COUNT, "[1, 1, 1]", rt::unlimited,
                                 "Bumps per unit along each axis."),
    rt::parameter<&Noise::octaves>("octaves", RT_UNIT_COUNT, "4", rt::range(1, 32),
                                   "Layers, each of half the size."),
    rt::parameter<&Noise::gain>("gain", RT_UNIT_RATIO, "0.5", rt::range(0, 1),
                                "Strength of a layer by that of the one before."),
    rt::parameter<&Noise::seed>("seed", RT_UNIT_NONE, "0", rt::range(0, 1e9),
                                "Another number, another pattern."),
    rt::choice<&Noise::space>("space", "object|world", "object",
                              "The space in which the pattern rests.")};

Noise create(const Noise& noise, rt::Host&) { return noise; }

RT_TEXTURE_PLUGIN("noise", "1.0.0", kParameters, create, "Cloudy noise between two colors.",
                  "marble: {noise: {a: [0.2, 0.2, 0.25], b: 0.9, scale: [3, 3, 3], octaves: 6}}\n")
