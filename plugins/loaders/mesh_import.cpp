#include "mesh_import.hpp"

#include "exact.hpp"
#include "file_bytes.hpp"
#include "normals.hpp"
#include "obj_text.hpp"
#include "ply.hpp"
#include "triangulate.hpp"

#include <algorithm>
#include <cmath>

namespace rt::loaders {
namespace {

/// Triangles of the repaired faces with their connectivity.
struct Triangles {
    ConnectedTriangles connected;                      // vertices are welded ones of the file
    std::vector<std::array<std::uint32_t, 3>> corners; // of the file
    std::vector<std::uint32_t> repairedFace;           // per triangle
    std::uint32_t crossedFaces = 0;
};

class Cutter {
public:
    Cutter(const MeshFile& file, const RepairedMesh& repaired) : file_(file), repaired_(repaired) {}

    Triangles run() {
        const std::size_t n = repaired_.corners.size() - 2 * std::size_t{repaired_.faceCount()};
        out_.corners.reserve(n), out_.connected.vertices.reserve(n), out_.repairedFace.reserve(n);
        out_.connected.face.reserve(n), out_.connected.mate.reserve(3 * n);
        out_.connected.positions = file_.positions;
        outside_.assign(repaired_.corners.size(), kNone);
        for (std::uint32_t f = 0; f < repaired_.faceCount(); ++f) cutFace(f);
        // Half-edges of polygons that became half-edges of triangles carry their mates over.
        for (std::uint32_t h = 0; h < outside_.size(); ++h) {
            const std::uint32_t m = repaired_.mate[h];
            if (m != kNone) out_.connected.mate[outside_[h]] = outside_[m];
        }
        return std::move(out_);
    }

private:
    std::uint32_t vertexOf(std::uint32_t corner) const {
        return repaired_.weld[file_.cornerPosition[corner]];
    }

    void cutFace(std::uint32_t f) {
        const std::uint32_t from = repaired_.faceStart[f], n = repaired_.faceStart[f + 1] - from;
        // Beginning at the lowest vertex, a face gives the same triangles however it was written.
        std::uint32_t first = 0;
        for (std::uint32_t i = 1; i < n; ++i)
            if (vertexOf(repaired_.corners[from + i]) < vertexOf(repaired_.corners[from + first]))
                first = i;
        const auto local = [&](std::uint32_t i) { return from + (first + i) % n; };

        polygon_.clear();
        for (std::uint32_t i = 0; i < n; ++i)
            polygon_.push_back(file_.positions[vertexOf(repaired_.corners[local(i)])]);
        if (!triangulator_.cut(polygon_, cut_) &&
            repaired_.outcomes[repaired_.sourceFace[f]].action != FaceAction::dropped)
            ++out_.crossedFaces;

        diagonals_.clear();
        const auto base = static_cast<std::uint32_t>(3 * out_.corners.size());
        for (std::uint32_t t = 0; t < cut_.size(); ++t) {
            auto& corners = out_.corners.emplace_back();
            auto& vertices = out_.connected.vertices.emplace_back();
            // A triangle, too, begins at its lowest vertex.
            std::uint32_t lowest = 0;
            for (std::uint32_t i = 1; i < 3; ++i)
                if (vertexOf(repaired_.corners[local(cut_[t][i])]) <
                    vertexOf(repaired_.corners[local(cut_[t][lowest])]))
                    lowest = i;
            for (std::uint32_t i = 0; i < 3; ++i) {
                const std::uint32_t a = cut_[t][(lowest + i) % 3],
                                    b = cut_[t][(lowest + i + 1) % 3];
                corners[i] = repaired_.corners[local(a)];
                vertices[i] = vertexOf(corners[i]);
                const std::uint32_t h = base + 3 * t + i;
                if (b == (a + 1) % n)
                    outside_[local(a)] = h;
                else
                    diagonals_.push_back({std::min(a, b), std::max(a, b), h});
                out_.connected.mate.push_back(kNone);
            }
            out_.repairedFace.push_back(f);
            out_.connected.face.push_back(repaired_.sourceFace[f]);
        }
        // Every diagonal belongs to two triangles, in opposite directions.
        std::sort(diagonals_.begin(), diagonals_.end());
        for (std::size_t i = 0; i + 1 < diagonals_.size(); i += 2) {
            const std::uint32_t a = diagonals_[i][2], b = diagonals_[i + 1][2];
            out_.connected.mate[a] = b, out_.connected.mate[b] = a;
        }
    }

    const MeshFile& file_;
    const RepairedMesh& repaired_;
    Triangles out_;
    Triangulator triangulator_;
    std::vector<std::uint32_t> outside_; // per half-edge of repaired_: that of its triangle
    std::vector<Vector3> polygon_;
    std::vector<Triangulator::Triangle> cut_;
    std::vector<std::array<std::uint32_t, 3>> diagonals_;
};

class Importer {
public:
    Importer(const MeshFile& file, const ImportOptions& options)
        : file_(file), options_(options), repaired_(repair(file, options.repair)),
          triangles_(Cutter(file, repaired_).run()) {}

    Import run() {
        out_.name = std::string(fileName(file_.path));
        out_.summary = repaired_.summary;
        out_.fileNotes = file_.notes;
        out_.crossedFaces = triangles_.crossedFaces;
        out_.materials = file_.materials;
        takeTriangles();
        if (out_.mesh.triangles.empty())
            throw FileError(out_.name + ": no face of the file has an area");
        takeNormals();
        takeUvs();
        return std::move(out_);
    }

private:
    std::uint32_t sourceFace(std::uint32_t t) const { return triangles_.connected.face[t]; }

    const FaceRun& runOf(std::uint32_t face,
                         std::size_t& at) const { // faces rise from call to call
        while (at + 1 < file_.runs.size() && file_.runs[at + 1].firstFace <= face) ++at;
        return file_.runs[at];
    }

    std::uint32_t materialOf(const FaceRun& r) const {
        return r.material == kNone ? kNone : file_.materialIndex[r.material];
    }

    void takeTriangles() {
        std::vector<std::uint32_t> vertex(file_.positions.size(), kNone); // compact number
        const auto& vertices = triangles_.connected.vertices;
        const auto& positions = triangles_.connected.positions;
        for (std::uint32_t t = 0; t < vertices.size(); ++t) {
            const auto& v = vertices[t];
            if (repaired_.outcomes[sourceFace(t)].action == FaceAction::dropped ||
                collinear(positions[v[0]], positions[v[1]], positions[v[2]]))
                continue;
            kept_.push_back(t);
            for (const std::uint32_t i : v) vertex[i] = 0;
        }
        for (std::uint32_t v = 0; v < vertex.size(); ++v) {
            if (vertex[v] == kNone) continue;
            vertex[v] = static_cast<std::uint32_t>(out_.mesh.positions.size());
            out_.mesh.positions.push_back(file_.positions[v]);
        }
        std::size_t at = 0;
        for (const std::uint32_t t : kept_) {
            const auto& v = vertices[t];
            out_.mesh.triangles.push_back({vertex[v[0]], vertex[v[1]], vertex[v[2]]});
            out_.mesh.sourceFaces.push_back(sourceFace(t));
            if (!file_.materials.empty())
                out_.mesh.materials.push_back(materialOf(runOf(sourceFace(t), at)));
        }
    }

    /// The file's normals with unit length; those without length are marked.
    void takeFileNormals() {
        fileNormal_.reserve(file_.normals.size());
        for (const Vector3& n : file_.normals) {
            const double largest = std::max({std::fabs(n.x), std::fabs(n.y), std::fabs(n.z)});
            if (largest == 0) {
                ++out_.zeroNormals;
                fileNormal_.push_back(kNone);
                continue;
            }
            fileNormal_.push_back(static_cast<std::uint32_t>(out_.mesh.normals.size()));
            const double size = dot(n, n);
            // A normal that is unit to within rounding stays as it is written.
            const bool unit = std::fabs(size - 1) <= gamma(8);
            out_.mesh.normals.push_back(unit ? n : normalize(n / largest));
        }
        negative_.assign(out_.mesh.normals.size(), kNone);
    }

    /// Do the file's normals of a triangle point to the side it is wound away from? Shading takes both to be on one side.
    bool normalsOppose(std::uint32_t t) const {
        const auto& v = triangles_.connected.vertices[t];
        const auto& p = triangles_.connected.positions;
        const std::array<Vector3, 3> triangle{p[v[0]], p[v[1]], p[v[2]]};
        const Vector3 geometric = newellNormal(triangle);
        double sum = 0;
        for (const std::uint32_t c : triangles_.corners[t]) {
            const std::uint32_t written = file_.cornerNormal[c];
            if (written != kNone && fileNormal_[written] != kNone)
                sum += dot(geometric, out_.mesh.normals[fileNormal_[written]]);
        }
        return sum < 0;
    }

    std::uint32_t fileNormal(std::uint32_t corner, bool turn) {
        const std::uint32_t written = file_.cornerNormal[corner];
        if (written == kNone || fileNormal_[written] == kNone) return kNone;
        const std::uint32_t n = fileNormal_[written];
        if (!turn) return n;
        if (negative_[n] == kNone) {
            negative_[n] = static_cast<std::uint32_t>(out_.mesh.normals.size());
            out_.mesh.normals.push_back(-out_.mesh.normals[n]);
        }
        return negative_[n];
    }

    void takeNormals() {
        const bool fromFile =
            options_.normals == Normals::automatic || options_.normals == Normals::file;
        const bool hasFile = fromFile && !file_.cornerNormal.empty();
        bool computed = false;
        std::vector<std::uint32_t> smooth(triangles_.corners.size(), 0);
        std::size_t at = 0;
        for (std::uint32_t t = 0; t < smooth.size(); ++t) {
            if (options_.normals == Normals::smooth) smooth[t] = 1;
            if (options_.normals == Normals::automatic) {
                const std::uint32_t group = runOf(sourceFace(t), at).smoothing;
                smooth[t] = group == kSmoothingUnstated ? kSmoothingOff : group;
            }
            if (smooth[t] == 0 || computed) continue;
            // Needed unless every corner has a normal of its own.
            for (const std::uint32_t c : triangles_.corners[t])
                computed |= !hasFile || file_.cornerNormal[c] == kNone;
        }
        if (hasFile) takeFileNormals();
        computed |= out_.zeroNormals != 0;
        CornerNormals normals;
        const auto offset = static_cast<std::uint32_t>(out_.mesh.normals.size());
        if (computed) {
            // Within a smoothing group every edge is smooth: the file says so.
            const Radians crease = options_.normals == Normals::smooth ? options_.creaseAngle
                                                                       : Radians{std::numbers::pi};
            normals = cornerNormals(triangles_.connected, smooth, crease);
            out_.mesh.normals.insert(out_.mesh.normals.end(), normals.normals.begin(),
                                     normals.normals.end());
        }
        if (out_.mesh.normals.empty()) return;
        out_.mesh.normalIndices.reserve(kept_.size());
        bool any = false;
        for (const std::uint32_t t : kept_) {
            auto& corners = out_.mesh.normalIndices.emplace_back();
            const bool turn = hasFile && normalsOppose(t);
            out_.turnedNormals += turn;
            for (std::uint32_t i = 0; i < 3; ++i) {
                corners[i] = hasFile ? fileNormal(triangles_.corners[t][i], turn) : kNone;
                if (corners[i] == kNone && computed && normals.corners[3 * t + i] != kNone)
                    corners[i] = offset + normals.corners[3 * t + i];
                any |= corners[i] != kNone;
            }
        }
        if (!any) out_.mesh.normals.clear(), out_.mesh.normalIndices.clear();
    }

    void takeUvs() {
        if (file_.cornerUv.empty()) return;
        out_.mesh.uvs = file_.uvs;
        out_.mesh.uvIndices.reserve(kept_.size());
        for (const std::uint32_t t : kept_) {
            const auto& c = triangles_.corners[t];
            out_.mesh.uvIndices.push_back(
                {file_.cornerUv[c[0]], file_.cornerUv[c[1]], file_.cornerUv[c[2]]});
        }
    }

    const MeshFile& file_;
    const ImportOptions& options_;
    const RepairedMesh repaired_;
    const Triangles triangles_;
    std::vector<std::uint32_t> kept_;       // triangles that are not flat
    std::vector<std::uint32_t> fileNormal_; // per vn: in out_.mesh.normals, or kNone
    std::vector<std::uint32_t> negative_;   // per normal: its opposite, once needed
    Import out_;
};

bool endsWith(std::string_view text, std::string_view end) {
    if (text.size() < end.size()) return false;
    text.remove_prefix(text.size() - end.size());
    return std::equal(text.begin(), text.end(), end.begin(),
                      [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

} // namespace

std::vector<std::string> Import::notes() const {
    std::vector<std::string> out = fileNotes;
    for (const std::string& note : summary.notes()) out.push_back(name + ": " + note);
    const auto say = [&](std::uint32_t n, const char* one, const char* many) {
        if (n != 0) out.push_back(name + ": " + std::to_string(n) + " " + (n == 1 ? one : many));
    };
    say(zeroNormals, "normal without length was not used", "normals without length were not used");
    say(turnedNormals, "triangle had its normals turned to the side it faces",
        "triangles had their normals turned to the side they face");
    say(crossedFaces, "face crosses itself in its best-fit plane; its triangles overlap",
        "faces cross themselves in their best-fit planes; their triangles overlap");
    return out;
}

std::string notClosed(const std::string& name, std::uint32_t openEdges) {
    return (name.empty() ? "" : name + ": ") + "the solid is not closed: it has " +
           std::to_string(openEdges) + (openEdges == 1 ? " boundary edge" : " boundary edges");
}

MeshFile readMesh(const std::string& path, std::string bytes) {
    std::string_view stem = path;
    if (endsWith(stem, ".gz")) stem.remove_suffix(3);
    if (endsWith(stem, ".ply")) return readPly(path, std::move(bytes));
    if (endsWith(stem, ".obj")) return readObj(path, std::move(bytes));
    if (bytes.compare(0, 3, "ply") == 0) return readPly(path, std::move(bytes));
    return readObj(path, std::move(bytes));
}

MeshFile readMesh(const std::string& path) { return readMesh(path, readFile(path, kLargestMesh)); }

Import importMesh(const MeshFile& file, const ImportOptions& options) {
    return Importer(file, options).run();
}

Import importMesh(const std::string& path, const ImportOptions& options) {
    return importMesh(readMesh(path), options);
}

} // namespace rt::loaders
