#include <core/trace/render.hpp>

#include <core/trace/adaptive.hpp>
#include <core/trace/grid.hpp>
#include <core/trace/smooth.hpp>

#include <algorithm>

namespace rt::trace {
namespace {

Region regionOf(const scene::Image& image, const Options& options) {
    if (!options.crop) return {0, 0, image.width, image.height};
    const auto& [x0, y0, x1, y1] = *options.crop;
    const std::uint32_t right = std::min(x1, image.width), bottom = std::min(y1, image.height);
    return {std::min(x0, right), std::min(y0, bottom), right, bottom};
}

/// Pixels outside become black again: they were traced as neighbours of those inside.
void keepOnly(const Region& region, image::Framebuffer& frame) {
    for (std::uint32_t y = 0; y < frame.height; ++y)
        for (std::uint32_t x = 0; x < frame.width; ++x)
            if (x < region.x0 || x >= region.x1 || y < region.y0 || y >= region.y1)
                frame.at(x, y) = {};
}

} // namespace

Result render(const octree::Octree& octree, const world::World& world,
              const scene::Description& description, const Options& options) {
    const scene::Image& image = description.image;
    const scene::Render& settings = description.render;
    const Stage stage(octree, world, description);
    const View view{stage,
                    {description.camera, image.width, image.height, settings.nearPlane},
                    image.tone,
                    options.markNotFinite ? LinearRgb{1, 0, 1} : LinearRgb{}};
    const Sampler sampler = samplerFor(stage, options);
    const Region wanted = regionOf(image, options);
    const bool full = options.shade == Shade::full;
    const bool smoothed = full && settings.smooth;
    Region traced = wanted;
    if (smoothed) {
        traced.x1 = std::min(traced.x1 + 1, image.width);
        traced.y1 = std::min(traced.y1 + 1, image.height);
    }

    Result result;
    const bool all = traced.width() == image.width && traced.height() == image.height;
    result.frame = all ? image::Framebuffer::unwritten(image.width, image.height)
                       : image::Framebuffer(image.width, image.height);
    if (traced.width() == 0 || traced.height() == 0) return result;
    const auto grid = [&](std::uint32_t n) {
        result.complete = sampleGrid(view, sampler, n, settings.sampling, traced, options,
                                     result.frame, result.counts);
    };
    if (!full)
        grid(1);
    else if (const auto* error = std::get_if<scene::AntialiasMaxError>(&settings.antialias))
        sampleAdaptively(view, sampler, error->rmse, traced, options, result);
    else if (const auto* uniform = std::get_if<scene::AntialiasGrid>(&settings.antialias))
        grid(uniform->n);
    else
        grid(std::holds_alternative<scene::AntialiasFsaa4>(settings.antialias) ? 2 : 1);
    if (smoothed) {
        smooth(result.frame);
        keepOnly(wanted, result.frame);
    }
    return result;
}

void scaleForDisplay(image::Framebuffer& frame, Shade shade) {
    if (shade != Shade::depth && shade != Shade::cost) return;
    double largest = 0;
    for (const LinearRgb& pixel : frame.pixels) largest = std::max(largest, pixel.r);
    if (largest > 0)
        for (LinearRgb& pixel : frame.pixels) pixel = LinearRgb::grey(pixel.r / largest);
}

} // namespace rt::trace
