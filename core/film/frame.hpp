// The scene at frame k: rest pose and tracks to a description and a world that trace can render.
#pragma once
#include <core/animation/poses.hpp>
#include <core/scene/description.hpp>
#include <core/world/world.hpp>

#include <functional>
#include <optional>
#include <vector>

namespace rt::film {

struct Frame {
    scene::Description description; // camera and background of this frame
    world::World world;
    std::vector<bool> moved; // by object: it does not stand where it does at rest
};

/// Where the objects of `rest` that move stand, for the motions. The center of an object of one primitive is that
/// primitive's own (a triangle's centroid); of any other, the middle of its bounds.
std::vector<animation::RestObject> restObjects(const scene::Description& description,
                                               const world::World& rest);

/// Takes a description to its world, as plugin_host::lower does.
using Lower =
    std::function<std::optional<world::World>(const scene::Description&, scene::Diagnostics&)>;

/// A function of the arguments alone. `rest` is `description` lowered; `lower` is called where keyframes change numbers of
/// objects, materials or textures, so that each frame has a rest pose of its own. Nothing, and errors, where a track
/// cannot be followed.
std::optional<Frame> frameAt(const scene::Description& description, const world::World& rest,
                             std::uint32_t frame, const Lower& lower,
                             scene::Diagnostics& diagnostics);

/// Primitives that may stand elsewhere in the later of two frames that have the same ones; by rising id.
std::vector<geometry::PrimitiveId> movedBetween(const Frame& before, const Frame& after);

} // namespace rt::film
