// The terms of the illumination model, each against its formula.
#include <core/numeric/elementary.hpp>
#include <tests/tolerance.hpp>
#include <tests/trace/scene_maker.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rt::trace {
namespace {

void expectNear(const LinearRgb& seen, const LinearRgb& expected) {
    const double slack = tolerance::roundings(64) * (1 + expected.maxComponent());
    EXPECT_NEAR(seen.r, expected.r, slack);
    EXPECT_NEAR(seen.g, expected.g, slack);
    EXPECT_NEAR(seen.b, expected.b, slack);
}

/// A floor at z = 0 seen from (0, -3, 4): the ray arrives at the origin with cosine 4/5.
struct Floor : testing::Test {
    SceneMaker scene;
    const Vec3 eye{0, -3, 4};

    void put(const Material& material) {
        scene.parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, scene.add(material));
    }
    LinearRgb seen() { return scene.along(eye, -eye); }
};

Material plastic() {
    Material m;
    m.color = {0.5, 0.25, 1};
    m.diffuse = {0.5, 0.75, 0.25};
    m.specular = {0, 0, 0};
    m.environment = {0.0625, 0.125, 0.03125};
    return m;
}

TEST_F(Floor, isDiffuseAndEnvironmentTimesTheLight) {
    put(plastic());
    scene.light({4, 0, 3}, {0.5, 0.25, 0.125}); // cosine 3/5, no falloff
    expectNear(seen(), {0.5 * (0.5 * 0.5 * 0.6 + 0.0625), 0.25 * (0.25 * 0.75 * 0.6 + 0.125),
                        0.125 * (1 * 0.25 * 0.6 + 0.03125)});
}

TEST_F(Floor, addsTheLightsUp) {
    put(plastic());
    scene.light({4, 0, 3}, {0.5, 0.25, 0.125});
    const LinearRgb first = seen();
    scene.description.lights.clear();
    scene.light({0, 0, 7}, {0.25, 0.25, 0.25});
    const LinearRgb second = seen();
    scene.light({4, 0, 3}, {0.5, 0.25, 0.125});
    expectNear(seen(), first + second);
}

TEST_F(Floor, brightnessMultipliesTheLight) {
    put(plastic());
    scene.light({0, 0, 7}, {0.25, 0.25, 0.25});
    const LinearRgb dim = seen();
    scene.description.lights[0].brightness = 2;
    expectNear(seen(), dim * 2);
}

TEST_F(Floor, highlightIsHalfwayBlinnPhongAndNotColored) {
    Material m;
    m.color = {0, 0, 0}; // neither highlight nor environment is multiplied by it
    m.specular = {0.5, 0.25, 0.125};
    m.environment = {0.125, 0.25, 0.5};
    m.shininess = 7.5;
    put(m);
    scene.light({0, 4, 3}); // L = (0, .8, .6), to the eye (0, -.6, .8)
    const Vec3 halfway = normalize(Vec3{0, 0.8, 0.6} + Vec3{0, -0.6, 0.8});
    const double highlight = numeric::pow(halfway.z, 7.5);
    expectNear(seen(), {0.5 * highlight + 0.125, 0.25 * highlight + 0.25, 0.125 * highlight + 0.5});
}

TEST_F(Floor, asksForNoLightThatOnlyAHighlightBelowRoundingWouldShow) {
    // H.N = 1.4 / sqrt 2; to the power 3636.9 it is 2^-53.
    for (const double shininess : {3636, 3638}) {
        SceneMaker mirrors;
        Material m;
        m.diffuse = {0, 0, 0};
        m.specular = {1, 1, 1};
        m.shininess = shininess;
        mirrors.parallelogram({-10, -10, 0}, {20, 0, 0}, {0, 20, 0}, mirrors.add(m));
        mirrors.light({0, 4, 3});
        const double seen = mirrors.along(eye, -eye).g;
        const bool isAsked = shininess == 3636;
        EXPECT_EQ(seen > 0, isAsked) << seen;
        EXPECT_LT(seen, 0x1p-52);
        EXPECT_EQ(mirrors.render().counts.shadow, isAsked ? 1u : 0u);
    }
}

TEST_F(Floor, isLitOnlyOnTheSideThatIsSeen) {
    put(plastic());
    scene.light({0, 0, -5});
    EXPECT_EQ(seen(), (LinearRgb{0, 0, 0}));
}

TEST_F(Floor, lightsItsUndersideToo) {
    put(plastic());
    scene.light({4, 0, 3});
    const LinearRgb above = seen();
    scene.description.lights[0].position.z = -3;
    expectNear(scene.along({0, -3, -4}, {0, 3, 4}), above);
}

TEST_F(Floor, withoutAVisibleLightIsBlack) {
    put(plastic());
    EXPECT_EQ(seen(), (LinearRgb{0, 0, 0}));
    scene.light({0, 0, 5}, {0, 0, 0});
    EXPECT_EQ(seen(), (LinearRgb{0, 0, 0}));
}

TEST_F(Floor, aLightOnThePointItselfAddsNothing) { // STABILITY.md C4
    put(plastic());
    scene.light({0, 0, 0});
    EXPECT_EQ(seen(), (LinearRgb{0, 0, 0}));
}

TEST_F(Floor, textureMultipliesColor) {
    Material m = matte({0.5, 0.5, 0.5});
    auto texture = uvTexture();
    m.colorTexture = &texture;
    put(m);
    scene.light({0, 0, 5});
    expectNear(seen(), {0.25, 0.25, 0});
}

TEST_F(Floor, mirrorsWithColorTimesSpecular) {
    Material m = mirror(0.5);
    m.color = {1, 0.5, 0.25};
    put(m);
    scene.description.background.color = {0.25, 0.5, 1};
    EXPECT_EQ(seen(), (LinearRgb{0.125, 0.125, 0.125}));
}

// ---- shadows ---------------------------------------------------------------------------------

TEST_F(Floor, opaqueThingsBlockTheLight) {
    put(matte({1, 1, 1}));
    scene.light({0, 0, 8});
    expectNear(seen(), {1, 1, 1});
    scene.sphere({0, 0, 6}, 0.5, scene.add(matte({1, 1, 1})));
    EXPECT_EQ(seen(), (LinearRgb{0, 0, 0}));
}

TEST_F(Floor, nothingBeyondTheLightBlocksIt) {
    put(matte({1, 1, 1}));
    scene.light({0, 0, 8});
    scene.parallelogram({-10, -10, 9}, {20, 0, 0}, {0, 20, 0}, scene.add(matte({1, 1, 1})));
    expectNear(seen(), {1, 1, 1});
}

TEST_F(Floor, coloredGlassAttenuatesAtEveryCrossing) {
    put(matte({1, 1, 1}));
    scene.light({0, 0, 8});
    const LinearRgb tint{0.5, 0.25, 0.75};
    const auto sheet = scene.add(clear(1.5, tint));
    scene.parallelogram({-1, -1, 7}, {2, 0, 0}, {0, 2, 0}, sheet); // once
    expectNear(seen(), tint);
    scene.sphere({0, 0, 6}, 0.5, sheet); // twice
    expectNear(seen(), tint * tint * tint);
    scene.box({-1, -1, 4.5}, {1, 1, 5}, sheet); // twice: (0, 0) is on the diagonals of its sides
    expectNear(seen(), tint * tint * tint * tint * tint);
}

TEST_F(Floor, shadowsOfGlassDoNotDependOnItsColorAndIndex) {
    put(matte({1, 1, 1}));
    scene.light({0, 0, 8});
    Material dark = clear(3, {0.5, 0.5, 0.5});
    dark.color = {0.1, 0.2, 0.3};
    scene.sphere({0, 0, 6}, 0.5, scene.add(dark));
    expectNear(seen(), {0.25, 0.25, 0.25});
}

TEST_F(Floor, lightFromBehindASheetComesThroughTheSheet) {
    Material sheet = clear(1, {0.5, 0.25, 0.125});
    sheet.color = {0, 0, 0}; // no view through it
    sheet.environment = {1, 1, 1};
    sheet.diffuse = {1, 1, 1};
    put(sheet);
    scene.light({0, 0, -5});
    expectNear(seen(), {0.5, 0.25, 0.125});
}

} // namespace
} // namespace rt::trace
