// What many rays met, as structure-of-arrays, and the shading that runs on several of them at once:
// wave.inl, compiled three times, with the flags of each SIMD level. Same bits from each.
#pragma once
#include <cstddef>
#include <cstdint>

namespace rt::trace {

inline constexpr std::size_t kWave = 256; // encounters, at most
/// Room of a column: not a power of two, or all columns would share few sets of the caches.
inline constexpr std::size_t kColumn = kWave + 24;

/// By number of the encounter.
struct Column {
    alignas(64) double at[kColumn];
};
struct Columns {
    Column x, y, z;
};
struct MaskColumn {
    alignas(64) std::int64_t at[kColumn]; // 0 or -1
};

/// Names are those of whitted.hpp.
struct Wave {
    // Set by whoever adds an encounter. Spheres' surfaces come from `face`: until then `geometric` is the
    // point that was hit, from the centre, and position, normal and error are nothing.
    Columns direction, geometric, normal, position;
    Column error;       // `face` adds that of a second surface, which may coincide with this one
    Column errorBeside; // at most, of that; of spheres their own
    MaskColumn isSphere;
    Columns center;
    Column radius;
    MaskColumn leaving; // set by `face`
    // The material, color included where the law has it.
    Columns diffuse, environment;                  // diffuse: color * diffuse
    Columns color, specular, transmission, weight; // of those that send rays off
    Columns light;                                 // sum over the lights so far
    // Toward one light.
    Column cosine;  // to the normal; 0: from behind; -1: the light lies on the point
    Column halfway; // cosine of the halfway vector to the normal
    Columns shadowOrigin, shadowDirection;
    Columns visible; // of the light; 0 where it does not matter
    Column power;    // of the highlight, 0 where there is none
    Columns added;   // to `light`
    // What leaves.
    Columns mirroredOrigin, mirrored, mirroredWeight;
    Column ratio; // index in front over index behind; 1: nothing is bent
    Column refractedError;
    Columns refractedOrigin, refracted, refractedWeight;
    MaskColumn passes; // else total reflection
};

/// Plain data only crosses between levels, as in octree/kernel.hpp. Each works on the first `count`
/// encounters and may write garbage behind them, up to the next multiple of eight.
struct WaveKernel {
    void (*face)(Wave&, std::size_t count); // surfaces of spheres; turns normals toward the rays
    void (*aim)(Wave&, std::size_t count, const double light[3]);
    void (*add)(Wave&, std::size_t count);
    void (*refract)(Wave&, std::size_t count);
    void (*mirror)(Wave&, std::size_t count, bool transmits); // if so, after `refract`
};

namespace avx512 {
extern const WaveKernel waveKernel;
}
namespace avx2 {
extern const WaveKernel waveKernel;
}
namespace baseline {
extern const WaveKernel waveKernel;
}

/// That of octree::Octree::simdLevel().
const WaveKernel& waveKernel();

} // namespace rt::trace
