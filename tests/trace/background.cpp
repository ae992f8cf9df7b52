#include <core/numeric/angle.hpp>
#include <core/trace/background.hpp>
#include <core/trace/direction.hpp>
#include <formats/image_reader.hpp>
#include <tests/tolerance.hpp>
#include <tests/trace/scene_maker.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

namespace rt::trace {
namespace {

void expectUv(const Vec2& uv, double u, double v) {
    EXPECT_NEAR(uv.x, u, tolerance::roundings(8));
    EXPECT_NEAR(uv.y, v, tolerance::roundings(8));
}

// The panorama seen from inside is not mirrored: looking at its middle (+y, +z up), +x is to the right.
TEST(LatLong, middleIsPlusYAndRightOfItPlusX) {
    expectUv(latLongUv({0, 1, 0}), 0.5, 0.5);
    expectUv(latLongUv({1, 0, 0}), 0.75, 0.5);
    expectUv(latLongUv({-1, 0, 0}), 0.25, 0.5);
    expectUv(latLongUv(unit({0, 1, 1})), 0.5, 0.75);
    expectUv(latLongUv(unit({0, 1, -1})), 0.5, 0.25);
    EXPECT_NEAR(latLongUv({0, 0, 1}).y, 1, tolerance::roundings(4));
    EXPECT_EQ(latLongUv({0, 0, -1}).y, 0);
}

TEST(Hemisphere, rowsAreHeightsAndTheHorizonMirrors) {
    expectUv(hemisphereUv({0, 1, 0}), 0.5, 0);
    expectUv(hemisphereUv({1, 0, 0}), 0.75, 0);
    expectUv(hemisphereUv({0, 0.8, 0.6}), 0.5, 0.6);
    expectUv(hemisphereUv({0, 0.8, -0.6}), 0.5, 0.6);
}

// STABILITY.md E1: poles and seam.
TEST(LatLong, isInsideThePictureEverywhere) {
    const auto inside = [](const Vec2& uv) {
        return uv.x >= 0 && uv.x < 1 && uv.y >= 0 && uv.y < 1;
    };
    const double tiny = std::numeric_limits<double>::denorm_min();
    for (const double x : {0.0, -0.0, tiny, -tiny, 1.0, -1.0})
        for (const double y : {0.0, -0.0, tiny, -tiny, 1.0, -1.0})
            for (const double z : {1.0, -1.0, 0.0, -0.0, tiny}) {
                EXPECT_TRUE(inside(latLongUv({x, y, z}))) << x << ' ' << y << ' ' << z;
                EXPECT_TRUE(inside(hemisphereUv({x, y, z}))) << x << ' ' << y << ' ' << z;
            }
    // Across the seam at -y, u goes from one end to the other by the angle between.
    for (const double step : {tolerance::kSeamStep, 0.01}) {
        const double left = latLongUv({std::sin(step), -std::cos(step), 0}).x;
        const double right = latLongUv({-std::sin(step), -std::cos(step), 0}).x;
        EXPECT_NEAR(1 - left + right, step / std::numbers::pi, tolerance::roundings(8));
    }
}

TEST(LatLong, isAccurateAtThePole) {
    for (double angle = tolerance::kSeamStep; angle < 0.1; angle *= 7) {
        const double v = latLongUv({std::sin(angle), 0, std::cos(angle)}).y;
        EXPECT_NEAR((1 - v) * std::numbers::pi, angle, tolerance::roundings(16));
    }
}

// A panorama whose colors are its directions: (d + 1) / 2, its own +y up, -z in the middle, +x right.
TEST(LatLong, agreesWithAPictureOfDirections) {
    const char* const named = std::getenv("RT_DATA");
    const std::string path = std::string(named ? named : RT_DATA_DIR) + "/sky/dirmap.png";
    if (!std::filesystem::exists(path))
        GTEST_SKIP() << "no " << path << "; RT_DATA names its folder";
    scene::Diagnostics diagnostics;
    formats::ReadPictureOptions options;
    options.encoding = scene::Encoding::linear;
    const auto picture = formats::readPicture(path, options, diagnostics);
    ASSERT_TRUE(picture);
    const image::Framebuffer& map = picture->frame;
    // Half a texel of 2 pi / 1024 is 0.0031 rad, and 8 bits of a color 1 / 255 in the direction.
    const double slack = std::numbers::pi / map.width + 1.0 / 255;
    for (double azimuth = 0.01; azimuth < 6.28; azimuth += 0.037)
        for (double height = -0.99; height < 1; height += 0.11) {
            const double flat = std::sqrt(1 - height * height);
            const Vec3 d{flat * std::sin(azimuth), flat * std::cos(azimuth), height};
            const Vec2 uv = latLongUv(d);
            const LinearRgb& c = map.at(static_cast<std::uint32_t>(uv.x * map.width),
                                        static_cast<std::uint32_t>((1 - uv.y) * map.height));
            const Vec3 shown{2 * c.r - 1, 1 - 2 * c.b, 2 * c.g - 1};
            ASSERT_LE(length(shown - d), 2 * slack) << azimuth << ' ' << height;
        }
}

// LEGACY.md section 4, with its numbers written out.
TEST(LegacyHemisphere, picksTheTexelOfTheFormula) {
    const Vec3 center{50, 50, 0};
    const double radius = std::sqrt(50.0 * 50 + 50.0 * 50 + 100.0 * 100);
    const std::array<std::uint32_t, 2> size{512, 256};
    for (const auto& direction : {Vec3{0.3, 0.8, 0.1}, {-0.5, 0.2, 0.7}, {0.1, -0.9, -0.4}}) {
        geometry::Ray ray;
        ray.origin = {62, 30, 41};
        ray.direction = unit(direction);
        const Vec3 c = center - ray.origin;
        const double along = dot(ray.direction, c);
        const double t = along + std::sqrt(radius * radius - dot(c, c) + along * along);
        const Vec3 n = ray.origin + t * ray.direction;
        const auto column =
            static_cast<std::uint32_t>(511 * (1 + std::atan2(-n.x, n.y) / 3.1415926) / 2);
        const auto row = static_cast<std::uint32_t>(255 * (1 - std::fabs(n.z) / length(n)));
        EXPECT_EQ(legacyTexel(ray, center, radius, size), (std::array{column, row}));
        ray.origin += ray.direction * 17.0; // the line decides, not where the ray starts on it
        EXPECT_EQ(legacyTexel(ray, center, radius, size), (std::array{column, row}));
    }
}

TEST(LegacyHemisphere, straightUpIsTheMiddleOfTheBottomRow) {
    geometry::Ray ray;
    ray.origin = {0, 0, 5};
    ray.direction = {0, 0, 1};
    EXPECT_EQ(legacyTexel(ray, {0, 0, 0}, 100, {512, 256}),
              (std::array<std::uint32_t, 2>{255, 255}));
}

TEST(LegacyHemisphere, staysInThePictureWhenTheSphereIsMissed) {
    geometry::Ray ray;
    ray.origin = {1e9, 0, 0};
    ray.direction = {0, -1, 0};
    const auto texel = legacyTexel(ray, {50, 50, 0}, 1, {512, 256});
    EXPECT_LT(texel[0], 512u);
    EXPECT_LT(texel[1], 256u);
}

struct InScene : testing::Test {
    SceneMaker scene;
    void use(const material::Texture& texture, scene::Mapping mapping) {
        scene.world.textures.push_back(std::make_shared<const material::Texture>(texture));
        scene.description.background.texture =
            static_cast<std::uint32_t>(scene.world.textures.size() - 1);
        scene.description.background.mapping = mapping;
    }
};

TEST_F(InScene, textureIsLookedUpInTheMiddleOfTheLegacyTexel) {
    use(texelTexture(512, 256), scene::Mapping::legacyHemisphere);
    scene.description.background.center = {50, 50, 0};
    scene.description.background.radius = 130;
    for (const auto& direction : {Vec3{0.3, 0.8, 0.1}, {-0.5, 0.2, 0.7}, {0.1, -0.9, -0.4}}) {
        scene.description.image.tone = scene::Tone::limit;
        geometry::Ray ray;
        ray.origin = {62, 30, 41};
        ray.direction = unit(direction);
        const auto texel = legacyTexel(ray, {50, 50, 0}, 130, {512, 256});
        const LinearRgb seen = scene.along(ray.origin, direction);
        const double scale = std::max(1.0, std::max(texel[0], texel[1]) / 256.0); // tone: limit
        EXPECT_NEAR(seen.r, texel[0] / 256.0 / scale, tolerance::roundings(8));
        EXPECT_NEAR(seen.g, texel[1] / 256.0 / scale, tolerance::roundings(8));
        EXPECT_LE(seen.b, 1.0 / 1024);
    }
}

TEST_F(InScene, isTheSameAtAnyDepth) {
    use(uvTexture(), scene::Mapping::latLong);
    const LinearRgb direct = scene.along({0, 0, 0}, {0.6, 0, 0.8});
    scene.parallelogram({-9, 5, -9}, {18, 0, 0}, {0, 0, 18}, scene.add(mirror()));
    const LinearRgb mirrored = scene.along({0, 0, 0}, {0.6, 1, 0.8});
    const Vec2 expected = latLongUv(unit({0.6, -1, 0.8}));
    EXPECT_NEAR(mirrored.r, expected.x, tolerance::roundings(16));
    EXPECT_NEAR(mirrored.g, expected.y, tolerance::roundings(16));
    EXPECT_NEAR(direct.r, 0.75, tolerance::roundings(16));
}

TEST_F(InScene, fadesBetweenTwoTextures) {
    use(uvTexture(), scene::Mapping::latLong);
    use(texelTexture(1, 1), scene::Mapping::latLong); // red and green 0
    scene.description.background.texture = 0;
    scene.description.background.fade = scene::Background::Fade{1, 0.25};
    const LinearRgb seen = scene.along({0, 0, 0}, {1, 0, 0});
    EXPECT_NEAR(seen.r, 0.75 * 0.75, tolerance::roundings(16));
    EXPECT_NEAR(seen.g, 0.75 * 0.5, tolerance::roundings(16));
}

} // namespace
} // namespace rt::trace
