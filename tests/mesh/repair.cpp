// Repair of index lists: every row of damage, what is counted, and what must not be guessed.
#include "meshes.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <random>
#include <set>

namespace rt::loaders {
namespace {

using testing::append;
using testing::ball;
using testing::cube;
using ::testing::ElementsAre;
using testing::Face;
using ::testing::HasSubstr;
using testing::moebius;
using testing::Polygons;
using testing::repairObj;
using testing::reverse;
using testing::shuffled;
using testing::torus;

/// Is face f of the result wound as `clean` (up to where it begins)?
bool woundAs(const MeshFile& file, const RepairedMesh& mesh, std::uint32_t f, const Face& clean) {
    Face corners;
    for (auto c = mesh.faceStart[f]; c < mesh.faceStart[f + 1]; ++c)
        corners.push_back(file.cornerPosition[mesh.corners[c]]);
    const auto at = std::find(corners.begin(), corners.end(), clean[0]);
    if (at == corners.end()) return false;
    std::rotate(corners.begin(), at, corners.end());
    return corners == clean;
}

void expectClean(const Polygons& clean, const Polygons& dirty) {
    const MeshFile file = testing::parse(dirty.obj());
    const RepairedMesh mesh = repair(file, Repair::full);
    ASSERT_EQ(mesh.faceCount(), clean.faces.size());
    std::size_t right = 0;
    for (std::uint32_t f = 0; f < mesh.faceCount(); ++f)
        right += woundAs(file, mesh, f, clean.faces[mesh.sourceFace[f]]);
    EXPECT_EQ(right, clean.faces.size());
    EXPECT_EQ(mesh.summary.openEdges, 0u);
    // The outcome of each face says whether it was turned.
    for (std::uint32_t f = 0; f < dirty.faces.size(); ++f) {
        const bool turned = dirty.faces[f] != clean.faces[f];
        EXPECT_EQ(mesh.outcomes[f].action, turned ? FaceAction::flipped : FaceAction::kept);
    }
}

std::vector<FaceAction> actions(const RepairedMesh& mesh) {
    std::vector<FaceAction> out;
    for (const FaceOutcome& o : mesh.outcomes) out.push_back(o.action);
    return out;
}

TEST(Repair, CleanMeshesStayAsTheyAre) {
    for (const Polygons& mesh : {cube(), torus(12, 9), ball(8, 6)}) {
        expectClean(mesh, mesh);
        EXPECT_TRUE(repairObj(mesh.obj()).summary.notes().empty());
    }
}

TEST(Repair, TurnsFacesBack) {
    for (const double share : {0.05, 0.3, 0.45})
        for (std::uint32_t seed = 0; seed < 5; ++seed) {
            expectClean(torus(20, 11), shuffled(torus(20, 11), share, seed));
            expectClean(ball(9, 7), shuffled(ball(9, 7), share, seed));
        }
}

TEST(Repair, TurnsBodiesInsideOut) {
    for (Polygons mesh : {cube(), torus(8, 8), ball(8, 6), cube({1e6, -1e6, 1e6}, 0.5)}) {
        const Polygons clean = mesh;
        for (Face& f : mesh.faces) reverse(f);
        expectClean(clean, mesh);
        const RepairSummary s = repairObj(mesh.obj()).summary;
        EXPECT_EQ(s.turnedComponents, 1u);
        EXPECT_EQ(s.count(FaceReason::insideOut), clean.faces.size());
    }
    expectClean(torus(9, 9), shuffled(torus(9, 9), 0.8, 1)); // a majority of turned faces
}

TEST(Repair, WeldsEqualPositions) {
    Polygons soup;
    const Polygons clean = torus(10, 8);
    for (const Face& f : clean.faces) {
        Face own;
        for (const std::uint32_t v : f) {
            own.push_back(static_cast<std::uint32_t>(soup.vertices.size()));
            soup.vertices.push_back(clean.vertices[v]);
        }
        soup.faces.push_back(own);
    }
    const RepairedMesh mesh = repairObj(shuffled(soup, 0.3, 2).obj());
    EXPECT_EQ(mesh.summary.weldedVertices, 4 * clean.faces.size() - clean.vertices.size());
    EXPECT_EQ(mesh.summary.components, 1u);
    EXPECT_EQ(mesh.summary.openEdges, 0u);
    EXPECT_EQ(
        repairObj(
            "v 0 0 0\nv -0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 4\nf 2 5 3\nf 1 4 5\nf 3 5 4\n")
            .summary.openEdges,
        0u);
}

TEST(Repair, DropsAndCountsDegenerateFaces) {
    const RepairedMesh mesh =
        repairObj("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 2 0 0\nv 0.5 0 0\n"
                  "f 1 2 3\nf 1 1 2\nf 1 2 4\nf 1 2\nf 5\nf 1 2 5\nf 1 2 2 3 3\nf 1 2 1 2\n");
    using enum FaceAction;
    EXPECT_THAT(actions(mesh),
                ElementsAre(kept, dropped, dropped, dropped, dropped, dropped, dropped, dropped));
    const RepairSummary& s = mesh.summary;
    EXPECT_EQ(s.count(FaceReason::fewCorners), 2u);
    EXPECT_EQ(s.count(FaceReason::repeatedCorner), 3u);
    EXPECT_EQ(s.count(FaceReason::zeroArea), 1u);
    EXPECT_EQ(s.count(FaceReason::duplicate), 1u); // with its repeated corners passed over
    EXPECT_THAT(s.notes()[0], "5 faces with fewer than three distinct corners were dropped");
}

TEST(Repair, FacesWithoutAreaHoldTheirNeighboursTogether) {
    // A T-junction sewn with a flat triangle: without it there are three open edges.
    const char* const tetrahedron = "v 0 0 0\nv 2 0 0\nv 0 2 0\nv 0 0 2\nv 1 0 0\n"
                                    "f 1 3 2\nf 1 4 3\nf 2 3 4\nf 1 5 4\nf 5 2 4\nf 1 2 5\n";
    const RepairedMesh mesh = repairObj(tetrahedron);
    EXPECT_EQ(mesh.summary.openEdges, 0u);
    EXPECT_EQ(mesh.summary.components, 1u);
    EXPECT_EQ(mesh.summary.count(FaceReason::zeroArea), 1u);
    EXPECT_EQ(importMesh(testing::parse(tetrahedron), {}).mesh.triangles.size(), 5u);
}

TEST(Repair, HangingSliversAreDropped) { // dirty-gen/goathead_degenerate
    Polygons mesh = torus(10, 8);
    const Vector3 a = mesh.vertices[0], b = mesh.vertices[1];
    mesh.vertices.push_back((a + b) * 0.5 + Vector3{0, 0, std::ldexp(1.0, -24)});
    mesh.faces.push_back({0, 1, 80});
    const RepairedMesh repaired = repairObj(mesh.obj());
    EXPECT_EQ(repaired.summary.count(FaceReason::zeroArea), 1u);
    EXPECT_EQ(repaired.summary.openEdges, 0u);
    // A fin that single precision can hold is a face like any other.
    mesh.vertices.back() = (a + b) * 0.5 + Vector3{0, 0, std::ldexp(1.0, -19)};
    const RepairedMesh fin = repairObj(mesh.obj());
    EXPECT_EQ(fin.faceCount(), 81u);
    EXPECT_EQ(fin.summary.openEdges, 3u);
}

TEST(Repair, DropsDuplicates) {
    Polygons mesh = torus(10, 8);
    const std::size_t n = mesh.faces.size();
    for (std::uint32_t f : {3u, 17u, 18u, 40u}) {
        Face copy = mesh.faces[f];
        std::rotate(copy.begin(), copy.begin() + 1 + f % 3, copy.end());
        if (f % 2) reverse(copy);
        mesh.faces.push_back(copy);
    }
    mesh.faces.push_back(mesh.faces[3]); // a third copy
    const RepairedMesh repaired = repairObj(mesh.obj());
    EXPECT_EQ(repaired.faceCount(), n);
    EXPECT_EQ(repaired.summary.count(FaceReason::duplicate), 3u);
    EXPECT_EQ(repaired.summary.count(FaceReason::reversedDuplicate), 2u);
    for (std::size_t f = 0; f < mesh.faces.size(); ++f)
        EXPECT_EQ(repaired.outcomes[f].action, f < n ? FaceAction::kept : FaceAction::dropped);
    EXPECT_EQ(repaired.summary.openEdges, 0u);
    // The same four corners in another order are another face.
    EXPECT_EQ(repairObj("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nf 1 2 3 4\nf 1 3 2 4\n").faceCount(),
              2u);
}

TEST(Repair, DoubledSheetsBecomeSingle) { // trimesh's chair_model: every face twice, back to back
    Polygons mesh;
    for (int i = 0; i < 12; ++i) mesh.vertices.push_back({double(i % 4), double(i / 4), 0});
    for (std::uint32_t j = 0; j < 2; ++j)
        for (std::uint32_t i = 0; i < 3; ++i)
            mesh.faces.push_back({4 * j + i, 4 * j + i + 1, 4 * j + i + 5, 4 * j + i + 4});
    const std::vector<Face> single = mesh.faces;
    for (Face f : single) reverse(f), mesh.faces.push_back(f);
    const RepairedMesh repaired = repairObj(mesh.obj());
    EXPECT_EQ(repaired.faceCount(), 6u);
    EXPECT_EQ(repaired.summary.count(FaceReason::reversedDuplicate), 6u);
}

TEST(Repair, FlapsAndTouchingBodiesKeepBothSides) {
    Polygons flap =
        torus(10, 8); // dirty-gen/goathead_nonmanifold: a flap of two faces, back to back
    flap.vertices.push_back({0, 0, 3});
    flap.faces.push_back({0, 1, 80});
    flap.faces.push_back({1, 0, 80});
    EXPECT_EQ(repairObj(flap.obj()).faceCount(), 82u);
    EXPECT_EQ(repairObj(flap.obj()).summary.openEdges, 0u);

    Polygons two = cube(); // share the positions of a face
    append(two, cube({1, 0, 0}));
    for (const double share : {0.0, 0.3}) {
        const RepairedMesh repaired = repairObj(shuffled(two, share, 4).obj());
        EXPECT_EQ(repaired.faceCount(), 12u);
        EXPECT_EQ(repaired.summary.components, 2u);
        EXPECT_EQ(repaired.summary.openEdges, 0u);
        EXPECT_EQ(repaired.summary.undefinedComponents, 0u);
    }
}

TEST(Repair, NonManifoldEdgesKeepEveryFace) {
    // Three sheets on one edge, and two cubes that share an edge by index.
    const RepairedMesh sheets =
        repairObj("v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nv -1 -1 0\nf 1 2 3\nf 1 2 4\nf 1 2 5\n");
    EXPECT_EQ(sheets.faceCount(), 3u);
    EXPECT_EQ(sheets.summary.nonManifoldEdges, 1u);
    EXPECT_EQ(sheets.summary.undefinedComponents, 3u);

    Polygons mesh = cube();
    append(mesh, cube({1, 1, 0}));
    for (Face& f : mesh.faces)
        for (std::uint32_t& v : f) v = v == 8 ? 3 : v == 12 ? 7 : v;
    const RepairedMesh cubes = repairObj(mesh.obj());
    EXPECT_EQ(cubes.faceCount(), 12u);
    EXPECT_EQ(cubes.summary.nonManifoldEdges, 1u);
    EXPECT_EQ(cubes.summary.openEdges, 0u);
    EXPECT_EQ(cubes.summary.count(FaceReason::none), 12u);
}

TEST(Repair, BowTiesKeepEveryFace) {
    Polygons mesh = cube();
    append(mesh, cube({1, 1, 1}));
    for (Face& f : mesh.faces)
        for (std::uint32_t& v : f) v = v == 8 ? 7 : v;
    expectClean(mesh, mesh);
}

TEST(Repair, OneSidedBandsAreNamedAndKept) {
    for (const double share : {0.0, 0.4}) {
        const RepairedMesh mesh = repairObj(shuffled(moebius(24), share, 3).obj());
        EXPECT_EQ(mesh.faceCount(), 24u);
        EXPECT_EQ(mesh.summary.unorientableComponents, 1u);
        EXPECT_EQ(mesh.summary.seamEdges, 1u);
        EXPECT_THAT(mesh.summary.notes(),
                    ::testing::Contains(HasSubstr("1 component is one-sided")));
    }
    // A band that the file winds as well as can be stays as it is.
    const RepairedMesh mesh = repairObj(moebius(24).obj());
    EXPECT_EQ(mesh.summary.count(FaceReason::none), 24u);
}

TEST(Repair, OpenBowlsFaceOutward) {
    Polygons bowl = ball(24, 16);
    std::erase_if(bowl.faces, [&](const Face& f) {
        return std::any_of(f.begin(), f.end(),
                           [&](std::uint32_t v) { return bowl.vertices[v].z > 0.3; });
    });
    for (int turned = 0; turned < 2; ++turned) {
        const RepairedMesh mesh = repairObj(bowl.obj());
        EXPECT_EQ(mesh.summary.undefinedComponents, 0u);
        EXPECT_EQ(mesh.summary.turnedComponents, turned ? 1u : 0u);
        EXPECT_EQ(mesh.summary.openEdges, 24u);
        for (Face& f : bowl.faces) reverse(f);
    }
}

TEST(Repair, FlatSheetsHaveNoOutside) {
    Polygons sheet;
    for (int i = 0; i < 16; ++i) sheet.vertices.push_back({double(i % 4), double(i / 4), 0});
    for (std::uint32_t i : {0u, 1u, 2u, 4u, 5u, 6u, 8u, 9u, 10u})
        sheet.faces.push_back({i, i + 1, i + 5, i + 4});
    const RepairedMesh plain = repairObj(sheet.obj());
    EXPECT_EQ(plain.summary.undefinedComponents, 1u);
    EXPECT_EQ(plain.summary.count(FaceReason::none), 9u);
    reverse(sheet.faces[4]);
    const RepairedMesh one = repairObj(sheet.obj());
    EXPECT_EQ(one.outcomes[4].action, FaceAction::flipped); // the majority stays
    EXPECT_EQ(one.outcomes[4].reason, FaceReason::againstNeighbours);
    // The file's normals decide where lines cannot.
    const RepairedMesh down = repairObj(
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 -1\nf 1//1 2//1 3//1\nf 1//1 3//1 4//1\n");
    EXPECT_EQ(down.summary.undefinedComponents, 0u);
    EXPECT_EQ(down.summary.count(FaceReason::insideOut), 2u);
}

TEST(Repair, CavitiesTurnOnlyWithTheBodyAroundThem) {
    Polygons hollow = cube({0, 0, 0}, 4), inner = ball(10, 8);
    for (Vector3& v : inner.vertices) v = v + Vector3{2, 2, 2};
    Polygons solid = hollow;
    append(solid, inner); // a body inside a body
    for (Face& f : inner.faces) reverse(f);
    append(hollow, inner); // a cavity
    for (const Polygons& mesh : {hollow, solid}) {
        EXPECT_EQ(repairObj(mesh.obj()).summary.count(FaceReason::none), mesh.faces.size());
        EXPECT_EQ(repairObj(mesh.obj()).summary.nestedComponents, 1u);
        expectClean(mesh, shuffled(mesh, 0.2, 6));
        Polygons inverted = mesh;
        for (Face& f : inverted.faces) reverse(f);
        expectClean(mesh, inverted);
    }
}

TEST(Repair, Levels) {
    Polygons mesh = shuffled(torus(10, 8), 0.3, 8);
    mesh.faces.push_back(mesh.faces[5]);
    mesh.faces.push_back({0, 0, 1});
    const RepairSummary full = repairObj(mesh.obj()).summary;
    EXPECT_EQ(full.count(FaceReason::duplicate), 1u);
    const RepairSummary orient = repairObj(mesh.obj(), Repair::orient).summary;
    EXPECT_EQ(orient.count(FaceReason::duplicate), 0u);
    EXPECT_EQ(orient.count(FaceReason::repeatedCorner), 1u);
    EXPECT_GT(orient.count(FaceReason::againstNeighbours), 10u);
    const RepairedMesh none = repairObj(mesh.obj(), Repair::none);
    EXPECT_EQ(none.faceCount(), 81u);
    EXPECT_EQ(none.summary.count(FaceReason::none), 81u);
}

TEST(Repair, MatesRunTheOtherWay) {
    Polygons all = shuffled(torus(9, 7), 0.3, 9);
    append(all, shuffled(moebius(15), 0.3, 10));
    append(all, cube({5, 5, 5}));
    all.faces.push_back({0, 1, 80});
    for (const Repair level : {Repair::full, Repair::orient, Repair::none}) {
        const MeshFile file = testing::parse(all.obj());
        const RepairedMesh mesh = repair(file, level);
        ASSERT_EQ(mesh.mate.size(), mesh.corners.size());
        std::vector<std::uint32_t> next(mesh.corners.size());
        for (std::uint32_t f = 0; f < mesh.faceCount(); ++f)
            for (auto h = mesh.faceStart[f]; h < mesh.faceStart[f + 1]; ++h)
                next[h] = h + 1 == mesh.faceStart[f + 1] ? mesh.faceStart[f] : h + 1;
        const auto vertex = [&](std::uint32_t h) {
            return mesh.weld[file.cornerPosition[mesh.corners[h]]];
        };
        std::size_t joined = 0;
        for (std::uint32_t h = 0; h < mesh.mate.size(); ++h) {
            const std::uint32_t m = mesh.mate[h];
            if (m == kNone) continue;
            ++joined;
            EXPECT_EQ(mesh.mate[m], h);
            EXPECT_EQ(vertex(h), vertex(next[m]));
            EXPECT_EQ(vertex(m), vertex(next[h]));
        }
        EXPECT_GT(joined, 100u);
    }
}

/// Every face of the file has an outcome, and those kept or turned are in the result, once, with their corners.
void expectNothingLost(const std::string& obj) {
    const MeshFile file = testing::parse(obj);
    for (const Repair level : {Repair::full, Repair::orient, Repair::none}) {
        const RepairedMesh mesh = repair(file, level);
        ASSERT_EQ(mesh.outcomes.size(), file.faceCount());
        std::set<std::uint32_t> present(mesh.sourceFace.begin(), mesh.sourceFace.end());
        EXPECT_EQ(present.size(), mesh.sourceFace.size());
        for (std::uint32_t f = 0; f < file.faceCount(); ++f)
            if (mesh.outcomes[f].action != FaceAction::dropped) {
                EXPECT_EQ(present.count(f), 1u);
            }
        std::uint64_t sum = 0;
        for (const std::uint32_t n : mesh.summary.outcomes) sum += n;
        EXPECT_EQ(sum, file.faceCount());
    }
}

TEST(Repair, RandomIndexListsLoseNothingSilently) {
    std::mt19937 random(12);
    for (int round = 0; round < 300; ++round) {
        std::string obj;
        const unsigned vertices = 4 + random() % 8;
        for (unsigned i = 0; i < vertices; ++i)
            obj += "v " + std::to_string(random() % 3) + " " + std::to_string(random() % 3) + " " +
                   std::to_string(random() % 3) + "\n";
        obj += "f 1 2 3\n";
        for (unsigned f = random() % 40; f != 0; --f) {
            obj += "f";
            for (unsigned c = 2 + random() % 5; c != 0; --c)
                obj += " " + std::to_string(1 + random() % vertices);
            obj += "\n";
        }
        expectNothingLost(obj);
        Import import;
        try {
            import = testing::import(obj, {.normals = Normals::smooth});
        } catch (const FileError& e) {
            EXPECT_THAT(e.what(), HasSubstr("no face of the file has an area"));
        }
        for (const Vector3& n : import.mesh.normals) EXPECT_NEAR(length(n), 1, gamma(16));
    }
}

TEST(Repair, ManyFacesOnOneEdge) { // time must not grow with the square of their number
    Polygons mesh;
    mesh.vertices = {{0, 0, 0}, {0, 0, 1}};
    for (int i = 0; i < 20000; ++i) {
        mesh.vertices.push_back({1, double(i), 0});
        mesh.faces.push_back({0, 1, static_cast<std::uint32_t>(i + 2)});
    }
    const RepairedMesh repaired = repairObj(mesh.obj());
    EXPECT_EQ(repaired.faceCount(), 20000u);
    EXPECT_EQ(repaired.summary.components, 20000u);
}

} // namespace
} // namespace rt::loaders
