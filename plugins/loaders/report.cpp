#include "report.hpp"

#include <algorithm>
#include <charconv>
#include <string>

namespace rt::loaders {
namespace {

std::string json(std::string_view text) {
    static constexpr char kHex[] = "0123456789abcdef";
    std::string out = "\"";
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\')
            out += {'\\', c};
        else if (byte < 0x20 || byte >= 0x7f) // bytes of unknown encoding are shown as Latin-1
            out += {'\\', 'u', '0', '0', kHex[byte >> 4], kHex[byte & 15]};
        else
            out += c;
    }
    return out + '"';
}

/// {"min": [x, y, z], "max": [...]} of the faces that are left; null where none is.
std::string boundsOf(const MeshFile& file, const RepairedMesh& repaired) {
    Box box{Vector3{kInfinity, kInfinity, kInfinity}, Vector3{-kInfinity, -kInfinity, -kInfinity}};
    for (std::uint32_t f = 0; f < repaired.faceCount(); ++f) {
        if (repaired.outcomes[repaired.sourceFace[f]].action == FaceAction::dropped) continue;
        for (auto c = repaired.faceStart[f]; c < repaired.faceStart[f + 1]; ++c) {
            const Vector3& p = file.positions[file.cornerPosition[repaired.corners[c]]];
            box.lower = {std::min(box.lower.x, p.x), std::min(box.lower.y, p.y),
                         std::min(box.lower.z, p.z)};
            box.upper = {std::max(box.upper.x, p.x), std::max(box.upper.y, p.y),
                         std::max(box.upper.z, p.z)};
        }
    }
    if (!(box.lower.x <= box.upper.x)) return "null";
    const auto array = [](const Vector3& v) {
        std::string text;
        for (const double value : {v.x, v.y, v.z}) {
            char digits[32];
            text += text.empty() ? "[" : ", ";
            text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
        }
        return text + "]";
    };
    return "{\"min\": " + array(box.lower) + ", \"max\": " + array(box.upper) + "}";
}

} // namespace

void writeReport(const MeshFile& file, const RepairedMesh& repaired, bool everyFace,
                 const std::function<void(std::string_view)>& write) {
    const RepairSummary& s = repaired.summary;
    std::uint32_t actions[3] = {};
    for (const FaceOutcome& o : repaired.outcomes) ++actions[static_cast<std::size_t>(o.action)];
    std::string out = "{\n  \"file\": " + json(fileName(file.path)) + ",\n  \"summary\": {";
    const char* separator = "";
    const auto count = [&](const char* key, std::uint64_t n) {
        out += separator + ("\n    \"" + std::string(key)) + "\": " + std::to_string(n);
        separator = ",";
    };
    count("faces", s.faces);
    count("kept", actions[0]);
    count("flipped", actions[1]);
    count("dropped", actions[2]);
    count("dropped_few_corners", s.count(FaceReason::fewCorners));
    count("dropped_repeated_corner", s.count(FaceReason::repeatedCorner));
    count("dropped_no_area", s.count(FaceReason::zeroArea));
    count("dropped_duplicate", s.count(FaceReason::duplicate));
    count("dropped_reversed_duplicate", s.count(FaceReason::reversedDuplicate));
    count("flipped_against_neighbours", s.count(FaceReason::againstNeighbours));
    count("flipped_inside_out", s.count(FaceReason::insideOut));
    count("vertices", s.vertices);
    count("welded_vertices", s.weldedVertices);
    count("texture_coordinates", file.uvs.size());
    count("normals", file.normals.size());
    count("names", file.names.size());
    count("materials", file.materials.size());
    count("components", s.components);
    count("components_turned", s.turnedComponents);
    count("components_nested", s.nestedComponents);
    count("components_without_outside", s.undefinedComponents);
    count("components_one_sided", s.unorientableComponents);
    count("open_edges", s.openEdges);
    count("non_manifold_edges", s.nonManifoldEdges);
    count("seam_edges", s.seamEdges);
    out += "\n  },\n  \"closed\": ";
    out += s.openEdges == 0 ? "true" : "false";
    out += ",\n  \"bounds\": " + boundsOf(file, repaired);
    out += ",\n  \"notes\": [";
    separator = "";
    std::vector<std::string> notes = file.notes;
    for (const std::string& note : s.notes()) notes.push_back(note);
    for (const std::string& note : notes) {
        out += separator + ("\n    " + json(note));
        separator = ",";
    }
    out += notes.empty() ? "]" : "\n  ]";
    if (everyFace) {
        out += ",\n  \"faces\": [";
        separator = "";
        for (const FaceOutcome& o : repaired.outcomes) {
            out += separator;
            out += "\n    {\"action\": \"";
            out += text(o.action);
            out += "\", \"reason\": \"";
            out += text(o.reason);
            out += "\"}";
            separator = ",";
            constexpr std::size_t kPiece = std::size_t{1} << 16;
            if (out.size() < kPiece) continue;
            write(out);
            out.clear();
        }
        out += "\n  ]";
    }
    write(out + "\n}\n");
}

} // namespace rt::loaders
