// One pixel taken apart: every ray of it, what it met, and what each contributed.
#pragma once
#include <core/geometry/surface.hpp>
#include <core/trace/render.hpp>

#include <string>
#include <vector>

namespace rt::trace {

struct RayTree {
    enum class Kind : std::uint8_t { primary, reflected, refracted };
    enum class Fate : std::uint8_t {
        traced,
        nothingToAdd,      // its weight is 0
        cutByDepth,        // more bounces than render.depth
        cutByContribution, // weight below render.cutoff
    };

    struct LightShare {
        std::uint32_t light;        // in the scene's lights
        numeric::LinearRgb visible; // its color after all that lies between
        numeric::LinearRgb added;   // to the color of the surface, not yet weighted
    };

    struct Node {
        std::uint32_t parent; // of the primary rays: their own number
        Kind kind;
        Fate fate;
        std::uint32_t depth;       // bounces so far
        numeric::LinearRgb weight; // share of what this ray sees that reaches the sample
        geometry::Vec3 origin, direction;
        std::vector<geometry::ObjectId> media; // solids that it travels in, in the order entered

        bool hit = false; // otherwise: fate, or the background
        double t = 0;     // = distance: direction is unit
        geometry::PrimitiveId primitive = geometry::kNoPrimitive;
        geometry::ObjectId object{};
        geometry::MaterialId material{};
        std::uint32_t sourceFace = 0;
        geometry::Vec3 position{0}, normal{0}; // normal: toward the ray
        bool leaving = false;                  // the surface is met from the inside
        numeric::LinearRgb color;              // of the surface, texture included
        std::vector<LightShare> lights;
        numeric::LinearRgb local; // lights, or background; unweighted
        numeric::LinearRgb seen;  // local and what the children add; unweighted, before tone
        std::vector<std::uint32_t> children;
    };

    struct Sample {
        double column, row;                // in the picture
        std::optional<std::uint32_t> root; // none: the ray never enters the scene's box
        numeric::LinearRgb light;          // before tone
        numeric::LinearRgb toned;
    };

    std::vector<Node> nodes;
    std::vector<Sample> samples;
    numeric::LinearRgb
        pixel; // mean of the samples' tones; equal to the frame's pixel before smooth
};

/// Pixel (x, y) as `render` traces it. With max_error, which decides about whole pictures: the one
/// sample in the middle.
RayTree tracePixel(const octree::Octree& octree, const world::World& world,
                   const scene::Description& description, std::uint32_t x, std::uint32_t y);

} // namespace rt::trace
