// antialias: {max_error}: more samples for less error, and the same again. tests/stability holds it to its promise.
#include <tests/trace/adaptive_scenes.hpp>

#include <gtest/gtest.h>

namespace rt::trace {
namespace {

void frame(SceneMaker& scene, std::uint32_t width, std::uint32_t height) {
    scene::Description& d = scene.description;
    d.image.width = width, d.image.height = height;
    d.image.tone = scene::Tone::limit;
    d.background.color = {0.3, 0.45, 0.7};
    d.render.depth = 5;
    scene.look({0, -6, 2}, {0, 6, -1.5});
    d.camera.screenDistance = 1.1;
    scene.light({-4, -6, 8}, {0.9, 0.9, 0.8});
    scene.light({5, -2, 5}, {0.3, 0.3, 0.5});
}

TEST(Adaptive, smallErrorsTakeMoreSamplesThanLargeOnes) {
    SceneMaker scene;
    frame(scene, 64, 48);
    scenesThatAreHardToSample()[0].make(scene);
    std::uint64_t last = 0;
    for (const double error : {0.5, 0.02, 0.005}) {
        scene.description.render.antialias = scene::AntialiasMaxError{error};
        const std::uint64_t samples = scene.render().counts.primary;
        EXPECT_GT(samples, last);
        last = samples;
    }
}

TEST(Adaptive, oneSampleIsTheMiddleOfThePixel) {
    SceneMaker scene;
    frame(scene, 64, 48);
    scenesThatAreHardToSample()[0].make(scene);
    scene.description.render.antialias = scene::AntialiasMaxError{10};
    const Result one = scene.render();
    EXPECT_EQ(one.counts.primary, 64u * 48u);
    scene.description.render.antialias = scene::AntialiasNone{};
    EXPECT_EQ(one.frame.pixels, scene.render().frame.pixels);
}

TEST(Adaptive, aTimeBudgetEndsWithAnErrorThatRepeatsTheBytes) {
    SceneMaker scene;
    frame(scene, 64, 48);
    scenesThatAreHardToSample()[6].make(scene);
    Options options;
    options.timeBudget = 0.05;
    scene.description.render.antialias = scene::AntialiasMaxError{0};
    const Result timed = scene.render(options);
    ASSERT_TRUE(timed.estimatedError);
    scene.description.render.antialias = scene::AntialiasMaxError{*timed.estimatedError};
    const Result again = scene.render();
    EXPECT_EQ(*again.estimatedError, *timed.estimatedError);
    EXPECT_EQ(again.counts.primary, timed.counts.primary);
    EXPECT_EQ(again.frame.pixels, timed.frame.pixels);
}

TEST(Adaptive, anEmptySceneIsExactWithOneSample) {
    SceneMaker scene;
    scene.description.render.antialias = scene::AntialiasMaxError{0};
    const Result result = scene.render();
    EXPECT_EQ(*result.estimatedError, 0);
    EXPECT_EQ(result.counts.primary, 32u * 24u);
}

} // namespace
} // namespace rt::trace
