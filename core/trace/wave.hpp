// What many rays met, as structure-of-arrays, and the shading that runs on several of them at once:
// wave.inl, compiled three times, with the flags of each SIMD level. Same bits from each.
#pragma once
#include <core/geometry/primitives.hpp>
#include <core/geometry/ray.hpp>
#include <core/material/material.hpp>
#include <core/trace/pinhole.hpp>
#include <core/trace/work.hpp>

#include <cstddef>
#include <cstdint>

namespace rt::trace {

/// Encounters, at most. More fill the octree's bundles better: glass.yaml of tests/bench/versus takes 1.09 times as long with
/// 512, 1.04 times with 1024; pictures of mirrors and meshes take the same within 1 %.
inline constexpr std::size_t kWave = 2048;
inline constexpr std::size_t kMostLanes = 8;
/// Room of a column: not a power of two, or all columns would share few sets of the caches.
inline constexpr std::size_t kColumn = kWave + 24;

struct Column {
    alignas(64) double at[kColumn];
};
struct Columns {
    Column x, y, z;
};
/// What an encounter sends off, by bit.
struct Sends {
    static constexpr long long kMirrors = 1, // its material reflects
        kReflects = 2, // it does, if only since it reflects all of what it would let through
        kRefracts = 4, kReflectedBlack = 8, // of no share of the picture
        kRefractedBlack = 16;
};
struct IntegerColumn {
    alignas(64) std::int64_t at[kColumn]; // 0 or -1, or a number
};

/// Rays that leave.
struct Leaving {
    alignas(64) geometry::Ray ray[kColumn];
    IntegerColumn group; // of ByDirection
};

/// By number of the encounter. Names are those of whitted.hpp.
struct Wave {
    // Set by whoever adds an encounter.
    std::uint32_t ray[kColumn]; // number in the batch
    alignas(64) const material::Material* material[kColumn];
    /// Its surface comes from `gather` and `face`: until then position, normals and error are nothing. Of others kNoSphere.
    alignas(64) const geometry::Sphere* sphere[kColumn];
    Columns geometric, normal, position;
    Column error;          // `face` adds that of a second surface, which may coincide with this one
    Column errorBeside;    // at most, of that; of spheres their own
    IntegerColumn bends;   // does it let light through into a solid, or out of one?
    IntegerColumn exclude; // from rays that leave, a PrimitiveId
    // Set by `gather`.
    Columns direction;
    Columns weight; // share of the picture
    Columns color;  // of the material; times its texture's, when that is known
    // Set by `face`.
    IntegerColumn leaving;
    Columns light; // sum over the lights so far: none
    // Toward one light.
    Column cosine;  // to the normal; 0: from behind; -1: the light lies on the point
    Column halfway; // cosine of the halfway vector to the normal
    Leaving shadow;
    Columns visible; // of the light; 0 where it does not matter, which `aim` sets
    Columns added;   // to `light`
    // What leaves, and its share of the picture.
    Leaving mirrored, refracted;
    Columns mirroredWeight, refractedWeight;
    Column ratio;          // index in front over index behind; 1: nothing is bent; set by `bend`
    Column refractedError; // likewise, to `error`
    IntegerColumn sends;   // bits of Sends
};

inline constexpr geometry::Sphere kNoSphere{};

/// Plain data only crosses between levels, as in octree/kernel.hpp. Each works on the first `count`
/// encounters, or those from `first` on, and may write garbage in lanes beside them. It takes up to kMostLanes
/// at once; where the last are fewer, `ray`, `material` and `sphere` are set in the lanes behind them, too.
struct WaveKernel {
    /// The rays through some points; see Camera. False, and none is right, if the distance of any from the eye is so extreme
    /// that its square is no normal number.
    bool (*through)(const Pinhole&, const PicturePoint*, std::size_t count, geometry::Ray*);
    /// What encounters take from their rays; of spheres `geometric`, the point that was hit, seen from the centre. True if that
    /// of any is too small or too large for `face`: not numeric::bits::isModerate.
    bool (*gather)(Wave&, std::size_t count, const geometry::Ray*, const geometry::Hit*,
                   const Work*);
    void (*face)(Wave&, std::size_t count); // surfaces of spheres; turns normals toward the rays
    void (*aim)(Wave&, std::size_t count, const double light[3]);
    void (*add)(Wave&, std::size_t count, bool transmits);     // what `visible` is worth
    void (*bend)(Wave&, std::size_t first, std::size_t count); // before `leave`
    void (*leave)(Wave&, std::size_t first, std::size_t transmitters, std::size_t count);
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
