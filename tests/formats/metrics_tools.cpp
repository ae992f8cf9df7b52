// core/image's metrics against independent programs, to the digits that they print.
#include <core/image/metrics.hpp>
#include <core/image/ssim.hpp>
#include <formats/image_reader.hpp>
#include <formats/image_writer.hpp>
#include <tests/formats/temporary_folder.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

namespace {

using namespace rt;
using image::Framebuffer;

std::string outputOf(const std::string& command) {
    FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    std::string text;
    char buffer[512];
    while (pipe && std::fgets(buffer, sizeof buffer, pipe)) text += buffer;
    if (pipe) pclose(pipe);
    return text;
}

bool installed(const std::string& program) {
    return std::system(("command -v " + program + " >/dev/null").c_str()) == 0;
}

/// The number after the last `label`, and half a unit of its last printed digit.
struct Printed {
    double value = std::nan(""), half = 0;
};
Printed after(const std::string& text, const std::string& label) {
    const std::size_t at = text.rfind(label);
    if (at == text.npos) return {};
    const std::size_t start = text.find_first_not_of(" =", at + label.size());
    const std::string number =
        text.substr(start, text.find_first_not_of("0123456789.e+-", start) - start);
    const std::size_t e = number.find('e'), dot = number.find('.');
    const int decimals =
        dot == number.npos ? 0 : static_cast<int>(std::min(e, number.size()) - dot - 1);
    const int exponent = e == number.npos ? 0 : std::stoi(number.substr(e + 1));
    return {std::stod(number), 0.5 * std::pow(10.0, exponent - decimals)};
}
#define EXPECT_PRINTED(ours, text, label)                                                          \
    do {                                                                                           \
        const Printed printed = after(text, label);                                                \
        EXPECT_NEAR(ours, printed.value, printed.half* tolerance::kPrintedDigits) << label << '\n' \
                                                                                  << text;         \
    } while (false)

/// A picture of smooth and busy parts, and another like it.
std::pair<Framebuffer, Framebuffer> twoPictures(double brightness) {
    Framebuffer a(130, 77), b(130, 77);
    std::mt19937 random(3);
    for (std::uint32_t y = 0; y < a.height; ++y)
        for (std::uint32_t x = 0; x < a.width; ++x) {
            const double busy = x > 60 ? (random() % 100) / 300.0 : 0;
            a.at(x, y) = {x / 130.0, (y / 77.0) * (1 - busy), 0.3 + busy};
            b.at(x, y) =
                a.at(x, y) * (1 + (static_cast<double>(random() % 1000) / 1000 - 0.5) * 0.2);
        }
    b.at(100, 50) = {1, 0, 0.9};
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        a.pixels[i] *= brightness, b.pixels[i] *= brightness;
    return {a, b};
}

struct Files {
    TemporaryFolder folder;
    std::string a, b;
    Framebuffer frameA, frameB; // as read back
    Files(const std::string& suffix, std::uint32_t bits, std::optional<scene::Encoding> decodeAs,
          double brightness = 1) {
        const auto [first, second] = twoPictures(brightness);
        a = folder / ("a" + suffix), b = folder / ("b" + suffix);
        const auto write = [&](const std::string& path, const Framebuffer& frame) {
            const formats::Encoding encoding{scene::Encoding::srgb, bits, 95};
            formats::writeFileAtomically(
                path, formats::encodeImage(frame, *formats::imageFormatOf(path), encoding));
            scene::Diagnostics diagnostics;
            formats::ReadPictureOptions options;
            options.encoding = decodeAs;
            return formats::readPicture(path, options, diagnostics).value().frame;
        };
        frameA = write(a, first);
        frameB = write(b, second);
    }
};

void expectIdiff(const Files& files) {
    const std::string text = outputOf("idiff '" + files.a + "' '" + files.b + "'");
    const image::Difference d = image::difference(files.frameA, files.frameB);
    EXPECT_PRINTED(d.meanAbsolute, text, "Mean error");
    EXPECT_PRINTED(d.rmse, text, "RMS error");
    EXPECT_PRINTED(d.psnr(), text, "Peak SNR");
    EXPECT_PRINTED(d.max, text, "Max error ");
    EXPECT_NE(text.find("@ (" + std::to_string(d.maxX) + ", " + std::to_string(d.maxY)), text.npos)
        << text;
}

TEST(MetricsTools, IdiffOnLinearLight) {
    if (!installed("idiff")) GTEST_SKIP() << "idiff (openimageio-tools) is not installed";
    expectIdiff(Files(".exr", 8, {}));
    expectIdiff(Files(".pfm", 8, {}, 0.25)); // the peak is 1 where no value reaches it
    expectIdiff(Files(".pfm", 8, {}, 40));   // and the largest value where one passes it
}

TEST(MetricsTools, IdiffOnStoredCodes) {
    if (!installed("idiff")) GTEST_SKIP() << "idiff (openimageio-tools) is not installed";
    expectIdiff(Files(".png", 8, scene::Encoding::linear));
    expectIdiff(Files(".png", 16, scene::Encoding::linear));
}

std::string ffmpeg(const Files& files, const std::string& filter, const std::string& format) {
    return outputOf("ffmpeg -hide_banner -nostdin -i '" + files.a + "' -i '" + files.b +
                    "' -lavfi '[0]format=" + format + "[a];[1]format=" + format + "[b];[a][b]" +
                    filter + "' -f null -");
}

TEST(MetricsTools, FfmpegPsnrOnStoredCodes) {
    if (!installed("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
    const Files eight(".png", 8, scene::Encoding::linear);
    EXPECT_PRINTED(image::difference(eight.frameA, eight.frameB).psnr(),
                   ffmpeg(eight, "psnr", "gbrp"), "average:");
    const Files sixteen(".png", 16, scene::Encoding::linear);
    EXPECT_PRINTED(image::difference(sixteen.frameA, sixteen.frameB).psnr(),
                   ffmpeg(sixteen, "psnr", "gbrp16le"), "average:");
}

TEST(MetricsTools, FfmpegSsim) {
    if (!installed("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
    const Files files(".png", 8, {});
    EXPECT_PRINTED(image::ssimBlocks(files.frameA, files.frameB).value(),
                   ffmpeg(files, "ssim", "gbrp"), "All:");
}

} // namespace
