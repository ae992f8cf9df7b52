#include <core/animation/poses.hpp>

#include <core/scene/parameter.hpp>

#include <algorithm>
#include <map>

namespace rt::animation {
namespace {

using numeric::Mat3;
using scene::Easing;
using scene::FrameRange;
using scene::Track;

constexpr scene::Code kNoDirection{340}, kNoFace{341};

/// Part of one motion: from share `from` to share `to`.
struct Jump {
    std::size_t track; // index into the tracks of the thing that moves
    double from, to;
};

/// The jumps up to `frame`, in order. `tracks` is sorted.
std::vector<Jump> jumpsTo(std::span<const Track* const> tracks, std::uint32_t frame) {
    std::vector<std::uint32_t> bounds;
    for (const Track* track : tracks) {
        bounds.push_back(std::min(track->frames.first, frame));
        bounds.push_back(std::min(track->frames.last, frame));
    }
    std::ranges::sort(bounds);
    bounds.erase(std::unique(bounds.begin(), bounds.end()), bounds.end());

    std::vector<Jump> jumps;
    std::vector<std::size_t> active;
    for (std::size_t i = 0; i + 1 < bounds.size(); ++i) {
        active.clear();
        for (std::size_t t = 0; t < tracks.size(); ++t) {
            if (tracks[t]->frames.first <= bounds[i] && bounds[i + 1] <= tracks[t]->frames.last)
                active.push_back(t);
        }
        const std::uint32_t stride = active.size() == 1 ? bounds[i + 1] - bounds[i] : 1;
        for (std::uint32_t q = bounds[i]; !active.empty() && q < bounds[i + 1]; q += stride) {
            for (const std::size_t t : active) {
                const Track& track = *tracks[t];
                jumps.push_back({t, shareDone(track.frames, track.easing, q),
                                 shareDone(track.frames, track.easing, q + stride)});
            }
        }
    }
    return jumps;
}

/// Something rigid that moves, with what a motion remembers about it.
struct Body {
    Vec3 restCenter, restNormal{0};
    AffineTransform worldFromRest;
    std::vector<Vec3>
        outward; // by track: the last direction of move_radius, which survives passing the centre
    std::vector<double> side; // by track: -1 once move_radius has passed the centre

    Vec3 center() const { return worldFromRest.point(restCenter); }
};

Mat3 turn(const Vec3& axis, double angle) { return numeric::rotation(axis, {angle}).linear; }

AffineTransform about(const Vec3& center, const Mat3& linear) {
    return {linear, center - linear * center};
}

/// worldAfter from worldBefore for this part of the motion of `body`.
AffineTransform stepOf(const scene::Motion& motion, const Jump& jump, Body& body) {
    const double share = jump.to - jump.from;
    if (const auto* rotate = std::get_if<scene::Rotate>(&motion)) {
        return about(rotate->center, turn(rotate->axis, rotate->angle.value * share));
    }
    if (const auto* rotateSelf = std::get_if<scene::RotateSelf>(&motion)) {
        const Vec3 axis =
            rotateSelf->axis ? *rotateSelf->axis : body.worldFromRest.direction(body.restNormal);
        if (axis == Vec3(0)) return {};
        return about(body.center(), turn(axis, rotateSelf->angle.value * share));
    }
    if (const auto* move = std::get_if<scene::Move>(&motion)) {
        const Vec3 rest = move->position - body.center();
        return {Mat3(1), jump.to == 1 ? rest : rest * (share / (1 - jump.from))};
    }
    if (const auto* radial = std::get_if<scene::MoveRadius>(&motion)) {
        const Vec3 fromCenter = body.center() - radial->center;
        const double radius = numeric::length(fromCenter);
        double& side = body.side[jump.track];
        Vec3& outward = body.outward[jump.track];
        if (radius > 0) outward = fromCenter * (side / radius);
        const double travelled = radial->distance * share;
        if (side * radius + travelled < 0)
            side = -1;
        else if (side * radius + travelled > 0)
            side = 1;
        return {Mat3(1), outward * travelled};
    }
    if (const auto* direct = std::get_if<scene::MoveDirect>(&motion)) {
        return {Mat3(1), normalize(direct->direction) * (direct->distance * share)};
    }
    return {}; // keyframes change parameters, not poses
}

/// What a track of one object acts on as one piece.
struct Scope {
    bool each = false;
    std::optional<std::array<std::uint32_t, 2>> faces; // none: the whole object

    bool contains(std::uint32_t face) const {
        return !faces || ((*faces)[0] <= face && face <= (*faces)[1]);
    }
    bool contains(const Scope& other) const {
        return !faces || (other.faces && (*faces)[0] <= (*other.faces)[0] &&
                          (*other.faces)[1] <= (*faces)[1]);
    }
    std::uint64_t size() const {
        return faces ? std::uint64_t((*faces)[1]) - (*faces)[0] + 1 : UINT64_MAX;
    }
    bool isWhole() const { return !faces && !each; }
};

Body bodyAtRest(const Vec3& center, const Vec3& normal, std::size_t tracks) {
    return {center, normal, {}, std::vector<Vec3>(tracks, Vec3(0)), std::vector<double>(tracks, 1)};
}

/// Middle of the centroids of the faces of a scope.
Vec3 centerOf(const RestObject& object, const Scope& scope) {
    if (!scope.faces) return object.center;
    Vec3 sum(0);
    for (std::uint32_t face = (*scope.faces)[0]; face <= (*scope.faces)[1]; ++face)
        sum += object.faces[face].centroid;
    return sum * (1.0 / static_cast<double>(scope.size()));
}

ObjectPose poseOf(const RestObject& object, std::span<const Track* const> tracks,
                  std::span<const Scope> scopes, std::uint32_t frame) {
    const std::vector<Jump> jumps = jumpsTo(tracks, frame);
    ObjectPose pose;
    const bool single =
        std::ranges::any_of(scopes, [](const Scope& scope) { return !scope.isWhole(); });
    if (jumps.empty() && !single) return pose;

    // Each group moves with the groups that contain it; so the largest first. Its own steps are kept for its faces.
    std::vector<AffineTransform> steps(jumps.size());
    std::vector<Scope> groups{{}};
    for (const Scope& scope : scopes) {
        const bool known = std::ranges::any_of(
            groups, [&](const Scope& group) { return group.faces == scope.faces; });
        if (!scope.each && !known) groups.push_back(scope);
    }
    std::ranges::stable_sort(groups, std::ranges::greater{}, &Scope::size);
    for (const Scope& group : groups) {
        Body body = bodyAtRest(centerOf(object, group), object.normal, tracks.size());
        for (std::size_t j = 0; j < jumps.size(); ++j) {
            const Scope& scope = scopes[jumps[j].track];
            if (scope.each || !scope.contains(group)) continue;
            if (scope.faces == group.faces)
                steps[j] = stepOf(*tracks[jumps[j].track]->motion, jumps[j], body);
            body.worldFromRest = steps[j] * body.worldFromRest;
        }
        if (!group.faces) pose.worldFromRest = body.worldFromRest;
    }
    if (!single) return pose;

    pose.faces.reserve(object.faces.size());
    for (std::uint32_t face = 0; face < object.faces.size(); ++face) {
        Body body =
            bodyAtRest(object.faces[face].centroid, object.faces[face].normal, tracks.size());
        for (std::size_t j = 0; j < jumps.size(); ++j) {
            const Scope& scope = scopes[jumps[j].track];
            if (!scope.contains(face)) continue;
            const AffineTransform step =
                scope.each ? stepOf(*tracks[jumps[j].track]->motion, jumps[j], body) : steps[j];
            body.worldFromRest = step * body.worldFromRest;
        }
        pose.faces.push_back(body.worldFromRest);
    }
    return pose;
}

void sortByFrames(std::vector<const Track*>& tracks) {
    std::ranges::stable_sort(tracks, [](const Track* a, const Track* b) {
        return std::pair(a->frames.first, a->frames.last) <
               std::pair(b->frames.first, b->frames.last);
    });
}

bool isKeyframed(const Track& track) {
    return !track.motion || std::holds_alternative<scene::Keyframes>(*track.motion);
}

/// `camera` comes as it is at rest in this frame. False, and an error, when it ends without a direction.
bool moveCamera(const scene::Description& description, std::uint32_t frame, scene::Camera& camera,
                scene::Diagnostics& diagnostics) {
    using scene::CameraPoint;
    const scene::Camera rest = camera;
    const Vec3 forward = normalize(rest.forward), up = normalize(rest.up);
    // The top point stands over the eye by the part of `up` that is perpendicular to `forward`.
    // A camera that looks at a point goes on doing so, with its own up unless the top point moves.
    const Vec3 restPoints[] = {rest.position,
                               rest.lookAt.value_or(rest.position + rest.screenDistance * forward),
                               rest.position + (up - forward * numeric::dot(forward, up))};
    Vec3 points[3];
    bool moved = false, keepsUp = rest.lookAt.has_value();
    const Track* mover = nullptr;
    for (const CameraPoint point : {CameraPoint::position, CameraPoint::front, CameraPoint::top}) {
        std::vector<const Track*> tracks;
        for (const Track& track : description.animation->tracks) {
            const auto* target = std::get_if<scene::CameraTarget>(&track.target);
            if (target && target->point == point && !isKeyframed(track)) tracks.push_back(&track);
        }
        sortByFrames(tracks);
        if (point == CameraPoint::top && !tracks.empty()) keepsUp = false;
        const auto i = static_cast<std::size_t>(point);
        Body body = bodyAtRest(restPoints[i], Vec3(0), tracks.size());
        for (const Jump& jump : jumpsTo(tracks, frame)) {
            mover = tracks[jump.track];
            body.worldFromRest = stepOf(*mover->motion, jump, body) * body.worldFromRest;
            moved = true;
        }
        points[i] = moved ? body.center() : restPoints[i];
    }
    if (!moved) return true;
    camera.lookAt.reset();
    camera.position = points[0];
    camera.forward = points[1] - points[0];
    camera.up = keepsUp ? rest.up : points[2] - points[0];
    const bool sane = numeric::isFinite(camera.position) && numeric::isFinite(camera.forward) &&
                      numeric::isFinite(camera.up);
    if (!sane ||
        !(numeric::lengthSquared(cross(normalize(camera.forward), normalize(camera.up))) > 0)) {
        const std::string image = "in frame " + std::to_string(frame) + " ";
        diagnostics.error(kNoDirection, mover->location,
                          camera.forward == Vec3(0)
                              ? image + "the camera's position and front point are the same"
                              : image + "the camera looks along its up direction");
        return false;
    }
    return true;
}

/// There is one fade at a time; those that are over have left their texture.
void fadeBackground(const scene::Description& description, std::uint32_t frame,
                    scene::Background& background) {
    std::vector<const Track*> fades;
    for (const Track& track : description.animation->tracks) {
        if (std::holds_alternative<scene::BackgroundFade>(track.target)) fades.push_back(&track);
    }
    sortByFrames(fades);
    for (const Track* fade : fades) {
        const double share = shareDone(fade->frames, fade->easing, frame);
        const std::uint32_t texture = std::get<scene::BackgroundFade>(fade->target).texture;
        if (share == 1)
            background.texture = texture;
        else if (share > 0)
            background.fade = scene::Background::Fade{texture, share};
    }
}

/// Values between keys; before the first and after the last they stay.
std::vector<double> valuesAt(const scene::Keyframes& keyframes, std::uint32_t frame) {
    using Interpolation = scene::Keyframes::Interpolation;
    const auto& keys = keyframes.keys;
    const auto next = std::ranges::upper_bound(keys, frame, {}, &scene::Keyframes::Key::frame);
    if (next == keys.begin()) return keys.front().values;
    const auto previous = next - 1;
    if (next == keys.end() || keyframes.interpolation == Interpolation::step)
        return previous->values;
    const Easing easing =
        keyframes.interpolation == Interpolation::smooth ? Easing::smooth : Easing::linear;
    const double share = shareDone({previous->frame, next->frame}, easing, frame);
    std::vector<double> values(previous->values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        values[i] = previous->values[i] * (1 - share) + next->values[i] * share;
    }
    return values;
}

} // namespace

double shareDone(const FrameRange& frames, scene::Easing easing, std::uint32_t frame) {
    if (frame <= frames.first) return 0;
    if (frame >= frames.last) return 1;
    const double x =
        static_cast<double>(frame - frames.first) / static_cast<double>(frames.last - frames.first);
    return easing == scene::Easing::smooth ? x * x * (3 - 2 * x) : x;
}

std::vector<Moving> whatMoves(const scene::Description& description) {
    std::vector<Moving> result(description.objects.size(), Moving::nothing);
    if (!description.animation) return result;
    for (const Track& track : description.animation->tracks) {
        const auto* target = std::get_if<scene::ObjectTarget>(&track.target);
        if (!target || isKeyframed(track)) continue;
        const Moving moving = target->each || target->faces ? Moving::faces : Moving::whole;
        for (const std::uint32_t object : target->objects)
            result[object] = std::max(result[object], moving);
    }
    return result;
}

bool keyframesReachTheWorld(const scene::Description& description) {
    using Owner = scene::Parameter::Owner;
    if (!description.animation) return false;
    return std::ranges::any_of(description.animation->tracks, [](const Track& track) {
        const auto* target = std::get_if<scene::ParameterTarget>(&track.target);
        if (!target) return false;
        const Owner owner = target->parameter.owner;
        return owner != Owner::camera && owner != Owner::light && owner != Owner::background;
    });
}

std::optional<scene::Description> descriptionAt(const scene::Description& description,
                                                std::uint32_t frame,
                                                scene::Diagnostics& diagnostics) {
    scene::Description still = description;
    if (!description.animation) return still;
    for (const Track& track : description.animation->tracks) {
        const auto* target = std::get_if<scene::ParameterTarget>(&track.target);
        if (!target) continue;
        scene::setParameter(still, target->parameter,
                            valuesAt(std::get<scene::Keyframes>(*track.motion), frame));
    }
    if (!moveCamera(description, frame, still.camera, diagnostics)) return std::nullopt;
    fadeBackground(description, frame, still.background);
    return still;
}

std::optional<std::vector<ObjectPose>> posesAt(const scene::Description& description,
                                               std::span<const RestObject> rest,
                                               std::uint32_t frame,
                                               scene::Diagnostics& diagnostics) {
    std::vector<ObjectPose> poses(description.objects.size());
    if (!description.animation) return poses;
    std::map<std::uint32_t, std::vector<const Track*>> tracksOf;
    for (const Track& track : description.animation->tracks) {
        const auto* target = std::get_if<scene::ObjectTarget>(&track.target);
        if (!target || isKeyframed(track)) continue;
        for (const std::uint32_t object : target->objects) {
            const std::size_t faces = rest[object].faces.size();
            if (target->faces && (*target->faces)[1] >= faces) {
                diagnostics.error(kNoFace, track.location,
                                  "there is no face " + std::to_string((*target->faces)[1]) +
                                      ": the mesh has " + std::to_string(faces) +
                                      (faces ? ", numbers 0 to " + std::to_string(faces - 1) : ""));
                return std::nullopt;
            }
            tracksOf[object].push_back(&track);
        }
    }
    for (auto& [object, tracks] : tracksOf) {
        sortByFrames(tracks);
        std::vector<Scope> scopes;
        for (const Track* track : tracks) {
            const auto& target = std::get<scene::ObjectTarget>(track->target);
            // A planar object is its own one face.
            scopes.push_back({target.each && !rest[object].faces.empty(), target.faces});
        }
        poses[object] = poseOf(rest[object], tracks, scopes, frame);
    }
    return poses;
}

} // namespace rt::animation
