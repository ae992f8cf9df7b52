#include "bench_meshes.hpp"

#include <core/numeric/box.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <stdexcept>
#include <string_view>

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

void readObj(Mesh& mesh, const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error("cannot read '" + path + "'");
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const auto base = static_cast<std::uint32_t>(mesh.positions.size());
    std::string_view rest = text;
    while (!rest.empty()) {
        const auto end = rest.find('\n');
        std::string_view line = rest.substr(0, end);
        rest = end == std::string_view::npos ? std::string_view{} : rest.substr(end + 1);
        const auto number = [&](auto& value) {
            while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
            const auto [to, error] = std::from_chars(line.data(), line.data() + line.size(), value);
            if (error != std::errc{}) return false;
            line.remove_prefix(static_cast<std::size_t>(to - line.data()));
            return true;
        };
        if (line.starts_with("v ")) {
            line.remove_prefix(2);
            Vec3 p;
            for (int i = 0; i < 3; ++i)
                if (!number(p[i])) throw std::runtime_error("bad vertex in '" + path + "'");
            mesh.positions.push_back(p);
        } else if (line.starts_with("f ")) {
            line.remove_prefix(2);
            std::vector<std::uint32_t> corners;
            for (std::int64_t i; number(i);) {
                const auto count = static_cast<std::int64_t>(mesh.positions.size());
                corners.push_back(static_cast<std::uint32_t>(i < 0 ? count + i : base + i - 1));
                while (!line.empty() && line.front() != ' ') line.remove_prefix(1);
            }
            for (std::size_t i = 2; i < corners.size(); ++i)
                mesh.indices.push_back({corners[0], corners[i - 1], corners[i]});
        }
    }
    for (const auto& t : mesh.indices)
        for (const auto i : t)
            if (i >= mesh.positions.size()) throw std::runtime_error("bad index in '" + path + "'");
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
    } else if (base == "stadium") {
        makeStadium(mesh);
    } else if (base == "soup") {
        makeSoup(mesh);
    } else if (base == "sliver") {
        makeSlivers(mesh);
    } else {
        readObj(mesh, base);
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
