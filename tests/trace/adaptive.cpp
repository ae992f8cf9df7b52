// antialias: {max_error}: the promise, what it costs, and that it can be repeated.
#include <tests/trace/adaptive_scenes.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace rt::trace {
namespace {

double rootMeanSquare(const image::Framebuffer& a, const image::Framebuffer& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        const LinearRgb &p = a.pixels[i], &q = b.pixels[i];
        sum += (p.r - q.r) * (p.r - q.r) + (p.g - q.g) * (p.g - q.g) + (p.b - q.b) * (p.b - q.b);
    }
    return std::sqrt(sum / static_cast<double>(3 * a.pixels.size()));
}

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

image::Framebuffer gridOf(SceneMaker& scene, std::uint32_t n) {
    scene.description.render.antialias = scene::AntialiasGrid{n};
    return scene.render().frame;
}

// Issue 6: the true error is at most the asked one in 95 % of the pairs. The reference is a grid, none
// of whose points is one of those tested; on even sizes it has none in the middle of a pixel.
TEST(Adaptive, keepsItsPromise) {
    const bool study = std::getenv("RT_ADAPTIVE_STUDY") != nullptr;
    const std::vector<double> errors =
        study ? std::vector{0.05, 0.02, 0.01} : std::vector{0.05, 0.02};
    int kept = 0, pairs = 0;
    std::vector<double> shares;
    for (const NamedScene& named : scenesThatAreHardToSample()) {
        SceneMaker scene;
        frame(scene, study ? 160 : 64, study ? 120 : 48);
        named.make(scene);
        if (!study) // fewer pixels, but of the same size
            scene.description.camera.screenWidth *= 0.4,
                scene.description.camera.screenHeight *= 0.4;
        const image::Framebuffer reference = gridOf(scene, study ? 28 : 14);
        std::vector<double> gridErrors{1e9};
        for (const double error : errors) {
            scene.description.render.antialias = scene::AntialiasMaxError{error};
            const Result result = scene.render();
            const double truth = rootMeanSquare(result.frame, reference);
            ASSERT_TRUE(result.estimatedError);
            EXPECT_LE(*result.estimatedError, error);
            ++pairs;
            kept += truth <= error;
            if (truth > error)
                std::printf("missed: %s asked %.3f, true %.4f\n", named.name.c_str(), error, truth);
            if (!study) continue;
            while (gridErrors.back() > error && gridErrors.size() < 20)
                gridErrors.push_back(rootMeanSquare(
                    gridOf(scene, static_cast<std::uint32_t>(gridErrors.size())), reference));
            const auto enough = std::find_if(gridErrors.begin(), gridErrors.end(),
                                             [&](double e) { return e <= error; });
            const auto n = static_cast<double>(enough - gridErrors.begin());
            const double perPixel =
                static_cast<double>(result.counts.primary) / static_cast<double>(160 * 120);
            shares.push_back(perPixel / (n * n));
            std::printf("%-24s asked %.2f estimated %.4f true %.4f, %.2f per pixel, grid %.0f, "
                        "share %.2f\n",
                        named.name.c_str(), error, *result.estimatedError, truth, perPixel, n,
                        shares.back());
        }
    }
    EXPECT_GE(kept, std::ceil(0.95 * pairs)) << "of " << pairs;
    if (study) {
        std::sort(shares.begin(), shares.end());
        std::printf("kept %d of %d, median share of the grid's samples %.2f\n", kept, pairs,
                    shares[shares.size() / 2]);
    }
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
