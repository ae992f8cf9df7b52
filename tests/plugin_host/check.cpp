// `rt plugins --check`: what is shipped passes, and each lie is found.
#include <core/plugin_host/check.hpp>
#include <tests/plugin_host/describe.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;
using numeric::Vec3;
using scene::TypeKind;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

const fs::path kModules = RT_TEST_MODULES;

TEST(Check, PassesEveryShippedPlugin) {
    Catalog catalog({RT_SHIPPED_PLUGINS});
    const auto all = catalog.openAll();
    EXPECT_GE(all.size(), 15u);
    for (const ModuleInfo& info : all) {
        const CheckReport report = checkModule(catalog, info.name, {}, 20000);
        EXPECT_THAT(report.faults, ElementsAre()) << info.name;
    }
}

TEST(Check, PassesExactShapesOfManyProportions) {
    Catalog catalog({RT_SHIPPED_PLUGINS});
    const auto shape = [&](const char* name, const test::Values& values) {
        const CheckReport report = checkModule(
            catalog, name, {test::instance(catalog, TypeKind::shape, name, values)}, 3000);
        EXPECT_THAT(report.faults, ElementsAre()) << name;
    };
    for (const double scale : {1 / 1e6, 1.0, 1e6}) {
        const Vec3 far = 1000.0 * scale * Vec3(3, -2, 5);
        shape("torus", {{"major_radius", scale}, {"minor_radius", 0.001 * scale}});
        shape("torus", {{"major_radius", scale}, {"minor_radius", 0.999 * scale}});
        shape("cylinder",
              {{"start", far}, {"end", far + scale * Vec3(1, 2, 3)}, {"radius", 0.01 * scale}});
        shape("cylinder", {{"end", scale * Vec3(0, 0, 0.01)},
                           {"radius", 5 * scale},
                           {"closed", std::int64_t{0}}});
        shape(
            "cone",
            {{"start", far}, {"end", far + scale * Vec3(-1, 0.5, 0)}, {"start_radius", 2 * scale}});
        shape("cone", {{"end", scale * Vec3(0, 0, 3)},
                       {"start_radius", 0.5 * scale},
                       {"end_radius", scale},
                       {"closed", std::int64_t{0}}});
        shape("disk", {{"center", far},
                       {"normal", Vec3(1, 1, 1)},
                       {"radius", scale},
                       {"inner_radius", 0.9 * scale}});
    }
}

CheckReport checkLie(std::int64_t lie) {
    Catalog catalog({kModules / "liar"});
    return checkModule(catalog, "liar",
                       {test::instance(catalog, TypeKind::shape, "liar", {{"lie", lie}})}, 5000);
}

TEST(Check, FindsEveryLieOfACustomShape) {
    const std::pair<std::int64_t, const char*> lies[] = {
        {1, "a miss writes into the hit"},
        {2, "a hit's normal is not unit"},
        {3, "the surface is not where a hit and its position_error say"},
        {4, "a hit lies outside the bounds of its primitive"},
        {5, "a ray whose origin is not a number hits"},
        {6, "a hit lies outside (t_min, t_max)"},
        {7, "the first crossing is not the closest hit"},
        {8, "the first crossing is not the closest hit"},
        {9, "a solid is entered and not left"},
        {10, "crossings with a capacity of 1 does not return the first"},
        {11, "two threads get different answers to one ray"},
        {12, "a hit's position is not where the ray is at its t"},
        {13, "with t_max at the hit it finds one that it had passed over"},
        {14, "a hit names a primitive that was not asked for"},
    };
    EXPECT_THAT(checkLie(0).faults, ElementsAre());
    for (const auto& [lie, fault] : lies)
        EXPECT_THAT(checkLie(lie).faults, Contains(StartsWith(fault))) << lie;
}

TEST(Check, FindsWhatIsWrongWithATexture) {
    Catalog catalog({kModules / "bad_texture"});
    EXPECT_THAT(
        checkModule(catalog, "bad_texture", {}, 5000).faults,
        ElementsAre("the module's doc is not a sentence with a point at its end.",
                    "the module has no version.", "the module's example does not use it.",
                    "the doc of the parameter 'text' is not a sentence with a point at its end.",
                    "the texture is not finite everywhere.", "the texture is negative somewhere.",
                    "the texture's colors depend on how many points are asked for at once.",
                    "two threads get different colors."));
}

TEST(Check, SkipsExamplesWhoseFilesAreNotThere) {
    Catalog catalog({RT_SHIPPED_PLUGINS});
    const auto example = test::instance(catalog, TypeKind::texture, "image",
                                        {{"file", std::string("/no/wood.png")}});
    const CheckReport report = checkModule(catalog, "image", {example});
    EXPECT_THAT(report.faults, ElementsAre());
    EXPECT_THAT(report.skipped,
                Contains("texture from example 1: '/no/wood.png': there is no such file"));
}

TEST(Check, SaysWhyAModuleIsRefused) {
    Catalog catalog({kModules / "major_2"});
    EXPECT_THAT(checkModule(catalog, "dot").faults,
                ElementsAre((kModules / "major_2/dot.rtplugin.so").string() +
                            " was refused: it was built for plugin ABI 2.1 and this rt speaks 1.1; "
                            "rebuild it against this rt."));
}

TEST(Check, SkipsWhatDefaultsCannotMake) {
    Catalog catalog({RT_SHIPPED_PLUGINS});
    EXPECT_THAT(checkModule(catalog, "image").skipped,
                ElementsAre("nothing was made from the defaults: 'file' has none"));
    EXPECT_THAT(checkModule(catalog, "mesh").skipped,
                ElementsAre("shape from its defaults: shape 'mesh', file: is missing, and there "
                            "are no vertices either"));
}

} // namespace
} // namespace rt::plugin_host
