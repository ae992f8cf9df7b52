// Every shipped plugin has a scene in scenes/plugins, and its picture is the one beside it, byte for byte.
// RT_WRITE_REFERENCES=1 writes the pictures instead.
#include <core/image/metrics.hpp>
#include <core/octree/octree.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/scene/validate.hpp>
#include <core/trace/render.hpp>
#include <formats/image_reader.hpp>
#include <formats/image_writer.hpp>
#include <formats/yaml_reader.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;

std::string textOf(const scene::Diagnostics& diagnostics) {
    std::string text;
    for (const auto& d : diagnostics.all()) text += scene::format(d, false);
    return text;
}

std::vector<std::string> shippedTypes() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(RT_SHIPPED_PLUGINS)) {
        const std::string file = entry.path().filename().string();
        names.push_back(file.substr(0, file.find('.')));
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::vector<std::byte> renderToPng(const fs::path& file) {
    Catalog catalog({RT_SHIPPED_PLUGINS});
    scene::Diagnostics diagnostics;
    const auto nodes = formats::readYaml(file.string(), diagnostics);
    const auto description = nodes ? scene::validate(*nodes, catalog, diagnostics) : std::nullopt;
    const auto world = description ? lower(*description, catalog, diagnostics) : std::nullopt;
    EXPECT_EQ(textOf(diagnostics), "");
    if (!world) return {};
    const auto octree = octree::Octree::build(world->primitives);
    const trace::Result result = trace::render(octree, *world, *description, {});
    EXPECT_EQ(result.counts.notFinite, 0u);
    return formats::encodeImage(result.frame, formats::ImageFormat::png, {});
}

std::optional<formats::Picture> decoded(std::string_view bytes) {
    scene::Diagnostics diagnostics;
    return formats::decodePicture(bytes, {}, diagnostics, {});
}

TEST(Gallery, HasASceneForEveryShippedPlugin) {
    const fs::path scenes = RT_PLUGIN_SCENES;
    for (const std::string& name : shippedTypes())
        EXPECT_TRUE(fs::exists(scenes / (name + ".yaml"))) << name;
}

TEST(Gallery, RendersEveryShippedPluginAsItsReference) {
    const fs::path scenes = RT_PLUGIN_SCENES;
    for (const std::string& name : shippedTypes()) {
        const std::vector<std::byte> png = renderToPng(scenes / (name + ".yaml"));
        ASSERT_FALSE(png.empty()) << name;
        const std::string_view ours(reinterpret_cast<const char*>(png.data()), png.size());
        const fs::path reference = scenes / (name + ".png");
        if (std::getenv("RT_WRITE_REFERENCES") != nullptr) {
            std::ofstream(reference, std::ios::binary) << ours;
            continue;
        }
        std::ifstream file(reference, std::ios::binary);
        const std::string theirs{std::istreambuf_iterator<char>(file), {}};
        const auto a = decoded(ours), b = decoded(theirs);
        ASSERT_TRUE(a && b) << name;
        ASSERT_EQ(a->frame.width, b->frame.width) << name;
        ASSERT_EQ(a->frame.height, b->frame.height) << name;
        const image::Difference difference = image::difference(a->frame, b->frame);
        EXPECT_EQ(difference.over, 0u) << name << ": largest difference " << difference.max
                                       << " at " << difference.maxX << ", " << difference.maxY;
        if (difference.over != 0) {
            std::ofstream(name + ".ours.png", std::ios::binary) << ours;
            const auto shown = formats::encodeImage(
                image::differencePicture(a->frame, b->frame, 10), formats::ImageFormat::png, {});
            std::ofstream(name + ".difference.png", std::ios::binary)
                .write(reinterpret_cast<const char*>(shown.data()),
                       static_cast<std::streamsize>(shown.size()));
        }
    }
}

} // namespace
} // namespace rt::plugin_host
