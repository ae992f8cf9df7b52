// Polygons to triangles: number, winding and area, exactly.
#include <plugins/loaders/exact.hpp>
#include <plugins/loaders/triangulate.hpp>
#include <tests/tolerance.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace rt::loaders {
namespace {

using Polygon = std::vector<Vector3>;

Polygon flat(std::initializer_list<Vector2> points) {
    Polygon out;
    for (const Vector2& p : points) out.push_back({p.x, p.y, 0});
    return out;
}

double newellArea(const Polygon& p) {
    Vector3 sum;
    for (std::size_t i = 0; i < p.size(); ++i)
        sum = sum + cross(p[i] - p[0], p[(i + 1) % p.size()] - p[0]);
    return length(sum) / 2;
}

/// Checks number, winding, area and that every edge of the polygon and every diagonal is used as it must be.
void expectCut(const Polygon& p, bool planar = true) {
    std::vector<Triangulator::Triangle> triangles;
    EXPECT_TRUE(Triangulator().cut(p, triangles));
    ASSERT_EQ(triangles.size(), p.size() - 2);
    Vector3 normal = newellNormal(p);
    double area = 0;
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    for (const auto& t : triangles) {
        const Vector3 n = cross(p[t[1]] - p[t[0]], p[t[2]] - p[t[0]]);
        if (planar) {
            EXPECT_GE(dot(n, normal), 0);
        }
        area += length(n) / 2;
        for (int i = 0; i < 3; ++i)
            ++edges[{t[static_cast<std::size_t>(i)], t[static_cast<std::size_t>((i + 1) % 3)]}];
    }
    if (planar) {
        EXPECT_NEAR(area, newellArea(p),
                    tolerance::roundings(static_cast<int>(20 * p.size())) * newellArea(p));
    }
    const auto n = static_cast<std::uint32_t>(p.size());
    for (const auto& [edge, count] : edges) {
        EXPECT_EQ(count, 1);
        if (edge.second != (edge.first + 1) % n) {
            EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
        }
    }
    for (std::uint32_t i = 0; i < n; ++i) EXPECT_EQ(edges.count({i, (i + 1) % n}), 1u);
}

void expectCutFromEveryCorner(Polygon p) {
    for (int turned = 0; turned < 2; ++turned) {
        for (std::size_t i = 0; i < p.size(); ++i) {
            expectCut(p);
            std::rotate(p.begin(), p.begin() + 1, p.end());
        }
        std::reverse(p.begin(), p.end());
    }
}

TEST(Exact, OrientationNearALine) {
    // Kettner et al. 2008: points on a fine grid beside a line; the rounded determinant is often wrong there.
    const double step = std::ldexp(1.0, -53);
    std::size_t positive = 0, zero = 0;
    for (int i = 0; i < 64; ++i)
        for (int j = 0; j < 64; ++j) {
            const int sign = orientation({0.5 + i * step, 0.5 + j * step}, {12, 12}, {24, 24});
            EXPECT_EQ(sign, i == j  ? 0
                            : i < j ? 1
                                    : -1)
                << i << ' ' << j; // b - a and c - b run along x = y
            positive += sign > 0, zero += sign == 0;
        }
    EXPECT_EQ(positive, 64u * 63 / 2);
    EXPECT_EQ(zero, 64u);
}

TEST(Exact, OrientationIsAntisymmetricAndCyclic) {
    std::mt19937 random(3);
    const auto coordinate = [&] {
        return std::ldexp(static_cast<double>(random() % 7) - 3,
                          static_cast<int>(random() % 5) * 20 - 40);
    };
    for (int i = 0; i < 20000; ++i) {
        const Vector2 a{coordinate(), coordinate()}, b{coordinate(), coordinate()},
            c{coordinate(), coordinate()};
        const int sign = orientation(a, b, c);
        EXPECT_EQ(orientation(b, c, a), sign);
        EXPECT_EQ(orientation(c, a, b), sign);
        EXPECT_EQ(orientation(b, a, c), -sign);
    }
}

TEST(Exact, CollinearInSpace) {
    EXPECT_TRUE(collinear({0, 0, 0}, {1, 2, 3}, {3, 6, 9}));
    EXPECT_TRUE(collinear({1, 1, 1}, {1, 1, 1}, {5, 6, 7}));
    EXPECT_FALSE(collinear({0, 0, 0}, {1, 2, 3}, {3, 6, std::nextafter(9.0, 10.0)}));
    const double tiny = std::ldexp(1.0, -300);
    EXPECT_FALSE(collinear({0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}));
}

TEST(Triangulate, Dart) { // LIBRARIES.md 5.1: OpenMesh's fan covers 2.5 instead of 1.5
    expectCutFromEveryCorner(flat({{0, 0}, {2, 0}, {2, 2}, {1.5, 0.5}}));
}
TEST(Triangulate, LShape) { // its fan turns one triangle over: 4 instead of 3
    expectCutFromEveryCorner(flat({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}));
}
TEST(Triangulate, Spiral) {
    expectCutFromEveryCorner(flat({{0, 0},
                                   {6, 0},
                                   {6, 6},
                                   {0, 6},
                                   {0, 2},
                                   {4, 2},
                                   {4, 4},
                                   {2, 4},
                                   {2, 3},
                                   {3, 3},
                                   {3, 2.5},
                                   {0.5, 2.5},
                                   {0.5, 5},
                                   {5, 5},
                                   {5, 1},
                                   {0, 1}}));
}
TEST(Triangulate, CornersOnALine) {
    expectCutFromEveryCorner(
        flat({{0, 0}, {1, 0}, {2, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}));
    expectCutFromEveryCorner(flat({{0, 0}, {1, 0}, {2, 0}, {0, 2}}));
    expectCutFromEveryCorner(flat({{0, 0}, {3, 0}, {3, 3}, {2, 1}, {1, 1}, {0, 3}, {0, 1}}));
}
TEST(Triangulate, BridgeToAHole) {
    expectCutFromEveryCorner(
        flat({{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}}));
}
TEST(Triangulate, StarsAndCombsInAnyPlane) {
    std::mt19937 random(11);
    const auto unit = [&] { return static_cast<double>(random()) / 4294967296.0; };
    for (int round = 0; round < 60; ++round) {
        const Vector3 u = normalize(Vector3{unit() - 0.5, unit() - 0.5, unit() - 0.5});
        const Vector3 v = normalize(cross(u, Vector3{unit() - 0.5, unit() - 0.5, unit() - 0.5}));
        const int n = 5 + static_cast<int>(random() % 60);
        Polygon p;
        for (int i = 0; i < n; ++i) { // star-shaped round the origin, so simple
            const double angle = 2 * std::numbers::pi * (i + 0.8 * unit()) / n, r = 0.1 + unit();
            p.push_back(u * (r * std::cos(angle)) + v * (r * std::sin(angle)) + Vector3{10, -7, 3});
        }
        expectCut(p);
    }
    Polygon comb{{0, -1, 5}};
    for (int i = 0; i < 400; ++i) comb.push_back({i + 0.0, i % 2 ? 100.0 : 0.0, 5});
    comb.push_back({400, -1, 5});
    std::reverse(comb.begin(), comb.end());
    expectCut(comb);
}
TEST(Triangulate, QuadsUseTheShorterDiagonal) {
    std::vector<Triangulator::Triangle> triangles;
    const Polygon kite = flat({{0, 0}, {2, -1}, {4, 0}, {2, 1}});
    EXPECT_TRUE(Triangulator().cut(kite, triangles));
    EXPECT_EQ(triangles, (std::vector<Triangulator::Triangle>{{0, 1, 3}, {1, 2, 3}}));
    const Polygon turned{kite[1], kite[2], kite[3], kite[0]};
    EXPECT_TRUE(Triangulator().cut(turned, triangles));
    EXPECT_EQ(triangles, (std::vector<Triangulator::Triangle>{{0, 1, 2}, {0, 2, 3}}));
}
TEST(Triangulate, CrossingAndFlatPolygonsLoseNoTriangle) {
    std::vector<Triangulator::Triangle> triangles;
    EXPECT_FALSE(Triangulator().cut(flat({{0, 0}, {2, 2}, {2, 0}, {0, 3}}), triangles));
    EXPECT_EQ(triangles.size(), 2u);
    EXPECT_FALSE(Triangulator().cut(flat({{0, 0}, {1, 1}, {2, 2}, {3, 3}, {1, 1}}), triangles));
    EXPECT_EQ(triangles.size(), 3u);
    std::mt19937 random(5);
    for (int round = 0; round < 2000;
         ++round) { // any polygon gives n - 2 triangles over its corners
        Polygon p;
        const std::size_t n = 3 + random() % 12;
        for (std::size_t i = 0; i < n; ++i)
            p.push_back({double(random() % 5), double(random() % 5), double(random() % 2)});
        Triangulator().cut(p, triangles);
        ASSERT_EQ(triangles.size(), n - 2);
        for (const auto& t : triangles)
            for (const std::uint32_t i : t) ASSERT_LT(i, n);
    }
}
TEST(Triangulate, ExtremeSizes) {
    for (const double scale : {1e90, 1.0, std::ldexp(1.0, -400)}) {
        Polygon p = flat({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}});
        for (Vector3& v : p) v = v * scale;
        std::vector<Triangulator::Triangle> triangles, plain;
        EXPECT_TRUE(Triangulator().cut(p, triangles));
        EXPECT_TRUE(
            Triangulator().cut(flat({{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}}), plain));
        EXPECT_EQ(triangles, plain);
    }
}

} // namespace
} // namespace rt::loaders
