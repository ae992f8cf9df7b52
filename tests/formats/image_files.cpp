// Pictures written and read back, and files that must be refused.
#include <core/image/quantize.hpp>
#include <core/numeric/colour.hpp>
#include <formats/image_reader.hpp>
#include <formats/image_writer.hpp>
#include <tests/formats/temporary_folder.hpp>

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace {

using namespace rt;
using formats::decodePicture;
using formats::encodeImage;
using formats::Encoding;
using formats::ImageFormat;
using formats::Picture;
using formats::PictureKind;
using formats::ReadPictureOptions;
using image::Framebuffer;

Framebuffer randomFrame(std::uint32_t width, std::uint32_t height) {
    Framebuffer frame(width, height);
    std::mt19937_64 random(1);
    const auto draw = [&] { return static_cast<double>(random() % 1000) / 999; };
    for (auto& p : frame.pixels) p = {draw(), draw(), draw()};
    return frame;
}

std::string textOf(const std::vector<std::byte>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

Picture decoded(std::string_view bytes, const ReadPictureOptions& options = {}) {
    scene::Diagnostics diagnostics;
    auto picture = decodePicture(bytes, options, diagnostics, {});
    if (!picture) throw std::runtime_error(diagnostics.all().at(0).message);
    return *std::move(picture);
}

/// "E0451 sentence", or "" where it was read.
std::string refusal(std::string_view bytes, const ReadPictureOptions& options = {}) {
    scene::Diagnostics diagnostics;
    if (decodePicture(bytes, options, diagnostics, {})) return "";
    EXPECT_EQ(diagnostics.all().size(), 1u);
    const auto& error = diagnostics.all().at(0);
    return "E0" + std::to_string(static_cast<unsigned>(error.code)) + " " + error.message;
}

std::uint32_t big32(const std::string& s, std::size_t at) {
    std::uint32_t v = 0;
    for (std::size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<unsigned char>(s[at + i]);
    return v;
}

TEST(ImageWriter, FormatBySuffix) {
    using formats::imageFormatOf;
    EXPECT_EQ(imageFormatOf("a.png"), ImageFormat::png);
    EXPECT_EQ(imageFormatOf("a.b/c.JPeG"), ImageFormat::jpeg);
    EXPECT_EQ(imageFormatOf("a.jpg"), ImageFormat::jpeg);
    EXPECT_EQ(imageFormatOf(".bmp"), ImageFormat::bmp);
    EXPECT_EQ(imageFormatOf("x.EXR"), ImageFormat::exr);
    EXPECT_EQ(imageFormatOf("x.pfm"), ImageFormat::pfm);
    for (const char* path : {"", "png", "a.png/b", "a.", "a.tiff", "a.png "})
        EXPECT_FALSE(imageFormatOf(path)) << path;
}

TEST(ImageWriter, PngCodesAreTheDefinedOnes) {
    const Framebuffer frame = randomFrame(37, 19);
    for (const auto transfer : {scene::Encoding::srgb, scene::Encoding::linear}) {
        for (const std::uint32_t bits : {8u, 16u}) {
            const std::string png =
                textOf(encodeImage(frame, ImageFormat::png, {transfer, bits, 0}));
            EXPECT_EQ(big32(png, 16), 37u);
            EXPECT_EQ(big32(png, 20), 19u);
            EXPECT_EQ(png[24], static_cast<char>(bits));
            EXPECT_EQ(png[25], 2); // RGB
            EXPECT_EQ(png.find("sRGB") != png.npos, transfer == scene::Encoding::srgb);
            EXPECT_EQ(png.find("tIME"), png.npos); // a date would change the bytes
            const Picture back =
                decoded(png, {scene::Encoding::linear, 1 << 20, true}); // codes as they are
            EXPECT_EQ(back.bits, bits);
            for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
                const double c = frame.pixels[i].g,
                             got = back.frame.pixels[i].g * (bits == 8 ? 255 : 65535);
                const bool srgb = transfer == scene::Encoding::srgb;
                const double expected = bits == 8 ? (srgb ? image::srgb8(c) : image::linear8(c))
                                                  : (srgb ? image::srgb16(c) : image::linear16(c));
                ASSERT_EQ(std::lround(got), std::lround(expected)) << i;
            }
        }
    }
}

TEST(ImageWriter, SameBytesAgain) {
    const Framebuffer frame = randomFrame(64, 48);
    for (const auto format : {ImageFormat::png, ImageFormat::jpeg, ImageFormat::bmp,
                              ImageFormat::exr, ImageFormat::pfm})
        EXPECT_EQ(encodeImage(frame, format, {}), encodeImage(frame, format, {}));
}

TEST(ImageWriter, BmpIsExactAndJpegIsNear) {
    const Framebuffer frame = randomFrame(16, 16);
    const Picture bmp = decoded(textOf(encodeImage(frame, ImageFormat::bmp, {})));
    EXPECT_EQ(bmp.kind, PictureKind::bmp);
    for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
        EXPECT_EQ(image::srgb8(bmp.frame.pixels[i].r), image::srgb8(frame.pixels[i].r));
        EXPECT_EQ(image::srgb8(bmp.frame.pixels[i].b), image::srgb8(frame.pixels[i].b));
    }
    Framebuffer smooth(64, 64);
    for (std::uint32_t y = 0; y < 64; ++y)
        for (std::uint32_t x = 0; x < 64; ++x)
            smooth.at(x, y) = numeric::LinearRgb::grey(numeric::linearFromSrgb((x + y) / 126.0));
    const std::string good =
        textOf(encodeImage(smooth, ImageFormat::jpeg, {scene::Encoding::srgb, 8, 95}));
    const std::string poor =
        textOf(encodeImage(smooth, ImageFormat::jpeg, {scene::Encoding::srgb, 8, 5}));
    EXPECT_LT(poor.size(), good.size());
    const Picture jpeg = decoded(good);
    EXPECT_EQ(jpeg.kind, PictureKind::jpeg);
    for (std::size_t i = 0; i < smooth.pixels.size(); ++i) // quality 95 on a grey ramp
        EXPECT_NEAR(image::srgb8(jpeg.frame.pixels[i].r), image::srgb8(smooth.pixels[i].r), 2);
}

TEST(ImageWriter, FloatFormatsAreExact) {
    Framebuffer frame = randomFrame(7, 5);
    const double inf = std::numeric_limits<double>::infinity();
    frame.at(0, 0) = {inf, -inf, std::numeric_limits<double>::quiet_NaN()};
    frame.at(6, 4) = {-0.0, 1e30, 1e300}; // the last overflows f32
    for (const auto format : {ImageFormat::pfm, ImageFormat::exr}) {
        const Picture back = decoded(textOf(encodeImage(frame, format, {})));
        EXPECT_EQ(back.bits, 32u);
        EXPECT_EQ(back.encoding, scene::Encoding::linear);
        ASSERT_EQ(back.frame.width, 7u);
        ASSERT_EQ(back.frame.height, 5u);
        for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
            const double ours[] = {frame.pixels[i].r, frame.pixels[i].g, frame.pixels[i].b};
            const double theirs[] = {back.frame.pixels[i].r, back.frame.pixels[i].g,
                                     back.frame.pixels[i].b};
            for (int c = 0; c < 3; ++c) {
                if (std::isnan(ours[c]))
                    EXPECT_TRUE(std::isnan(theirs[c]));
                else
                    EXPECT_EQ(std::bit_cast<std::uint32_t>(static_cast<float>(ours[c])),
                              std::bit_cast<std::uint32_t>(static_cast<float>(theirs[c])));
            }
        }
    }
}

TEST(ImageWriter, PfmBytes) {
    Framebuffer frame(1, 2);
    frame.at(0, 0) = {1, 2, 3};
    frame.at(0, 1) = {4, 5, 6};
    const std::string header = "PF\n1 2\n-1.0\n";
    const float samples[] = {4, 5, 6, 1, 2, 3};
    EXPECT_EQ(textOf(encodeImage(frame, ImageFormat::pfm, {})),
              header + std::string(reinterpret_cast<const char*>(samples), sizeof samples));
}

TEST(ImageWriter, EmptyPictureIsRefused) {
    for (const auto format : {ImageFormat::png, ImageFormat::pfm})
        EXPECT_THROW(encodeImage(Framebuffer(0, 4), format, {}), std::runtime_error);
}

TEST(ImageWriter, CodecOpens) {
    for (const auto format :
         {ImageFormat::png, ImageFormat::jpeg, ImageFormat::exr, ImageFormat::pfm})
        EXPECT_NO_THROW(formats::openCodec(format).get());
}

/// This program at another place, where the modules are missing or others: what it prints when it encodes a PNG.
std::string outputWithModules(const TemporaryFolder& folder, const std::string& pngModule) {
    namespace fs = std::filesystem;
    fs::create_directories(folder / "bin");
    fs::create_directories(folder / "lib/rt");
    fs::copy_file("/proc/self/exe", folder / "bin/program");
    if (!pngModule.empty()) fs::copy_file(pngModule, folder / "lib/rt/rt_codec_png.so");
    FILE* pipe =
        popen((folder / "bin/program --gtest_filter=ImageWriter.CodecOpens 2>&1").c_str(), "r");
    std::string text;
    for (char buffer[512]; pipe && std::fgets(buffer, sizeof buffer, pipe);) text += buffer;
    if (pipe) pclose(pipe);
    return text;
}

TEST(ImageWriter, MissingOrForeignCodecIsNamed) {
    const TemporaryFolder missing, foreign;
    const auto path = [](const TemporaryFolder& folder) {
        return folder / "lib/rt/rt_codec_png.so";
    };
    EXPECT_NE(outputWithModules(missing, "")
                  .find("the image codec cannot be opened: " + path(missing) +
                        ": cannot open shared object file"),
              std::string::npos);
    EXPECT_NE(outputWithModules(foreign, RT_FOREIGN_MODULE)
                  .find("the image codec " + path(foreign) + " belongs to another build of rt"),
              std::string::npos);
}

TEST(ImageReader, GreyAndAlphaAndOtherNetpbm) {
    const Picture grey = decoded("P5 # a comment\n2 1\n255\n\x80\xff");
    EXPECT_EQ(grey.kind, PictureKind::pnm);
    EXPECT_EQ(grey.frame.at(0, 0), numeric::LinearRgb::grey(image::linearFromSrgb8(0x80)));
    EXPECT_EQ(grey.frame.at(1, 0), numeric::LinearRgb::grey(1));
    using namespace std::string_literals;
    const Picture wide = decoded("P6 1 1 65535\n\xff\xff\x00\x00\x80\x00"s,
                                 {scene::Encoding::linear, 1 << 20, true});
    EXPECT_EQ(wide.bits, 16u);
    EXPECT_EQ(wide.frame.at(0, 0), (numeric::LinearRgb{1, 0, 0x8000 / 65535.0}));
    const Picture bigEndian = decoded("Pf\n1 1\n1.0\n\x3f\x80\x00\x00"s);
    EXPECT_EQ(bigEndian.frame.at(0, 0), numeric::LinearRgb::grey(1));
}

std::string hdrOf(const std::string& resolution, const std::string& rgbe) {
    return "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n" + resolution + "\n" + rgbe;
}

TEST(ImageReader, RadianceHdr) {
    using namespace std::string_literals;
    const std::string hdr = hdrOf("-Y 1 +X 2", "\x80\x40\x20\x81\x00\x00\x80\x8a"s);
    const Picture picture = decoded(hdr);
    EXPECT_EQ(picture.kind, PictureKind::hdr);
    EXPECT_EQ(picture.encoding, scene::Encoding::linear);
    EXPECT_EQ(picture.frame.at(0, 0), (numeric::LinearRgb{1, 0.5, 0.25}));
    EXPECT_EQ(picture.frame.at(1, 0), (numeric::LinearRgb{0, 0, 512}));
    for (std::size_t n = 0; n < hdr.size(); ++n) EXPECT_NE(refusal(hdr.substr(0, n)), "") << n;
}

TEST(ImageReader, DamagedJpegIsRefusedAndQuiet) {
    const std::string whole = textOf(encodeImage(randomFrame(64, 64), ImageFormat::jpeg, {}));
    std::string damaged = whole;
    damaged.replace(whole.size() / 2, 2, "\xff\xd9"); // the end, too early
    testing::internal::CaptureStderr();
    const std::string why = refusal(damaged);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_EQ(why,
              "E0451 the picture cannot be read: Corrupt JPEG data: premature end of data segment");
    EXPECT_EQ(refusal(whole.substr(0, whole.size() - 1)),
              "E0451 the picture cannot be read: Premature end of JPEG file");
}

/// Every prefix of a file of each kind is refused, never filled up with grey. (A trailing byte or two may be padding.)
TEST(ImageReader, TruncatedFilesAreRefused) {
    const Framebuffer frame = randomFrame(20, 10);
    for (const auto format : {ImageFormat::png, ImageFormat::jpeg, ImageFormat::bmp,
                              ImageFormat::exr, ImageFormat::pfm}) {
        const std::string whole = textOf(encodeImage(frame, format, {}));
        ASSERT_EQ(refusal(whole), "");
        for (std::size_t n = 0; n < whole.size(); n += n < 200 ? 1 : 37) {
            const std::string why = refusal(whole.substr(0, n));
            EXPECT_TRUE(why.starts_with("E0450") || why.starts_with("E0451")) << why << " at " << n;
        }
        EXPECT_NE(refusal(whole.substr(0, whole.size() - 1)), "");
    }
}

TEST(ImageReader, WrongKindsAreRefused) {
    for (const char* text : {"", "GIF89a", "II*", "<svg>", "hello",
                             "\x7f"
                             "ELF",
                             "P3 1 1 255 0 0 0", "P"})
        EXPECT_EQ(refusal(text), "E0450 this is no picture that can be read (PNG, JPEG, BMP, HDR, "
                                 "EXR, PFM, PGM or PPM)");
}

std::string pngOfSize(std::uint32_t width, std::uint32_t height) {
    std::string png =
        textOf(encodeImage(Framebuffer(1, 1), ImageFormat::png, {scene::Encoding::linear, 8, 0}));
    for (int i = 0; i < 4; ++i) {
        png[16 + i] = static_cast<char>(width >> (24 - 8 * i));
        png[20 + i] = static_cast<char>(height >> (24 - 8 * i));
    }
    std::uint32_t crc = ~0u; // of the IHDR chunk, ISO 3309
    for (std::size_t i = 12; i < 29; ++i) {
        crc ^= static_cast<unsigned char>(png[i]);
        for (int k = 0; k < 8; ++k) crc = crc & 1 ? 0xedb88320 ^ (crc >> 1) : crc >> 1;
    }
    crc = ~crc;
    for (int i = 0; i < 4; ++i) png[29 + i] = static_cast<char>(crc >> (24 - 8 * i));
    return png;
}

std::string bmpOfSize(std::uint32_t width, std::uint32_t height) {
    std::string bmp = textOf(encodeImage(Framebuffer(1, 1), ImageFormat::bmp, {}));
    std::memcpy(bmp.data() + 18, &width, 4);
    std::memcpy(bmp.data() + 22, &height, 4);
    bmp[30] = 1; // run-length: the length says nothing about the size
    return bmp;
}

TEST(ImageReader, SizesAreCheckedBeforeDecoding) {
    for (const std::uint32_t side : {20000u, 65536u, 0x7fffffffu}) {
        const std::string n = std::to_string(side);
        const std::string expected =
            "E0713 the picture has " + n + " x " + n + " pixels, more than the limit of 67108864";
        EXPECT_EQ(refusal(pngOfSize(side, side)), expected);
        EXPECT_EQ(refusal("PF\n" + n + " " + n + "\n-1.0\n"), expected);
        EXPECT_EQ(refusal("P6\n" + n + " " + n + "\n255\n"), expected);
        EXPECT_EQ(refusal("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + n + " +X " + n + "\n"),
                  expected);
        EXPECT_EQ(refusal(bmpOfSize(side, side)), expected);
    }
    EXPECT_NE(refusal(bmpOfSize(0x80000000u, 1)), "");
    EXPECT_NE(refusal("PF\n-1 1\n-1.0\n"), "");
    EXPECT_NE(refusal("PF\n0 1\n-1.0\n"), "");
    EXPECT_NE(refusal("PF\n99999999999999999999 1\n-1.0\n"), "");
    EXPECT_NE(refusal("PF\n1 1\nnan\n1234"), "");
    ReadPictureOptions four;
    four.maxPixels = 4;
    EXPECT_EQ(refusal(textOf(encodeImage(randomFrame(2, 2), ImageFormat::exr, {})), four), "");
    EXPECT_EQ(refusal(textOf(encodeImage(randomFrame(5, 1), ImageFormat::exr, {})), four),
              "E0713 the picture has 5 x 1 pixels, more than the limit of 4");
    EXPECT_EQ(refusal(textOf(encodeImage(randomFrame(5, 1), ImageFormat::jpeg, {})), four),
              "E0713 the picture has 5 x 1 pixels, more than the limit of 4");
}

TEST(ImageReader, NonFiniteTexels) {
    Framebuffer frame(3, 2);
    frame.at(2, 1).g = std::numeric_limits<double>::quiet_NaN();
    ReadPictureOptions strict;
    strict.allowNonFinite = false;
    for (const auto format : {ImageFormat::pfm, ImageFormat::exr}) {
        const std::string bytes = textOf(encodeImage(frame, format, {}));
        EXPECT_EQ(refusal(bytes), "");
        EXPECT_EQ(refusal(bytes, strict), "E0452 pixel 2,1 is not finite");
    }
}

/// Flipped bytes anywhere: read or refused, nothing else.
TEST(ImageReader, DamagedFiles) {
    const Framebuffer frame = randomFrame(12, 9);
    std::mt19937 random(7);
    for (const auto format : {ImageFormat::png, ImageFormat::jpeg, ImageFormat::bmp,
                              ImageFormat::exr, ImageFormat::pfm}) {
        const std::string whole = textOf(encodeImage(frame, format, {}));
        int refused = 0;
        testing::internal::CaptureStderr();
        for (int i = 0; i < 200; ++i) {
            std::string bytes = whole;
            for (int k = 0; k < 3; ++k)
                bytes[random() % bytes.size()] = static_cast<char>(random());
            ReadPictureOptions small;
            small.maxPixels = 1 << 16;
            refused += refusal(bytes, small) != "";
        }
        EXPECT_GT(refused, 0);
        EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    }
}

TEST(ImageReader, FilesThatAreNone) {
    const TemporaryFolder folder;
    for (const std::string& path :
         {folder / "missing.png", folder.path().string(), std::string("/dev/zero")}) {
        scene::Diagnostics diagnostics;
        EXPECT_FALSE(formats::readPicture(path, {}, diagnostics));
        EXPECT_EQ(diagnostics.exitCode(), 4) << path;
    }
    formats::writeFileAtomically(folder / "a.png",
                                 encodeImage(randomFrame(3, 4), ImageFormat::png, {}));
    scene::Diagnostics diagnostics;
    const auto picture = formats::readPicture(folder / "a.png", {}, diagnostics);
    ASSERT_TRUE(picture);
    EXPECT_EQ(picture->frame.height, 4u);
}

} // namespace
