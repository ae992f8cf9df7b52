// One subject measured: every structure on the same rays, in turns.
#pragma once
#include "bench_meshes.hpp"

#include <core/octree/octree.hpp>

#include <string>

namespace rt::bench {

struct Options {
    bool json = false;
    bool textbook = false; // the textbook octree too, which is slow
    bool physical = false; // what is touched, and what the machine could deliver
    int rounds = 5;
    octree::BuildOptions build;
};

struct Subject {
    std::string name;
    geometry::Primitives primitives;
    Vec3 eye, target, light;
    double fieldOfView = 0; // whole angle, radians
    Mesh mesh;              // of triangles; else
    std::vector<Ball> balls;
};

Subject subjectOf(Mesh mesh);
Subject subjectOf(const std::string& name, std::vector<Ball> balls);

/// Prints a table, or one line of JSON.
void measure(const Subject& subject, const Options& options);

/// Median seconds of building on one and on two threads, wall clock, in turns.
struct BuildTimes {
    double one, two;
};
BuildTimes buildTimes(const Subject& subject, const octree::BuildOptions& options, int rounds);

/// How fast primary, shadow, mirror and random rays are with other constants; one line for each value.
void sweep(const Subject& subject, const Options& options, const std::string& constant);

/// Updates of a movable tree against builds; one line for each kind of motion.
void measureMoves(const Subject& subject, const Options& options);

/// What a rigid body, or the whole mesh where none is marked, would gain as an instance: a tree at rest under a
/// moving frame. One line for each class of rays.
void measureInstance(const Subject& subject, const Options& options);

/// How many of about `rays` rays at corners, and as many at edges, leave closed meshes from inside; one line for each.
void measureLeaks(std::uint64_t rays);

} // namespace rt::bench
