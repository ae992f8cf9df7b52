#include <core/report/bench.hpp>

#include <core/octree/octree.hpp>
#include <core/report/arithmetic.hpp>
#include <core/trace/render.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>

namespace rt::report {

namespace {

using image::Framebuffer;
using octree::Octree;

/// A configuration that can be run.
struct Runner {
    Row row;
    std::function<Framebuffer()> run;        // what is timed
    std::function<trace::RayCounts()> count; // counters, not timed
    const Framebuffer* reference = nullptr;
};

double wallSeconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

/// Everything scaled about the origin. Textures that look at world coordinates see other ones.
void scale(world::World& world, scene::Description& d, double s) {
    auto& p = world.primitives;
    for (auto& v : p.triangles.positions) v *= s;
    for (auto& sphere : p.spheres) sphere.center *= s, sphere.radius *= s;
    for (auto& g : p.parallelograms) g.origin *= s, g.edgeU *= s, g.edgeV *= s;
    for (auto& light : d.lights) light.position *= s;
    d.camera.position *= s;
    if (d.render.nearPlane == scene::NearPlane::screen)
        d.camera.screenWidth *= s, d.camera.screenHeight *= s, d.camera.screenDistance *= s;
    if (d.bounds) d.bounds->min *= s, d.bounds->max *= s;
    d.background.center *= s, d.background.radius *= s;
    for (auto& object : world.objectFromWorld) object.linear *= 1 / s;
}

Octree treeOf(const world::World& world, const scene::Description& d, std::uint32_t maxObjects,
              octree::Precision precision = octree::Precision::exact) {
    return Octree::build(
        world.primitives,
        {.maxObjects = maxObjects, .minSize = d.render.octreeMinSize, .precision = precision});
}

class Bench {
public:
    Bench(const std::string& name, const world::World& world, const scene::Description& description,
          const Plan& plan)
        : world_(world), description_(description), plan_(plan),
          tree_(treeOf(world, description, description.render.octreeMaxObjects)) {
        report_.scene = name;
        report_.width = description.image.width, report_.height = description.image.height;
        report_.primitives = world.primitives.count();
    }

    SceneReport run() {
        requireSameBytes();
        if (wants('A')) arithmetics();
        if (wants('B')) samplings();
        if (wants('C')) features();
        return std::move(report_);
    }

private:
    bool wants(char panel) const {
        return plan_.panels.find(panel) != std::string::npos && !stopped();
    }
    bool stopped() const { return plan_.stop && plan_.stop->load(std::memory_order_relaxed); }
    void say(const std::string& what) const {
        if (plan_.progress) plan_.progress(report_.scene + ": " + what);
    }

    static trace::Result render(const Octree& tree, const world::World& world,
                                const scene::Description& d, int threads, bool count) {
        trace::Options options;
        options.threads = threads, options.count = count;
        return trace::render(tree, world, d, options);
    }

    /// Neither is a configuration: a picture depends on nothing but the scene.
    void requireSameBytes() const {
        say("same bytes on other threads and without the octree");
        scene::Description d = description_;
        d.render.antialias = scene::AntialiasNone{};
        const auto expected = render(tree_, world_, d, 1, false).frame;
        if (render(tree_, world_, d, 7, false).frame.pixels != expected.pixels)
            throw std::logic_error("the picture depends on the number of threads");
        // One leaf for all: feasible for small scenes, and tests/octree holds the tree to it in any case.
        constexpr std::uint32_t kFeasible = 20'000;
        if (world_.primitives.count() > kFeasible) return;
        const Octree flat = treeOf(world_, d, 0xFFFFFFFF);
        if (render(flat, world_, d, plan_.threads, false).frame.pixels != expected.pixels)
            throw std::logic_error("the picture depends on the octree");
    }

    // ---- A -------------------------------------------------------------------------------------

    void arithmetics() {
        if (!isBuiltIn(world_)) {
            report_.remark = "Panel A knows triangles, spheres and parallelograms; shapes that "
                             "answer rays by themselves compute in f64.";
            return;
        }
        for (const double s : plan_.scales) {
            if (stopped()) return;
            say("arithmetic at scale " + std::to_string(s));
            world::World world = world_;
            scene::Description d = description_;
            d.render.antialias = scene::AntialiasNone{};
            d.render.smooth = false;
            if (s != 1) scale(world, d, s);
            const std::uint32_t maxObjects = d.render.octreeMaxObjects;
            const Octree tree = treeOf(world, d, maxObjects),
                         fast = treeOf(world, d, maxObjects, octree::Precision::f32);
            const Framebuffer reference =
                renderIn(Arithmetic::f128Reference, world, d, plan_.threads).frame;
            std::vector<Runner> runners;
            for (const Arithmetic arithmetic : {Arithmetic::f32Naive, Arithmetic::f32Robust,
                                                Arithmetic::f64Naive, Arithmetic::f64Robust}) {
                const std::string name = std::string(nameOf(arithmetic)) + " (scalar)";
                Runner r = runner('A', name, "", s, reference);
                const auto rays = renderIn(arithmetic, world, d, 1).rays;
                r.run = [&world, &d, arithmetic] {
                    return renderIn(arithmetic, world, d, 1).frame;
                };
                r.count = [rays] { return trace::RayCounts{.primary = rays}; };
                runners.push_back(std::move(r));
            }
            for (const Octree* const octree : {&fast, &tree}) {
                const bool isDefault = octree == &tree;
                Runner r = runner('A', isDefault ? kProduct : kProductInF32, "", s, reference);
                r.row.isDefault = isDefault;
                r.row.bytes = octree->statistics().bytes;
                r.run = [&world, &d, octree] { return render(*octree, world, d, 1, false).frame; };
                r.count = [&world, &d, octree] {
                    return render(*octree, world, d, 1, true).counts;
                };
                runners.push_back(std::move(r));
            }
            measure(runners);
        }
    }

    // ---- B -------------------------------------------------------------------------------------

    void samplings() {
        say("reference of the samplings");
        const auto grid = [&](std::uint32_t n) {
            scene::Description d = description_;
            d.render.antialias = scene::AntialiasGrid{n};
            d.render.sampling = scene::Sampling::center;
            return render(tree_, world_, d, plan_.threads, false).frame;
        };
        // Grids of n and n + 1 have no sample in common, and none with those that are tested but the middle.
        Framebuffer reference = grid(plan_.reference);
        const Framebuffer other = grid(plan_.reference + 1);
        report_.referenceSigma = image::difference(reference, other).rmse / 2;
        for (std::size_t i = 0; i < reference.pixels.size(); ++i)
            reference.pixels[i] = (reference.pixels[i] + other.pixels[i]) * 0.5;
        std::vector<Runner> runners;
        const auto add = [&](const std::string& name, const std::string& flags,
                             const scene::Antialias& antialias, bool isDefault) {
            runners.push_back(product('B', name, flags, reference, [&](scene::Description& d) {
                d.render.antialias = antialias;
                d.render.smooth = false;
            }));
            runners.back().row.isDefault = isDefault;
        };
        add("none", "--antialias none", scene::AntialiasNone{}, true);
        add("fsaa4", "--antialias fsaa4", scene::AntialiasFsaa4{}, false);
        for (const std::uint32_t n : {2u, 3u, 4u, 6u})
            add("grid " + std::to_string(n), "--antialias grid=" + std::to_string(n),
                scene::AntialiasGrid{n}, false);
        for (const char* const e : {"0.05", "0.02", "0.01"})
            add(std::string("max_error ") + e, std::string("--antialias max_error=") + e,
                scene::AntialiasMaxError{std::stod(e)}, false);
        measure(runners);
    }

    // ---- C -------------------------------------------------------------------------------------

    void features() {
        const Framebuffer reference =
            render(tree_, world_, description_, plan_.threads, false).frame;
        std::vector<Runner> runners;
        const auto add = [&](const std::string& name, const std::string& flags,
                             const std::function<void(scene::Description&)>& change) {
            runners.push_back(product('C', name, flags, reference, change));
        };
        add("as the scene says", "", [](scene::Description&) {});
        runners.back().row.isDefault = true;
        for (const std::uint32_t depth : {0u, 1u, 2u, 5u, 8u})
            add("depth " + std::to_string(depth), "--depth " + std::to_string(depth),
                [=](scene::Description& d) { d.render.depth = depth; });
        add("no lights, no shadow rays", "", [](scene::Description& d) { d.lights.clear(); });
        add("plain background", "--set background={color: 0}",
            [](scene::Description& d) { d.background = scene::Background{}; });
        add("smooth", "--set render.smooth=true",
            [](scene::Description& d) { d.render.smooth = true; });
        add("cutoff 1/255", "--set render.cutoff=0.0039",
            [](scene::Description& d) { d.render.cutoff = kWrong; });
        measure(runners);
    }

    // ---- measuring -----------------------------------------------------------------------------

    Runner runner(char panel, const std::string& name, const std::string& flags, double s,
                  const Framebuffer& reference) const {
        Runner r;
        r.row.scene = report_.scene, r.row.panel = panel, r.row.name = name;
        r.row.flags = flags, r.row.scale = s;
        r.reference = &reference;
        return r;
    }

    Runner product(char panel, const std::string& name, const std::string& flags,
                   const Framebuffer& reference,
                   const std::function<void(scene::Description&)>& change) {
        const auto d = std::make_shared<scene::Description>(description_);
        change(*d);
        Runner r = runner(panel, name, flags, 1, reference);
        r.row.bytes = tree_.statistics().bytes;
        r.run = [this, d] { return render(tree_, world_, *d, plan_.threads, false).frame; };
        r.count = [this, d] { return render(tree_, world_, *d, plan_.threads, true).counts; };
        return r;
    }

    /// Rounds in which each configuration runs once, in random order, so that drift hits all alike. A first run of
    /// each, not timed, warms up and gives the errors and the counters.
    void measure(std::vector<Runner>& runners) {
        for (Runner& r : runners) {
            if (stopped()) break;
            say(std::string(1, r.row.panel) + ", " + r.row.name);
            r.row.error = image::difference(r.run(), *r.reference, {.tolerance = kWrong});
            const trace::RayCounts counts = r.count();
            r.row.rays = counts.primary + counts.reflected + counts.refracted + counts.shadow;
            r.row.visits = counts.visits;
        }
        std::mt19937 random(1);
        std::vector<std::size_t> order(runners.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        for (int round = 0; round < plan_.rounds && !stopped(); ++round) {
            say("round " + std::to_string(round + 1) + " of " + std::to_string(plan_.rounds));
            std::shuffle(order.begin(), order.end(), random);
            for (const std::size_t i : order) {
                const double wall = wallSeconds(), cpu = cpuSeconds();
                runners[i].run();
                runners[i].row.cpuSeconds.push_back(cpuSeconds() - cpu);
                runners[i].row.wallSeconds.push_back(wallSeconds() - wall);
            }
        }
        if (stopped()) {
            report_.complete = false;
            return;
        }
        const Runner* chosen = nullptr;
        for (const Runner& r : runners)
            if (r.row.isDefault) chosen = &r;
        for (Runner& r : runners) {
            r.row.wall = spreadOf(r.row.wallSeconds), r.row.cpu = spreadOf(r.row.cpuSeconds);
            r.row.noisy = r.row.cpu.mad > kNoisy * r.row.cpu.median;
            r.row.ratio = ratioOf(r.row.cpuSeconds, chosen->row.cpuSeconds);
        }
        for (Runner& r : runners)
            r.row.onFront = std::none_of(runners.begin(), runners.end(), [&](const Runner& o) {
                return &o != &r && dominates(o.row, r.row);
            });
        for (Runner& r : runners) report_.rows.push_back(std::move(r.row));
    }

    /// Clearly faster, and in no column of errors worse.
    static bool dominates(const Row& a, const Row& b) {
        const double pooled = std::sqrt(a.cpu.mad * a.cpu.mad + b.cpu.mad * b.cpu.mad);
        const auto &x = *a.error, &y = *b.error;
        return b.cpu.median - a.cpu.median > 3 * pooled && x.over <= y.over && x.rmse <= y.rmse &&
               x.max <= y.max;
    }

    const world::World& world_;
    const scene::Description& description_;
    const Plan& plan_;
    Octree tree_;
    SceneReport report_;
};

} // namespace

SceneReport bench(const std::string& name, const world::World& world,
                  const scene::Description& description, const Plan& plan) {
    return Bench(name, world, description, plan).run();
}

std::optional<double> priceOfRobustness(const std::vector<SceneReport>& reports) {
    std::vector<double> prices;
    for (const SceneReport& report : reports) {
        double robust = 0, naive = 0;
        for (const Row& row : report.rows) {
            if (row.panel != 'A' || row.scale != 1) continue;
            if (row.name == kProduct) robust = row.cpu.median;
            if (row.name == kProductInF32) naive = row.cpu.median;
        }
        if (robust > 0 && naive > 0) prices.push_back(robust / naive);
    }
    if (prices.empty()) return {};
    return spreadOf(prices).median;
}

Choice choose(const std::vector<SceneReport>& reports, const Wanted& wanted) {
    struct Candidate {
        std::string flags;
        std::size_t scenes = 0;
        double slowest = 0, rmse = 0;
        std::vector<double> rounds; // CPU seconds, summed over the scenes
    };
    std::map<std::string, Candidate> byName;
    for (const SceneReport& report : reports)
        for (const Row& row : report.rows) {
            if (row.panel == 'A' && row.name == "f64-robust" && row.error->over > wanted.maxWrong)
                return {"",
                        "f64-robust has " + std::to_string(row.error->over) + " wrong pixels in " +
                            report.scene + "; no sampling mends that",
                        false};
            if (row.panel != 'B') continue;
            if (row.error->rmse > wanted.maxRmse || row.wall.median > wanted.seconds) continue;
            Candidate& c = byName[row.name];
            c.flags = row.flags;
            ++c.scenes;
            c.slowest = std::max(c.slowest, row.wall.median);
            c.rmse = std::max(c.rmse, row.error->rmse);
            c.rounds.resize(row.cpuSeconds.size());
            for (std::size_t i = 0; i < c.rounds.size(); ++i) c.rounds[i] += row.cpuSeconds[i];
        }
    std::vector<std::pair<double, const Candidate*>> fit;
    for (const auto& [name, c] : byName)
        if (c.scenes == reports.size()) fit.emplace_back(spreadOf(c.rounds).median, &c);
    if (fit.empty()) return {"", "no sampling tried is within the limits on every scene", false};
    std::sort(fit.begin(), fit.end(),
              [](const auto& a, const auto& b) { return a.first < b.first; });
    const Candidate& best = *fit[0].second;
    const auto number = [](double v) {
        std::string s = std::to_string(v);
        return s.substr(0, s.find('.') + 5);
    };
    Choice choice{best.flags,
                  "RMSE " + number(best.rmse) + ", " + number(best.slowest) + " s at most", true};
    for (std::size_t i = 1; i < fit.size(); ++i)
        if (ratioOf(fit[i].second->rounds, best.rounds).holds(1))
            choice.sentence += "; not clearly faster than " + fit[i].second->flags;
    return choice;
}

} // namespace rt::report
