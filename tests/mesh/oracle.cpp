// tinyobjloader, an independent reader, must find the same corners, normals and uvs in files and in made-up meshes.
#include "meshes.hpp"

#include <gmock/gmock.h>

#define TINYOBJLOADER_USE_DOUBLE
#include <tiny_obj_loader.h>

#include <cstdlib>
#include <fstream>
#include <iterator>

namespace rt::loaders {
namespace {

namespace fs = std::filesystem;

/// Corners as both readers give them: polygons in file order, each corner a position and, where it has them, a normal and a uv.
struct Corner {
    std::array<double, 3> position{}, normal{};
    std::array<double, 2> uv{};
    bool hasNormal = false, hasUv = false;
    bool operator==(const Corner&) const = default;
};
using Faces = std::vector<std::vector<Corner>>;

struct Theirs {
    Faces faces;
    std::vector<tinyobj::material_t> materials;
};

std::optional<Theirs> readByTinyObj(const std::string& path) {
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    Theirs theirs;
    std::string warning, error;
    const std::string folder = fs::path(path).parent_path().string() + "/";
    if (!tinyobj::LoadObj(&attributes, &shapes, &theirs.materials, &warning, &error, path.c_str(),
                          folder.c_str(), false))
        return std::nullopt;
    for (const tinyobj::shape_t& shape : shapes) {
        std::size_t at = 0;
        for (const unsigned corners : shape.mesh.num_face_vertices) {
            auto& face = theirs.faces.emplace_back();
            for (unsigned i = 0; i < corners; ++i, ++at) {
                const tinyobj::index_t& index = shape.mesh.indices[at];
                const auto within = [](int number, const std::vector<double>& list,
                                       std::size_t width) {
                    return number < 0 ||
                           (static_cast<std::size_t>(number) + 1) * width <= list.size();
                };
                if (index.vertex_index < 0 || !within(index.vertex_index, attributes.vertices, 3) ||
                    !within(index.normal_index, attributes.normals, 3) ||
                    !within(index.texcoord_index, attributes.texcoords, 2))
                    return std::nullopt; // it lets indices pass that name nothing
                Corner& corner = face.emplace_back();
                for (std::size_t k = 0; k < 3; ++k) {
                    corner.position[k] =
                        attributes.vertices[3 * static_cast<std::size_t>(index.vertex_index) + k];
                    if (index.normal_index >= 0)
                        corner.normal[k] =
                            attributes
                                .normals[3 * static_cast<std::size_t>(index.normal_index) + k];
                }
                for (std::size_t k = 0; k < 2 && index.texcoord_index >= 0; ++k)
                    corner.uv[k] =
                        attributes
                            .texcoords[2 * static_cast<std::size_t>(index.texcoord_index) + k];
                corner.hasNormal = index.normal_index >= 0,
                corner.hasUv = index.texcoord_index >= 0;
            }
        }
    }
    return theirs;
}

Faces facesOf(const MeshFile& file) {
    Faces faces(file.faceCount());
    for (std::uint32_t f = 0; f < file.faceCount(); ++f)
        for (std::uint32_t c = file.faceStart[f]; c < file.faceStart[f + 1]; ++c) {
            Corner& corner = faces[f].emplace_back();
            const Vector3& p = file.positions[file.cornerPosition[c]];
            corner.position = {p.x, p.y, p.z};
            if (!file.cornerNormal.empty() && file.cornerNormal[c] != kNone) {
                const Vector3& n = file.normals[file.cornerNormal[c]];
                corner.normal = {n.x, n.y, n.z}, corner.hasNormal = true;
            }
            if (!file.cornerUv.empty() && file.cornerUv[c] != kNone) {
                const Vector2& uv = file.uvs[file.cornerUv[c]];
                corner.uv = {uv.x, uv.y}, corner.hasUv = true;
            }
        }
    return faces;
}

/// tinyobjloader's own number parser is off by some last places; what both parse exactly is compared exactly.
bool near(double ours, double theirs) {
    constexpr double kTheirParser = 0x1p-40; // measured: at most 2^-49 of the number in data/
    return std::fabs(ours - theirs) <= kTheirParser * std::max(1.0, std::fabs(ours));
}

void expectSame(const Faces& ours, const Faces& theirs, const std::string& name) {
    ASSERT_EQ(ours.size(), theirs.size()) << name;
    for (std::size_t f = 0; f < ours.size(); ++f) {
        ASSERT_EQ(ours[f].size(), theirs[f].size()) << name << ", face " << f;
        for (std::size_t c = 0; c < ours[f].size(); ++c) {
            const Corner &a = ours[f][c], &b = theirs[f][c];
            ASSERT_EQ(a.hasNormal, b.hasNormal) << name << ", face " << f;
            ASSERT_EQ(a.hasUv, b.hasUv) << name << ", face " << f;
            for (std::size_t k = 0; k < 3; ++k) {
                ASSERT_TRUE(near(a.position[k], b.position[k])) << name << ", face " << f;
                ASSERT_TRUE(near(a.normal[k], b.normal[k])) << name << ", face " << f;
                if (k < 2) {
                    ASSERT_TRUE(near(a.uv[k], b.uv[k])) << name << ", face " << f;
                }
            }
        }
    }
}

TEST(TinyObjLoader, FindsTheSameCornersInWhatWeMakeUp) {
    const testing::TemporaryFolder folder;
    // Dyadic numbers, which every parser reads exactly.
    std::string obj;
    std::uint32_t state = 7;
    const auto next = [&] { return state = state * 1664525u + 1013904223u, state >> 16; };
    const auto number = [&] {
        return std::to_string(static_cast<int>(next() % 4096) - 2048) + "." +
               (next() % 2 ? "5" : "25");
    };
    constexpr int kVertices = 200;
    for (int i = 0; i < kVertices; ++i) {
        obj += "v " + number() + " " + number() + " " + number() + "\n";
        obj += "vn " + number() + " " + number() + " " + number() + "\n";
        obj += "vt " + number() + " " + number() + "\n";
    }
    for (int i = 0; i < 1000; ++i) {
        obj += "f";
        const int form = static_cast<int>(next() % 4), corners = 3 + static_cast<int>(next() % 3);
        for (int c = 0; c < corners; ++c) {
            const auto index = [&] {
                return std::to_string(next() % 2 ? 1 + static_cast<int>(next() % kVertices)
                                                 : -1 - static_cast<int>(next() % kVertices));
            };
            obj += " " + index();
            if (form == 1) obj += "/" + index();
            if (form == 2) obj += "//" + index();
            if (form == 3) obj += "/" + index() + "/" + index();
        }
        obj += "\n";
    }
    const std::string path = folder.write("a.obj", obj);
    const auto theirs = readByTinyObj(path);
    ASSERT_TRUE(theirs);
    EXPECT_EQ(facesOf(readMesh(path)), theirs->faces);
}

TEST(TinyObjLoader, GivesTheSameCornerNormals) {
    const testing::TemporaryFolder folder;
    testing::Polygons mesh = testing::torus(24, 16);
    std::string obj;
    for (const Vector3& v :
         mesh.vertices) { // normals rounded to eighths: not unit, and read exactly
        obj += "v " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z) +
               "\n";
        const auto eighths = [](double x) { return std::to_string(std::nearbyint(x * 8) / 8); };
        obj += "vn " + eighths(v.x) + " " + eighths(v.y) + " " + eighths(v.z + 2) + "\n";
    }
    for (const auto& face : mesh.faces) {
        obj += "f";
        for (const std::uint32_t v : face)
            obj += " " + std::to_string(v + 1) + "//" + std::to_string(mesh.vertices.size() - v);
        obj += "\n";
    }
    const std::string path = folder.write("a.obj", obj);
    const auto theirs = readByTinyObj(path);
    ASSERT_TRUE(theirs);
    const MeshFile file = readMesh(path);
    expectSame(facesOf(file), theirs->faces, "torus");
    // Through the whole import: unit, and of the corner that the file gives them to, up to the side that the face is turned to.
    const Import import = importMesh(file, {.repair = Repair::none});
    ASSERT_EQ(import.mesh.normalIndices.size(), import.mesh.triangles.size());
    for (std::size_t t = 0; t < import.mesh.triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3& position = import.mesh.positions[import.mesh.triangles[t][i]];
            const Vector3& normal = import.mesh.normals[import.mesh.normalIndices[t][i]];
            bool found = false;
            for (const Corner& c : theirs->faces[import.mesh.sourceFaces[t]]) {
                if (!near(position.x, c.position[0]) || !near(position.y, c.position[1]) ||
                    !near(position.z, c.position[2]))
                    continue;
                const Vector3 expected = normalize(Vector3{c.normal[0], c.normal[1], c.normal[2]});
                found |= length(normal - expected) <= gamma(16) ||
                         length(normal + expected) <= gamma(16);
            }
            ASSERT_TRUE(found) << "triangle " << t << ", corner " << i;
        }
}

TEST(TinyObjLoader, ReadsTheObjSuiteAlike) {
    const char* const shared = std::getenv("RT_SHARED");
    const fs::path suite =
        (shared ? fs::path(shared) : fs::path(RT_SOURCE_DIR) / "../shared") / "data";
    if (!fs::exists(suite)) GTEST_SKIP() << "no meshes at " << suite;
    std::size_t compared = 0;
    for (const char* const folder : {"obj-suite", "meshes", "dirty"})
        for (const auto& entry : fs::recursive_directory_iterator(suite / folder)) {
            const std::string path = entry.path().string(), name = entry.path().filename().string();
            if (entry.path().extension() != ".obj") continue;
            std::optional<MeshFile> ours;
            if (testing::messageOf([&] { ours = readMesh(path); }) != "")
                continue; // EXPECTATIONS.tsv says which
            const auto theirs = readByTinyObj(path);
            if (!theirs) continue;
            Faces faces = facesOf(*ours);
            if (faces.size() != theirs->faces.size()) {
                std::cout << name << ": " << faces.size() << " faces, tinyobjloader "
                          << theirs->faces.size() << "\n";
                continue;
            }
            expectSame(faces, theirs->faces, name);
            ++compared;
        }
    std::cout << compared << " files are alike\n";
    EXPECT_GT(compared, 80u);
}

} // namespace
} // namespace rt::loaders
