// Every shipped plugin has a scene in scenes/plugins, and its picture is the one beside it, byte for byte; so is a piece of
// every scene of the gallery. RT_WRITE_REFERENCES=1 writes the pictures of the plugins instead; `./dev gallery` those of the
// gallery.
#include <core/image/metrics.hpp>
#include <core/octree/octree.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/scene/validate.hpp>
#include <core/trace/render.hpp>
#include <formats/image_reader.hpp>
#include <formats/image_writer.hpp>
#include <formats/yaml_reader.hpp>

#include <tests/plugin_host/temporary_folder.hpp>

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

struct Rendered {
    image::Framebuffer frame;
    std::array<std::uint32_t, 4> drawn; // x0, y0, x1, y1
    formats::Encoding encoding;
};

/// The whole picture, or its middle where a pixel does not depend on the rest of the picture.
std::optional<Rendered> render(const fs::path& file, bool middle) {
    Catalog catalog({RT_SHIPPED_PLUGINS});
    scene::Diagnostics diagnostics;
    const auto nodes = formats::readYaml(file.string(), diagnostics);
    const auto description = nodes ? scene::validate(*nodes, catalog, diagnostics) : std::nullopt;
    const auto world = description ? lower(*description, catalog, diagnostics) : std::nullopt;
    EXPECT_EQ(textOf(diagnostics), "");
    if (!world) return {};
    const auto octree = octree::Octree::build(world->primitives);
    const std::uint32_t width = description->image.width, height = description->image.height;
    std::array<std::uint32_t, 4> drawn{0, 0, width, height};
    trace::Options options;
    if (middle && !std::holds_alternative<scene::AntialiasMaxError>(description->render.antialias))
        options.crop = drawn = {width * 3 / 8, height * 3 / 8, width * 5 / 8, height * 5 / 8};
    trace::Result result = trace::render(octree, *world, *description, options);
    EXPECT_EQ(result.counts.notFinite, 0u);
    return Rendered{std::move(result.frame), drawn, {.transfer = description->image.encoding}};
}

std::vector<std::byte> renderToPng(const fs::path& file) {
    const auto rendered = render(file, false);
    if (!rendered) return {};
    return formats::encodeImage(rendered->frame, formats::ImageFormat::png, {});
}

image::Framebuffer cut(const image::Framebuffer& frame, const std::array<std::uint32_t, 4>& r) {
    image::Framebuffer part(r[2] - r[0], r[3] - r[1]);
    for (std::uint32_t y = 0; y < part.height; ++y)
        std::copy_n(&frame.at(r[0], r[1] + y), part.width, &part.at(0, y));
    return part;
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

std::vector<std::string> galleryScenes() {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(RT_GALLERY))
        if (entry.path().extension() == ".yaml") names.push_back(entry.path().stem().string());
    std::sort(names.begin(), names.end());
    return names;
}

class GalleryScene : public testing::TestWithParam<std::string> {};

TEST_P(GalleryScene, DrawsItsPicture) {
    const fs::path scene = fs::path(RT_GALLERY) / (GetParam() + ".yaml");
    const std::string text = test::readFile(scene);
    if (text.find("loader: assimp") != std::string::npos &&
        !fs::exists(fs::path(RT_SHIPPED_PLUGINS) / "assimp.rtplugin.so"))
        GTEST_SKIP() << "needs the loader 'assimp'";
    const auto rendered = render(scene, true);
    ASSERT_TRUE(rendered);
    const auto png = formats::encodeImage(cut(rendered->frame, rendered->drawn),
                                          formats::ImageFormat::png, rendered->encoding);
    const auto ours = decoded({reinterpret_cast<const char*>(png.data()), png.size()});
    const auto theirs = decoded(test::readFile(fs::path(RT_GALLERY) / (GetParam() + ".png")));
    ASSERT_TRUE(ours && theirs);
    ASSERT_EQ(theirs->frame.width, rendered->frame.width);
    ASSERT_EQ(theirs->frame.height, rendered->frame.height);
    // The same bytes on every machine: nothing may differ.
    const image::Difference difference =
        image::difference(ours->frame, cut(theirs->frame, rendered->drawn));
    EXPECT_EQ(difference.over, 0u)
        << "largest difference " << difference.max << " at " << difference.maxX + rendered->drawn[0]
        << ", " << difference.maxY + rendered->drawn[1];
}

INSTANTIATE_TEST_SUITE_P(Scenes, GalleryScene, testing::ValuesIn(galleryScenes()),
                         [](const auto& tested) { return tested.param; });

TEST(GalleryPage, ShowsEverySceneWithItsPicture) {
    const std::string page = test::readFile(fs::path(RT_GALLERY).parent_path() / "README.md");
    EXPECT_GE(galleryScenes().size(), 12u);
    for (const std::string& name : galleryScenes()) {
        EXPECT_NE(page.find("(gallery/" + name + ".png)"), std::string::npos) << name;
        EXPECT_NE(page.find("(gallery/" + name + ".yaml)"), std::string::npos) << name;
    }
}

} // namespace
} // namespace rt::plugin_host
