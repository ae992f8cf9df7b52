// Whole pictures: sampling, tone, smoothing, bounds, near plane, threads, crops, shade modes.
#include <core/trace/ray_tree.hpp>
#include <core/trace/smooth.hpp>
#include <core/trace/tiles.hpp>
#include <core/trace/tone.hpp>
#include <tests/tolerance.hpp>
#include <tests/trace/scene_maker.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

namespace rt::trace {
namespace {

bool sameBytes(const image::Framebuffer& a, const image::Framebuffer& b) {
    return a.width == b.width && a.height == b.height &&
           std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(a.pixels[0])) ==
               0;
}

/// Something of everything: glass, mirror, textures, meshes, two lights.
SceneMaker variedScene() {
    static const material::Texture texture = uvTexture();
    SceneMaker scene;
    scene.description.image.width = 53, scene.description.image.height = 37;
    scene.description.background.color = {0.2, 0.3, 0.6};
    Material floor = matte({0.8, 0.9, 0.7});
    floor.colorTexture = &texture;
    floor.specular = {0.2, 0.2, 0.2};
    Material shiny = matte({0.9, 0.3, 0.2});
    shiny.specular = {0.4, 0.4, 0.4};
    shiny.environment = {0.1, 0.1, 0.1};
    scene.parallelogram({-9, 0, -1}, {18, 0, 0}, {0, 18, 0}, scene.add(floor));
    scene.sphere({-1, 5, 0}, 1, scene.add(shiny));
    scene.sphere({1, 4, -0.3}, 0.7, scene.add(clear(1.5, {0.9, 0.8, 0.9})));
    scene.box({0.6, 6, -1}, {2, 7, 1}, scene.add(mirror(0.9)));
    scene.icosphere({-0.3, 3, -0.6}, 0.4, 2, true, scene.add(shiny));
    scene.light({-4, 0, 6}, {0.9, 0.9, 0.8});
    scene.light({5, 2, 3}, {0.3, 0.3, 0.6});
    scene.description.image.tone = scene::Tone::limit;
    return scene;
}

TEST(Picture, hasTheSameBytesForAnyNumberOfThreads) {
    SceneMaker scene = variedScene();
    for (const scene::Antialias& antialias :
         {scene::Antialias{scene::AntialiasNone{}}, scene::Antialias{scene::AntialiasGrid{3}},
          scene::Antialias{scene::AntialiasMaxError{0.02}}}) {
        scene.description.render.antialias = antialias;
        Options options;
        options.threads = 1;
        options.count = true;
        const Result one = scene.render(options);
        for (const int threads : {2, 7}) {
            options.threads = threads;
            const Result many = scene.render(options);
            EXPECT_TRUE(sameBytes(one.frame, many.frame));
            EXPECT_EQ(one.counts.shadow, many.counts.shadow);
            EXPECT_EQ(one.counts.lostByDepth, many.counts.lostByDepth);
            EXPECT_EQ(one.counts.visits.nodes, many.counts.visits.nodes);
            EXPECT_EQ(one.estimatedError, many.estimatedError);
        }
    }
}

TEST(Picture, countingChangesNoPixel) {
    SceneMaker scene = variedScene();
    Options counting;
    counting.count = true;
    const Result counted = scene.render(counting), plain = scene.render();
    EXPECT_TRUE(sameBytes(counted.frame, plain.frame));
    EXPECT_GT(counted.counts.visits.nodes, 0u);
    EXPECT_EQ(plain.counts.visits.nodes, 0u);
    EXPECT_EQ(plain.counts.primary, 53u * 37u);
    EXPECT_EQ(plain.counts.notFinite, 0u);
}

TEST(Picture, cropHasTheBytesOfTheWhole) {
    SceneMaker scene = variedScene();
    scene.description.render.smooth = true;
    const image::Framebuffer whole = scene.render().frame;
    Options options;
    options.crop = {{7, 5, 40, 29}};
    const Result cropped = scene.render(options);
    EXPECT_EQ(cropped.counts.primary, 34u * 25u); // one more column and row for the neighbours
    for (std::uint32_t y = 0; y < whole.height; ++y)
        for (std::uint32_t x = 0; x < whole.width; ++x) {
            const bool inside = x >= 7 && x < 40 && y >= 5 && y < 29;
            ASSERT_EQ(cropped.frame.at(x, y), inside ? whole.at(x, y) : LinearRgb{})
                << x << ' ' << y;
        }
    options.crop = {{60, 0, 70, 10}};
    EXPECT_EQ(scene.render(options).counts.primary, 0u);
}

TEST(Picture, fsaa4IsTheBoxAverageOfTwiceTheSize) {
    for (const scene::Sampling sampling : {scene::Sampling::center, scene::Sampling::corner})
        for (const scene::Tone tone : {scene::Tone::limit, scene::Tone::clamp}) {
            SceneMaker scene = variedScene();
            scene.description.render.sampling = sampling;
            scene.description.image.tone = tone;
            scene.description.lights[0].brightness = 4; // so that tone has work to do
            scene.description.render.antialias = scene::AntialiasFsaa4{};
            const image::Framebuffer averaged = scene.render().frame;
            scene.description.render.antialias = scene::AntialiasNone{};
            scene.description.image.width *= 2, scene.description.image.height *= 2;
            const image::Framebuffer large = scene.render().frame;
            for (std::uint32_t y = 0; y < averaged.height; ++y)
                for (std::uint32_t x = 0; x < averaged.width; ++x)
                    ASSERT_EQ(averaged.at(x, y),
                              (large.at(2 * x, 2 * y) + large.at(2 * x + 1, 2 * y) +
                               large.at(2 * x, 2 * y + 1) + large.at(2 * x + 1, 2 * y + 1)) *
                                  0.25);
        }
}

TEST(Picture, cornerSamplesSitOnTheTopLeftCorner) {
    SceneMaker scene = variedScene();
    scene.description.image.width = 54, scene.description.image.height = 38;
    scene.description.render.sampling = scene::Sampling::corner;
    const RayTree tree = tracePixel(scene.octree(), scene.world, scene.description, 27, 19);
    EXPECT_EQ(tree.nodes[0].direction, Vec3(0, 1, 0)); // the optical axis is pixel (W/2, H/2)
}

TEST(Picture, toneKeepsHueOrCutsAndNeverLifts) {
    EXPECT_EQ(toned({2, 1, -0.5}, scene::Tone::limit), (LinearRgb{1, 0.5, -0.25}));
    EXPECT_EQ(toned({2, 1, -0.5}, scene::Tone::clamp), (LinearRgb{1, 1, -0.5}));
    for (const scene::Tone tone : {scene::Tone::limit, scene::Tone::clamp})
        EXPECT_EQ(toned({1, 0.5, -2}, tone), (LinearRgb{1, 0.5, -2}));
}

TEST(Picture, smoothIsTheMeanOfSelfRightBelowAndBelowRight) {
    image::Framebuffer frame(3, 2);
    const double values[] = {1, 2, 4, 8, 16, 32};
    for (std::size_t i = 0; i < 6; ++i) frame.pixels[i] = LinearRgb::grey(values[i]);
    smooth(frame);
    const double expected[] = {(1 + 2 + 8 + 16) / 4.0, (2 + 4 + 16 + 32) / 4.0, (4 + 32) / 2.0,
                               (8 + 16) / 2.0,         (16 + 32) / 2.0,         32};
    for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(frame.pixels[i].r, expected[i]) << i;
}

TEST(Picture, smoothComesAfterAntialiasing) {
    SceneMaker scene = variedScene();
    scene.description.render.antialias = scene::AntialiasFsaa4{};
    image::Framebuffer expected = scene.render().frame;
    smooth(expected);
    scene.description.render.smooth = true;
    EXPECT_TRUE(sameBytes(scene.render().frame, expected));
}

TEST(Picture, depthIsTheNumberOfBouncesAfterThePrimaryRay) {
    // Two mirrors face each other; the light comes from a background that is never reached.
    SceneMaker scene;
    Material half = mirror(0.5);
    half.environment = {0.25, 0.25, 0.25};
    const auto material = scene.add(half);
    scene.parallelogram({-9, 1, -9}, {18, 0, 0}, {0, 0, 18}, material);
    scene.parallelogram({-9, -1, -9}, {18, 0, 0}, {0, 0, 18}, material);
    scene.light({0.5, 0.25, 3});
    for (const std::uint32_t depth : {0u, 1u, 2u, 5u, 100'000u}) {
        scene.description.render.depth = depth;
        double expected = 0;
        const double per = 0.25;
        const LinearRgb seen = scene.along({0, 0, 0}, {0, 1, 0});
        // Highlights do not reach: shininess 20 still leaves some, so compare with the tree's sums.
        const RayTree tree = tracePixel(scene.octree(), scene.world, scene.description, 0, 0);
        for (const auto& node : tree.nodes) expected += node.weight.r * node.local.r;
        EXPECT_NEAR(seen.r, expected, tolerance::roundings(64));
        EXPECT_GE(seen.r, per * (depth ? 1.5 : 1) - tolerance::roundings(64));
        std::size_t traced = 0;
        for (const auto& node : tree.nodes) traced += node.fate == RayTree::Fate::traced;
        EXPECT_EQ(traced, depth == 100'000u ? 1075u : depth + 1); // 0.5^1075 rounds to 0
    }
}

TEST(Picture, cutoffSkipsWhatCanAddLess) {
    SceneMaker scene;
    const auto material = scene.add(mirror(0.5));
    scene.parallelogram({-9, 1, -9}, {18, 0, 0}, {0, 0, 18}, material);
    scene.parallelogram({-9, -1, -9}, {18, 0, 0}, {0, 0, 18}, material);
    scene.description.render.depth = 50;
    scene.description.render.cutoff = 0.125;
    scene.along({0, 0, 0}, {0, 1, 0});
    const Result result = scene.render();
    EXPECT_EQ(result.counts.reflected, 3u); // 1/2, 1/4, 1/8
    EXPECT_EQ(result.counts.cutByContribution, 1u);
    EXPECT_EQ(result.counts.cutByDepth, 0u);
}

TEST(Picture, nearPlaneHidesWhatIsBeforeTheScreen) {
    SceneMaker scene;
    scene.description.background.color = {0, 0, 1};
    scene.light({0, -5, 0});
    scene.sphere({0, 2, 0}, 0.5, scene.add(flatColored({1, 0, 0})));
    scene.description.camera.screenDistance = 3;
    scene.description.camera.screenWidth = scene.description.camera.screenHeight = 1;
    EXPECT_EQ(scene.along({0, 0, 0}, {0, 1, 0}), (LinearRgb{1, 0, 0}));
    scene.description.render.nearPlane = scene::NearPlane::screen;
    EXPECT_EQ(scene.along({0, 0, 0}, {0, 1, 0}), (LinearRgb{0, 0, 1}));
}

// The middle pixel of legacy/cases/s5_defaults: the original sees the background there.
TEST(Picture, aTangentRayPassesTheBall) {
    SceneMaker scene;
    scene.description.background.color = {0, 0, 1};
    scene.sphere({42, 50, 50}, 8, scene.add(flatColored({1, 0, 0})));
    scene.light({50, 0.5, 99});
    EXPECT_EQ(scene.along({50, 10, 50}, {0, 1, 0}), (LinearRgb{0, 0, 1}));
}

// ---- bounds ----------------------------------------------------------------------------------

struct Bounds : testing::Test {
    SceneMaker scene;
    const LinearRgb red{1, 0, 0}, blue{0, 0, 1}, black{0, 0, 0};

    Bounds() {
        scene.description.background.color = blue;
        scene.description.bounds = numeric::Box3d{{0, 0, 0}, {10, 10, 10}};
        scene.light({5, 5, 5});
    }
    void wall(double y) {
        scene.parallelogram({-90, y, -90}, {180, 0, 0}, {0, 0, 180}, scene.add(flatColored(red)));
    }
};

TEST_F(Bounds, rayThatNeverEntersIsBlack) {
    EXPECT_EQ(scene.along({5, -5, 5}, {0, -1, 0}), black);
    EXPECT_EQ(scene.along({5, -5, 5}, {1, 0, 0}), black);
    EXPECT_EQ(scene.along({5, -5, 20}, {0, 1, 0}), black);
    EXPECT_EQ(scene.along({5, -5, 5}, {0, 1, 0}), blue);
    EXPECT_EQ(scene.along({5, 5, 5}, {0, 1, 0}), blue);
}

TEST_F(Bounds, nothingBeforeTheEntryIsSeen) {
    wall(-2);
    EXPECT_EQ(scene.along({5, -5, 5}, {0, 1, 0}), blue);
}

TEST_F(Bounds, nothingBeyondTheExitIsSeen) {
    wall(11);
    EXPECT_EQ(scene.along({5, -5, 5}, {0, 1, 0}), blue);
}

TEST_F(Bounds, surfacesInTheFacesAreSeen) {
    for (const double y : {0.0, 10.0}) {
        scene.description.lights[0].position.y = y - 5; // on the side of the viewer
        wall(y);
        for (double x = 0.01; x < 10; x += 0.37)
            ASSERT_EQ(scene.along({5 + x / 30, -5 - x * 100, 5},
                                  Vec3{x, 5 + x * 100 + y, 7} - Vec3{5 + x / 30, 0, 5}),
                      red)
                << x << ' ' << y;
        scene.world.primitives = {};
    }
}

TEST_F(Bounds, onlyWhatIsInsideCastsShadows) {
    scene.description.lights[0].position = {5, 5, 30}; // outside, and works
    scene.parallelogram({0, 0, 1}, {10, 0, 0}, {0, 10, 0}, scene.add(flatColored(red)));
    const auto blocker = scene.add(matte({1, 1, 1}));
    scene.sphere({5, 5, 20}, 3, blocker);
    EXPECT_EQ(scene.along({5, 1, 6}, {0, 4, -5}), red);
    scene.sphere({5, 5, 9}, 0.5, blocker);
    EXPECT_EQ(scene.along({5, 1, 6}, {0, 4, -5}), black);
}

// ---- what must not happen --------------------------------------------------------------------

void notANumber(const void*, const rt_surface_point*, std::uint32_t count, double* rgb) {
    for (std::uint32_t i = 0; i < 3 * count; ++i) rgb[i] = std::numeric_limits<double>::quiet_NaN();
}

TEST(Picture, noNaNReachesIt) {
    const rt_texture_type type{
        sizeof(rt_texture_type), 0, nullptr, nullptr, notANumber, nullptr, nullptr};
    const material::Texture texture{&type, nullptr};
    SceneMaker scene;
    Material m = matte({1, 1, 1});
    m.colorTexture = &texture;
    scene.sphere({0, 3, 0}, 1, scene.add(m));
    scene.light({0, 0, 0});
    const Result result = scene.render();
    EXPECT_GT(result.counts.notFinite, 0u);
    for (const LinearRgb& p : result.frame.pixels) EXPECT_TRUE(std::isfinite(p.r + p.g + p.b));
}

TEST(Picture, stopsWhenToldAndSaysSo) {
    SceneMaker scene = variedScene();
    const std::atomic<bool> stop = true;
    Options options;
    options.stop = &stop;
    for (const scene::Antialias& antialias : {scene::Antialias{scene::AntialiasNone{}},
                                              scene::Antialias{scene::AntialiasMaxError{0.1}}}) {
        scene.description.render.antialias = antialias;
        const Result result = scene.render(options);
        EXPECT_FALSE(result.complete);
        EXPECT_EQ(result.counts.primary, 0u);
    }
}

TEST(Picture, reportsProgressInOrderUpToOne) {
    SceneMaker scene = variedScene();
    Options options;
    options.threads = 1;
    for (const scene::Antialias& antialias : {scene::Antialias{scene::AntialiasNone{}},
                                              scene::Antialias{scene::AntialiasMaxError{0.02}}}) {
        scene.description.render.antialias = antialias;
        double last = 0;
        options.progress = [&](double share) {
            EXPECT_GE(share, last);
            last = share;
        };
        scene.render(options);
        EXPECT_EQ(last, 1);
    }
}

TEST(Tiles, coverTheRegionOnce) {
    const Region region{3, 5, 70, 42};
    const Tiles tiles(region);
    std::vector<int> covered(100 * 100);
    for (std::size_t i = 0; i < tiles.count(); ++i)
        for (std::uint32_t y = tiles[i].y0; y < tiles[i].y1; ++y)
            for (std::uint32_t x = tiles[i].x0; x < tiles[i].x1; ++x) ++covered[y * 100 + x];
    for (std::uint32_t y = 0; y < 100; ++y)
        for (std::uint32_t x = 0; x < 100; ++x)
            ASSERT_EQ(covered[y * 100 + x], x >= 3 && x < 70 && y >= 5 && y < 42);
}

// ---- shade modes -----------------------------------------------------------------------------

TEST(Shade, normalsDepthIdAndCost) {
    SceneMaker scene;
    scene.description.image.width = scene.description.image.height = 3;
    scene.description.camera.screenWidth = 1;
    scene.sphere({0, 3, 0}, 1, scene.add(matte({1, 1, 1})));
    scene.light({0, 0, 0});
    Options options;
    options.shade = Shade::normals;
    EXPECT_EQ(scene.render(options).frame.at(1, 1), (LinearRgb{0.5, 0, 0.5}));
    EXPECT_EQ(scene.render(options).frame.at(0, 0), (LinearRgb{0, 0, 0}));
    options.shade = Shade::depth;
    EXPECT_EQ(scene.render(options).frame.at(1, 1), LinearRgb::grey(2));
    options.shade = Shade::id;
    const LinearRgb id = scene.render(options).frame.at(1, 1);
    EXPECT_FALSE(id.isBlack());
    scene.sphere({0, 1.5, 0}, 0.25, MaterialId{0});
    EXPECT_NE(scene.render(options).frame.at(1, 1), id);
    options.shade = Shade::cost;
    const image::Framebuffer cost = scene.render(options).frame;
    EXPECT_GT(cost.at(1, 1).r, cost.at(0, 0).r);
    EXPECT_GE(cost.at(1, 1).r, 2); // the ray, and its shadow ray
    image::Framebuffer shown = cost;
    scaleForDisplay(shown, Shade::cost);
    EXPECT_EQ(shown.at(1, 1).r, 1);
    EXPECT_LT(shown.at(0, 0).r, 1);
}

// ---- one pixel taken apart -------------------------------------------------------------------

TEST(RayTree, addsUpToThePixel) {
    SceneMaker scene = variedScene();
    scene.description.render.antialias = scene::AntialiasFsaa4{};
    const image::Framebuffer frame = scene.render().frame;
    for (std::uint32_t y = 0; y < frame.height; y += 5)
        for (std::uint32_t x = 0; x < frame.width; x += 5) {
            const RayTree tree = tracePixel(scene.octree(), scene.world, scene.description, x, y);
            ASSERT_EQ(tree.pixel, frame.at(x, y));
            ASSERT_EQ(tree.samples.size(), 4u);
            for (const auto& sample : tree.samples) {
                const auto& root = tree.nodes[*sample.root];
                EXPECT_NEAR(root.seen.g, sample.light.g, tolerance::roundings(1000));
                EXPECT_EQ(root.depth, 0u);
            }
            for (const auto& node : tree.nodes)
                for (const auto child : node.children)
                    EXPECT_EQ(tree.nodes[child].depth, node.depth + 1);
        }
}

TEST(RayTree, saysWhyRaysWereNotTraced) {
    SceneMaker scene;
    Material m = mirror(0.5);
    m.transmission = {0.001, 0, 0};
    scene.sphere({0, 3, 0}, 1, scene.add(m));
    scene.description.render.cutoff = 0.01;
    scene.description.render.depth = 0;
    scene.along({0, 0, 0}, {0, 1, 0});
    RayTree tree = tracePixel(scene.octree(), scene.world, scene.description, 0, 0);
    ASSERT_EQ(tree.nodes.size(), 3u);
    EXPECT_EQ(tree.nodes[1].fate, RayTree::Fate::cutByDepth);
    EXPECT_EQ(tree.nodes[2].fate, RayTree::Fate::cutByDepth);
    scene.description.render.depth = 1;
    tree = tracePixel(scene.octree(), scene.world, scene.description, 0, 0);
    EXPECT_EQ(tree.nodes[1].fate, RayTree::Fate::cutByContribution);
    EXPECT_EQ(tree.nodes[1].kind, RayTree::Kind::refracted);
    EXPECT_EQ(tree.nodes[2].fate, RayTree::Fate::traced);
}

} // namespace
} // namespace rt::trace
