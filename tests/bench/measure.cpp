#include "measure.hpp"

#include "bench_rays.hpp"
#include "clock.hpp"
#include "machine.hpp"
#include "textbook_octree.hpp"
#ifdef RT_BENCH_EMBREE
#include "embree_scene.hpp"
#endif

#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <memory>
#include <span>

namespace rt::bench {
namespace {

using geometry::Hit;
using geometry::PrimitiveId;
using octree::Coherence;
using octree::Octree;

/// One structure, asked in one way.
struct Contender {
    std::string name;
    std::function<void(RayClass)> run;
    bool has[kClasses] = {true, true, true, true};
    std::vector<double> seconds[kClasses] = {};
};

struct Answers {
    std::vector<Hit> hits[kClasses];
    std::vector<std::uint8_t> occluded;

    explicit Answers(const Rays& rays) : occluded(rays.of[kShadow].size()) {
        for (int c = 0; c < kClasses; ++c) hits[c].resize(rays.of[c].size());
    }
    std::size_t differing(const Answers& other, int c) const {
        std::size_t n = 0;
        if (c == kShadow)
            for (std::size_t i = 0; i < occluded.size(); ++i) n += occluded[i] != other.occluded[i];
        else
            for (std::size_t i = 0; i < hits[c].size(); ++i) {
                const Hit &a = hits[c][i], &b = other.hits[c][i];
                n += a.id != b.id || a.t != b.t || a.u != b.u || a.v != b.v;
            }
        return n;
    }
    std::size_t otherIds(const Answers& other, int c) const {
        if (c == kShadow) return differing(other, c);
        std::size_t n = 0;
        for (std::size_t i = 0; i < hits[c].size(); ++i) n += hits[c][i].id != other.hits[c][i].id;
        return n;
    }
};

void ask(const Octree& tree, const Rays& rays, RayClass c, Answers& answers) {
    const auto& list = rays.of[c];
    if (c == kShadow)
        for (std::size_t i = 0; i < list.size(); ++i) answers.occluded[i] = tree.occluded(list[i]);
    else
        for (std::size_t i = 0; i < list.size(); ++i) answers.hits[c][i] = tree.closest(list[i]);
}

void ask(const Octree& tree, const Rays& rays, RayClass c, Coherence coherence, Answers& answers) {
    if (c == kShadow)
        tree.occluded(rays.of[c], answers.occluded, coherence);
    else
        tree.closest(rays.of[c], answers.hits[c], coherence);
}

octree::Visits visitsOf(const Octree& tree, const Rays& rays, int c) {
    octree::Visits visits;
    for (const auto& ray : rays.of[c])
        if (c == kShadow)
            tree.occluded(ray, &visits);
        else
            tree.closest(ray, &visits);
    return visits;
}

void addSegment(geometry::Primitives& p, geometry::Kind kind, std::size_t count) {
    p.segments.push_back({PrimitiveId{0}, static_cast<std::uint32_t>(count), kind, true, 0,
                          geometry::ObjectId{0}, geometry::MaterialId{0}});
}

#ifdef RT_BENCH_EMBREE
std::vector<EmbreeRay> embreeRays(const std::vector<geometry::Ray>& rays) {
    std::vector<EmbreeRay> narrow;
    for (const auto& r : rays) narrow.push_back(embreeRay(r));
    return narrow;
}

std::unique_ptr<EmbreeScene> embreeScene(const Subject& subject, bool robust, int threads = 1) {
    return subject.balls.empty() ? std::make_unique<EmbreeScene>(subject.mesh, robust, threads)
                                 : std::make_unique<EmbreeScene>(subject.balls, robust);
}

/// Embree asked about all classes of rays.
struct EmbreeAnswers {
    std::vector<EmbreeRay> rays[kClasses];
    std::vector<EmbreeHit> hits[kClasses];
    std::vector<char> occluded;

    explicit EmbreeAnswers(const Rays& of) : occluded(of.of[kShadow].size()) {
        for (int c = 0; c < kClasses; ++c) {
            rays[c] = embreeRays(of.of[c]);
            hits[c].resize(rays[c].size());
        }
    }
    void ask(const EmbreeScene& scene, RayClass c, bool packets) {
        const EmbreeRay* const list = rays[c].data();
        const std::size_t count = rays[c].size();
        if (c == kShadow)
            packets ? scene.occluded16(list, count, occluded.data())
                    : scene.occluded(list, count, occluded.data());
        else
            packets ? scene.closest16(list, count, hits[c].data())
                    : scene.closest(list, count, hits[c].data());
    }
    std::size_t differing(const Answers& ours, int c) const {
        std::size_t n = 0;
        for (std::size_t i = 0; i < rays[c].size(); ++i)
            n += c == kShadow ? (ours.occluded[i] != 0) != (occluded[i] != 0)
                              : static_cast<std::uint32_t>(ours.hits[c][i].id) != hits[c][i].id;
        return n;
    }
};
#endif

double ratio(const Contender& a, const Contender& base, int c) {
    std::vector<double> r;
    for (std::size_t i = 0; i < a.seconds[c].size(); ++i)
        r.push_back(base.seconds[c][i] / a.seconds[c][i]);
    return median(r);
}

double wallSecondsOf(const std::function<void()>& call) {
    const auto start = std::chrono::steady_clock::now();
    call();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Bytes that a tree's visits read: nodes, and blocks as full as the tree's are on average.
double bytesTouched(const octree::Visits& visits, const octree::Statistics& tree, double count) {
    const double nodes = static_cast<double>(tree.nodes) * 256;
    const double perPrimitive = (static_cast<double>(tree.bytes) - nodes) / count;
    return static_cast<double>(visits.nodes) * 256 +
           static_cast<double>(visits.triangles + visits.spheres) * perPrimitive;
}

/// Seconds a ray, of some of a class, each asked over and over: then all that it reads is in L1 and every branch foretold, and
/// what is left is how fast the core issues instructions, many rays side by side.
double secondsAtIssueRate(const Octree& tree, const Rays& rays, int c) {
    constexpr std::size_t kSome = 1000;
    constexpr int kTimes = 200;
    const auto& list = rays.of[c];
    std::size_t asked = 0;
    double seconds = 0;
    const auto repeat = [&](const geometry::Ray& ray) {
        for (int i = 0; i < kTimes; ++i)
            if (c == kShadow)
                tree.occluded(ray);
            else
                tree.closest(ray);
    };
    for (std::size_t i = 0; i < list.size(); i += std::max<std::size_t>(1, list.size() / kSome)) {
        repeat(list[i]);
        seconds += cpuSecondsOf([&] { repeat(list[i]); });
        asked += kTimes;
    }
    return seconds / static_cast<double>(asked);
}

} // namespace

Subject subjectOf(Mesh mesh) {
    Subject s;
    s.name = mesh.name;
    s.primitives.triangles.positions = mesh.positions;
    s.primitives.triangles.indices = mesh.indices;
    addSegment(s.primitives, geometry::Kind::triangle, mesh.indices.size());
    s.eye = mesh.eye;
    s.target = mesh.target;
    s.light = mesh.light;
    s.fieldOfView = mesh.fieldOfView;
    s.mesh = std::move(mesh);
    return s;
}

Subject subjectOf(const std::string& name, std::vector<Ball> balls) {
    Subject s;
    s.name = name;
    numeric::Box3d box;
    for (const Ball& b : balls) {
        s.primitives.spheres.push_back({b.center, b.radius});
        box.add({b.center - b.radius, b.center + b.radius});
    }
    addSegment(s.primitives, geometry::Kind::sphere, balls.size());
    const double radius = 0.5 * numeric::length(box.diagonal());
    s.target = box.centre();
    s.eye = s.target + numeric::normalize(Vec3(0.3, 0.4, 1)) * (2 * radius);
    s.light = s.target + numeric::normalize(Vec3(1.3, 1.2, 0.7)) * (3 * radius);
    s.fieldOfView = 2 * std::atan(0.55 / 2);
    s.balls = std::move(balls);
    return s;
}

BuildTimes buildTimes(const Subject& subject, const octree::BuildOptions& options, int rounds) {
    std::vector<double> seconds[2];
    for (int round = 0; round < rounds; ++round)
        for (int threads = 1; threads <= 2; ++threads) {
            octree::BuildOptions o = options;
            o.threads = threads;
            seconds[threads - 1].push_back(
                wallSecondsOf([&] { Octree::build(subject.primitives, o); }));
        }
    return {median(seconds[0]), median(seconds[1])};
}

void measure(const Subject& subject, const Options& options) {
    const auto& primitives = subject.primitives;
    const bool isMesh = subject.balls.empty();
    octree::BuildOptions wide = options.build;
    wide.storage = octree::Storage::f64;
    // Builds take turns too, and come first: as long as an Embree device of one thread lives, oneTBB
    // gives nobody more.
    constexpr int kBuilds = 5;
    std::vector<double> ours1, ours2, theirs1, theirs2;
    for (int i = 0; i < kBuilds; ++i) {
        const BuildTimes times = buildTimes(subject, wide, 1);
        ours1.push_back(times.one);
        ours2.push_back(times.two);
#ifdef RT_BENCH_EMBREE
        theirs1.push_back(embreeScene(subject, true, 1)->buildSeconds());
        theirs2.push_back(embreeScene(subject, true, 2)->buildSeconds());
#endif
    }
    const double build = median(ours1), count = primitives.count();
    const Octree tree = Octree::build(primitives, wide);
    const Octree narrow = Octree::build(primitives, options.build);
    const Rays rays =
        makeRays(tree, primitives, subject.eye, subject.target, subject.light, subject.fieldOfView);
    octree::BuildOptions approximate = options.build;
    approximate.precision = octree::Precision::f32;
    const Octree fast = Octree::build(primitives, approximate);
    Answers single(rays), f32(rays), bundles(rays), turns(rays), inF32(rays), others(rays);

    // The stored answers of single rays, f32 storage and Embree robust are compared below.
    std::vector<Contender> contenders;
    const auto add = [&](const char* name, std::function<void(RayClass)> run) -> Contender& {
        contenders.push_back({name, std::move(run)});
        return contenders.back();
    };
    const std::size_t kSingle = contenders.size();
    add("octree", [&](RayClass c) { ask(tree, rays, c, single); });
    const std::size_t kBundles = contenders.size();
    add("octree 16", [&](RayClass c) { ask(tree, rays, c, Coherence::coherent, bundles); });
    const std::size_t kTurns = contenders.size();
    add("octree in turns", [&](RayClass c) { ask(tree, rays, c, Coherence::incoherent, turns); });
    std::size_t kNarrow = 0;
    if (isMesh) {
        kNarrow = contenders.size();
        add("octree f32", [&](RayClass c) { ask(narrow, rays, c, f32); });
        add("f32 in turns",
            [&](RayClass c) { ask(narrow, rays, c, Coherence::incoherent, others); });
    }
    const std::size_t kFast = contenders.size();
    add("octree fast", [&](RayClass c) { ask(fast, rays, c, inF32); });
    const std::size_t kFastTurns = contenders.size();
    add("fast in turns", [&](RayClass c) { ask(fast, rays, c, Coherence::incoherent, others); });
    add("fast 16", [&](RayClass c) { ask(fast, rays, c, Coherence::coherent, others); });
    std::size_t kRobust = 0, kDefault = 0, kRobust16 = 0;
#ifdef RT_BENCH_EMBREE
    const auto robust = embreeScene(subject, true), plain = embreeScene(subject, false);
    EmbreeAnswers embree(rays), otherEmbree(rays);
    kRobust = contenders.size();
    add("embree robust", [&](RayClass c) { embree.ask(*robust, c, false); });
    kDefault = contenders.size();
    add("embree default", [&](RayClass c) { otherEmbree.ask(*plain, c, false); });
    kRobust16 = contenders.size();
    add("embree robust 16", [&](RayClass c) { otherEmbree.ask(*robust, c, true); });
#endif
    std::unique_ptr<TextbookOctree> textbook;
    Answers old(rays);
    if (options.textbook && isMesh) {
        textbook = std::make_unique<TextbookOctree>(primitives);
        add("textbook octree", [&](RayClass c) {
            const auto& list = rays.of[c];
            for (std::size_t i = 0; i < list.size(); ++i)
                if (c == kShadow)
                    old.occluded[i] = textbook->occluded(list[i]);
                else
                    old.hits[c][i] = textbook->closest(list[i]);
        });
    }
    // Not class by class: each would find its tree gone from the caches, and bundles take up to twice as long.
    for (int round = 0; round < options.rounds; ++round)
        for (Contender& contender : contenders)
            for (int c = 0; c < kClasses; ++c)
                contender.seconds[c].push_back(
                    cpuSecondsOf([&] { contender.run(static_cast<RayClass>(c)); }));
    const Contender& base = contenders[kRobust];
    const auto mrays = [&](const Contender& a, int c) {
        return static_cast<double>(rays.of[c].size()) / median(a.seconds[c]) / 1e6;
    };

    const auto statistics = tree.statistics();
    std::size_t mismatches[kClasses] = {}, otherBits[kClasses] = {}, otherFast[kClasses];
    for (int c = 0; c < kClasses; ++c) {
        otherFast[c] = single.otherIds(inF32, c);
        otherBits[c] = single.differing(bundles, c) + single.differing(turns, c) +
                       (kNarrow ? single.differing(f32, c) : 0);
#ifdef RT_BENCH_EMBREE
        mismatches[c] = embree.differing(single, c);
#endif
    }

    if (options.json) {
        std::printf("{\"mesh\": \"%s\", \"triangles\": %.0f, \"rays\": [", subject.name.c_str(),
                    count);
        const char* comma = "";
        const auto row = [&](const char* name, const char* suffix, int c, const Contender& ours) {
            std::printf("%s{\"class\": \"%s%s\", \"mrays\": %.3f", comma, name, suffix,
                        mrays(ours, c));
            comma = ", ";
            if (kRobust)
                std::printf(", \"ratio_robust\": %.3f, \"ratio_default\": %.3f, "
                            "\"mismatches\": %zu",
                            ratio(ours, base, c), ratio(ours, contenders[kDefault], c),
                            mismatches[c]);
            if (kRobust && suffix[0] == '1')
                std::printf(", \"ratio_robust16\": %.3f", ratio(ours, contenders[kRobust16], c));
            std::printf(", \"other_bits\": %zu}", otherBits[c]);
        };
        for (int c = 0; c < kClasses; ++c) row(kClassNames[c], "", c, contenders[kSingle]);
        for (const int c : {kPrimary, kShadow}) row(kClassNames[c], "16", c, contenders[kBundles]);
        for (int c = 0; c < kClasses; ++c) row(kClassNames[c], "_in_turns", c, contenders[kTurns]);
        if (kNarrow)
            for (int c = 0; c < kClasses; ++c) row(kClassNames[c], "_f32", c, contenders[kNarrow]);
        for (int c = 0; c < kClasses; ++c) {
            const Contender& ours = contenders[kFast];
            std::printf(", {\"class\": \"%s_fast\", \"mrays\": %.3f", kClassNames[c],
                        mrays(ours, c));
            if (kRobust)
                std::printf(", \"ratio_robust\": %.3f, \"ratio_default\": %.3f",
                            ratio(ours, base, c), ratio(ours, contenders[kDefault], c));
            std::printf(", \"other_ids\": %zu}", otherFast[c]);
        }
        std::printf("], \"build_s\": %.4f, \"build2_s\": %.4f, ", build, median(ours2));
        if (kRobust) std::printf("\"ratio_build\": %.3f, ", build / median(theirs1));
        std::printf("\"bytes_per_triangle\": %.1f, \"bytes_per_triangle_f32\": %.1f}\n",
                    static_cast<double>(statistics.bytes) / count,
                    static_cast<double>(narrow.statistics().bytes) / count);
        std::fflush(stdout);
        return;
    }

    std::printf("%s: %.0f primitives; bytes each %.1f", subject.name.c_str(), count,
                static_cast<double>(statistics.bytes) / count);
    if (kNarrow) std::printf(", f32 %.1f", static_cast<double>(narrow.statistics().bytes) / count);
#ifdef RT_BENCH_EMBREE
    std::printf(", Embree %.1f", static_cast<double>(robust->bytes()) / count);
#endif
    if (textbook) std::printf(", textbook %.1f", static_cast<double>(textbook->bytes()) / count);
    std::printf("\nbuild: %.4f s, two threads %.4f (%.2f)", build, median(ours2),
                build / median(ours2));
    if (kRobust)
        std::printf("; Embree %.4f, two threads %.4f (%.2f); ratio %.2f", median(theirs1),
                    median(theirs2), median(theirs1) / median(theirs2), build / median(theirs1));
    std::printf("\n%-18s", "Mrays/s (ratio)");
    for (const char* name : kClassNames) std::printf(" %15s", name);
    std::printf("\n");
    const auto line = [&](const char* name, const Contender& ours, const Contender& theirs) {
        std::printf("%-18s", name);
        double product = 1;
        for (int c = 0; c < kClasses; ++c) {
            const double r = ratio(ours, theirs, c);
            product *= r;
            std::printf(" %8.2f (%4.2f)", mrays(ours, c), r);
        }
        std::printf("   mean %.3f\n", std::pow(product, 0.25));
    };
    for (const Contender& contender : contenders) line(contender.name.c_str(), contender, base);
    if (kDefault) {
        line("fast / default", contenders[kFast], contenders[kDefault]);
        line("in turns / default", contenders[kFastTurns], contenders[kDefault]);
    }
    const auto counts = [](const char* name, const std::size_t* n) {
        std::printf("%-18s %15zu %15zu %15zu %15zu\n", name, n[0], n[1], n[2], n[3]);
    };
    counts("other bits", otherBits);
    counts("other id, fast", otherFast);
    if (kRobust) counts("other id, Embree", mismatches);
    if (textbook) {
        std::size_t n[kClasses];
        for (int c = 0; c < kClasses; ++c) n[c] = single.differing(old, c);
        counts("other, textbook", n);
    }
    if (options.physical) {
        const Machine machine = measureMachine();
        double nodes[kClasses], tests[kClasses], bytes[kClasses];
        for (int c = 0; c < kClasses; ++c) {
            const auto n = static_cast<double>(rays.of[c].size());
            const auto visits = visitsOf(tree, rays, c);
            nodes[c] = static_cast<double>(visits.nodes) / n;
            tests[c] = static_cast<double>(visits.triangles + visits.spheres) / n;
            bytes[c] = bytesTouched(visits, statistics, count) / n;
        }
        const auto values = [&](const char* name, const auto& value) {
            std::printf("%-18s", name);
            for (int c = 0; c < kClasses; ++c) std::printf(" %15.2f", value(c));
            std::printf("\n");
        };
        values("nodes/ray", [&](int c) { return nodes[c]; });
        values("boxes/ray", [&](int c) { return 8 * nodes[c]; });
        values("primitives/ray", [&](int c) { return tests[c]; });
        values("bytes/ray", [&](int c) { return bytes[c]; });
        values("ns/ray", [&](int c) { return 1e3 / mrays(contenders[kSingle], c); });
        values("ns/ray at best: L2", [&](int c) { return bytes[c] / machine.l2Bandwidth * 1e9; });
        values("  L3 or memory", [&](int c) { return bytes[c] / machine.memoryBandwidth * 1e9; });
        values("  issue rate", [&](int c) { return secondsAtIssueRate(tree, rays, c) * 1e9; });
        std::printf("one thread reads %.1f GB/s from L2 and %.1f GB/s from memory\n",
                    machine.l2Bandwidth / 1e9, machine.memoryBandwidth / 1e9);
    }
    std::fflush(stdout);
}

void sweep(const Subject& subject, const Options& options, const std::string& constant) {
    struct Value {
        std::string text;
        octree::BuildOptions build;
    };
    std::vector<Value> values;
    const auto vary = [&](std::initializer_list<int> list, const auto& set) {
        for (const int x : list) {
            Value v{std::to_string(x), options.build};
            set(v.build, x);
            values.push_back(std::move(v));
        }
    };
    using Build = octree::BuildOptions;
    if (constant == "max_objects")
        vary({4, 8, 12, 16, 24, 32},
             [](Build& b, int x) { b.maxObjects = static_cast<std::uint32_t>(x); });
    else if (constant == "bins")
        vary({4, 8, 12, 16, 24, 32}, [](Build& b, int x) { b.tuning.bins = x; });
    else if (constant == "least_cut")
        vary({1, 2, 4, 6, 8, 12},
             [](Build& b, int x) { b.tuning.leastCut = static_cast<std::uint32_t>(x); });
    else if (constant == "block_cost") // in percent of a node's
        vary({40, 60, 80, 100, 130, 170},
             [](Build& b, int x) { b.tuning.blockCost = static_cast<float>(x) / 100; });
    else
        throw std::runtime_error("no constant '" + constant +
                                 "': max_objects, bins, least_cut or block_cost");
    const Octree reference = Octree::build(subject.primitives, options.build);
    const Rays rays = makeRays(reference, subject.primitives, subject.eye, subject.target,
                               subject.light, subject.fieldOfView);
    std::vector<Octree> trees;
    for (const Value& value : values)
        trees.push_back(Octree::build(subject.primitives, value.build));
    Answers answers(rays);
    std::vector<std::vector<double>> seconds[kClasses];
    for (auto& s : seconds) s.resize(values.size());
    for (int round = 0; round < options.rounds; ++round)
        for (std::size_t i = 0; i < values.size(); ++i)
            for (int c = 0; c < kClasses; ++c)
                seconds[c][i].push_back(
                    cpuSecondsOf([&] { ask(trees[i], rays, static_cast<RayClass>(c), answers); }));
    std::printf("%s, %s: Mrays/s\n%-12s %10s %10s %10s %10s %10s %10s %8s\n", subject.name.c_str(),
                constant.c_str(), "value", "primary", "shadow", "mirror", "random", "mean",
                "bytes each", "build s");
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::printf("%-12s", values[i].text.c_str());
        double product = 1;
        for (int c = 0; c < kClasses; ++c) {
            const double speed =
                static_cast<double>(rays.of[c].size()) / median(seconds[c][i]) / 1e6;
            product *= speed;
            std::printf(" %10.3f", speed);
        }
        std::printf(" %10.3f %10.1f %8.4f\n", std::pow(product, 0.25),
                    static_cast<double>(trees[i].statistics().bytes) / subject.primitives.count(),
                    buildTimes(subject, values[i].build, 3).one);
    }
    std::fflush(stdout);
}

} // namespace rt::bench
