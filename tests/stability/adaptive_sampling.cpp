// P: the promise of antialias: {max_error: e} on scenes that are hard to sample, and what keeping it costs.
#include <tests/stability/cases.hpp>

#include <core/image/metrics.hpp>
#include <core/trace/tiles.hpp>
#include <tests/trace/adaptive_scenes.hpp>

#include <array>

namespace rt::stability {

namespace {

using image::Framebuffer;
using trace::Result;
using trace::SceneMaker;

/// `whole`: of a picture of the whole scene; a narrower one shows its middle.
void frame(SceneMaker& scene, std::uint32_t width, double whole) {
    scene::Description& d = scene.description;
    d.image.width = width, d.image.height = width * 3 / 4;
    d.image.tone = scene::Tone::limit;
    d.background.color = {0.3, 0.45, 0.7};
    d.render.depth = 5;
    scene.look({0, -6, 2}, {0, 6, -1.5});
    d.camera.screenDistance = 1.1;
    d.camera.screenWidth *= width / whole, d.camera.screenHeight *= width / whole;
    scene.light({-4, -6, 8}, {0.9, 0.9, 0.8});
    scene.light({5, -2, 5}, {0.3, 0.3, 0.5});
}

Result withGrid(SceneMaker& scene, std::uint32_t n, const trace::Options& options = {}) {
    scene.description.render.antialias = scene::AntialiasGrid{n};
    return scene.render(options);
}

double rmseOf(const Framebuffer& a, const Framebuffer& b) { return image::difference(a, b).rmse; }

/// Samples, and all rays.
std::array<double, 2> costOf(const Result& result) {
    const trace::RayCounts& c = result.counts;
    return {static_cast<double>(c.primary),
            static_cast<double>(c.primary + c.reflected + c.refracted + c.shadow)};
}

/// The mean of two grids that share no point, with each other or with what is tested; tile by tile as fine as needed.
struct Reference {
    Framebuffer frame;
    double halves; // how far the two are apart
};

Reference referenceOf(SceneMaker& scene, double precision) {
    constexpr std::uint32_t kFinest = 64;
    const scene::Image& image = scene.description.image;
    Reference reference{Framebuffer(image.width, image.height), 0};
    const trace::Tiles tiles({0, 0, image.width, image.height});
    double sum = 0;
    for (std::size_t i = 0; i < tiles.count(); ++i) {
        const trace::Region tile = tiles[i];
        trace::Options options;
        options.crop = {{tile.x0, tile.y0, tile.x1, tile.y1}};
        for (std::uint32_t n = 12;;) { // even: no point in the middle of a pixel
            const Framebuffer one = withGrid(scene, n, options).frame;
            const Framebuffer other = withGrid(scene, n + 2, options).frame;
            // Both are black beside the tile.
            const double squares = std::pow(rmseOf(one, other), 2) * image.width * image.height;
            const double halves = std::sqrt(squares / tile.width() / tile.height());
            for (std::uint32_t y = tile.y0; y < tile.y1; ++y)
                for (std::uint32_t x = tile.x0; x < tile.x1; ++x)
                    reference.frame.at(x, y) = (one.at(x, y) + other.at(x, y)) * 0.5;
            if (halves <= precision || n >= kFinest) {
                sum += squares;
                break;
            }
            // Edges fall by n^1.5 [Mitchell 1996]; a tenth more, so that two steps do.
            const double wanted = 1.1 * n * std::pow(halves / precision, 2.0 / 3);
            n = std::min(kFinest, static_cast<std::uint32_t>(wanted / 2 + 1) * 2);
        }
    }
    reference.halves = std::sqrt(sum / image.width / image.height);
    return reference;
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

struct Asked {
    const char* text;
    double error;
};

} // namespace

void adaptiveSampling(const Load& load, Table& table) {
    std::vector<Asked> asked{{"0.05", 0.05}, {"0.02", 0.02}};
    if (load.full) asked.push_back({"0.01", 0.01});
    double pairs = 0, broken = 0, over = 0, estimate = 0, halves = 0;
    std::string worst;
    std::vector<double> samples, rays; // of the grid's, by pair
    for (const trace::NamedScene& named : trace::scenesThatAreHardToSample()) {
        SceneMaker scene;
        frame(scene, load.width(64, 320), load.full ? 320 : 160);
        named.make(scene);
        const double precision = asked.back().error / 4;
        // A continuous build makes do with the first two grids.
        const Reference reference = referenceOf(scene, load.full ? precision : numeric::kInfinity);
        halves = std::max(halves, reference.halves / precision);
        // The uniform grids, as far as they are needed.
        struct Grid {
            double error;
            std::array<double, 2> cost;
        };
        std::vector<Grid> grids;
        constexpr std::size_t kFinest = 20; // where none reaches the error, this one counts
        for (const Asked& a : asked) {
            scene.description.render.antialias = scene::AntialiasMaxError{a.error};
            const Result result = scene.render();
            const double truth = rmseOf(result.frame, reference.frame) / a.error;
            ++pairs, broken += truth > 1;
            if (truth > over) over = truth, worst = named.name + " at " + a.text;
            estimate = std::max(estimate, result.estimatedError.value() / a.error);
            if (!load.full) continue; // in so small pictures nearly every pixel has an edge
            while (grids.size() < kFinest && (grids.empty() || grids.back().error > a.error)) {
                const Result grid = withGrid(scene, static_cast<std::uint32_t>(grids.size()) + 1);
                grids.push_back({rmseOf(grid.frame, reference.frame), costOf(grid)});
            }
            auto enough = std::find_if(grids.begin(), grids.end(),
                                       [&](const Grid& g) { return g.error <= a.error; });
            if (enough == grids.end()) --enough;
            samples.push_back(costOf(result)[0] / enough->cost[0]);
            rays.push_back(costOf(result)[1] / enough->cost[1]);
            std::fprintf(
                stderr,
                "%-22s %s: true %.2f of it; grid %td; %.2f of its samples, %.2f of its rays\n",
                named.name.c_str(), a.text, truth, enough - grids.begin() + 1, samples.back(),
                rays.back());
        }
    }
    const auto of = static_cast<std::uint64_t>(pairs);
    table.measure("P", "max_error: pairs whose true error is larger (worst: " + worst + ")",
                  broken / pairs, 0.05, "of all", of);
    table.measure("P", "max_error: the estimate", estimate, 1, "of what was asked", of);
    if (!load.full) return;
    table.measure("P", "halves of the reference, apart", halves, 1, "e/4", of);
    table.measure("P", "max_error: samples, median", median(samples), 0.5, "of the least grid's",
                  of);
    table.measure("P", "max_error: rays, median", median(rays), 0.5, "of the least grid's", of);
}

} // namespace rt::stability
