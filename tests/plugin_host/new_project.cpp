// `rt new`: what it writes builds, passes the check and makes a scene.
#include <core/plugin_host/check.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/plugin_host/new_project.hpp>
#include <core/scene/validate.hpp>
#include <formats/yaml_reader.hpp>
#include <tests/plugin_host/temporary_folder.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;
using scene::TypeKind;
using test::TemporaryFolder;

std::string textOf(const scene::Diagnostics& diagnostics) {
    std::string text;
    for (const auto& d : diagnostics.all()) text += scene::format(d, false);
    return text;
}

class NewProject : public testing::TestWithParam<TypeKind> {};

TEST_P(NewProject, BuildsAndMakesItsScene) {
    const TemporaryFolder folder;
    const fs::path project = folder / "mine";
    const auto written = writeNewProject(GetParam(), "mine", project);
    ASSERT_TRUE(std::holds_alternative<std::vector<fs::path>>(written))
        << std::get<std::string>(written);
    for (const fs::path& file : std::get<std::vector<fs::path>>(written))
        EXPECT_TRUE(fs::is_regular_file(file)) << file;
    const std::string build = (project / "build").string(), log = (folder / "log").string();
    const std::string command = "cmake -S '" + project.string() + "' -B '" + build + "' >'" + log +
                                "' 2>&1 && cmake --build '" + build + "' >>'" + log + "' 2>&1";
    ASSERT_EQ(std::system(command.c_str()), 0) << test::readFile(log);

    Catalog catalog({build, RT_SHIPPED_PLUGINS});
    EXPECT_THAT(checkModule(catalog, "mine", {}, 2000).faults, testing::ElementsAre());
    scene::Diagnostics diagnostics;
    const auto nodes = formats::readYaml(project / "scene.yaml", diagnostics);
    ASSERT_TRUE(nodes) << textOf(diagnostics);
    const auto description = scene::validate(*nodes, catalog, diagnostics);
    ASSERT_TRUE(description) << textOf(diagnostics);
    const auto world = lower(*description, catalog, diagnostics);
    ASSERT_TRUE(world) << textOf(diagnostics);
    EXPECT_GT(world->primitives.count(), 1u);
    EXPECT_EQ(textOf(diagnostics), "");
}

INSTANTIATE_TEST_SUITE_P(Kinds, NewProject,
                         testing::Values(TypeKind::shape, TypeKind::texture, TypeKind::loader));

TEST(NewProjectFolder, OverwritesNothing) {
    const TemporaryFolder folder;
    folder.write("mine/notes.txt", "precious");
    EXPECT_EQ(std::get<std::string>(writeNewProject(TypeKind::shape, "mine", folder / "mine")),
              "'" + (folder / "mine").string() +
                  "' exists already, and nothing in it is overwritten");
    EXPECT_EQ(std::get<std::string>(writeNewProject(TypeKind::shape, "../mine", folder / "other")),
              "the name of a type is [a-z][a-z0-9_]*, at most 64 characters (got '../mine')");
    EXPECT_FALSE(fs::exists(folder / "other"));
}

} // namespace
} // namespace rt::plugin_host
