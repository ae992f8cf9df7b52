// Speed of the octree by class of rays, against Embree 3.13 on the very same rays, in one thread.
//
// octree_bench [MESH...] [--json] [--rounds N] [--textbook] [--physical]   single rays, batches, builds
// octree_bench --spheres [flake|random...]                       against Embree's points
// octree_bench --moves [MESH...]                                 updates of moved primitives
// octree_bench --instance [MESH...]                              a rigid body in a tree of its own
// octree_bench --leaks RAYS                                      rays out of closed meshes, at corners and edges
// octree_bench --sweep CONSTANT [MESH...]                        max_objects, bins, least_cut or block_cost
//
// A MESH is a file that rt's loader reads, or one that bench_meshes.hpp makes. All structures take turns
// in every round, so that whatever slows the machine slows them all; times are CPU times of this
// thread, ratios medians of the rounds' ratios, speeds those of the median time. A ratio is against
// Embree's robust mode, single rays; "octree fast", Precision::f32, has one against the default mode too.
#include "measure.hpp"

#include <charconv>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

namespace rt::bench {
namespace {

int run(int argc, char** argv) {
    Options options;
    bool spheres = false, moves = false, instance = false;
    std::uint64_t leaks = 0; // rays
    std::string constant;
    std::vector<std::string> names;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto value = [&]() -> std::string {
            if (i + 1 >= argc) throw std::runtime_error(word + " needs a value");
            return argv[++i];
        };
        const auto readNumber = [&](auto& to) {
            const std::string text = value();
            const char* const end = text.data() + text.size();
            const auto read = std::from_chars(text.data(), end, to);
            if (read.ec != std::errc() || read.ptr != end || to < 1)
                throw std::runtime_error(word + " needs a whole number of at least 1, not '" +
                                         text + "'");
        };
        if (word == "--json")
            options.json = true;
        else if (word == "--spheres")
            spheres = true;
        else if (word == "--moves")
            moves = true;
        else if (word == "--instance")
            instance = true;
        else if (word == "--textbook")
            options.textbook = true;
        else if (word == "--physical")
            options.physical = true;
        else if (word == "--rounds")
            readNumber(options.rounds);
        else if (word == "--sweep")
            constant = value();
        else if (word == "--leaks")
            readNumber(leaks);
        else if (word.starts_with("--"))
            throw std::runtime_error("no option " + word);
        else
            names.push_back(word);
    }
    if (leaks) {
        measureLeaks(leaks);
        return 0;
    }
    if (names.empty())
        names = spheres ? std::vector<std::string>{"flake", "random"}
                : moves || instance
                    ? std::vector<std::string>{"bodies", "ico"}
                    : std::vector<std::string>{"scan70k", "scan870k", "ico", "stadium", "soup"};
    for (const std::string& name : names) {
        const Subject subject =
            spheres ? subjectOf(name, makeBalls(name)) : subjectOf(makeMesh(name));
        if (moves)
            measureMoves(subject, options);
        else if (instance)
            measureInstance(subject, options);
        else if (!constant.empty())
            sweep(subject, options, constant);
        else
            measure(subject, options);
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
