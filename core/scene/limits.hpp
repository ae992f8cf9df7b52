// What a scene may cost before rt refuses it. Every member has an option --limit-NAME; exceeding one ends with exit 7.
#pragma once
#include <cstddef>
#include <cstdint>

namespace rt::scene {

struct Limits {
    std::uint64_t pixels = std::uint64_t{1} << 28;        // of one picture
    std::uint64_t texturePixels = std::uint64_t{1} << 26; // of one texture
    std::uint64_t primitives = 0xFFFFFFFE;                // what 32-bit ids can tell apart
    std::uint64_t memory = 0; // bytes of what is drawn and of the process; 0: what the machine has
    std::uint64_t fileBytes = 0;   // of one input file; 0: what its kind may have
    std::size_t nodes = 1'000'000; // of one YAML document, aliases expanded
    std::size_t nesting = 64;      // lists and maps within each other
};

/// yaml-cpp takes up to 0.16 us a byte on a Zen 3: 16 MiB of one word would take 2.5 s.
inline constexpr std::uint64_t kMaxSceneBytes = std::uint64_t{8} << 20;
inline constexpr std::uint64_t kMaxMeshBytes = std::uint64_t{4} << 30; // as the loaders have it
inline constexpr std::uint64_t kMaxPictureBytes = std::uint64_t{2}
                                                  << 30; // 2^26 pixels of three f32 take 0.75 GiB
/// yaml-cpp refuses deeper nesting in words of its own.
inline constexpr std::size_t kDeepestNesting = 400;

} // namespace rt::scene
