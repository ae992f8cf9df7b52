// octree_bench MESH... [--json] [--rounds N] [--spheres]: speed of the octree by class of rays, against
// Embree 3.13 on the very same rays, in one thread.
//
// All structures take turns in every round, so that whatever slows the machine slows them all; a time
// is CPU time of this thread, a ratio the median of the rounds' ratios, a speed the median's.
#include "bench_meshes.hpp"
#include "bench_rays.hpp"
#ifdef RT_BENCH_EMBREE
#include "embree_scene.hpp"
#endif

#include <core/octree/octree.hpp>
#include <core/parallel/parallel.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace rt::bench {
namespace {

using geometry::Hit;
using geometry::PrimitiveId;
using geometry::Primitives;
using octree::Octree;

double cpuSeconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) / 1e9;
}

double median(std::vector<double> v) {
    std::nth_element(v.begin(), v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2), v.end());
    return v[v.size() / 2];
}

struct Contender {
    std::string name;
    std::function<void(RayClass)> run; // null for a class that it does not do
    std::vector<double> seconds[kClasses];
};

struct Options {
    bool json = false, spheres = false;
    int rounds = 5;
    octree::BuildOptions build;
};

struct Subject {
    std::string name;
    std::unique_ptr<Primitives> primitives = std::make_unique<Primitives>();
    Vec3 eye, target, light;
    double fieldOfView;
};

void addSegment(Primitives& p, geometry::Kind kind, std::size_t count) {
    p.segments.push_back({PrimitiveId{0}, static_cast<std::uint32_t>(count), kind, true, 0,
                          geometry::ObjectId{0}, geometry::MaterialId{0}});
}

Subject subjectOf(const Mesh& mesh) {
    Subject s;
    s.name = mesh.name;
    s.primitives->triangles.positions = mesh.positions;
    s.primitives->triangles.indices = mesh.indices;
    addSegment(*s.primitives, geometry::Kind::triangle, mesh.indices.size());
    s.eye = mesh.eye;
    s.target = mesh.target;
    s.light = mesh.light;
    s.fieldOfView = mesh.fieldOfView;
    return s;
}

Subject subjectOf(const std::string& name, const std::vector<Ball>& balls) {
    Subject s;
    s.name = name;
    numeric::Box3d box;
    for (const Ball& b : balls) {
        s.primitives->spheres.push_back({b.center, b.radius});
        box.add({b.center - b.radius, b.center + b.radius});
    }
    addSegment(*s.primitives, geometry::Kind::sphere, balls.size());
    const double radius = 0.5 * numeric::length(box.diagonal());
    s.target = box.centre();
    s.eye = s.target + numeric::normalize(Vec3(0.3, 0.4, 1)) * (2 * radius);
    s.light = s.target + numeric::normalize(Vec3(1.3, 1.2, 0.7)) * (3 * radius);
    s.fieldOfView = 2 * std::atan(0.55 / 2);
    return s;
}

double buildSeconds(const Primitives& primitives, octree::BuildOptions options, int threads) {
    options.threads = threads;
    const auto start = std::chrono::steady_clock::now();
    const Octree tree = Octree::build(primitives, options);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void measure(const Subject& subject, const Mesh* mesh, const std::vector<Ball>* balls,
             const Options& options) {
    const Primitives& primitives = *subject.primitives;
    const Octree tree = Octree::build(primitives, options.build);
    const Rays rays =
        makeRays(tree, primitives, subject.eye, subject.target, subject.light, subject.fieldOfView);
    std::vector<Hit> hits[kClasses];
    std::vector<char> occluded(rays.of[kShadow].size());
    for (int c = 0; c < kClasses; ++c) hits[c].resize(rays.of[c].size());

    std::vector<Contender> contenders;
    contenders.push_back({"octree",
                          [&](RayClass c) {
                              const auto& list = rays.of[c];
                              if (c == kShadow)
                                  for (std::size_t i = 0; i < list.size(); ++i)
                                      occluded[i] = tree.occluded(list[i]);
                              else
                                  for (std::size_t i = 0; i < list.size(); ++i)
                                      hits[c][i] = tree.closest(list[i]);
                          },
                          {}});
    std::vector<Hit> batchHits;
    std::vector<std::uint8_t> batchOccluded(occluded.size());
    for (const auto& list : rays.of) batchHits.resize(std::max(batchHits.size(), list.size()));
    const auto batch = [&](RayClass c, octree::Coherence coherence) {
        const auto& list = rays.of[c];
        if (c == kShadow)
            tree.occluded(list, batchOccluded, coherence);
        else
            tree.closest(list, std::span(batchHits).first(list.size()), coherence);
    };
    contenders.push_back(
        {"octree bundles", [&](RayClass c) { batch(c, octree::Coherence::coherent); }, {}});
    contenders.push_back(
        {"octree in turns", [&](RayClass c) { batch(c, octree::Coherence::incoherent); }, {}});
    constexpr std::size_t kBase = 3; // Embree robust: the ratios are to this
#ifdef RT_BENCH_EMBREE
    const auto scene = [&](bool robust) {
        return mesh ? std::make_unique<EmbreeScene>(*mesh, robust)
                    : std::make_unique<EmbreeScene>(*balls, robust);
    };
    const auto robust = scene(true), plain = scene(false);
    std::vector<EmbreeRay> embreeRays[kClasses];
    for (int c = 0; c < kClasses; ++c)
        for (const auto& r : rays.of[c])
            embreeRays[c].push_back(
                {{static_cast<float>(r.origin.x), static_cast<float>(r.origin.y),
                  static_cast<float>(r.origin.z)},
                 static_cast<float>(r.tMax),
                 {static_cast<float>(r.direction.x), static_cast<float>(r.direction.y),
                  static_cast<float>(r.direction.z)},
                 0});
    std::vector<EmbreeHit> embreeHits[kClasses], scratch;
    std::vector<char> embreeOccluded(occluded.size()), scratchOccluded(occluded.size());
    for (int c = 0; c < kClasses; ++c) {
        embreeHits[c].resize(rays.of[c].size());
        scratch.resize(std::max(scratch.size(), rays.of[c].size()));
    }
    const auto embree = [&](const EmbreeScene& e, RayClass c, bool keep, bool packets) {
        const auto& list = embreeRays[c];
        EmbreeHit* const out = keep ? embreeHits[c].data() : scratch.data();
        char* const answers = keep ? embreeOccluded.data() : scratchOccluded.data();
        if (c == kShadow)
            packets ? e.occluded16(list.data(), list.size(), answers)
                    : e.occluded(list.data(), list.size(), answers);
        else
            packets ? e.closest16(list.data(), list.size(), out)
                    : e.closest(list.data(), list.size(), out);
    };
    contenders.push_back(
        {"embree robust", [&](RayClass c) { embree(*robust, c, true, false); }, {}});
    contenders.push_back(
        {"embree default", [&](RayClass c) { embree(*plain, c, false, false); }, {}});
    contenders.push_back(
        {"embree robust 16", [&](RayClass c) { embree(*robust, c, false, true); }, {}});
#endif
    for (int round = 0; round < options.rounds; ++round)
        for (Contender& contender : contenders)
            for (int c = 0; c < kClasses; ++c) {
                const double start = cpuSeconds();
                contender.run(static_cast<RayClass>(c));
                contender.seconds[c].push_back(cpuSeconds() - start);
            }
    const auto ratio = [&](const Contender& a, const Contender& base, int c) {
        std::vector<double> r;
        for (std::size_t i = 0; i < a.seconds[c].size(); ++i)
            r.push_back(base.seconds[c][i] / a.seconds[c][i]);
        return median(r);
    };
    const auto mrays = [&](const Contender& a, int c) {
        return static_cast<double>(rays.of[c].size()) / median(a.seconds[c]) / 1e6;
    };
    const auto statistics = tree.statistics();
    const double count = primitives.count();
    const double build = buildSeconds(primitives, options.build, 1);
    if (!options.json) {
        std::printf("%s: %.0f primitives, %.1f bytes each, built in %.3f s (1 thread), %.3f s (2)",
                    subject.name.c_str(), count, static_cast<double>(statistics.bytes) / count,
                    build, buildSeconds(primitives, options.build, 2));
#ifdef RT_BENCH_EMBREE
        std::printf("; Embree %.1f bytes each, %.3f s",
                    static_cast<double>(robust->bytes()) / count, robust->buildSeconds());
#endif
        std::printf("\n%-18s", "nodes, tests/ray");
        for (int c = 0; c < kClasses; ++c) {
            octree::Visits visits;
            for (const auto& r : rays.of[c])
                if (c == kShadow)
                    tree.occluded(r, &visits);
                else
                    tree.closest(r, &visits);
            const auto n = static_cast<double>(rays.of[c].size());
            std::printf(" %7.2f,%7.2f", static_cast<double>(visits.nodes) / n,
                        static_cast<double>(visits.triangles + visits.spheres) / n);
        }
        std::printf("\n%-18s", "Mrays/s (ratio)");
        for (const char* name : kClassNames) std::printf(" %15s", name);
        std::printf("\n");
        const Contender& base = contenders.size() > kBase ? contenders[kBase] : contenders[0];
        for (const Contender& contender : contenders) {
            std::printf("%-18s", contender.name.c_str());
            double product = 1;
            for (int c = 0; c < kClasses; ++c) {
                const double r = ratio(contender, base, c);
                product *= r;
                std::printf(" %8.2f (%4.2f)", mrays(contender, c), r);
            }
            std::printf("   mean %.3f\n", std::pow(product, 0.25));
        }
    }
    std::size_t mismatches[kClasses] = {};
#ifdef RT_BENCH_EMBREE
    for (int c = 0; c < kClasses; ++c)
        for (std::size_t i = 0; i < rays.of[c].size(); ++i)
            mismatches[c] += c == kShadow
                                 ? occluded[i] != embreeOccluded[i]
                                 : static_cast<std::uint32_t>(hits[c][i].id) != embreeHits[c][i].id;
    if (!options.json)
        std::printf("%-18s %15zu %15zu %15zu %15zu\n", "other id", mismatches[0], mismatches[1],
                    mismatches[2], mismatches[3]);
#else
    (void)mesh;
    (void)balls;
#endif
    if (options.json) {
        std::printf("{\"mesh\": \"%s\", \"triangles\": %.0f, \"rays\": [", subject.name.c_str(),
                    count);
        for (int c = 0; c < kClasses; ++c) {
            std::printf("%s{\"class\": \"%s\", \"mrays\": %.3f", c ? ", " : "", kClassNames[c],
                        mrays(contenders[0], c));
            if (contenders.size() > kBase)
                std::printf(", \"ratio_robust\": %.3f, \"ratio_default\": %.3f, "
                            "\"mismatches\": %zu",
                            ratio(contenders[0], contenders[kBase], c),
                            ratio(contenders[0], contenders[kBase + 1], c), mismatches[c]);
            std::printf("}");
        }
        std::printf("], \"build_s\": %.4f, ", build);
#ifdef RT_BENCH_EMBREE
        std::printf("\"ratio_build\": %.3f, ", build / robust->buildSeconds());
#endif
        std::printf("\"bytes_per_triangle\": %.1f}\n",
                    static_cast<double>(statistics.bytes) / count);
    }
    std::fflush(stdout);
}

int run(int argc, char** argv) {
    Options options;
    std::vector<std::string> meshes;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto value = [&] {
            if (i + 1 >= argc) throw std::runtime_error(word + " needs a value");
            return std::stoi(argv[++i]);
        };
        if (word == "--json")
            options.json = true;
        else if (word == "--spheres")
            options.spheres = true;
        else if (word == "--rounds")
            options.rounds = value();
        else if (word == "--f64")
            options.build.storage = octree::Storage::f64;
        else if (word == "--max-objects")
            options.build.maxObjects = static_cast<std::uint32_t>(value());
        else if (word.starts_with("--"))
            throw std::runtime_error("no option " + word);
        else
            meshes.push_back(word);
    }
    if (meshes.empty())
        meshes = options.spheres ? std::vector<std::string>{"flake", "random"}
                                 : std::vector<std::string>{"ico", "stadium", "soup"};
    for (const std::string& name : meshes) {
        if (options.spheres) {
            const auto balls = makeBalls(name);
            measure(subjectOf(name, balls), nullptr, &balls, options);
        } else {
            const Mesh mesh = makeMesh(name);
            measure(subjectOf(mesh), &mesh, nullptr, options);
        }
    }
    return 0;
}

} // namespace
} // namespace rt::bench

int main(int argc, char** argv) {
    try {
        return rt::bench::run(argc, argv);
    } catch (const std::exception& e) {
        std::fprintf(stderr, "octree_bench: %s\n", e.what());
        return 2;
    }
}
