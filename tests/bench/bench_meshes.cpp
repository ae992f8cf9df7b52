#include "bench_meshes.hpp"

#include <core/numeric/box.hpp>
#include <plugins/loaders/mesh_import.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>

namespace rt::bench {
namespace {

using numeric::normalize;

class Uniform {
public:
    explicit Uniform(std::uint32_t seed) : bits_(seed) {}
    double operator()() { return (bits_() + 0.5) / 4294967296.0; }

private:
    std::mt19937 bits_;
};

void readFile(Mesh& mesh, const std::string& path) {
    const auto import = loaders::importMesh(path, {.normals = loaders::Normals::flat});
    for (const auto& p : import.mesh.positions) mesh.positions.emplace_back(p.x, p.y, p.z);
    mesh.indices = import.mesh.triangles;
}

void subdivide(Mesh& mesh) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
        const auto [it, isNew] = middles.try_emplace(
            std::minmax(a, b), static_cast<std::uint32_t>(mesh.positions.size()));
        if (isNew) mesh.positions.push_back((mesh.positions[a] + mesh.positions[b]) * 0.5);
        return it->second;
    };
    std::vector<std::array<std::uint32_t, 3>> finer;
    finer.reserve(4 * mesh.indices.size());
    for (const auto [a, b, c] : mesh.indices) {
        const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
        finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    mesh.indices = std::move(finer);
}

double bumps(const Vec3& p) {
    double sum = 0, amplitude = 0.5, frequency = 3;
    for (int octave = 0; octave < 5; ++octave, amplitude *= 0.55, frequency *= 2.03)
        sum += amplitude * std::sin(p.x * frequency + 1.3 * octave) *
               std::sin(p.y * frequency * 1.1 + 2.1 * octave) *
               std::sin(p.z * frequency * 0.9 + 0.7 * octave);
    return sum;
}

void addIcosphere(Mesh& mesh, int levels, double displacement, Vec3 center, double radius) {
    Mesh ball;
    const double g = (1 + std::sqrt(5.0)) / 2;
    ball.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                      {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    ball.indices = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int i = 0; i < levels; ++i) {
        subdivide(ball);
        for (Vec3& p : ball.positions) p = normalize(p);
    }
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3& p : ball.positions)
        mesh.positions.push_back(center + p * (radius * (1 + displacement * bumps(p))));
    for (const auto [a, b, c] : ball.indices)
        mesh.indices.push_back({a + base, b + base, c + base});
}

/// A tube along a trefoil knot, `around` times `across` quads of unequal sizes, bumpy at all scales.
void addKnot(Mesh& mesh, std::uint32_t around, std::uint32_t across) {
    const auto at = [](double a) {
        return Vec3(std::sin(a) + 2 * std::sin(2 * a), std::cos(a) - 2 * std::cos(2 * a),
                    -std::sin(3 * a));
    };
    for (std::uint32_t i = 0; i < around; ++i) {
        const double share = static_cast<double>(i) / around;
        const double a = 2 * M_PI * (share + 0.03 * std::sin(2 * M_PI * 5 * share));
        const Vec3 center = at(a), along = normalize(at(a + 0.001) - at(a - 0.001));
        const Vec3 side = normalize(numeric::cross(along, Vec3(0, 0, 1) + center * 0.2));
        const Vec3 other = numeric::cross(along, side);
        for (std::uint32_t k = 0; k < across; ++k) {
            const double b = 2 * M_PI * k / across;
            const Vec3 out = side * std::cos(b) + other * std::sin(b);
            mesh.positions.push_back(center + out * (0.5 * (1 + 0.3 * bumps(center + out * 0.5))));
        }
    }
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t k = 0; k < across; ++k) {
            const std::uint32_t next = (i + 1) % around * across, turn = (k + 1) % across;
            const std::uint32_t a = i * across + k, b = next + k, c = next + turn,
                                d = i * across + turn;
            mesh.indices.insert(mesh.indices.end(), {{a, b, c}, {a, c, d}});
        }
}

void addQuad(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
    const auto i = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), {a, b, c, d});
    mesh.indices.insert(mesh.indices.end(), {{i, i + 1, i + 2}, {i, i + 2, i + 3}});
}

void lookFrom(Mesh& mesh, const Vec3& direction, double distance) {
    numeric::Box3d box;
    for (const Vec3& p : mesh.positions) box.add(p);
    const double radius = 0.5 * numeric::length(box.diagonal());
    mesh.target = box.centre();
    mesh.eye = mesh.target + normalize(direction) * (radius * distance);
    mesh.light =
        mesh.target +
        normalize(Vec3(direction.z + direction.x, 1.2, direction.z - direction.x)) * (radius * 3);
    mesh.fieldOfView = 2 * std::atan(0.55 / distance);
}

void makeStadium(Mesh& mesh) {
    constexpr std::uint32_t kRings = 60, kSeats = 160;
    for (std::uint32_t r = 0; r <= kRings; ++r)
        for (std::uint32_t s = 0; s < kSeats; ++s) {
            const double a = 2 * M_PI * s / kSeats;
            const double radius = 60 + 2.0 * (r / 2) + (r & 1 ? 1.9 : 0), y = (r + 1) / 2 * 1.2;
            mesh.positions.emplace_back(radius * std::cos(a), y, radius * std::sin(a) * 0.7);
        }
    for (std::uint32_t r = 0; r < kRings; ++r)
        for (std::uint32_t s = 0; s < kSeats; ++s) {
            const std::uint32_t a = r * kSeats + s, b = r * kSeats + (s + 1) % kSeats,
                                c = a + kSeats, d = b + kSeats;
            mesh.indices.insert(mesh.indices.end(), {{a, b, c}, {b, d, c}});
        }
    addQuad(mesh, {-200, 0, -200}, {200, 0, -200}, {200, 0, 200}, {-200, 0, 200});
    for (int i = 0; i < 40; ++i) {
        const double a = 2 * M_PI * i / 40, x = 62 * std::cos(a), z = 62 * 0.7 * std::sin(a);
        addQuad(mesh, {x - 0.2, 0, z}, {x + 0.2, 0, z}, {x + 0.2, 40, z}, {x - 0.2, 40, z});
    }
    addIcosphere(mesh, 6, 0.2, {0.3, 0.5, 0}, 0.4);
    addIcosphere(mesh, 5, 0.35, {0.9, 0.3, 0.3}, 0.2);
    mesh.eye = {2.2, 1.6, 3.2};
    mesh.target = {0.3, 0.25, 0};
    mesh.light = {30, 60, 20};
    mesh.fieldOfView = 50 * M_PI / 180;
}

void makeSoup(Mesh& mesh) {
    Uniform u(7);
    for (std::uint32_t i = 0; i < 500000; ++i) {
        const Vec3 p(u(), u(), u());
        for (int k = 0; k < 3; ++k)
            mesh.positions.push_back(p + Vec3(u() - 0.5, u() - 0.5, u() - 0.5) * 0.012);
        mesh.indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    lookFrom(mesh, {0.3, 0.4, 1}, 2);
}

void makeSlivers(Mesh& mesh) {
    Uniform u(7);
    const auto direction = [&] { return normalize(Vec3(u() - 0.5, u() - 0.5, u() - 0.5)); };
    for (std::uint32_t i = 0; i < 20000; ++i) {
        const Vec3 p(u(), u(), u()), d = direction() * (0.1 + 0.4 * u()), e = direction() * 0.0015;
        mesh.positions.insert(mesh.positions.end(), {p, p + d, p + d * 0.5 + e});
        mesh.indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    lookFrom(mesh, {0.3, 0.4, 1}, 2);
}

void addFlake(std::vector<Ball>& balls, const Vec3& center, double radius, const Vec3& up,
              int depth) {
    balls.push_back({center, radius});
    if (depth == 0) return;
    const Vec3 side =
        normalize(numeric::cross(up, std::fabs(up.x) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 1, 0)));
    const Vec3 front = numeric::cross(up, side);
    const auto child = [&](double azimuth, double elevation) {
        const Vec3 d =
            (side * std::cos(azimuth) + front * std::sin(azimuth)) * std::cos(elevation) +
            up * std::sin(elevation);
        addFlake(balls, center + d * (radius * 4 / 3), radius / 3, d, depth - 1);
    };
    for (int i = 0; i < 6; ++i) child(2 * M_PI * i / 6, 0);
    for (int i = 0; i < 3; ++i) child(2 * M_PI * (i + 0.5) / 3, M_PI / 3.3);
}

} // namespace

Mesh makeMesh(const std::string& what) {
    const auto star = what.find('*');
    const std::string base = what.substr(0, star);
    Mesh mesh;
    if (base == "ico") {
        addIcosphere(mesh, 8, 0.35, Vec3(0.0), 1);
        lookFrom(mesh, {0.4, 0.3, 1}, 2);
    } else if (base == "scan70k" || base == "scan870k") {
        // 2 · 577 · 61 is 70 394, 2 · 2000 · 218 is 872 000: the classes of the bunny and the dragon.
        base == "scan70k" ? addKnot(mesh, 577, 61) : addKnot(mesh, 2000, 218);
        lookFrom(mesh, {0.3, 0.3, 1}, 2);
    } else if (base == "bodies") {
        addIcosphere(mesh, 7, 0.35, Vec3(0.0), 1);
        addIcosphere(mesh, 7, 0.2, {0.2, 2.2, 0}, 0.6);
        addIcosphere(mesh, 7, 0.2, {-0.2, -2.2, 0}, 0.6);
        mesh.firstOfBody = static_cast<std::uint32_t>(mesh.indices.size());
        mesh.firstVertexOfBody = static_cast<std::uint32_t>(mesh.positions.size());
        addIcosphere(mesh, 6, 0.2, {2.6, 0, 0}, 0.5);
        lookFrom(mesh, {0.4, 0.3, 1}, 2);
    } else if (base == "stadium") {
        makeStadium(mesh);
    } else if (base == "soup") {
        makeSoup(mesh);
    } else if (base == "sliver") {
        makeSlivers(mesh);
    } else {
        readFile(mesh, base);
        lookFrom(mesh, {0.3, 0.3, 1}, 2);
    }
    if (star != std::string::npos)
        for (int n = std::stoi(what.substr(star + 1)); n > 0; --n) subdivide(mesh);
    for (Vec3& p : mesh.positions)
        p = Vec3(static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z));
    const auto slash = what.rfind('/');
    mesh.name = slash == std::string::npos ? what : what.substr(slash + 1);
    return mesh;
}

std::vector<Ball> makeBalls(const std::string& what) {
    std::vector<Ball> balls;
    if (what == "flake") {
        addFlake(balls, Vec3(0.0), 1, {0, 1, 0}, 4);
    } else if (what == "random") {
        Uniform u(5);
        for (int i = 0; i < 100000; ++i) {
            const Vec3 c(u(), u(), u());
            balls.push_back({c, 0.001 + 0.006 * u()});
        }
    } else {
        throw std::runtime_error("no balls named '" + what + "'");
    }
    for (Ball& b : balls) {
        b.center = Vec3(static_cast<float>(b.center.x), static_cast<float>(b.center.y),
                        static_cast<float>(b.center.z));
        b.radius = static_cast<float>(b.radius);
    }
    return balls;
}

} // namespace rt::bench
