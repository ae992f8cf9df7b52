// The cases, by their ids: S spheres, T triangles, O leaving surfaces, B boxes, A motion, R refraction, N interpolated
// normals, E backgrounds, C whole pictures, P the promise of max_error. All run rt's own code; what is expected is exact
// or binary128, and for P a far finer sampling.
#pragma once
#include <tests/stability/table.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace rt::stability {

/// How much is tried.
struct Load {
    bool full = false; // else what a continuous build can afford
    double share = 1;  // of the full run's trials
    std::uint64_t seed = 1;

    std::uint64_t of(std::uint64_t inCi, std::uint64_t inFull) const {
        return full ? static_cast<std::uint64_t>(static_cast<double>(inFull) * share) : inCi;
    }
    /// Width of a picture: its pixels are the trials.
    std::uint32_t width(std::uint32_t inCi, std::uint32_t inFull) const {
        return full ? std::max(inCi, static_cast<std::uint32_t>(inFull * std::sqrt(share))) : inCi;
    }
};

struct Case {
    const char* id;
    void (*run)(const Load& load, Table& table);
};

/// By family, in the order of their letters above.
const std::vector<Case>& allCases();

void spheres(const Load&, Table&);
void closedMeshes(const Load&, Table&);
void triangles(const Load&, Table&);
void coplanarFaces(const Load&, Table&);
void leavingSurfaces(const Load&, Table&);
void boxes(const Load&, Table&);
void motion(const Load&, Table&);
void refraction(const Load&, Table&);
void interpolatedNormals(const Load&, Table&);
void backgrounds(const Load&, Table&);
void pictures(const Load&, Table&);
void adaptiveSampling(const Load&, Table&);

} // namespace rt::stability
