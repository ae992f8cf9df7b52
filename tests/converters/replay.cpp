// The renderer against the original's film, in poses and screens of the original: its rotation, which shrinks heights, and
// its view, which jumps, are replayed here step by step as section 5 of LEGACY.md words them. Nothing of this is in rt.
#include <core/image/metrics.hpp>
#include <core/trace/render.hpp>
#include <formats/image_reader.hpp>
#include <tests/converters/legacy_stage.hpp>

#include <cmath>
#include <numbers>

namespace rt::converters {
namespace {

using geometry::Vec3;

const Vec3 kCenter(50, 65, 30); // of every motion of the film
constexpr double kScreenWidth = 17.79, kScreenHeight = 10, kFocus = 9;
constexpr double kTurn = 6.28, kHalfTurn = 3.14; // as the movie file writes them

/// One of `steps` equal steps of a rotation. The term that would keep the part of v along the axis is missing.
Vec3 rotated(const Vec3& point, const Vec3& axis, double angle, int steps) {
    const Vec3 v = point - kCenter, unit = normalize(axis);
    const double step = angle / steps;
    return kCenter + v * std::cos(step) + cross(v, unit) * std::sin(step);
}

Vec3 movedAway(const Vec3& point, double distance, int steps) {
    return point + normalize(point - kCenter) * (distance / steps);
}

/// The original's camera: neither up nor side is made a unit vector again, so the screen shrinks with them.
struct View {
    Vec3 position, forward, up;
    double scale = 1;

    View(const Vec3& position_, const Vec3& forward_, const Vec3& up_)
        : position(position_), forward(normalize(forward_)), up(normalize(up_)) {
        constexpr double kPerpendicular = 1.0 / (1 << 20);
        const Vec3 left = cross(up, forward);
        if (std::fabs(dot(forward, up)) > kPerpendicular) up = cross(forward, left);
        scale = length(left);
    }
};

struct Replay {
    View view{{90, 0, 40}, {-40, 80, -30}, {0, 0, 1}};
    Vec3 eye = view.position, front = eye + kFocus * view.forward, top = eye + view.up;
    world::World world;

    void step(int q) {
        const Vec3 z(0, 0, 1);
        eye = rotated(eye, z, kHalfTurn, 48);
        if (q >= 24) eye = rotated(eye, z, kHalfTurn, 24);
        if (q == 0) front = kCenter;
        top = rotated(movedAway(top, -5, 48), z, kHalfTurn, 48);
        if (q >= 24) top = rotated(movedAway(top, 5, 24), z, kHalfTurn, 24);
        view = View(eye, front - eye, top - eye);

        auto& spheres = world.primitives.spheres;
        const Vec3 axes[] = {z, {-1, 0, 1}, {1, 0, 1}};
        for (int i = 0; i < 3; ++i)
            spheres[std::size_t(i) + 1].center =
                rotated(spheres[std::size_t(i) + 1].center, axes[i], kTurn, 96);
        for (Vec3& corner : world.primitives.triangles.positions)
            corner = rotated(corner, z, kTurn, 96);
    }
};

class LegacyFilm : public testing::TestWithParam<int> {};

// The video is lossy: a half-pixel error already costs image 0 all above 33 dB.
TEST_P(LegacyFilm, LooksAsItDid) {
    constexpr double kVideo = 30;
    const int image = GetParam();
    if (!std::filesystem::exists(legacy("author_b/Scene.inf")))
        GTEST_SKIP() << "the legacy files are not here";
    plugin_host::Catalog catalog({RT_SHIPPED_PLUGINS});
    const auto stage = stageOf(legacy("author_b/Scene.inf"), catalog);
    ASSERT_TRUE(stage);
    ASSERT_EQ(stage->world.primitives.spheres.size(), 4u);
    ASSERT_EQ(stage->world.primitives.triangles.indices.size(), 4u);
    Replay replay;
    replay.world = stage->world;
    for (int q = 0; q < image; ++q) replay.step(q);
    scene::Description description = stage->description;
    description.camera = {.position = replay.view.position,
                          .forward = replay.view.forward,
                          .up = replay.view.up,
                          .screenWidth = kScreenWidth * replay.view.scale,
                          .screenHeight = kScreenHeight * replay.view.scale,
                          .screenDistance = kFocus};
    const auto octree = octree::Octree::build(replay.world.primitives);
    auto ours = trace::render(octree, replay.world, description, {}).frame;

    scene::Diagnostics diagnostics;
    const auto video =
        formats::readPicture(legacy("reference/author_b_video_" + std::to_string(image) + ".png"),
                             {.encoding = scene::Encoding::linear}, diagnostics);
    ASSERT_TRUE(video) << errorsOf(diagnostics);
    const double psnr = image::difference(ours, video->frame, {}).psnr();
    RecordProperty("psnr", std::to_string(psnr));
    EXPECT_GE(psnr, kVideo);
}

INSTANTIATE_TEST_SUITE_P(Images, LegacyFilm, testing::Values(24, 48),
                         [](const auto& tested) { return std::to_string(tested.param); });

} // namespace
} // namespace rt::converters
