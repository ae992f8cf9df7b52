// The half-edges of a list of polygons, grouped by the edge they lie on.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

namespace rt::loaders {

/// Half-edge h runs from vertex[h] to the vertex of the next corner of its face.
class EdgeGroups {
public:
    /// `vertex` per corner, each below `vertexCount`; corners of face f as in MeshFile::faceStart.
    /// Neighbouring corners differ.
    EdgeGroups(std::span<const std::uint32_t> vertex, std::span<const std::uint32_t> faceStart,
               std::uint32_t vertexCount);

    /// Calls visit(half-edges) for every edge, edges by rising vertices, half-edges rising.
    template <class Visit> void forEach(Visit&& visit) const {
        for (std::size_t bucket = 0; bucket + 1 < bucketStart_.size(); ++bucket)
            for (std::size_t i = bucketStart_[bucket]; i < bucketStart_[bucket + 1];) {
                std::size_t j = i + 1;
                while (j < bucketStart_[bucket + 1] && other_[j] == other_[i]) ++j;
                visit(std::span<const std::uint32_t>(half_.data() + i, j - i));
                i = j;
            }
    }

private:
    std::vector<std::uint32_t> bucketStart_;  // per lower vertex
    std::vector<std::uint32_t> other_, half_; // higher vertex and half-edge, sorted within a bucket
};

} // namespace rt::loaders
