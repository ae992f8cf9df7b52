// rt compare: how far two pictures differ, in linear light.
#include <core/cli/commands.hpp>
#include <core/cli/exit_codes.hpp>
#include <core/cli/output.hpp>
#include <core/image/metrics.hpp>
#include <core/image/ssim.hpp>
#include <formats/image_reader.hpp>

#include <nlohmann/json.hpp>

#include <array>
#include <charconv>
#include <cmath>

namespace rt::cli {

namespace {

using Json = nlohmann::ordered_json;

std::string spelled(double value) {
    if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
    std::array<char, 32> text;
    return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value,
                                       std::chars_format::general, 6)
                             .ptr};
}

std::string sizeOf(const image::Framebuffer& frame) {
    return std::to_string(frame.width) + "x" + std::to_string(frame.height);
}

/// JSON has no infinity: a PSNR of equal pictures is null.
Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json asJson(const CompareOptions& options, const image::Difference& d, std::optional<double> ssim,
            bool equal) {
    return {{"a", options.a},
            {"b", options.b},
            {"equal", equal},
            {"pixels", d.pixels},
            {"rmse", number(d.rmse)},
            {"psnr", number(d.psnr())},
            {"ssim", ssim ? Json(*ssim) : Json()},
            {"mean_absolute", number(d.meanAbsolute)},
            {"mean_relative_square", number(d.meanRelativeSquare)},
            {"energy_error", number(d.energyError)},
            {"max", number(d.max)},
            {"max_pixel", {d.maxX, d.maxY}},
            {"tolerance", options.tolerance},
            {"over", d.over},
            {"over_share", d.overShare()},
            {"nan", d.nan},
            {"infinite", d.infinite}};
}

std::string asText(const CompareOptions& options, const image::Difference& d,
                   std::optional<double> ssim) {
    std::string text;
    const auto line = [&](std::string name, const std::string& value) {
        name.resize(15, ' ');
        text += name + value + "\n";
    };
    line("pixels", std::to_string(d.pixels));
    line("RMSE", spelled(d.rmse));
    line("PSNR", spelled(d.psnr()) + " dB");
    line("SSIM", ssim ? spelled(*ssim) : "needs at least 8x8 pixels");
    line("mean absolute", spelled(d.meanAbsolute));
    line("max", spelled(d.max) + " at " + std::to_string(d.maxX) + "," + std::to_string(d.maxY));
    line("over " + spelled(options.tolerance),
         std::to_string(d.over) + " (" + spelled(100 * d.overShare()) + " %)");
    if (d.nan) line("NaN", std::to_string(d.nan));
    if (d.infinite) line("infinite", std::to_string(d.infinite));
    return text;
}

} // namespace

int compare(const CompareOptions& options, Console& console) {
    scene::Diagnostics diagnostics;
    const auto finish = [&] {
        console.report(diagnostics);
        return diagnostics.exitCode();
    };
    const formats::ReadPictureOptions reading{.encoding = options.encoding};
    const auto a = formats::readPicture(options.a, reading, diagnostics);
    const auto b = formats::readPicture(options.b, reading, diagnostics);
    std::optional<formats::Picture> mask;
    if (!options.mask.empty()) mask = formats::readPicture(options.mask, {}, diagnostics);
    std::vector<Output> outputs;
    if (!options.difference.empty()) {
        RenderOptions asWritten;
        asWritten.outputs = {options.difference};
        outputs = planOutputs(asWritten, {}, diagnostics);
    }
    if (diagnostics.failed()) return finish();

    const auto refuse = [&](const std::string& sentence) {
        console.fail("compare", kExitInput, sentence, "");
        return int(kExitInput);
    };
    if (sizeOf(a->frame) != sizeOf(b->frame))
        return refuse("the sizes differ: " + options.a + " is " + sizeOf(a->frame) + ", " +
                      options.b + " is " + sizeOf(b->frame));
    if (mask && sizeOf(mask->frame) != sizeOf(a->frame))
        return refuse("the mask is " + sizeOf(mask->frame) + ", the pictures are " +
                      sizeOf(a->frame));
    image::CompareOptions how{
        .crop = {}, .mask = mask ? &mask->frame : nullptr, .tolerance = options.tolerance};
    if (options.crop) {
        const auto [x0, y0, x1, y1] = *options.crop;
        if (x1 > a->frame.width || y1 > a->frame.height)
            throw UsageError("--crop: must lie inside the pictures, which are " + sizeOf(a->frame));
        how.crop = image::Region{x0, y0, x1, y1};
    }

    const image::Difference d = image::difference(a->frame, b->frame, how);
    const auto ssim = image::ssimBlocks(a->frame, b->frame, how);
    const bool equal = d.over == 0;
    if (!outputs.empty()) {
        const auto picture = image::differencePicture(a->frame, b->frame, 1);
        if (!writeOutput(outputs[0].path, formats::encodeImage(picture, outputs[0].format, {}),
                         console, diagnostics))
            return finish();
    }
    console.result(options.json ? asJson(options, d, ssim, equal).dump(2) + "\n"
                                : asText(options, d, ssim));
    return equal ? kExitOk : kExitDifferent;
}

} // namespace rt::cli
