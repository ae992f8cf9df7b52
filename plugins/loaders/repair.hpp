// Repair of a list of polygons before any half-edge structure: what lies together is joined, what is there twice or
// has no area is dropped, what is joined is wound alike, and closed bodies are wound outward.
#pragma once
#include "mesh_file.hpp"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace rt::loaders {

enum class Repair : std::uint8_t {
    full,   // everything below
    orient, // no face is dropped but those with less than three distinct corners
    none    // neither dropped nor turned
};

enum class FaceAction : std::uint8_t { kept, flipped, dropped };

enum class FaceReason : std::uint8_t {
    none,
    againstNeighbours, // flipped: wound against the majority of its component
    insideOut,         // flipped: with its whole component, which was wound inward
    fewCorners,        // dropped: less than three corners in the file
    repeatedCorner,    // dropped: less than three distinct positions
    zeroArea,  // dropped: all corners on one line, or a hanging sliver thinner than f32 resolves
    duplicate, // dropped: an earlier face has the same corners
    reversedDuplicate // dropped: an earlier face has the same corners the other way round
};

const char* text(FaceAction);
const char* text(FaceReason);

struct FaceOutcome {
    FaceAction action = FaceAction::kept;
    FaceReason reason = FaceReason::none;
};

struct RepairSummary {
    std::uint32_t faces = 0;                 // in the file
    std::uint32_t vertices = 0;              // in the file
    std::uint32_t weldedVertices = 0;        // that lie exactly on an earlier one
    std::array<std::uint32_t, 8> outcomes{}; // faces by FaceReason
    std::uint32_t components = 0;            // connected by edges that exactly two faces share
    std::uint32_t turnedComponents =
        0; // closed ones that were wound inward, open ones that look so
    std::uint32_t undefinedComponents =
        0;                              // "outside" is not defined: left as their majority is wound
    std::uint32_t nestedComponents = 0; // closed, inside another closed one: turned only with it
    std::uint32_t unorientableComponents = 0; // one-sided, such as a Moebius strip
    std::uint32_t seamEdges = 0;              // of these, where the winding changes
    std::uint32_t nonManifoldEdges = 0;       // shared by three faces or more
    std::uint32_t openEdges = 0;              // whose faces do not cancel: none is a closed body

    std::uint32_t count(FaceReason r) const { return outcomes[static_cast<std::size_t>(r)]; }
    /// One sentence each for everything that was changed or could not be decided.
    std::vector<std::string> notes() const;
};

/// The faces that are left, wound as they should be. Half-edge h runs from corner h to the next corner of its face.
struct RepairedMesh {
    std::vector<std::uint32_t> weld;       // per vertex of the file: the first at the same position
    std::vector<std::uint32_t> faceStart;  // as in MeshFile
    std::vector<std::uint32_t> corners;    // corner of MeshFile; neighbours differ in position
    std::vector<std::uint32_t> sourceFace; // per face: its number in the file
    std::vector<std::uint32_t>
        mate; // per half-edge: the one that runs back along the same edge, or kNone
    std::vector<FaceOutcome> outcomes; // per face of the file
    RepairSummary summary;

    std::uint32_t faceCount() const { return static_cast<std::uint32_t>(sourceFace.size()); }
};

RepairedMesh repair(const MeshFile& file, Repair level);

} // namespace rt::loaders
