// What the original made of a Wavefront OBJ file: its faces are the objects that a movie file counts.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace rt::converters {

struct ObjFaces {
    std::uint64_t count = 0; // one per `f` line; 0 where the original refused the file
    std::uint64_t polygons =
        0; // with more than three corners: the original drew their first triangle alone
    std::uint64_t refusedLine =
        0; // where it did: an index that is negative, 0 or beyond the vertices; else 0
};

ObjFaces countObjFaces(std::string_view text);

/// Nothing when the file cannot be read.
std::optional<ObjFaces> readObjFaces(const std::string& path);

} // namespace rt::converters
