#include <core/animation/poses.hpp>
#include <core/scene/parameter.hpp>
#include <tests/tolerance.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace rt::animation {
namespace {

using scene::Easing;
using scene::FrameRange;
using scene::Track;

constexpr double kSceneSize = 100;

scene::Description filmOf(std::size_t objects, std::vector<Track> tracks) {
    scene::Description description;
    description.camera = {.position = {90, 0, 40},
                          .forward = {-40, 80, -30},
                          .up = {0, 0, 1},
                          .screenWidth = 16,
                          .screenHeight = 9,
                          .screenDistance = 9};
    description.objects.resize(objects);
    description.animation = scene::Animation{.frames = 97, .fps = 24, .tracks = std::move(tracks)};
    return description;
}

Track track(scene::Motion motion, FrameRange frames, Easing easing = Easing::linear) {
    Track result;
    result.target = scene::ObjectTarget{{0}, std::nullopt, false};
    result.motion = std::move(motion);
    result.frames = frames;
    result.easing = easing;
    return result;
}

Track eachFace(Track whole) {
    std::get<scene::ObjectTarget>(whole.target).each = true;
    return whole;
}

Track facesOf(Track whole, std::uint32_t first, std::uint32_t last) {
    std::get<scene::ObjectTarget>(whole.target).faces = {first, last};
    return whole;
}

Track cameraTrack(scene::CameraPoint point, scene::Motion motion, FrameRange frames) {
    Track result = track(std::move(motion), frames);
    result.target = scene::CameraTarget{point};
    return result;
}

Track fade(std::uint32_t texture, FrameRange frames) {
    Track result;
    result.target = scene::BackgroundFade{texture};
    result.frames = frames;
    return result;
}

std::vector<ObjectPose> posesOf(const scene::Description& description,
                                const std::vector<RestObject>& rest, std::uint32_t frame) {
    scene::Diagnostics diagnostics;
    const auto poses = posesAt(description, rest, frame, diagnostics);
    EXPECT_TRUE(poses.has_value()) << (diagnostics.failed() ? diagnostics.all()[0].message : "");
    return poses.value_or(std::vector<ObjectPose>(description.objects.size()));
}

scene::Description stillOf(const scene::Description& description, std::uint32_t frame) {
    scene::Diagnostics diagnostics;
    const auto still = descriptionAt(description, frame, diagnostics);
    EXPECT_TRUE(still.has_value()) << (diagnostics.failed() ? diagnostics.all()[0].message : "");
    return still.value_or(description);
}

void expectNear(const Vec3& actual, const Vec3& expected, const std::string& what) {
    const double error = numeric::length(actual - expected);
    EXPECT_LE(error, tolerance::kClosedForm * kSceneSize)
        << what << ": " << actual.x << " " << actual.y << " " << actual.z << ", expected "
        << expected.x << " " << expected.y << " " << expected.z;
}

/// Rodrigues' formula on the C library, independent of `rotation`.
Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {
    const Vec3 k = axis * (1 / std::sqrt(axis.x * axis.x + axis.y * axis.y + axis.z * axis.z));
    return v * std::cos(angle) + cross(k, v) * std::sin(angle) +
           k * (dot(k, v) * (1 - std::cos(angle)));
}

const Vec3 kCenter{75, 65, 30}, kPivot{50, 60, 25};
const std::vector<RestObject> kOne{{.center = kCenter, .normal = {0, 0, 0}, .faces = {}}};

const std::vector<RestObject> kMesh{{.center = {50, 40, 14},
                                     .normal = {},
                                     .faces = {{{49, 41, 11}, {0, 0, -1}},
                                               {{51, 39, 17}, {0, 0, 1}},
                                               {{51, 37, 13}, {0, -1, 0}},
                                               {{53, 41, 13}, {2, 0, 0}}}}};

double linearShare(FrameRange frames, std::uint32_t k) {
    return k <= frames.first  ? 0
           : k >= frames.last ? 1
                              : double(k - frames.first) / (frames.last - frames.first);
}

// ---- closed forms, every type, every frame ---------------------------------------------------------------------

struct ClosedForm {
    const char* name;
    scene::Motion motion;
    std::function<Vec3(const Vec3& rest, double share)> center;
};

class EveryMotion : public testing::TestWithParam<ClosedForm> {};

TEST_P(EveryMotion, FollowsItsClosedFormInEveryFrame) {
    for (const Easing easing : {Easing::linear, Easing::smooth}) {
        const FrameRange frames{7, 61};
        const auto film = filmOf(1, {track(GetParam().motion, frames, easing)});
        for (std::uint32_t k = 0; k <= 96; ++k) {
            const double x = linearShare(frames, k);
            const double share = easing == Easing::smooth ? x * x * (3 - 2 * x) : x;
            const auto poses = posesOf(film, kOne, k);
            expectNear(poses[0].worldFromRest.point(kCenter), GetParam().center(kCenter, share),
                       "frame " + std::to_string(k));
        }
    }
}

TEST_P(EveryMotion, CarriesFacesByThemselvesInEveryFrame) {
    const FrameRange frames{7, 61};
    const auto film = filmOf(1, {eachFace(track(GetParam().motion, frames))});
    for (std::uint32_t k = 0; k <= 96; ++k) {
        const auto poses = posesOf(film, kMesh, k);
        ASSERT_EQ(poses[0].faces.size(), kMesh[0].faces.size());
        for (std::size_t f = 0; f < kMesh[0].faces.size(); ++f) {
            const Vec3& rest = kMesh[0].faces[f].centroid;
            expectNear(poses[0].faces[f].point(rest),
                       GetParam().center(rest, linearShare(frames, k)),
                       "face " + std::to_string(f) + " in frame " + std::to_string(k));
        }
    }
}

TEST_P(EveryMotion, CarriesTheCameraInEveryFrame) {
    using scene::CameraPoint;
    const FrameRange frames{7, 61};
    for (const CameraPoint point : {CameraPoint::position, CameraPoint::front, CameraPoint::top}) {
        const auto film = filmOf(1, {cameraTrack(point, GetParam().motion, frames)});
        const Vec3 forward = normalize(film.camera.forward);
        const Vec3 eye = film.camera.position, front = eye + forward * film.camera.screenDistance,
                   top = eye + (film.camera.up - forward * dot(film.camera.up, forward));
        for (std::uint32_t k = 0; k <= 96; ++k) {
            const scene::Camera camera = stillOf(film, k).camera;
            if (k <= frames.first) {
                EXPECT_EQ(camera.position, film.camera.position);
                EXPECT_EQ(camera.forward, film.camera.forward);
                EXPECT_EQ(camera.up, film.camera.up);
                continue;
            }
            const auto at = [&](CameraPoint which, const Vec3& rest) {
                return which == point ? GetParam().center(rest, linearShare(frames, k)) : rest;
            };
            const Vec3 position = at(CameraPoint::position, eye);
            const std::string what =
                "point " + std::to_string(static_cast<int>(point)) + ", frame " + std::to_string(k);
            expectNear(camera.position, position, what);
            expectNear(camera.forward, at(CameraPoint::front, front) - position, what);
            expectNear(camera.up, at(CameraPoint::top, top) - position, what);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(
    Poses, EveryMotion,
    testing::Values(ClosedForm{"rotate", scene::Rotate{kPivot, {-1, 0, 1}, {12.56}},
                               [](const Vec3& c, double share) {
                                   return kPivot + turned(c - kPivot, {-1, 0, 1}, 12.56 * share);
                               }},
                    ClosedForm{"rotate_self", scene::RotateSelf{Vec3{0, 1, 1}, {3.14}},
                               [](const Vec3& c, double) { return c; }},
                    ClosedForm{"move", scene::Move{{10, 20, 90}},
                               [](const Vec3& c, double share) {
                                   return c + (Vec3{10, 20, 90} - c) * share;
                               }},
                    ClosedForm{"move_radius", scene::MoveRadius{kPivot, 17},
                               [](const Vec3& c, double share) {
                                   return c + normalize(c - kPivot) * (17 * share);
                               }},
                    ClosedForm{"move_radius_through_the_center", scene::MoveRadius{kPivot, -60},
                               [](const Vec3& c, double share) {
                                   return c - normalize(c - kPivot) * (60 * share);
                               }},
                    ClosedForm{"move_direct", scene::MoveDirect{{0, 3, 4}, 12},
                               [](const Vec3& c, double share) {
                                   return c + Vec3{0, 0.6, 0.8} * (12 * share);
                               }}),
    [](const auto& tested) { return tested.param.name; });

TEST(Poses, RotationIsRigidAndRightHanded) {
    const auto film =
        filmOf(1, {track(scene::Rotate{{0, 0, 0}, {0, 0, 2}, {std::acos(-1.0) / 2}}, {0, 8})});
    const AffineTransform quarter = posesOf(film, kOne, 8)[0].worldFromRest;
    expectNear(quarter.point({1, 0, 7}), {0, 1, 7}, "x turns to y, and height stays");
    const AffineTransform part = posesOf(film, kOne, 3)[0].worldFromRest;
    EXPECT_NEAR(numeric::length(part.direction({3, 4, 12})), 13,
                tolerance::kClosedForm * kSceneSize);
}

TEST(Poses, RotateSelfTurnsAPlanarObjectAboutItsOwnNormal) {
    std::vector<RestObject> rest = kOne;
    rest[0].normal = {0, -3, 0};
    const auto film = filmOf(1, {track(scene::RotateSelf{std::nullopt, {0.5}}, {0, 4})});
    for (std::uint32_t k = 0; k <= 4; ++k) {
        const AffineTransform pose = posesOf(film, rest, k)[0].worldFromRest;
        expectNear(pose.point(kCenter), kCenter, "the centre stays");
        expectNear(pose.direction({1, 0, 0}), turned({1, 0, 0}, {0, -1, 0}, 0.125 * k),
                   "the edge turns");
    }
}

TEST(Poses, RotateSelfWithoutANormalDoesNothing) {
    const auto film = filmOf(1, {track(scene::RotateSelf{std::nullopt, {0.5}}, {0, 4})});
    EXPECT_TRUE(posesOf(film, kOne, 3)[0].worldFromRest.isIdentity());
}

// ---- several motions on one thing ------------------------------------------------------------------------------

/// The steps of the legacy program without its bugs, one at a time from rest: what overlapping motions mean.
Vec3 replayed(Vec3 c, std::vector<const Track*> tracks, std::uint32_t frame) {
    std::stable_sort(tracks.begin(), tracks.end(), [](const Track* a, const Track* b) {
        return std::pair(a->frames.first, a->frames.last) <
               std::pair(b->frames.first, b->frames.last);
    });
    for (std::uint32_t q = 0; q < frame; ++q) {
        for (const Track* t : tracks) {
            if (q < t->frames.first || q >= t->frames.last) continue;
            const double n = t->frames.last - t->frames.first;
            if (const auto* r = std::get_if<scene::Rotate>(&*t->motion))
                c = r->center + turned(c - r->center, r->axis, r->angle.value / n);
            if (const auto* m = std::get_if<scene::Move>(&*t->motion))
                c += (m->position - c) * (1.0 / (t->frames.last - q));
            if (const auto* m = std::get_if<scene::MoveRadius>(&*t->motion))
                c += normalize(c - m->center) * (m->distance / n);
            if (const auto* m = std::get_if<scene::MoveDirect>(&*t->motion))
                c += normalize(m->direction) * (m->distance / n);
        }
    }
    return c;
}

TEST(Poses, OverlappingMotionsTakeTurnsInTheLegacyOrder) {
    const std::vector<Track> tracks{track(scene::MoveRadius{{50, 65, 30}, 20}, {48, 96}),
                                    track(scene::Rotate{{50, 65, 30}, {0, 0, 1}, {6.28}}, {0, 96}),
                                    track(scene::Move{{70, 70, 40}}, {20, 70}),
                                    track(scene::MoveDirect{{1, 2, 3}, -9}, {48, 80})};
    const auto film = filmOf(1, tracks);
    std::vector<const Track*> pointers;
    for (const Track& each : tracks) pointers.push_back(&each);
    for (std::uint32_t k = 0; k <= 96; ++k) {
        expectNear(posesOf(film, kOne, k)[0].worldFromRest.point(kCenter),
                   replayed(kCenter, pointers, k), "frame " + std::to_string(k));
    }
}

// In the original a finished motion kept acting while an earlier-sorted one ran, and a finished move divided by 0.
TEST(Poses, AFinishedMotionStops) {
    const auto film = filmOf(1, {track(scene::Rotate{kCenter, {0, 0, 1}, {1}}, {0, 90}),
                                 track(scene::Move{{1, 2, 3}}, {0, 10}),
                                 track(scene::MoveDirect{{1, 0, 0}, 4}, {20, 24})});
    const std::vector<RestObject> rest{{.center = kCenter, .normal = {}, .faces = {}}};
    const Vec3 moved = posesOf(film, rest, 24)[0].worldFromRest.point(kCenter);
    const Vec3 later = posesOf(film, rest, 25)[0].worldFromRest.point(kCenter);
    expectNear(later, kCenter + turned(moved - kCenter, {0, 0, 1}, 1.0 / 90),
               "only the rotation goes on");
}

TEST(Poses, AFrameAloneIsBitEqualToTheFrameInSequence) {
    const auto film = filmOf(1, {track(scene::Rotate{kPivot, {-1, 0, 1}, {12.56}}, {0, 96}),
                                 track(scene::MoveRadius{kPivot, 20}, {30, 60}),
                                 cameraTrack(scene::CameraPoint::position,
                                             scene::Rotate{kPivot, {0, 0, 1}, {3.14}}, {0, 48})});
    std::vector<std::vector<ObjectPose>> sequence;
    std::vector<scene::Camera> cameras;
    for (std::uint32_t k = 0; k <= 96; ++k) {
        sequence.push_back(posesOf(film, kOne, k));
        cameras.push_back(stillOf(film, k).camera);
    }
    for (const std::uint32_t k : {96u, 31u, 59u, 60u, 61u, 0u, 1u}) {
        const auto alone = posesOf(film, kOne, k);
        EXPECT_EQ(alone[0].worldFromRest.linear, sequence[k][0].worldFromRest.linear);
        EXPECT_EQ(alone[0].worldFromRest.translation, sequence[k][0].worldFromRest.translation);
        EXPECT_EQ(stillOf(film, k).camera.position, cameras[k].position);
        EXPECT_EQ(stillOf(film, k).camera.forward, cameras[k].forward);
    }
}

TEST(Poses, AShrinkingRadiusNeverMeetsNan) {
    const std::vector<RestObject> atCenter{{.center = kPivot, .normal = {}, .faces = {}}};
    const auto film = filmOf(1, {track(scene::MoveRadius{kPivot, 5}, {0, 5})});
    EXPECT_EQ(posesOf(film, atCenter, 5)[0].worldFromRest.point(kPivot), kPivot);
    // 4 steps of 5 from 20 away: exactly on the centre in frame 4, and out on the other side.
    const std::vector<RestObject> beside{{.center = {20, 0, 0}, .normal = {}, .faces = {}}};
    const auto through = filmOf(1, {track(scene::MoveRadius{{0, 0, 0}, -40}, {0, 8}),
                                    track(scene::MoveDirect{{0, 0, 1}, 0}, {0, 8})});
    for (std::uint32_t k = 0; k <= 8; ++k) {
        expectNear(posesOf(through, beside, k)[0].worldFromRest.point({20, 0, 0}),
                   {20 - 5.0 * k, 0, 0}, "frame " + std::to_string(k));
    }
}

// ---- meshes ----------------------------------------------------------------------------------------------------

TEST(Poses, AWholeMeshMovesAsOne) {
    const auto film = filmOf(1, {track(scene::Move{{0, 0, 0}}, {0, 2})});
    const auto poses = posesOf(film, kMesh, 2);
    EXPECT_TRUE(poses[0].faces.empty());
    expectNear(poses[0].worldFromRest.translation, {-50, -40, -14}, "its centre ends there");
}

TEST(Poses, EachFaceMovesAboutItsOwnCentroid) {
    const auto film = filmOf(1, {eachFace(track(scene::MoveRadius{{50, 40, 14}, 10}, {0, 2})),
                                 eachFace(track(scene::RotateSelf{std::nullopt, {1}}, {2, 4}))});
    ASSERT_THAT(whatMoves(film), testing::ElementsAre(Moving::faces));
    const auto poses = posesOf(film, kMesh, 3);
    ASSERT_EQ(poses[0].faces.size(), 4u);
    for (std::size_t f = 0; f < 4; ++f) {
        const RestFace& face = kMesh[0].faces[f];
        const Vec3 exploded = face.centroid + normalize(face.centroid - Vec3{50, 40, 14}) * 10.0;
        expectNear(poses[0].faces[f].point(face.centroid), exploded,
                   "centroid of face " + std::to_string(f));
        const Vec3 edge{0.3, 0.4, 0.5};
        expectNear(poses[0].faces[f].direction(edge), turned(edge, face.normal, 0.5),
                   "turn of face " + std::to_string(f));
    }
}

TEST(Poses, EachFaceCollapsesToTheSpotOfAMove) {
    const auto film = filmOf(1, {eachFace(track(scene::Move{{1, 2, 3}}, {0, 3}))});
    for (const std::size_t f : {0, 1, 2, 3}) {
        expectNear(posesOf(film, kMesh, 3)[0].faces[f].point(kMesh[0].faces[f].centroid), {1, 2, 3},
                   "face");
    }
}

TEST(Poses, ARangeOfFacesLeavesTheOthers) {
    const auto film =
        filmOf(1, {facesOf(track(scene::Rotate{{0, 0, 0}, {0, 0, 1}, {1}}, {0, 2}), 1, 2)});
    const auto poses = posesOf(film, kMesh, 2);
    ASSERT_EQ(poses[0].faces.size(), 4u);
    EXPECT_TRUE(poses[0].faces[0].isIdentity());
    EXPECT_TRUE(poses[0].faces[3].isIdentity());
    expectNear(poses[0].faces[1].point({1, 0, 0}), turned({1, 0, 0}, {0, 0, 1}, 1), "face 1 turns");
}

TEST(Poses, FacesFollowTheirMeshAndThenMoveByThemselves) {
    const auto film = filmOf(1, {track(scene::Rotate{{50, 40, 14}, {0, 0, 1}, {3.1416}}, {0, 12}),
                                 eachFace(track(scene::MoveRadius{{50, 40, 14}, 8}, {4, 10}))});
    const Vec3 pivot{50, 40, 14};
    for (std::uint32_t k = 0; k <= 12; ++k) {
        const auto poses = posesOf(film, kMesh, k);
        const double out = 8 * linearShare({4, 10}, k);
        for (std::size_t f = 0; f < 4; ++f) {
            const Vec3 rest = kMesh[0].faces[f].centroid - pivot;
            const Vec3 expected =
                turned(rest * (1 + out / numeric::length(rest)), {0, 0, 1}, 3.1416 * k / 12);
            expectNear(poses[0].faces[f].point(kMesh[0].faces[f].centroid), pivot + expected,
                       "frame " + std::to_string(k));
        }
    }
}

TEST(Poses, AFaceThatIsNotThereIsAnErrorAtItsTrack) {
    auto film = filmOf(1, {facesOf(track(scene::Move{{0, 0, 0}}, {0, 2}), 2, 4)});
    film.animation->tracks[0].location.line = 31;
    scene::Diagnostics diagnostics;
    EXPECT_FALSE(posesAt(film, kMesh, 1, diagnostics));
    ASSERT_EQ(diagnostics.errorCount(), 1u);
    EXPECT_EQ(diagnostics.all()[0].message, "there is no face 4: the mesh has 4, numbers 0 to 3");
    EXPECT_EQ(diagnostics.all()[0].location.line, 31u);
}

// ---- camera ----------------------------------------------------------------------------------------------------

TEST(Poses, ACameraThatDoesNotMoveIsTheRestCameraBitForBit) {
    const auto film = filmOf(1, {track(scene::Move{{0, 0, 0}}, {0, 2})});
    const scene::Camera camera = stillOf(film, 2).camera;
    EXPECT_EQ(camera.forward, film.camera.forward);
    EXPECT_EQ(camera.up, film.camera.up);
}

TEST(Poses, CameraPointsMoveByThemselvesAndTheFieldOfViewStays) {
    using scene::CameraPoint;
    const Vec3 center{50, 65, 30};
    const auto film = filmOf(
        1, {cameraTrack(CameraPoint::position, scene::Rotate{center, {0, 0, 1}, {-3.14}}, {0, 48}),
            cameraTrack(CameraPoint::front, scene::Move{center}, {0, 1}),
            cameraTrack(CameraPoint::top, scene::Move{{50, 65, 100}}, {0, 1})});
    for (std::uint32_t k = 1; k <= 48; ++k) {
        const scene::Camera camera = stillOf(film, k).camera;
        const Vec3 eye = center + turned(film.camera.position - center, {0, 0, 1}, -3.14 * k / 48);
        expectNear(camera.position, eye, "eye");
        expectNear(camera.forward, center - eye, "forward");
        expectNear(camera.up, Vec3{50, 65, 100} - eye, "up");
        EXPECT_EQ(camera.screenWidth, film.camera.screenWidth);
        EXPECT_EQ(camera.screenHeight, film.camera.screenHeight);
        EXPECT_EQ(camera.screenDistance, film.camera.screenDistance);
    }
}

TEST(Poses, TheTopPointStandsPerpendicularOverTheEye) {
    using scene::CameraPoint;
    const auto film =
        filmOf(1, {cameraTrack(CameraPoint::position, scene::MoveDirect{{0, 0, 1}, 0}, {0, 1})});
    const scene::Camera camera = stillOf(film, 1).camera;
    expectNear({dot(camera.up, camera.forward), 0, 0}, {0, 0, 0}, "perpendicular");
    const Vec3 forward = normalize(film.camera.forward);
    EXPECT_NEAR(numeric::length(camera.up), std::sqrt(1 - forward.z * forward.z),
                tolerance::kClosedForm);
    expectNear(camera.forward, forward * 9.0, "the front point is on the screen");
}

TEST(Poses, ACameraWithoutADirectionIsAnError) {
    using scene::CameraPoint;
    const auto film =
        filmOf(1, {cameraTrack(CameraPoint::front, scene::Move{{90, 0, 40}}, {0, 5})});
    scene::Diagnostics diagnostics;
    EXPECT_TRUE(descriptionAt(film, 4, diagnostics));
    EXPECT_FALSE(descriptionAt(film, 5, diagnostics));
    ASSERT_EQ(diagnostics.errorCount(), 1u);
    EXPECT_EQ(diagnostics.all()[0].message,
              "in frame 5 the camera's position and front point are the same");
}

// The gallery's film once looked at the floor: its front point stayed a unit before the first position.
TEST(Poses, ACameraThatLooksAtAPointGoesOnDoingSo) {
    auto film = filmOf(
        8, {cameraTrack(scene::CameraPoint::position, scene::MoveDirect{{0, 0, 1}, 40}, {0, 8})});
    film.camera.lookAt = Vec3{50, 65, 30};
    const scene::Camera camera = stillOf(film, 4).camera;
    const Vec3 eye = film.camera.position + Vec3{0, 0, 20};
    expectNear(camera.position, eye, "eye");
    expectNear(camera.forward, *film.camera.lookAt - eye, "forward");
    EXPECT_EQ(camera.up, film.camera.up);
}

// ---- background ------------------------------------------------------------------------------------------------

TEST(Poses, BackgroundsFade) {
    auto film = filmOf(0, {fade(1, {3, 9}), fade(0, {20, 24})});
    film.background.texture = 0;
    const auto check = [&](std::uint32_t k, std::uint32_t texture, std::uint32_t next,
                           double share) {
        const scene::Background background = stillOf(film, k).background;
        EXPECT_EQ(background.texture, texture) << k;
        EXPECT_EQ(background.fade.has_value(), share > 0) << k;
        if (!background.fade) return;
        EXPECT_EQ(background.fade->texture, next) << k;
        EXPECT_EQ(background.fade->share, share) << k;
    };
    for (std::uint32_t k = 0; k <= 96; ++k) {
        if (k < 9)
            check(k, 0, 1, linearShare({3, 9}, k));
        else if (k < 24)
            check(k, 1, 0, linearShare({20, 24}, k));
        else
            check(k, 0, 0, 0);
    }
}

TEST(Poses, AColourFadesToATexture) {
    const auto film = filmOf(0, {fade(0, {0, 2})});
    const scene::Background background = stillOf(film, 1).background;
    EXPECT_FALSE(background.texture.has_value());
    ASSERT_TRUE(background.fade.has_value());
    EXPECT_EQ(background.fade->texture, 0u);
}

// ---- keyframes -------------------------------------------------------------------------------------------------

scene::Description withKeyframes(const std::string& path, scene::Keyframes keyframes) {
    auto film = filmOf(0, {});
    film.lights.push_back(
        {.name = "key", .position = {1, 2, 3}, .color = {1, 1, 1}, .brightness = 1});
    const auto parameter = scene::findParameter(film, path, {});
    EXPECT_TRUE(std::holds_alternative<scene::Parameter>(parameter)) << path;
    Track keyed;
    keyed.target = scene::ParameterTarget{path, std::get<scene::Parameter>(parameter)};
    keyed.frames = {keyframes.keys.front().frame, keyframes.keys.back().frame};
    keyed.motion = std::move(keyframes);
    film.animation->tracks.push_back(std::move(keyed));
    return film;
}

TEST(Keyframes, ValuesRunBetweenTheirFrames) {
    using Interpolation = scene::Keyframes::Interpolation;
    const auto brightness = [](Interpolation interpolation, std::uint32_t frame) {
        const auto film = withKeyframes("lights.key.brightness",
                                        {{{10, {2}}, {20, {4}}, {40, {0}}}, interpolation});
        return stillOf(film, frame).lights[0].brightness;
    };
    for (const auto interpolation :
         {Interpolation::linear, Interpolation::smooth, Interpolation::step}) {
        EXPECT_EQ(brightness(interpolation, 0), 2);
        EXPECT_EQ(brightness(interpolation, 10), 2);
        EXPECT_EQ(brightness(interpolation, 20), 4);
        EXPECT_EQ(brightness(interpolation, 96), 0);
    }
    EXPECT_EQ(brightness(Interpolation::linear, 15), 3);
    EXPECT_EQ(brightness(Interpolation::linear, 25), 3);
    EXPECT_EQ(brightness(Interpolation::smooth, 25), 4 * (1 - 0.25 * 0.25 * 2.5));
    EXPECT_EQ(brightness(Interpolation::step, 19), 2);
    EXPECT_EQ(brightness(Interpolation::step, 39), 4);
}

TEST(Keyframes, TriplesAndTheCamera) {
    const auto lit = withKeyframes("lights.key.color", {{{0, {1, 0, 0}}, {4, {0, 1, 0.5}}}, {}});
    EXPECT_EQ(stillOf(lit, 1).lights[0].color, (numeric::LinearRgb{0.75, 0.25, 0.125}));
    const auto seen = withKeyframes("camera.screen.width", {{{0, {16}}, {4, {8}}}, {}});
    EXPECT_EQ(stillOf(seen, 3).camera.screenWidth, 10);
    EXPECT_FALSE(keyframesReachTheWorld(seen));
}

} // namespace
} // namespace rt::animation
