// The shipped textures: what they are at known points, and what they say about files that are no pictures.
#include <core/numeric/colour.hpp>
#include <tests/plugin_host/describe.hpp>
#include <tests/plugin_host/pictures.hpp>
#include <tests/plugin_host/temporary_folder.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>

namespace rt::plugin_host {
namespace {

using namespace std::literals;
using numeric::LinearRgb;
using numeric::Vec3;
using test::Scene;
using test::TemporaryFolder;

template <std::size_t N> std::string_view bytesOf(const unsigned char (&array)[N]) {
    return {reinterpret_cast<const char*>(array), N};
}

/// One texture in a world of its own.
class TextureAt {
public:
    explicit TextureAt(Scene&& scene) : scene_(std::move(scene)), world_(scene_.lower()) {}

    bool exists() const { return world_.has_value(); }
    std::string said() const { return scene_.said(); }
    const material::Texture& texture() const { return *world_->textures.back(); }
    LinearRgb operator()(double u, double v, Vec3 object = {}, Vec3 world = {}) const {
        const rt_surface_point point{
            {u, v}, {object.x, object.y, object.z}, {world.x, world.y, world.z}};
        double rgb[3];
        texture().type->evaluate(texture().state, &point, 1, rgb);
        return {rgb[0], rgb[1], rgb[2]};
    }

private:
    Scene scene_;
    std::optional<world::World> world_;
};

TextureAt make(const std::string& type, const test::Values& values) {
    Scene scene({RT_SHIPPED_PLUGINS});
    scene.addTexture("t", type, values);
    return TextureAt(std::move(scene));
}

// As numbers of the image texture's choices.
constexpr std::int64_t kSrgb = 1, kLinear = 2, kNearest = 0, kClamp = 1, kHorizontal = 2;

constexpr LinearRgb kRed{1, 0, 0}, kGreen{0, 1, 0}, kBlue{0, 0, 1}, kWhite{1, 1, 1};

/// "" or what is said about `bytes` as an image.
std::string complaint(std::string_view bytes) {
    const TemporaryFolder folder;
    const auto image = make("image", {{"file", folder.write("picture", bytes).string()}});
    EXPECT_EQ(image.exists(), image.said().find("error") == std::string::npos);
    return image.said();
}

std::string fault(const std::string& clause) {
    return "scene.yaml:100: error[E0450]: texture 'image', file: " + clause + "\n";
}

std::string overLimit(const std::string& clause) {
    return "scene.yaml:100: error[E0714]: texture 'image', file: " + clause + "\n";
}

TEST(Image, HasTheMiddlesOfItsTexelsWhereTheHeaderSays) {
    const TemporaryFolder folder;
    for (const std::string_view bytes :
         {bytesOf(test::kPng), bytesOf(test::kBmp),
          "P6\n# a comment\n2 2\n255\n\xFF\0\0\0\xFF\0\0\0\xFF\xFF\xFF\xFF"sv}) {
        const auto image = make("image", {{"file", folder.write("picture", bytes).string()}});
        ASSERT_TRUE(image.exists()) << image.said();
        EXPECT_EQ(image(0.25, 0.75), kRed);
        EXPECT_EQ(image(0.75, 0.75), kGreen);
        EXPECT_EQ(image(0.25, 0.25), kBlue);
        EXPECT_EQ(image(0.75, 0.25), kWhite);
        std::uint32_t size[2];
        image.texture().type->resolution(image.texture().state, size);
        EXPECT_EQ(size[0], 2u);
        EXPECT_EQ(size[1], 2u);
    }
}

TEST(Image, MixesFourTexels) {
    const TemporaryFolder folder;
    const std::string file = folder.write("picture", bytesOf(test::kPng));
    const auto mixed = make("image", {{"file", file}});
    EXPECT_EQ(mixed(0.5, 0.75), (LinearRgb{0.5, 0.5, 0}));
    EXPECT_EQ(mixed(0.5, 0.5), (LinearRgb{0.5, 0.5, 0.5}));
    const auto nearest = make("image", {{"file", file}, {"filter", kNearest}});
    EXPECT_EQ(nearest(0.499, 0.501), kRed);
    EXPECT_EQ(nearest(0.501, 0.499), kWhite);
}

TEST(Image, WrapsAsItIsTold) {
    const TemporaryFolder folder;
    const std::string file = folder.write("picture", bytesOf(test::kPng));
    const auto repeat = make("image", {{"file", file}});
    EXPECT_EQ(repeat(-0.75, 3.75), kRed);
    EXPECT_EQ(repeat(0, 0.75), (LinearRgb{0.5, 0.5, 0})); // half of each side
    EXPECT_EQ(repeat(0.25, 0), (LinearRgb{0.5, 0, 0.5}));
    const auto clamp = make("image", {{"file", file}, {"wrap", kClamp}});
    EXPECT_EQ(clamp(-5, 5), kRed);
    EXPECT_EQ(clamp(1, 1), kGreen);
    EXPECT_EQ(clamp(0, 0.75), kRed);
    const auto sky = make("image", {{"file", file}, {"wrap", kHorizontal}});
    EXPECT_EQ(sky(1.25, 2), kRed);
    EXPECT_EQ(sky(0, 1), (LinearRgb{0.5, 0.5, 0}));
    const double bad[] = {std::nan(""),         numeric::kInfinity,
                          -numeric::kInfinity,  1e300,
                          std::nextafter(1, 0), -std::numeric_limits<double>::denorm_min()};
    for (const TextureAt* image : {&repeat, &clamp, &sky})
        for (const double u : bad)
            for (const double v : bad)
                EXPECT_LE((*image)(u, v).maxComponent(), 1); // a texel, whatever the uv
}

TEST(Image, DecodesSrgbUnlessToldOtherwise) {
    const TemporaryFolder folder;
    std::string bytes = "P5 256 1 255\n";
    for (int i = 0; i < 256; ++i) bytes += static_cast<char>(i);
    const std::string file = folder.write("grey", bytes);
    const auto srgb = make("image", {{"file", file}}),
               asked = make("image", {{"file", file}, {"encoding", kSrgb}}),
               linear = make("image", {{"file", file}, {"encoding", kLinear}});
    for (int i = 0; i < 256; ++i) {
        const double u = (i + 0.5) / 256, expected = numeric::linearFromSrgb(i / 255.0);
        const LinearRgb color = srgb(u, 0.5);
        EXPECT_NEAR(color.r, expected, tolerance::roundings(8) * expected);
        EXPECT_EQ(color, LinearRgb::grey(color.r));
        EXPECT_EQ(asked(u, 0.5), color);
        EXPECT_EQ(linear(u, 0.5), LinearRgb::grey(i / 255.0));
    }
}

TEST(Image, KeepsSixteenBitsAndFloats) {
    const TemporaryFolder folder;
    const auto deep =
        make("image", {{"file", folder.write("a.png", bytesOf(test::kPng16)).string()},
                       {"encoding", kLinear}});
    ASSERT_TRUE(deep.exists()) << deep.said();
    EXPECT_EQ(deep(0.75, 0.5), LinearRgb::grey(32768 / 65535.0));
    const auto exr = make("image", {{"file", folder.write("a.exr", bytesOf(test::kExr)).string()}});
    ASSERT_TRUE(exr.exists()) << exr.said();
    EXPECT_EQ(exr(0.25, 0.5), (LinearRgb{2, 0.5, 0.25}));
    EXPECT_EQ(exr(0.75, 0.5), (LinearRgb{1000, 0, 0}));
    EXPECT_EQ(exr.said(),
              "scene.yaml:10: note: texture 'image': 1 negative channels of texels count as 0\n");
    const auto hdr = make("image", {{"file", folder.write("a.hdr", bytesOf(test::kHdr)).string()}});
    ASSERT_TRUE(hdr.exists()) << hdr.said();
    EXPECT_EQ(hdr(0.25, 0.5), (LinearRgb{2, 0.5, 0.25}));
    const std::string pfm = "Pf\n1 1\n-1.0\n"s + "\0\0\x40\x40"s; // 3, little-endian
    const auto grey = make("image", {{"file", folder.write("a.pfm", pfm).string()}});
    ASSERT_TRUE(grey.exists()) << grey.said();
    EXPECT_EQ(grey(0.5, 0.5), LinearRgb::grey(3));
}

TEST(Image, IgnoresAlphaAndSaysSo) {
    EXPECT_EQ(complaint(bytesOf(test::kPngAlpha)),
              "scene.yaml:10: note: texture 'image': the alpha channel of the image is ignored\n");
}

TEST(Image, ReadsAJpeg) {
    const TemporaryFolder folder;
    const auto jpeg = make("image", {{"file", folder.write("a.jpg", bytesOf(test::kJpeg)).string()},
                                     {"encoding", kLinear}});
    ASSERT_TRUE(jpeg.exists()) << jpeg.said();
    EXPECT_EQ(jpeg(0.5, 0.5), LinearRgb::grey(128 / 255.0));
}

TEST(Image, RefusesWhatIsNoPicture) {
    const std::string unknown = fault("is not a PNG, JPEG, BMP, HDR, EXR, PFM, PGM or PPM file");
    EXPECT_EQ(complaint(""), unknown);
    EXPECT_EQ(complaint("some text"), unknown);
    EXPECT_EQ(complaint("GIF89a"), unknown);
    EXPECT_EQ(complaint("II*\0\b\0\0\0"sv), unknown); // TIFF
    EXPECT_EQ(complaint("P6 two 2 255\n"), fault("has a damaged header"));
    EXPECT_EQ(complaint("P6 -2 2 255\n"), fault("has a damaged header"));
    EXPECT_EQ(complaint("P6 0 2 255\n"), fault("says that it has 0 x 2 texels"));
    EXPECT_EQ(complaint("P6 4 4 255\nabc"), fault("is a damaged or truncated PPM file"));
    EXPECT_EQ(complaint("Pf\n1 1\n-1.0\n"s + "\0\0\xC0\x7F"s),
              fault("has texels that are not finite"));
    EXPECT_EQ(complaint("Pf\n1 1\n-1.0\n"s + "\0\0\x80\x7F"s),
              fault("has texels that are not finite"));
    EXPECT_EQ(complaint("#?RADIANCE\n\n+X 1 -Y 1\n"),
              fault("is turned or mirrored (its size must be '-Y height +X width')"));
}

TEST(Image, RefusesFloatsThatAreTooBrightOnceDecodedFromSrgb) {
    const TemporaryFolder folder;
    const auto picture =
        make("image", {{"file", folder.write("a.pfm", "Pf\n1 1\n-1.0\n"s + "\0\0\0\x7F"s).string()},
                       {"encoding", kSrgb}}); // 2^127
    EXPECT_FALSE(picture.exists());
    EXPECT_EQ(picture.said(), fault("has texels that exceed the range of f32 in linear light"));
}

TEST(Image, RefusesBombsByTheirHeader) {
    std::string bomb(bytesOf(test::kPng));
    bomb.replace(16, 8, "\0\0\x4E\x20\0\0\x4E\x20"sv);
    EXPECT_EQ(complaint(bomb),
              overLimit("has 20000 x 20000 texels, more than the limit of 67108864"));
    EXPECT_EQ(complaint("P6 4294967295 4294967295 255\n"),
              overLimit("has 4294967295 x 4294967295 texels, more than the limit of 67108864"));
    std::string bmp(bytesOf(test::kBmp));
    bmp.replace(18, 8, "\xFF\xFF\xFF\x7F\0\0\0\x80"sv); // INT_MIN high, top to bottom
    EXPECT_EQ(complaint(bmp),
              overLimit("has 2147483647 x 2147483648 texels, more than the limit of 67108864"));
}

TEST(Image, RefusesEveryTruncation) {
    const std::pair<const char*, std::string_view> pictures[] = {{"PNG", bytesOf(test::kPng)},
                                                                 {"JPEG", bytesOf(test::kJpeg)},
                                                                 {"BMP", bytesOf(test::kBmp)},
                                                                 {"EXR", bytesOf(test::kExr)}};
    for (const auto& [name, bytes] : pictures)
        for (std::size_t length = 0; length + 1 < bytes.size(); length += 7) {
            if (name == "PNG"sv && length + 16 > bytes.size())
                continue; // only the end marker and its checksum are missing
            EXPECT_NE(complaint(bytes.substr(0, length)).find("error[E0450]"), std::string::npos)
                << name << " cut at " << length;
        }
}

TEST(Checker, AlternatesInEverySpace) {
    const auto uv =
        make("checker", {{"a", Vec3(1, 0, 0)}, {"b", Vec3(0, 0, 1)}, {"scale", Vec3(2, 4, 1)}});
    EXPECT_EQ(uv(0.1, 0.1), kRed);
    EXPECT_EQ(uv(0.6, 0.1), kBlue);
    EXPECT_EQ(uv(0.6, 0.3), kRed);
    EXPECT_EQ(uv(-0.1, 0.1), kBlue); // no seam through 0
    const auto object = make("checker", {{"space", std::int64_t{1}}});
    EXPECT_EQ(object(0, 0, Vec3(0.5, 0.5, 0.5)), kWhite);
    EXPECT_EQ(object(0, 0, Vec3(0.5, 0.5, 1.5)), (LinearRgb{0, 0, 0}));
    const auto world = make("checker", {{"space", std::int64_t{2}}});
    EXPECT_EQ(world(0, 0, Vec3(0.5), Vec3(0.5, 0.5, -0.5)), (LinearRgb{0, 0, 0}));
}

TEST(Checker, EvaluatesOtherTextures) {
    Scene scene({RT_SHIPPED_PLUGINS});
    // The outer comes first in the file: the order of making is its own.
    scene.addTexture("outer", "checker",
                     {{"texture_a", std::int64_t{1}}, {"a", Vec3(0.5, 0.5, 0.5)}});
    scene.addTexture("inner", "gradient", {{"a", Vec3(0, 0, 0)}, {"b", Vec3(1, 1, 1)}});
    const auto world = scene.lower();
    ASSERT_TRUE(world) << scene.said();
    const rt_surface_point point{{0.5, 0.25}, {}, {}};
    double rgb[3];
    world->textures[0]->type->evaluate(world->textures[0]->state, &point, 1, rgb);
    EXPECT_EQ(rgb[0], 0.125);
}

TEST(Checker, CannotNeedItself) {
    Scene scene({RT_SHIPPED_PLUGINS});
    scene.addTexture("one", "checker", {{"texture_a", std::int64_t{1}}});
    scene.addTexture("two", "checker", {{"texture_b", std::int64_t{0}}});
    EXPECT_FALSE(scene.lower());
    EXPECT_EQ(scene.said(), "scene.yaml:10: error[E0349]: texture 'one' needs itself\n");
}

TEST(Gradient, IsStraightBetweenItsEnds) {
    const auto t = make("gradient", {{"a", Vec3(1, 0, 0)},
                                     {"b", Vec3(0, 0, 1)},
                                     {"from", Vec3(0, 0, 0)},
                                     {"to", Vec3(0, 0, 4)},
                                     {"space", std::int64_t{1}}});
    EXPECT_EQ(t(0, 0, Vec3(9, 9, -1)), kRed);
    EXPECT_EQ(t(0, 0, Vec3(9, 9, 1)), (LinearRgb{0.75, 0, 0.25}));
    EXPECT_EQ(t(0, 0, Vec3(9, 9, 5)), kBlue);
    EXPECT_EQ(make("gradient", {{"to", Vec3(0, 0, 0)}}).said(),
              "scene.yaml:103: error[E0348]: texture 'gradient', to: is the same point as from, so "
              "that there is no direction\n");
}

} // namespace
} // namespace rt::plugin_host
