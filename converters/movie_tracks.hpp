// A legacy movie's statements to the scene language's `animation`.
#pragma once
#include <converters/statements.hpp>
#include <core/scene/node.hpp>

#include <span>

namespace rt::converters {

/// An object of the scene and the run of numbers by which a movie file knows it: one, or one per face of a mesh.
struct NumberedObject {
    std::string name;
    Keyword keyword{};
    std::uint64_t first = 0;
    std::optional<std::uint64_t> count; // none: a mesh whose file cannot be read
    scene::Location location;
};

struct MovieContext {
    std::span<const NumberedObject> objects;   // by rising `first`
    std::span<const std::string> textureNames; // by legacy index
    bool lenient = false;
    bool complete =
        true; // false: the scene has errors, so numbers may be off and are not held against it
};

/// Errors E0384, E0389 to E0392 and E0395. Comments stay beside what they commented.
scene::Node animationNode(const MovieText& movie, const scene::Location& movieFile,
                          const MovieContext& context, scene::Diagnostics& diagnostics);

} // namespace rt::converters
