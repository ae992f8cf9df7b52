// Refraction through the whole renderer: slabs, balls, nested and touching solids, furnaces.
#include <core/image/metrics.hpp>
#include <core/numeric/angle.hpp>
#include <core/trace/direction.hpp>
#include <core/trace/media.hpp>
#include <core/trace/ray_tree.hpp>
#include <tests/tolerance.hpp>
#include <tests/trace/scene_maker.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace rt::trace {
namespace {

double radians(double degrees) { return degrees * numeric::kRadiansPerDegree; }

/// The tree of the one ray from `from` along `direction`.
RayTree treeOf(SceneMaker& scene, const Vec3& from, const Vec3& direction) {
    scene.along(from, direction);
    return tracePixel(scene.octree(), scene.world, scene.description, 0, 0);
}

/// The chain of refracted rays from the first on.
std::vector<RayTree::Node> refractedChain(const RayTree& tree) {
    std::vector<RayTree::Node> chain{tree.nodes.at(*tree.samples.at(0).root)};
    for (bool found = true; found;) {
        found = false;
        for (const auto child : chain.back().children)
            if (tree.nodes[child].kind == RayTree::Kind::refracted &&
                tree.nodes[child].fate == RayTree::Fate::traced) {
                chain.push_back(tree.nodes[child]);
                found = true;
                break;
            }
    }
    return chain;
}

double angleBetween(const Vec3& a, const Vec3& b) {
    return std::atan2(length(cross(a, b)), dot(a, b));
}

/// A ray through a box, against a screen whose color is its position: where the ray lands says how
/// it was bent.
TEST(Glass, slabDisplacesTheRayAsComputedByHand) {
    for (const double degrees : {10.0, 30.0, 60.0, 80.0}) {
        const double angle = radians(degrees);
        SceneMaker scene;
        scene.box({-50, 2, -50}, {50, 3, 50}, scene.add(clear(1.5)));
        Material screen = matte({1, 1, 1});
        auto texture = uvTexture();
        screen.colorTexture = &texture;
        scene.parallelogram({-64, 5, -64}, {128, 0, 0}, {0, 0, 128}, scene.add(screen));
        scene.light({0, 4, 0});
        const LinearRgb seen = scene.along({0, 0, 0.3}, {std::sin(angle), std::cos(angle), 0});
        const double inside = std::asin(std::sin(angle) / 1.5);
        const double x = (2 + 2) * std::tan(angle) + std::tan(inside);
        const double cosine = 1 / std::sqrt(x * x + 0.3 * 0.3 + 1); // of the light on the screen
        EXPECT_NEAR(seen.r, (x + 64) / 128 * cosine, tolerance::kSlabChain) << degrees;
        EXPECT_NEAR(seen.g, (0.3 + 64) / 128 * cosine, tolerance::kSlabChain) << degrees;
    }
}

// STABILITY.md R2, through the octree, with gaps and without them.
TEST(Glass, aRayLeavesAThousandSlabsAsItCame) {
    for (const double gap : {0.5, 0.0}) {
        SceneMaker scene;
        const auto glass = scene.add(clear(1.5));
        for (int i = 0; i < 1000; ++i) {
            const double z = -1 - i * (1 + gap);
            scene.box({-1e4, -1e4, z - 1}, {1e4, 1e4, z}, glass);
        }
        scene.description.render.depth = 2001;
        scene.description.background.color = {0.5, 0.5, 0.5};
        const Vec3 in = unit({0.7, -0.2, -0.6});
        const auto chain = refractedChain(treeOf(scene, {-700, 100, 0}, in));
        ASSERT_EQ(chain.size(), gap > 0 ? 2001u : 1002u); // touching faces are crossed together
        EXPECT_LE(angleBetween(chain.back().direction, in), tolerance::kSlabChain);
        EXPECT_EQ(chain.back().local, (LinearRgb{0.5, 0.5, 0.5}));
        EXPECT_TRUE(chain.back().media.empty());
        for (const auto& node : chain) EXPECT_LE(node.media.size(), 1u);
    }
}

/// The exit direction of a ball by hand: twice bent by the difference of the angles.
TEST(Glass, ballBendsByTwiceTheDifferenceOfItsAngles) {
    for (const double ior : {1.5, 0.75, 2.4})
        for (const double height : {0.0, 0.1, 0.5, 0.7}) {
            SceneMaker scene;
            scene.sphere({0, 0, 0}, 1, scene.add(clear(ior)));
            const auto chain = refractedChain(treeOf(scene, {-3, height, 0}, {1, 0, 0}));
            ASSERT_EQ(chain.size(), 3u);
            const double outside = std::asin(height), inside = std::asin(height / ior);
            const double bend = 2 * (outside - inside); // toward the axis
            const Vec3 expected{std::cos(bend), -std::sin(bend), 0};
            EXPECT_LE(angleBetween(chain.back().direction, expected), tolerance::kBall)
                << ior << ' ' << height;
            EXPECT_TRUE(chain[1].hit && chain[1].leaving);
        }
}

TEST(Glass, totalReflectionFromInsideTakesTheTransmittedShare) {
    // A ray inside a box of glass meets its side beyond the critical angle (41.8 degrees): the mirror
    // takes all; below it nothing is mirrored, since specular is 0.
    for (const double degrees : {35.0, 41.7, 41.9, 60.0}) {
        SceneMaker scene;
        Material glass = clear(1.5, {0.5, 0.5, 0.5});
        glass.color = {0.5, 1, 1};
        scene.box({-10, -1, -10}, {10, 1, 10}, scene.add(glass));
        scene.description.render.depth = 1;
        const auto tree =
            treeOf(scene, {0, 0, 0}, {std::sin(radians(degrees)), std::cos(radians(degrees)), 0});
        const auto& root = tree.nodes.at(*tree.samples[0].root);
        ASSERT_EQ(root.children.size(), 1u);
        const auto& child = tree.nodes[root.children[0]];
        const bool total = degrees > 41.81;
        EXPECT_EQ(child.kind == RayTree::Kind::reflected, total) << degrees;
        EXPECT_EQ(child.weight, (LinearRgb{0.25, 0.5, 0.5}));
        EXPECT_EQ(child.media.size(), total ? 1u : 0u);
    }
}

TEST(Glass, totalReflectionFromOutsideOfABubble) {
    for (const double degrees : {41.0, 42.5}) {
        SceneMaker scene; // air in glass: ior 1 / 1.5, entered from the dense side
        scene.box({-10, 1, -10}, {10, 3, 10}, scene.add(clear(1 / 1.5)));
        const auto tree =
            treeOf(scene, {0, 0, 0}, {std::sin(radians(degrees)), std::cos(radians(degrees)), 0});
        const auto& root = tree.nodes.at(*tree.samples[0].root);
        ASSERT_EQ(root.children.size(), 1u);
        EXPECT_EQ(tree.nodes[root.children[0]].kind == RayTree::Kind::reflected, degrees > 41.81);
    }
}

TEST(Glass, sheetsAreNotBentFromEitherSide) {
    for (const double side : {1.0, -1.0}) {
        SceneMaker scene;
        scene.parallelogram({-9, -9, 0}, {18, 0, 0}, {0, 18, 0},
                            scene.add(clear(1.5, {0.5, 0.25, 1})));
        scene.description.background.color = {1, 1, 1};
        const auto tree = treeOf(scene, {0, -2, side}, {0, 2, -side});
        const auto chain = refractedChain(tree);
        ASSERT_EQ(chain.size(), 2u);
        EXPECT_EQ(chain[1].direction, chain[0].direction);
        EXPECT_TRUE(chain[1].media.empty());
        EXPECT_EQ(tree.pixel, (LinearRgb{0.5, 0.25, 1}));
    }
}

TEST(Glass, closedMeshRefractsAsASolid) {
    SceneMaker ball, mesh;
    ball.sphere({0, 0, 0}, 1, ball.add(clear(1.5)));
    mesh.icosphere({0, 0, 0}, 1, 5, true, mesh.add(clear(1.5)));
    const Vec3 from{-3, 0.31, 0.17};
    const auto smooth = refractedChain(treeOf(ball, from, {1, 0, 0}));
    const auto facets = refractedChain(treeOf(mesh, from, {1, 0, 0}));
    ASSERT_EQ(facets.size(), 3u);
    // Facets of level 5 are 2 degrees wide and stand off the ball by their sagitta; the interpolated
    // normals follow it to about the square of that.
    EXPECT_LE(angleBetween(smooth.back().direction, facets.back().direction), radians(0.25));
}

// ---- nested and touching solids: STABILITY.md R5 ----------------------------------------------

TEST(Media, nestedSolidsRefractRelativeToWhatIsAroundThem) {
    // Glass around water around ice, flat layers: n sin is the same everywhere.
    const double glass = 1.5, water = 1.333, ice = 1.31;
    SceneMaker scene;
    const auto a = scene.box({-90, -90, -10}, {90, 90, 0}, scene.add(clear(glass)));
    const auto b = scene.box({-80, -80, -9}, {80, 80, -1}, scene.add(clear(water / glass)));
    const auto c = scene.box({-70, -70, -8}, {70, 70, -2}, scene.add(clear(ice / water)));
    const Vec3 in = unit({0.8, 0.3, -0.5});
    const auto chain = refractedChain(treeOf(scene, {-3, -2, 1}, in));
    ASSERT_EQ(chain.size(), 7u);
    const double index[] = {1, glass, water, ice, water, glass, 1};
    const double sine = std::sqrt(in.x * in.x + in.y * in.y);
    for (std::size_t i = 0; i < 7; ++i) {
        const Vec3& d = chain[i].direction;
        EXPECT_NEAR(std::sqrt(d.x * d.x + d.y * d.y) * index[i], sine, tolerance::kSlabChain);
        EXPECT_EQ(chain[i].media.size(), i <= 3 ? i : 6 - i);
    }
    EXPECT_EQ(chain[3].media, (std::vector{a, b, c}));
}

TEST(Media, touchingSolidsAreCrossedTogether) {
    // Layers of different glass face to face; the rays start inside the first, where the step through
    // the air between them would be a total reflection for the steeper angle.
    for (const double degrees : {20.0, 50.0})
        for (const bool swapped : {false, true}) {
            SceneMaker scene;
            std::vector<std::pair<double, double>> layers{{0, 1.5}, {-1, 1.333}, {-2, 1.31}};
            std::vector<ObjectId> ids(3);
            for (std::size_t k = 0; k < 3; ++k) {
                const std::size_t i = swapped ? 2 - k : k;
                const auto& [top, ior] = layers[i];
                ids[i] = scene.box({-90, -90, top - 1}, {90, 90, top}, scene.add(clear(ior)));
            }
            const Vec3 in{std::sin(radians(degrees)), 0, -std::cos(radians(degrees))};
            const auto chain = refractedChain(treeOf(scene, {0.1, 0.2, -0.5}, in));
            ASSERT_GE(chain.size(), 3u);
            for (std::size_t i = 0; i < 3; ++i) {
                EXPECT_NEAR(chain[i].direction.x * layers[i].second,
                            std::sin(radians(degrees)) * 1.5, tolerance::kSlabChain);
                EXPECT_EQ(chain[i].media, std::vector{ids[i]});
            }
        }
}

TEST(Media, waterThatFillsItsGlassTouchesItEverywhere) {
    // A ball of water in a shell whose hollow has the same radius: one crossing, glass to water.
    SceneMaker scene;
    const auto glass = scene.add(clear(1.5)), hollow = scene.add(clear(1 / 1.5)),
               water = scene.add(clear(1.333));
    scene.sphere({0, 0, 0}, 2, glass);
    scene.sphere({0, 0, 0}, 1, hollow);
    scene.sphere({0, 0, 0}, 1, water);
    for (const double height : {0.05, 0.4, 0.9}) {
        const auto chain = refractedChain(treeOf(scene, {-5, height, 0}, {1, 0, 0}));
        const double shell = height / 1.5 * 2 / 2; // n r sin is the same everywhere (Bouguer)
        ASSERT_EQ(chain.size(), shell < 1 ? 5u : 3u);
        EXPECT_EQ(chain[2].media.size(), 3u); // glass, its hollow, water
        const double outer = std::asin(height / 2), inGlass = std::asin(height / 2 / 1.5),
                     atWater = std::asin(height / 1.5), inWater = std::asin(height / 1.333);
        const double bend = 2 * ((outer - inGlass) + (atWater - inWater));
        EXPECT_LE(angleBetween(chain.back().direction, {std::cos(bend), -std::sin(bend), 0}),
                  tolerance::kBall);
    }
}

TEST(Media, glassOnAFloorShowsTheFloor) {
    // The lower face of the box lies in the floor: whichever has the lower id, nothing is seen below.
    for (const bool floorFirst : {false, true}) {
        SceneMaker scene;
        scene.description.background.color = {1, 0, 0};
        const auto floor = scene.add(flatColored({0, 0.5, 0})), glass = scene.add(clear(1.5));
        scene.light({3, 3, 9});
        const auto putFloor = [&] {
            scene.parallelogram({-40, -40, 0.1}, {80, 0, 0}, {0, 80, 0}, floor);
        };
        if (floorFirst) putFloor();
        scene.box({-2, -2, 0.1}, {2, 2, 2.1}, glass);
        if (!floorFirst) putFloor();
        scene.look({-6, -5, 4}, {6, 5, -3.5});
        scene.description.camera.screenDistance = 2;
        const auto frame = scene.render().frame;
        for (const auto& pixel : frame.pixels) EXPECT_EQ(pixel, (LinearRgb{0, 0.5, 0}));
    }
}

// The bound of a large ground is a million times that of what stands on it: half of the rays that left
// through the glass missed the ground, and half of those that left the glass upward met it.
TEST(Media, glassStandingOnAVeryLargePlaneHasNoSpeckles) {
    for (const bool floorFirst : {false, true}) {
        std::optional<image::Framebuffer> small;
        for (const double extent : {100.0, 1e4, 1e9}) {
            SceneMaker scene;
            const auto floor = scene.add(flatColored({0, 0.5, 0}));
            scene.description.background.color = {0, 0.5, 0}; // no horizon
            Material plastic = clear(1.5, {0.9, 0.8, 0.7});
            plastic.specular = {0.1, 0.2, 0.3};
            const auto glass = scene.add(plastic);
            scene.light({3, 3, 9});
            const auto putFloor = [&] {
                scene.parallelogram({-extent / 2, -extent / 2, 0}, {extent, 0, 0}, {0, extent, 0},
                                    floor);
            };
            if (floorFirst) putFloor();
            scene.box({-1, -1, 0}, {1, 1, 1.4}, glass);
            const double sine = std::sin(radians(25)), cosine = std::cos(radians(25));
            for (Vec3& p : scene.world.primitives.triangles.positions)
                p = {cosine * p.x - sine * p.y, sine * p.x + cosine * p.y, p.z};
            if (!floorFirst) putFloor();
            scene.description.image.width = 160, scene.description.image.height = 100;
            scene.look({-3, -2.5, 3}, {3, 2.5, -2.5});
            scene.description.camera.screenDistance = 2;
            const auto frame = scene.render().frame;
            if (!small) small = frame;
            // Where a ray meets the ground is known to that bound, so highlights differ a little.
            const auto difference = image::difference(frame, *small, {.tolerance = 1.0 / 255});
            EXPECT_EQ(difference.over, 0u) << extent << ' ' << floorFirst;
        }
    }
}

// Likewise without glass: shadow rays from a small tile met the floor that it lies in.
TEST(Media, aTileInAVeryLargeFloorHasNoSpeckles) {
    SceneMaker scene;
    const auto red = scene.add(flatColored({1, 0, 0})), green = scene.add(flatColored({0, 1, 0}));
    const double sine = std::sin(radians(25)), cosine = std::cos(radians(25));
    scene.parallelogram({0, -1, 0}, {cosine, sine, 0}, {-sine, cosine, 0}, red);
    scene.parallelogram({-5e8, -5e8, 0}, {1e9, 0, 0}, {0, 1e9, 0}, green);
    scene.light({30, 3, 2});
    scene.description.image.width = 160, scene.description.image.height = 100;
    scene.look({-3, -2.5, 3}, {3, 2.5, -2.5});
    scene.description.camera.screenDistance = 2;
    const auto frame = scene.render().frame;
    std::size_t ofTile = 0;
    for (const auto& pixel : frame.pixels) {
        ofTile += pixel.r == 1;
        EXPECT_EQ(pixel.r + pixel.g, 1);
    }
    EXPECT_GT(ofTile, frame.pixels.size() / 50);
}

TEST(Media, startInsideOfNestedSolids) {
    SceneMaker scene;
    const auto glass = scene.add(clear(1.5));
    const auto outer = scene.box({-4, -4, -4}, {4, 4, 4}, glass);
    const auto inner = scene.sphere({0, 0, 0}, 2, glass);
    scene.sphere({9, 0, 0}, 1, glass);
    scene.sphere({0, 0, 0}, 1, scene.add(matte({1, 1, 1})));
    const Stage stage(scene.octree(), scene.world, scene.description);
    EXPECT_EQ(mediaAt(stage, {0, 0, 0}), (std::vector{outer, inner}));
    EXPECT_EQ(mediaAt(stage, {0, 0, 3}), std::vector{outer});
    EXPECT_EQ(mediaAt(stage, {9, 0, 0}), std::vector{ObjectId{2}});
    EXPECT_TRUE(mediaAt(stage, {0, 0, 5}).empty());
}

TEST(Media, aCameraInsideOfGlassSeesOutAsComputedByHand) {
    SceneMaker scene;
    scene.box({-90, -1, -90}, {90, 1, 90}, scene.add(clear(1.5)));
    const Vec3 d{std::sin(radians(20)), std::cos(radians(20)), 0};
    const auto chain = refractedChain(treeOf(scene, {0, 0, 0}, d));
    ASSERT_EQ(chain.size(), 2u);
    EXPECT_NEAR(chain[1].direction.x, 1.5 * std::sin(radians(20)), tolerance::kSlabChain);
    EXPECT_EQ(chain[0].media.size(), 1u);
    EXPECT_TRUE(chain[1].media.empty());
}

TEST(Coincidence, isLookedForOnlyWhereSpheresMayTouch) {
    const auto mayCoincide = [](const Vec3& center, double radius) {
        SceneMaker scene;
        const auto glass = scene.add(clear(1.5));
        scene.sphere({0, 0, 0}, 1, glass);
        scene.sphere(center, radius, glass);
        const Stage stage(scene.octree(), scene.world, scene.description);
        EXPECT_EQ(stage.mayCoincide[0], stage.mayCoincide[1]);
        return stage.mayCoincide[0];
    };
    EXPECT_FALSE(mayCoincide({1.5, 1.5, 0}, 1)); // only their boxes overlap
    EXPECT_FALSE(mayCoincide({0.1, 0, 0}, 0.5)); // within
    EXPECT_TRUE(mayCoincide({1, 1, 0}, 1));      // they cross
    EXPECT_TRUE(mayCoincide({0, 0, 0}, 1));
    EXPECT_TRUE(mayCoincide({1.5, 0, 0}, 0.5));   // they touch
    EXPECT_TRUE(mayCoincide({0, 0.25, 0}, 0.75)); // from within
    EXPECT_TRUE(mayCoincide({0.6, 0.8, 0}, std::nextafter(2.0, 3.0)));
}

// ---- energy: STABILITY.md R4 ------------------------------------------------------------------

TEST(Furnace, losslessGlassAndMirrorsDisappearInAConstantBackground) {
    SceneMaker scene;
    scene.description.image.width = 160, scene.description.image.height = 120;
    scene.description.background.color = {1, 1, 1};
    scene.description.render.depth = 400;
    const auto glass = scene.add(clear(1.5)), diamond = scene.add(clear(2.4)),
               bubble = scene.add(clear(1 / 1.5)), silver = scene.add(mirror());
    scene.sphere({-1.2, 6, 0}, 1.1, glass);
    scene.sphere({-1.2, 6, 0.2}, 0.5, bubble);
    scene.sphere({1.3, 7, 0.4}, 1, silver);
    scene.icosphere({0.2, 5, -1}, 0.7, 2, true, glass);
    scene.box({0.9, 4.5, -1.2}, {1.9, 5.5, -0.4}, diamond);
    scene.box({-2, 5, -2}, {-1, 6, -1.3}, glass);
    scene.parallelogram({-9, 2, -2.2}, {18, 0, 0}, {0, 12, 0}, silver);
    const Result result = scene.render();
    double worst = 0;
    for (const auto& p : result.frame.pixels)
        for (const double c : {p.r, p.g, p.b}) worst = std::max(worst, std::fabs(c - 1));
    const double samples = static_cast<double>(result.counts.primary);
    EXPECT_LE(worst, tolerance::kFurnace + result.counts.lostByDepth);
    // Nearly nothing is lost: light that is caught for ever in the box of index 2.4 apart.
    EXPECT_LE(result.counts.lostByDepth / samples, 0.05);
}

} // namespace
} // namespace rt::trace
