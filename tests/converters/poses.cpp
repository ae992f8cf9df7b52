// The converted tracks of a legacy movie, image by image, against the centres that the original program printed.
#include <core/film/frame.hpp>
#include <tests/converters/legacy_stage.hpp>
#include <tests/tolerance.hpp>

#include <fstream>
#include <sstream>

namespace rt::converters {
namespace {

using geometry::Vec3;

/// Centres by the original's object numbers, every face of a mesh one object.
std::vector<Vec3> centersOf(const world::World& world) {
    std::vector<Vec3> centers;
    for (const geometry::Segment& segment : world.primitives.segments) {
        for (std::uint32_t i = segment.index; i < segment.index + segment.count; ++i) {
            const auto& primitives = world.primitives;
            if (segment.kind == geometry::Kind::sphere)
                centers.push_back(primitives.spheres[i].center);
            if (segment.kind == geometry::Kind::parallelogram) {
                const auto& sheet = primitives.parallelograms[i];
                centers.push_back(sheet.origin + sheet.edgeU * 0.5 + sheet.edgeV * 0.5);
            }
            if (segment.kind == geometry::Kind::triangle) {
                const auto& [a, b, c] = primitives.triangles.indices[i];
                const auto& p = primitives.triangles.positions;
                centers.push_back((p[a] + p[b] + p[c]) / 3.0);
            }
        }
    }
    return centers;
}

struct PrintedState {
    Vec3 position, forward, up;
    int background, next;
    double alpha;
    std::vector<Vec3> centers;
};

std::vector<PrintedState> readTable(const std::string& path) {
    std::vector<PrintedState> states;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
        std::istringstream words(line);
        std::string word;
        const auto vec = [&] {
            Vec3 v;
            words >> v.x >> v.y >> v.z;
            return v;
        };
        words >> word;
        if (word == "STATE") {
            PrintedState state{};
            words >> word >> word >> word;
            state.position = vec(), words >> word, state.forward = vec(), words >> word,
            state.up = vec();
            words >> word >> word >> word >> state.background >> word >> state.next >> word >>
                state.alpha;
            states.push_back(state);
        } else if (word == "OBJ") {
            words >> word >> word;
            states.back().centers.push_back(vec());
        }
    }
    return states;
}

// Bugs of the original that act in this film: rotate shrinks what lies above or below its pivot, so the heights of the
// box's faces, 3 to 14, are off; and it starts with an up of the length sin, which the printed directions show.
TEST(LegacyPoses, CentersAreThoseThatTheOriginalPrinted) {
    if (!std::filesystem::exists(legacy("cases/m1_objects.inf")))
        GTEST_SKIP() << "the legacy files are not here";
    plugin_host::Catalog catalog({RT_SHIPPED_PLUGINS});
    const auto stage = stageOf(legacy("cases/m1_objects.inf"), catalog);
    ASSERT_TRUE(stage);
    const auto table = readTable(legacy("reference/m1_objects.txt"));
    ASSERT_EQ(table.size(), 13u);
    ASSERT_EQ(stage->description.animation->frames, 13u);

    for (std::uint32_t k = 0; k < table.size(); ++k) {
        SCOPED_TRACE("image " + std::to_string(k));
        scene::Diagnostics diagnostics;
        const auto frame = film::frameAt(stage->description, stage->world, k, {}, diagnostics);
        ASSERT_TRUE(frame) << errorsOf(diagnostics);
        const std::vector<Vec3> centers = centersOf(frame->world);
        ASSERT_EQ(centers.size(), table[k].centers.size());
        for (std::size_t number = 0; number < centers.size(); ++number) {
            const bool heightIsShrunk = number >= 3 && number <= 14;
            for (int axis = 0; axis < (heightIsShrunk ? 2 : 3); ++axis) {
                EXPECT_NEAR(centers[number][axis], table[k].centers[number][axis],
                            tolerance::kPrintedCenter)
                    << "object " << number << ", axis " << axis;
            }
            if (heightIsShrunk) {
                const double restHeight = table[0].centers[number].z;
                EXPECT_NEAR(centers[number].z, restHeight, tolerance::kClosedForm * 100)
                    << "object " << number;
            }
        }
        const auto expectSame = [](const Vec3& actual, const Vec3& expected) {
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_NEAR(actual[axis], expected[axis], tolerance::kPrintedCenter);
        };
        const scene::Camera& camera = frame->description.camera;
        const Vec3 forward = normalize(camera.forward);
        expectSame(camera.position, table[k].position);
        expectSame(forward, table[k].forward);
        expectSame(normalize(camera.up - forward * dot(camera.up, forward)),
                   normalize(table[k].up));

        const scene::Background& background = frame->description.background;
        EXPECT_EQ(static_cast<int>(background.texture.value()), table[k].background);
        EXPECT_EQ(background.fade ? static_cast<int>(background.fade->texture) : -1, table[k].next);
        EXPECT_NEAR(background.fade ? background.fade->share : 0, table[k].alpha,
                    tolerance::kPrintedCenter);
    }
}

} // namespace
} // namespace rt::converters
