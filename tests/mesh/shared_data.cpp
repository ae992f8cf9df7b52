// Real and damaged meshes that are not shipped: beside the source tree, or where $RT_SHARED says. Skipped without them.
#include "meshes.hpp"

#include <tests/tolerance.hpp>

#include <gmock/gmock.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>

namespace rt::loaders {
namespace {

namespace fs = std::filesystem;
using testing::messageOf;
using ::testing::StartsWith;

fs::path data() {
    const char* const shared = std::getenv("RT_SHARED");
    return (shared ? fs::path(shared) : fs::path(RT_SOURCE_DIR) / "../shared") / "data";
}

class SharedData : public ::testing::Test {
protected:
    void SetUp() override {
        if (!fs::exists(data()))
            GTEST_SKIP() << "no meshes at " << data() << "; set RT_SHARED to test with them";
    }
};

std::vector<std::vector<std::string>> table(const fs::path& file) {
    std::vector<std::vector<std::string>> rows;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        std::vector<std::string> row;
        std::istringstream fields(line);
        for (std::string field; std::getline(fields, field, '\t');) row.push_back(field);
        rows.push_back(row);
    }
    return rows;
}

int number(const std::string& text) {
    int value = 0;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// The number before `word` in `text`, such as 12 in "12 triangles"; or behind it, as in "materials 2".
std::optional<int> numberBefore(const std::string& text, const std::string& word) {
    const auto at = text.find(" " + word);
    if (at == text.npos) return std::nullopt;
    auto from = at;
    while (from > 0 && isdigit(static_cast<unsigned char>(text[from - 1]))) --from;
    return from == at ? std::nullopt : std::optional(number(text.substr(from, at - from)));
}
std::optional<int> numberBehind(const std::string& text, const std::string& word) {
    const auto at = text.find(word + " ");
    if (at == text.npos || !isdigit(static_cast<unsigned char>(text[at + word.size() + 1])))
        return std::nullopt;
    return number(text.substr(at + word.size() + 1));
}

TEST_F(SharedData, ObjSuiteAsItsPeersExpect) {
    const auto rows = table(data() / "EXPECTATIONS.tsv");
    ASSERT_GT(rows.size(), 40u);
    std::size_t refused = 0, counted = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const std::string path = (data() / rows[i][0]).string(), name = fs::path(path).filename(),
                          &says = rows[i][2];
        const bool mustFail = says.starts_with("MUST FAIL") || says.starts_with("empty") ||
                              says.find("faces 0") != says.npos;
        MeshFile mesh;
        const std::string message = messageOf([&] { mesh = readMesh(path); });
        EXPECT_EQ(!message.empty(), mustFail) << name << ": " << message;
        if (mustFail) {
            EXPECT_THAT(message, StartsWith(name + ":"));
            ++refused;
            continue;
        }
        const Import import = importMesh(mesh, {});
        EXPECT_GT(import.mesh.triangles.size(), 0u) << name;
        const auto expect = [&](std::optional<int> expected, std::size_t found, const char* what) {
            if (!expected) return;
            ++counted;
            EXPECT_EQ(found, static_cast<std::size_t>(*expected)) << name << ": " << what;
        };
        expect(numberBefore(says, "triangles"), import.mesh.triangles.size(), "triangles");
        expect(numberBefore(says, "vertices with"), mesh.positions.size(), "vertices");
        if (says.find("triangles, ") != says.npos)
            expect(numberBefore(says, "vertices"), mesh.positions.size(), "vertices");
        expect(numberBehind(says, "faces"), mesh.faceCount(), "faces");
        expect(numberBefore(says, "v "), mesh.positions.size(), "v");
        expect(numberBefore(says, "f "), mesh.faceCount(), "f");
        expect(numberBefore(says, "corners"), mesh.cornerPosition.size(), "corners");
        if (says.find("closed manifold") != says.npos) {
            EXPECT_EQ(import.summary.components, 1u) << name;
            EXPECT_EQ(import.summary.openEdges, 0u) << name;
            EXPECT_TRUE(import.summary.notes().empty()) << name;
        }
        if (const auto groups = numberBefore(says, "groups when split")) {
            std::vector<std::uint32_t> seen;
            for (const FaceRun& r : mesh.runs) seen.push_back(r.group);
            std::sort(seen.begin(), seen.end());
            expect(groups,
                   static_cast<std::size_t>(std::unique(seen.begin(), seen.end()) - seen.begin()),
                   "groups");
        }
    }
    EXPECT_EQ(refused, 4u);
    EXPECT_GE(counted, 15u);
}

TEST_F(SharedData, MtlKeysOfTheObjSuite) {
    const auto material = [&](const std::string& file, std::size_t i) {
        const MeshFile mesh = readMesh((data() / "obj-suite" / file).string());
        EXPECT_GT(mesh.materials.size(), i) << file;
        return i < mesh.materials.size() ? mesh.materials[i] : Material{};
    };
    const Color white{1, 1, 1};
    EXPECT_EQ(material("tinyobjloader/issue-95.obj", 0).transmission, (Color{0.1, 0.2, 0.3}));
    EXPECT_EQ(material("tinyobjloader/issue-95-2.obj", 0).transmission, (Color{0.1, 0.2, 0.3}));
    EXPECT_EQ(material("tinyobjloader/tr-and-d-issue-43.obj", 0).transmission, white * 0.25);
    EXPECT_EQ(material("tinyobjloader/tr-and-d-issue-43.obj", 1).transmission, white * 0.25);
    EXPECT_EQ(material("tinyobjloader/issue-138.obj", 0).ior, 1.5);
    EXPECT_EQ(material("tinyobjloader/issue-138.obj", 0).diffuse, (Color{0.5, 0.2, 0.2}));
    EXPECT_EQ(material("tinyobjloader/issue-138.obj", 1).diffuse, (Color{0.2, 0.5, 0.2}));
    EXPECT_EQ(material("tinyobjloader/issue-138.obj", 1).transmission, Color{});
    EXPECT_EQ(material("tinyobjloader/mtllib-multiple-files-issue-112.obj", 0).name, "default");
    EXPECT_EQ(material("tinyobjloader/issue-235-usemtl-then-o.obj", 1).diffuse, (Color{1, 0, 0}));
    EXPECT_EQ(material("assimp/space_in_material_name.obj", 0).name, "Hard Shiny Plastic White");
    EXPECT_EQ(material("assimp/space_in_material_name.obj", 0).shininess, 400);
    EXPECT_EQ(material("assimp/box_mat_with_spaces.obj", 0).diffuse, white * 0.2);
    for (const Material& m : readMesh((data() / "obj-suite/assimp/spider.obj").string()).materials)
        if (m.name == "Skin") {
            EXPECT_TRUE(m.colorFile.path.ends_with("/wal67ar_small.jpg")) << m.colorFile.path;
        }
    const MeshFile box = readMesh((data() / "obj-suite/tobj/cornell_box.obj").string());
    EXPECT_EQ(box.materials.size(), 4u); // blue is defined and not used
    std::vector<std::string> objects;
    for (const FaceRun& r : box.runs)
        if (r.object != kNone && (objects.empty() || objects.back() != box.names[r.object]))
            objects.push_back(box.names[r.object]);
    EXPECT_THAT(objects,
                ::testing::ElementsAre("floor", "light", "ceiling", "back_wall", "green_wall",
                                       "red_wall", "short_block", "tall_block"));
    for (const Material& m : box.materials)
        if (m.name == "light") {
            EXPECT_EQ(m.ior, 1.25);
            EXPECT_EQ(m.transmission, white * (1 - 0.8));
        }
}

/// Corner positions of a face of the clean file, beginning at the least, to compare winding.
std::vector<std::array<double, 3>> canonical(std::vector<std::array<double, 3>> corners) {
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    return corners;
}

std::vector<std::array<double, 3>> corners(const MeshFile& file,
                                           const std::vector<std::uint32_t>& list) {
    std::vector<std::array<double, 3>> out;
    for (const std::uint32_t c : list) {
        const Vector3& p = file.positions[file.cornerPosition[c]];
        out.push_back({p.x, p.y, p.z});
    }
    return canonical(std::move(out));
}

TEST_F(SharedData, DirtyMeshesAreWoundAsTheCleanOnes) {
    std::size_t scored = 0;
    for (const auto& entry : fs::directory_iterator(data() / "dirty-gen")) {
        if (!entry.path().string().ends_with(".truth.tsv")) continue;
        const std::string stem =
            entry.path().filename().string().substr(0, entry.path().filename().string().find('.'));
        const std::string obj = (data() / "dirty-gen" / (stem + ".obj")).string();
        if (stem.ends_with("_nan")) {
            EXPECT_THAT(messageOf([&] { readMesh(obj); }), StartsWith(stem + ".obj:280:3: "));
            ++scored;
            continue;
        }
        const MeshFile file = readMesh(obj);
        const RepairedMesh mesh = repair(file, Repair::full);
        const auto truth = table(entry.path());
        ASSERT_EQ(truth.size(), file.faceCount()) << stem;
        std::map<std::uint32_t, std::uint32_t> place; // face of the file -> of the result
        for (std::uint32_t f = 0; f < mesh.faceCount(); ++f) place[mesh.sourceFace[f]] = f;
        std::size_t right = 0, wrong = 0, lost = 0;
        for (const auto& row : truth) {
            const auto face = static_cast<std::uint32_t>(number(row[0]));
            if (number(row[1]) < 0) continue;
            if (mesh.outcomes[face].action == FaceAction::dropped) {
                ++lost;
                continue;
            }
            const bool turned = mesh.outcomes[face].action == FaceAction::flipped;
            (turned == (row[2] == "1") ? right : wrong) += 1;
        }
        const bool closed = stem.find("holes") == stem.npos && stem.find("_all") == stem.npos;
        if (!closed && wrong > right) std::swap(right, wrong);
        EXPECT_EQ(lost, 0u) << stem;
        EXPECT_GE(static_cast<double>(right), 0.999 * static_cast<double>(right + wrong)) << stem;
        std::cout << stem << ": " << right << " of " << right + wrong << " right\n";
        // Only exact duplicates and faces without area are dropped.
        for (std::uint32_t f = 0; f < file.faceCount(); ++f)
            if (mesh.outcomes[f].action == FaceAction::dropped) {
                EXPECT_LT(number(truth[f][1]), 0) << stem << ' ' << f;
            }
        ++scored;
    }
    EXPECT_GE(scored, 15u);
}

TEST_F(SharedData, ShuffledBlobbyIsItsTwin) {
    const MeshFile clean = readMesh((data() / "dirty/cgal_blobby.obj").string());
    const MeshFile dirty = readMesh((data() / "dirty/cgal_blobby-shuffled.obj").string());
    const RepairedMesh mesh = repair(dirty, Repair::full), reference = repair(clean, Repair::full);
    EXPECT_EQ(reference.summary.count(FaceReason::none), clean.faceCount());
    const auto faces = [](const MeshFile& file, const RepairedMesh& repaired) {
        std::vector<std::vector<std::array<double, 3>>> all;
        for (std::uint32_t f = 0; f < repaired.faceCount(); ++f)
            all.push_back(corners(file, {repaired.corners.begin() + repaired.faceStart[f],
                                         repaired.corners.begin() + repaired.faceStart[f + 1]}));
        std::sort(all.begin(), all.end());
        return all;
    };
    EXPECT_EQ(faces(dirty, mesh), faces(clean, reference));
}

TEST_F(SharedData,
       RepairedQuadsGiveTheCleanTriangles) { // so the picture in glass is the same, byte for byte
    const Import clean = importMesh((data() / "dirty-gen/base_spot_quads.obj").string(), {});
    const Import dirty = importMesh((data() / "dirty-gen/spot_quads_flip30.obj").string(), {});
    EXPECT_EQ(dirty.mesh.positions, clean.mesh.positions);
    EXPECT_EQ(dirty.mesh.triangles, clean.mesh.triangles);
    EXPECT_EQ(dirty.mesh.sourceFaces, clean.mesh.sourceFaces);
    {
        const ImportOptions options{.normals = Normals::smooth};
        const Mesh a =
            importMesh((data() / "dirty-gen/base_spot_quads.obj").string(), options).mesh;
        const Mesh b =
            importMesh((data() / "dirty-gen/spot_quads_flip30.obj").string(), options).mesh;
        for (std::size_t t = 0; t < a.triangles.size(); ++t)
            for (std::size_t i = 0; i < 3; ++i) {
                ASSERT_EQ(a.normalIndices[t][i] == kNone, b.normalIndices[t][i] == kNone);
                if (a.normalIndices[t][i] == kNone) continue;
                ASSERT_EQ(a.normals[a.normalIndices[t][i]], b.normals[b.normalIndices[t][i]]);
            }
    }
}

TEST_F(SharedData, EveryMeshIsReadOrRefused) {
    std::size_t read = 0, refused = 0;
    for (const auto& entry : fs::recursive_directory_iterator(data())) {
        const std::string path = entry.path().string();
        if (!entry.is_regular_file() ||
            !(path.ends_with(".obj") || path.ends_with(".obj.gz") || path.ends_with(".ply")))
            continue;
        for (const Normals normals : {Normals::automatic, Normals::smooth}) {
            Import import;
            const std::string message =
                messageOf([&] { import = importMesh(path, {.normals = normals}); });
            message.empty() ? ++read : ++refused;
            for (const Vector3& n : import.mesh.normals)
                ASSERT_NEAR(length(n), 1, tolerance::roundings(8)) << path;
            const MeshFile file = message.empty() ? readMesh(path) : MeshFile{};
            std::uint64_t outcomes = 0;
            for (const std::uint32_t n : import.summary.outcomes) outcomes += n;
            EXPECT_EQ(outcomes, file.faceCount()) << path;
        }
    }
    EXPECT_GT(read, 200u);
    EXPECT_GT(refused, 10u);
}

TEST_F(SharedData, FlatWoodyHasNoOutside) {
    const Import woody = importMesh((data() / "meshes/woody.obj").string(), {});
    EXPECT_EQ(woody.summary.undefinedComponents, 1u);
    const Import beam = importMesh((data() / "dirty/cgal_beam.obj").string(), {});
    EXPECT_EQ(beam.summary.turnedComponents, 1u); // closed and inside out
}

} // namespace
} // namespace rt::loaders
