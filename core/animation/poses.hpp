// Tracks to poses: where everything stands in frame k, as a pure function of the scene at rest and k.
//
// A motion acts in steps first <= q < last, so frame k, the state after k steps, shows share (k - first) / (last - first)
// of it, eased. Where one motion acts alone its closed form is used; where several act on one thing at once they take
// turns step by step, in the order of (first, last), then of the file. Nothing is carried from frame to frame.
#pragma once
#include <core/numeric/transform.hpp>
#include <core/scene/description.hpp>

#include <optional>
#include <span>
#include <vector>

namespace rt::animation {

using numeric::AffineTransform;
using numeric::Vec3;

/// A face of a mesh at rest, world space. The normal may have any length; 0: none.
struct RestFace {
    Vec3 centroid{0}, normal{0};
};

/// What motions ask of an object at rest, world space.
struct RestObject {
    Vec3 center{0}; // what `move` brings to a point and `move_radius` measures from
    Vec3 normal{0}; // of a planar object, any length; 0: none, and rotate_self needs an axis
    std::vector<RestFace> faces; // by source face; may be empty unless Moving::faces
};

/// What tracks move of an object: nothing, all of it as one, or faces by themselves too.
enum class Moving : std::uint8_t { nothing, whole, faces };
/// Indexed like description.objects.
std::vector<Moving> whatMoves(const scene::Description& description);

struct ObjectPose {
    AffineTransform worldFromRest;      // of what is not listed in `faces`; rigid
    std::vector<AffineTransform> faces; // empty, or one per source face, in place of worldFromRest
};

/// Where the objects stand in this frame, indexed like description.objects; nothing, and an error, when a track names a
/// face that the mesh does not have (E0341).
std::optional<std::vector<ObjectPose>> posesAt(const scene::Description& description,
                                               std::span<const RestObject> rest,
                                               std::uint32_t frame,
                                               scene::Diagnostics& diagnostics);

/// The scene of this frame but for the poses: keyframed numbers, the camera, the background and its fade. Nothing, and
/// an error, when the camera has no direction or no up (E0340). The field of view stays what it is at rest.
std::optional<scene::Description> descriptionAt(const scene::Description& description,
                                                std::uint32_t frame,
                                                scene::Diagnostics& diagnostics);

/// Do keyframes change numbers of objects, materials or textures, so that each frame's description is lowered anew?
bool keyframesReachTheWorld(const scene::Description& description);

/// Share of a motion over `frames` that is done in `frame`: 0 up to first, 1 from last on.
double shareDone(const scene::FrameRange& frames, scene::Easing easing, std::uint32_t frame);

} // namespace rt::animation
