// Corner normals: the file's, smooth within groups, broken at creases, flat; never a NaN.
#include "meshes.hpp"

#include <plugins/loaders/normals.hpp>
#include <tests/tolerance.hpp>

#include <gmock/gmock.h>

#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace rt::loaders {
namespace {

using testing::append;
using ::testing::Contains;
using testing::cube;
using ::testing::Each;
using testing::Face;
using testing::import;
using testing::moebius;
using testing::Polygons;
using testing::torus;

constexpr Radians degrees(double d) { return {d * std::numbers::pi / 180}; }

/// Normal of a corner of a triangle of the result; of the triangle itself where the corner is flat.
Vector3 cornerNormal(const Mesh& mesh, std::size_t triangle, std::size_t corner) {
    const auto& t = mesh.triangles[triangle];
    const std::uint32_t n = mesh.normals.empty() ? kNone : mesh.normalIndices[triangle][corner];
    if (n != kNone) return mesh.normals[n];
    return normalize(cross(mesh.positions[t[1]] - mesh.positions[t[0]],
                           mesh.positions[t[2]] - mesh.positions[t[0]]));
}

std::size_t flatCorners(const Mesh& mesh) {
    if (mesh.normals.empty()) return 3 * mesh.triangles.size();
    std::size_t flat = 0;
    for (const auto& t : mesh.normalIndices)
        for (const std::uint32_t n : t) flat += n == kNone;
    return flat;
}

TEST(Normals, AnglesBetweenVectors) {
    std::mt19937 random(1);
    const auto unit = [&] { return static_cast<double>(random()) / 2147483648.0 - 1; };
    for (int i = 0; i < 20000; ++i) {
        Vector3 a{unit(), unit(), unit()};
        Vector3 b{unit(), unit(), unit()};
        if (i % 3 == 0) b = a + b * std::ldexp(1.0, -static_cast<int>(random() % 100));
        if (i % 7 == 0) b = -b;
        if (i % 5 == 0) a = a * std::ldexp(1.0, static_cast<int>(random() % 900) - 450);
        using L = long double;
        const L ax = a.x, ay = a.y, az = a.z, bx = b.x, by = b.y, bz = b.z;
        const L x = ay * bz - az * by, y = az * bx - ax * bz, z = ax * by - ay * bx;
        const L expected =
            std::atan2(std::sqrt(x * x + y * y + z * z), ax * bx + ay * by + az * bz);
        EXPECT_NEAR(angleBetween(a, b), static_cast<double>(expected), tolerance::kAngle);
    }
    EXPECT_EQ(angleBetween({1, 0, 0}, {0, 3, 0}), std::numbers::pi / 2);
    EXPECT_EQ(angleBetween({1, 0, 0}, {-2, 0, 0}), std::numbers::pi);
    EXPECT_EQ(angleBetween({1, 2, 3}, {1, 2, 3}), 0);
    EXPECT_EQ(angleBetween({0, 0, 0}, {1, 2, 3}), 0);
}

/// Every corner's normal is the sum over the triangles round its vertex, in extended precision.
void expectAngleWeighted(const Mesh& mesh) {
    using L = long double;
    struct Sum {
        L x = 0, y = 0, z = 0;
    };
    std::vector<Sum> sums(mesh.positions.size());
    for (const auto& t : mesh.triangles) {
        L p[3][3];
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3& v = mesh.positions[t[i]];
            p[i][0] = v.x, p[i][1] = v.y, p[i][2] = v.z;
        }
        const auto sub = [](const L* a, const L* b, L* out) {
            for (int k = 0; k < 3; ++k) out[k] = a[k] - b[k];
        };
        const auto crossed = [](const L* a, const L* b, L* out) {
            out[0] = a[1] * b[2] - a[2] * b[1], out[1] = a[2] * b[0] - a[0] * b[2],
            out[2] = a[0] * b[1] - a[1] * b[0];
        };
        const auto norm = [](const L* a) {
            return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
        };
        L n[3], e[3], f[3], c[3];
        sub(p[1], p[0], e), sub(p[2], p[0], f), crossed(e, f, n);
        const L size = norm(n);
        for (int i = 0; i < 3; ++i) {
            sub(p[(i + 1) % 3], p[i], e), sub(p[(i + 2) % 3], p[i], f), crossed(e, f, c);
            const L angle = std::atan2(norm(c), e[0] * f[0] + e[1] * f[1] + e[2] * f[2]);
            Sum& s = sums[t[static_cast<std::size_t>(i)]];
            s.x += angle * n[0] / size, s.y += angle * n[1] / size, s.z += angle * n[2] / size;
        }
    }
    double worst = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const Sum& s = sums[mesh.triangles[t][i]];
            const L size = std::sqrt(s.x * s.x + s.y * s.y + s.z * s.z);
            const Vector3 expected{double(s.x / size), double(s.y / size), double(s.z / size)};
            worst = std::max(worst, length(cornerNormal(mesh, t, i) - expected));
        }
    EXPECT_LE(worst, tolerance::kCornerNormal);
}

TEST(Normals, SmoothIsAngleWeighted) {
    std::mt19937 random(2);
    Polygons mesh = torus(40, 30);
    for (Vector3& v : mesh.vertices)
        v = v +
            Vector3{double(random()), double(random()), double(random())} * std::ldexp(1.0, -38);
    const ImportOptions smooth{.normals = Normals::smooth, .creaseAngle = degrees(180)};
    const Import plain = import(mesh.obj(), smooth);
    expectAngleWeighted(plain.mesh);
    EXPECT_EQ(plain.mesh.normals.size(), mesh.vertices.size());
    EXPECT_EQ(flatCorners(plain.mesh), 0u);
    // Turning faces back gives the same bits.
    const Import turned = import(testing::shuffled(mesh, 0.3, 5).obj(), smooth);
    EXPECT_EQ(turned.mesh.triangles, plain.mesh.triangles);
    for (std::size_t t = 0; t < plain.mesh.triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i)
            ASSERT_EQ(cornerNormal(turned.mesh, t, i), cornerNormal(plain.mesh, t, i));
}

TEST(Normals, CreasesSplitCorners) {
    const std::string obj = cube().obj();
    const Import hard = import(obj, {.normals = Normals::smooth});
    for (std::size_t t = 0; t < 12; ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3 n = cornerNormal(hard.mesh, t, i);
            EXPECT_EQ(std::fabs(n.x) + std::fabs(n.y) + std::fabs(n.z), 1); // an axis
        }
    const Import soft = import(obj, {.normals = Normals::smooth, .creaseAngle = degrees(91)});
    EXPECT_EQ(soft.mesh.normals.size(), 8u);
    for (std::size_t t = 0; t < 12; ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3 p =
                soft.mesh.positions[soft.mesh.triangles[t][i]] - Vector3{0.5, 0.5, 0.5};
            EXPECT_NEAR(length(cornerNormal(soft.mesh, t, i) - normalize(p)), 0,
                        tolerance::roundings(16));
        }
    // Prisms: with eight sides and more, round at the default; with seven and less, hard.
    for (const int n : {4, 5, 6, 7, 8, 9, 16}) {
        std::string prism;
        for (int i = 0; i < n; ++i)
            for (const int z : {0, 1})
                prism += "v " + std::to_string(std::cos(2 * std::numbers::pi * i / n)) + " " +
                         std::to_string(std::sin(2 * std::numbers::pi * i / n)) + " " +
                         std::to_string(z) + "\n";
        for (int i = 0; i < n; ++i) {
            const int a = 2 * i + 1, b = 2 * ((i + 1) % n) + 1;
            prism += "f " + std::to_string(a) + " " + std::to_string(b) + " " +
                     std::to_string(b + 1) + " " + std::to_string(a + 1) + "\n";
        }
        const Mesh mesh = import(prism, {.normals = Normals::smooth}).mesh;
        const Vector3 first = cornerNormal(mesh, 0, 0),
                      face = normalize(cross(mesh.positions[mesh.triangles[0][1]] -
                                                 mesh.positions[mesh.triangles[0][0]],
                                             mesh.positions[mesh.triangles[0][2]] -
                                                 mesh.positions[mesh.triangles[0][0]]));
        EXPECT_EQ(dot(first, face) < 0.999, n >= 8) << n;
    }
}

TEST(Normals, SmoothingGroups) {
    // A roof: two quads in a group, a third, level with the second, in none, a fourth in another group.
    const std::string points = "v 0 0 0\nv 0 1 0\nv 1 0 1\nv 1 1 1\nv 2 0 0\nv 2 1 0\nv 3 0 -1\nv "
                               "3 1 -1\nv 4 0 0\nv 4 1 0\n";
    const std::string faces[] = {"f 1 3 4 2\n", "f 3 5 6 4\n", "f 5 7 8 6\n", "f 7 9 10 8\n"};
    const auto ridge = [&](const Mesh& mesh) { // how many corners are not flat, by source face
        std::map<std::uint32_t, std::size_t> smooth;
        for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
            for (std::size_t i = 0; i < 3; ++i)
                smooth[mesh.sourceFaces[t]] +=
                    !mesh.normals.empty() && mesh.normalIndices[t][i] != kNone;
        return smooth;
    };
    const Mesh grouped =
        import(points + "s 1\n" + faces[0] + faces[1] + "s off\n" + faces[2] + "s 2\n" + faces[3])
            .mesh;
    auto smooth = ridge(grouped);
    EXPECT_GT(smooth[0], 0u);
    EXPECT_GT(smooth[1], 0u);
    EXPECT_EQ(smooth[2], 0u);
    for (std::size_t t = 0; t < grouped.triangles.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const Vector3 p = grouped.positions[grouped.triangles[t][i]];
            if (p.x == 1) {
                EXPECT_NEAR(length(cornerNormal(grouped, t, i) - Vector3{0, 0, 1}), 0,
                            tolerance::roundings(16));
            }
            if (p.x >= 3) {
                EXPECT_NEAR(std::fabs(cornerNormal(grouped, t, i).x), std::sqrt(0.5),
                            tolerance::roundings(8));
            }
        }
    EXPECT_EQ(flatCorners(import(points + faces[0] + faces[1]).mesh), 12u); // nothing said: flat
    EXPECT_EQ(flatCorners(import(points + "s off\n" + faces[0] + faces[1]).mesh), 12u);
    EXPECT_EQ(flatCorners(
                  import(points + "s 1\n" + faces[0] + faces[1], {.normals = Normals::flat}).mesh),
              12u);
    EXPECT_EQ(flatCorners(
                  import(points + "s 1\n" + faces[0] + faces[1], {.normals = Normals::file}).mesh),
              12u);
    EXPECT_LT(flatCorners(import(points + "s off\n" + faces[0] + faces[1],
                                 {.normals = Normals::smooth, .creaseAngle = degrees(91)})
                              .mesh),
              12u);
}

TEST(Normals, TheFilesAreKeptPerCorner) {
    const std::string obj =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvn 0.6 0 0.8\nvn 0 0 2\nvn 0 0 0\n"
        "f 1//1 2//2 3//3\nf 1 3//2 4//4\n";
    const Mesh mesh = import(obj).mesh;
    EXPECT_EQ(cornerNormal(mesh, 0, 0), (Vector3{0, 0, 1}));
    EXPECT_EQ(cornerNormal(mesh, 0, 1), (Vector3{0.6, 0, 0.8}));
    EXPECT_EQ(cornerNormal(mesh, 0, 2), (Vector3{0, 0, 1}));
    EXPECT_EQ(mesh.normalIndices[1][0], kNone);
    EXPECT_EQ(cornerNormal(mesh, 1, 1), (Vector3{0.6, 0, 0.8}));
    EXPECT_EQ(mesh.normalIndices[1][2], kNone);
    EXPECT_THAT(import(obj).notes(), Contains("test.obj: 1 normal without length was not used"));
    // Where the file has none, the groups decide.
    const Mesh mixed = import("s 1\n" + obj + "v 2 0 1\nf 2 5 3\n").mesh;
    EXPECT_NE(mixed.normalIndices[2][0], kNone);
    EXPECT_NE(mixed.normalIndices[1][0], kNone);
    EXPECT_EQ(cornerNormal(mixed, 0, 1), (Vector3{0.6, 0, 0.8}));
}

TEST(Normals, TheFilesTurnWithTheirFaces) {
    // A cube whose top is wound downward, with a normal that follows the winding, and one that does not.
    std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 0 0 1\nv 1 0 1\nv 0 1 1\nv 1 1 1\n"
                      "f 1 3 4 2\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\nvn 0 0 ";
    for (const char* const z : {"1", "-1"}) {
        const Import top = import(obj + z + "\nf 5//1 7//1 8//1 6//1\n");
        const std::size_t last = top.mesh.triangles.size() - 1;
        EXPECT_EQ(top.mesh.sourceFaces[last], 5u);
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(cornerNormal(top.mesh, last, i), (Vector3{0, 0, 1}));
        EXPECT_EQ(top.turnedNormals, *z == '-' ? 2u : 0u);
    }
}

TEST(Normals, OfFlatFacesAndCancellingSheetsAreNotInvented) {
    // Two sheets back to back, a flat triangle, a lone needle: finite unit normals or flat corners.
    const std::string obj =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 1 5 0\nv 1.0000000000000002 5 0\n"
        "f 1 2 3\nf 3 2 1\nf 1 2 4\nf 2 5 6\n";
    for (const Repair level : {Repair::full, Repair::orient, Repair::none}) {
        const Mesh mesh =
            import(obj, {.normals = Normals::smooth, .creaseAngle = degrees(180), .repair = level})
                .mesh;
        for (const Vector3& n : mesh.normals) EXPECT_NEAR(length(n), 1, tolerance::roundings(8));
    }
}

TEST(Normals, ScaleAndPlaceDoNotMatter) {
    const ImportOptions smooth{.normals = Normals::smooth, .creaseAngle = degrees(180)};
    const Polygons mesh = torus(16, 12);
    const Import plain = import(mesh.obj(), smooth);
    for (const int power : {-300, -60, 40, 300}) {
        Polygons scaled = mesh;
        for (Vector3& v : scaled.vertices) v = v * std::ldexp(1.0, power);
        const Import other = import(scaled.obj(), smooth);
        ASSERT_EQ(other.mesh.triangles, plain.mesh.triangles) << power;
        ASSERT_EQ(other.mesh.normals.size(), plain.mesh.normals.size());
        for (std::size_t i = 0; i < plain.mesh.normals.size(); ++i)
            EXPECT_NEAR(length(other.mesh.normals[i] - plain.mesh.normals[i]), 0,
                        tolerance::roundings(16));
    }
}

TEST(Normals, OneSidedAndNonManifoldMeshesHaveThemToo) {
    Polygons mesh = moebius(30);
    append(mesh, torus(12, 10));
    mesh.faces.push_back({60, 61, 0});
    const Mesh out =
        import(mesh.obj(), {.normals = Normals::smooth, .creaseAngle = degrees(180)}).mesh;
    EXPECT_EQ(out.triangles.size(), 60u + 240 + 1);
    for (const Vector3& n : out.normals) EXPECT_NEAR(length(n), 1, tolerance::roundings(8));
    EXPECT_EQ(flatCorners(out), 5u); // the fin's, and two that stand alone beside the band's seam
}

} // namespace
} // namespace rt::loaders
