// Embree 3 as the yardstick: the same geometry in f32, one thread, its public interface.
#pragma once
#include "bench_meshes.hpp"
#include "bench_rays.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace rt::bench {

struct EmbreeRay {
    float origin[3], tMax, direction[3], reserved;
};
/// What f32 holds of a ray.
EmbreeRay embreeRay(const geometry::Ray& ray);

struct EmbreeHit {
    float t, u, v;
    std::uint32_t id; // 0xFFFFFFFF: none
};

class EmbreeScene {
public:
    EmbreeScene(const Mesh& mesh, bool robust, int threads = 1);
    EmbreeScene(const std::vector<Ball>& balls, bool robust);
    ~EmbreeScene();

    void closest(const EmbreeRay* rays, std::size_t count, EmbreeHit* hits) const;
    void occluded(const EmbreeRay* rays, std::size_t count, char* answers) const;
    /// In packets of 16; count is a multiple of 16.
    void closest16(const EmbreeRay* rays, std::size_t count, EmbreeHit* hits) const;
    void occluded16(const EmbreeRay* rays, std::size_t count, char* answers) const;

    double buildSeconds() const;
    std::size_t bytes() const; // of the tree

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace rt::bench
