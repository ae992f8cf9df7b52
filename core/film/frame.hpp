// The scene at frame k: rest pose and tracks to a description and a world that trace can render.
#pragma once
#include <core/animation/poses.hpp>
#include <core/scene/description.hpp>
#include <core/world/world.hpp>

#include <optional>
#include <vector>

namespace rt::film {

struct Frame {
    scene::Description description; // camera and background of this frame
    world::World world;
};

/// Where the objects of `rest` stand, for the motions. The center of an object of one primitive is that primitive's own
/// (a triangle's centroid); of any other, the middle of its bounds.
std::vector<animation::RestObject> restObjects(const scene::Description& description,
                                               const world::World& rest);

/// A function of the arguments alone. Nothing, and errors, where a track cannot be followed.
std::optional<Frame> frameAt(const scene::Description& description, const world::World& rest,
                             std::uint32_t frame, scene::Diagnostics& diagnostics);

} // namespace rt::film
