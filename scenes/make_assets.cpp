// Generates the meshes and textures of the gallery: make_assets FOLDER. Same bytes on every machine.
#include <core/numeric/elementary.hpp>
#include <core/numeric/vec.hpp>

#include <bit>
#include <charconv>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

namespace {

using rt::numeric::Vec2;
using rt::numeric::Vec3;
constexpr double kTau = 2 * std::numbers::pi;

Vec3 onCircle(double angle) { return {rt::numeric::cos(angle), rt::numeric::sin(angle), 0}; }

// ---- meshes ---------------------------------------------------------------------------------------------

class ObjText {
public:
    void line(const char* keyword, std::initializer_list<double> numbers) {
        text_ += keyword;
        for (const double x : numbers) number(x);
        text_ += '\n';
    }
    /// Corners of one face, from 0; the same index serves v, vt and vn where the mesh has them.
    void face(std::initializer_list<std::uint32_t> corners, const char* pattern) {
        text_ += 'f';
        for (const std::uint32_t c : corners) {
            const std::string index = std::to_string(c + 1);
            text_ += ' ';
            for (const char* p = pattern; *p; ++p) *p == '#' ? text_ += index : text_ += *p;
        }
        text_ += '\n';
    }
    void comment(const std::string& words) { text_ += "# " + words + '\n'; }
    const std::string& text() const { return text_; }

private:
    void number(double x) {
        char buffer[32];
        const auto end = std::to_chars(buffer, buffer + sizeof buffer, x).ptr;
        text_ += ' ';
        text_.append(buffer, end);
    }
    std::string text_;
};

/// A tube around the (2, 3) torus knot, standing on z = 0, about 2 wide. Smooth normals, uv along and around.
std::string knot(std::uint32_t along, std::uint32_t around) {
    const auto curve = [](double t) {
        const double r = 0.62 + 0.25 * rt::numeric::cos(3 * t);
        return onCircle(2 * t) * r + Vec3(0, 0, 0.25 * rt::numeric::sin(3 * t));
    };
    constexpr double kTube = 0.13;
    ObjText obj;
    obj.comment("(2, 3) torus knot, " + std::to_string(along * around) +
                " quads; made by scenes/make_assets.cpp");
    const double height = 0.25 + kTube;
    for (std::uint32_t i = 0; i < along; ++i) {
        const double t = kTau * i / along, step = kTau / (64.0 * along);
        const Vec3 here = curve(t),
                   tangent = rt::numeric::normalize(curve(t + step) - curve(t - step));
        const Vec3 side = rt::numeric::normalize(rt::numeric::cross(tangent, Vec3(0, 0, 1)));
        const Vec3 up = rt::numeric::cross(side, tangent);
        for (std::uint32_t k = 0; k < around; ++k) {
            const Vec3 circle = onCircle(kTau * k / around);
            const Vec3 normal = side * circle.x + up * circle.y;
            const Vec3 p = here + normal * kTube + Vec3(0, 0, height);
            obj.line("v", {p.x, p.y, p.z});
            obj.line("vn", {normal.x, normal.y, normal.z});
            obj.line("vt", {8.0 * i / along, double(k) / around});
        }
    }
    for (std::uint32_t i = 0; i < along; ++i)
        for (std::uint32_t k = 0; k < around; ++k) {
            const std::uint32_t i1 = (i + 1) % along, k1 = (k + 1) % around;
            obj.face({i * around + k, i1 * around + k, i1 * around + k1, i * around + k1}, "#/#/#");
        }
    return obj.text();
}

/// A brilliant-like cut stone: closed, faceted, n-gon table and facets; tip at the origin, about 1 wide.
std::string gem() {
    ObjText obj;
    obj.comment("cut stone, closed and faceted; made by scenes/make_assets.cpp");
    constexpr std::uint32_t kSides = 16;
    const auto ring = [&](double radius, double z, double turn) {
        for (std::uint32_t k = 0; k < kSides; ++k) {
            const Vec3 c = onCircle(kTau * (k + turn) / kSides) * radius;
            obj.line("v", {c.x, c.y, z});
        }
    };
    obj.line("v", {0, 0, 0}); // 0: culet
    ring(0.5, 0.43, 0);       // 1..: lower girdle
    ring(0.5, 0.46, 0);       // upper girdle
    ring(0.28, 0.62, 0.5);    // table
    const auto v = [](std::uint32_t ringIndex, std::uint32_t k) {
        return 1 + ringIndex * kSides + k % kSides;
    };
    for (std::uint32_t k = 0; k < kSides; ++k) {
        obj.face({0, v(0, k + 1), v(0, k)}, "#");
        obj.face({v(0, k), v(0, k + 1), v(1, k + 1), v(1, k)}, "#");
        obj.face({v(1, k), v(1, k + 1), v(2, k)}, "#");
        obj.face({v(1, k + 1), v(2, k + 1), v(2, k)}, "#");
    }
    std::string table = "f";
    for (std::uint32_t k = 0; k < kSides; ++k) table += ' ' + std::to_string(v(2, k) + 1);
    return obj.text() + table + '\n';
}

/// A snail's shell: a tube that grows by the same factor with every turn, apex at the top; 1.9 high. Its normals are those of
/// the surface; u runs once along each turn, v round the tube.
std::string shell(std::uint32_t along, std::uint32_t around) {
    constexpr double kTurns = 6, kGrowth = 0.125; // per radian
    const auto surface = [](double turn, double v) {
        const double size = rt::numeric::exp(kGrowth * kTau * (turn - kTurns));
        const double ribs = 1 + 0.035 * rt::numeric::cos(12 * kTau * turn);
        const double away = 0.5 + 0.46 * ribs * rt::numeric::cos(v);
        return size * (onCircle(kTau * turn) * away +
                       Vec3(0, 0, -1.15 + 0.5 * ribs * rt::numeric::sin(v))) +
               Vec3(0, 0, 1.65);
    };
    ObjText obj;
    obj.comment("snail's shell, " + std::to_string(along * around) +
                " quads; made by scenes/make_assets.cpp");
    for (std::uint32_t i = 0; i <= along; ++i)
        for (std::uint32_t k = 0; k <= around; ++k) {
            const double turn = kTurns * i / along, v = kTau * k / around, h = 1.0 / 4096;
            const Vec3 p = surface(turn, v);
            const Vec3 normal = rt::numeric::normalize(
                rt::numeric::cross(surface(turn + h, v) - surface(turn - h, v),
                                   surface(turn, v + h) - surface(turn, v - h)));
            obj.line("v", {p.x, p.y, p.z});
            obj.line("vn", {normal.x, normal.y, normal.z});
            obj.line("vt", {turn, double(k) / around});
        }
    const std::uint32_t row = around + 1;
    for (std::uint32_t i = 0; i < along; ++i)
        for (std::uint32_t k = 0; k < around; ++k)
            obj.face({i * row + k, (i + 1) * row + k, (i + 1) * row + k + 1, i * row + k + 1},
                     "#/#/#");
    return obj.text();
}

/// Vertices and triangles for a glTF file: f32 positions and normals, u16 indices.
class Lathe {
public:
    struct
        Ring { // of a profile: distance from the y axis and height, and the normal's parts along both
        double radius, y, outward, upward;
    };

    /// Turns the profile, from its top down, about y. Its ends may lie on the axis.
    void turn(const std::vector<Ring>& profile, std::uint32_t around) {
        const auto first = static_cast<std::uint32_t>(normals_.size());
        for (const Ring& ring : profile)
            for (std::uint32_t k = 0; k < around; ++k) {
                const Vec3 c = onCircle(kTau * k / around);
                positions_.push_back({ring.radius * c.x, ring.y, -ring.radius * c.y});
                normals_.push_back(rt::numeric::normalize(
                    Vec3(ring.outward * c.x, ring.upward, -ring.outward * c.y)));
            }
        for (std::uint32_t i = 0; i + 1 < profile.size(); ++i)
            for (std::uint32_t k = 0; k < around; ++k) {
                const std::uint32_t k1 = (k + 1) % around, upper = first + i * around,
                                    lower = upper + around;
                if (profile[i].radius > 0) triangle(upper + k, lower + k, upper + k1);
                if (profile[i + 1].radius > 0) triangle(upper + k1, lower + k, lower + k1);
            }
    }

    std::size_t vertexCount() const { return positions_.size(); }
    std::size_t indexCount() const { return indices_.size(); }
    std::string bytes() const {
        std::string out;
        for (const auto* list : {&positions_, &normals_})
            for (const Vec3& v : *list)
                for (int i = 0; i < 3; ++i) put(out, std::bit_cast<std::uint32_t>(float(v[i])), 4);
        for (const std::uint32_t index : indices_) put(out, index, 2);
        return out;
    }

private:
    void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        indices_.insert(indices_.end(), {a, b, c});
    }
    static void put(std::string& out, std::uint32_t value, int count) { // little-endian
        for (int i = 0; i < count; ++i) out += char(value >> 8 * i & 255);
    }

    std::vector<Vec3> positions_, normals_;
    std::vector<std::uint32_t> indices_;
};

/// A chess pawn, about 1 high, as the glTF files `pawns.gltf` and `pawns.bin`: an ivory one, a taller one of ebony, and
/// one of ivory that has fallen over. y is up, as always in glTF.
Lathe pawn() {
    Lathe lathe;
    constexpr std::uint32_t kAround = 64;
    const auto ellipsoid = [&](double y, double radius, double height, std::uint32_t rings) {
        std::vector<Lathe::Ring> profile;
        for (std::uint32_t i = 0; i <= rings; ++i) {
            const double angle = kTau / 2 * i / rings, c = rt::numeric::cos(angle);
            const double s = i == rings ? 0 : rt::numeric::sin(angle);
            profile.push_back({radius * s, y + height * c, s / radius, c / height});
        }
        lathe.turn(profile, kAround);
    };
    ellipsoid(0.86, 0.17, 0.17, 32);
    ellipsoid(0.68, 0.2, 0.035, 16);
    std::vector<Lathe::Ring> body; // radius 0.1 + 0.2 h^3, h from 0 at the collar to 1 at the base
    for (std::uint32_t i = 0; i <= 24; ++i) {
        const double h = i / 24.0;
        body.push_back({0.1 + 0.2 * h * h * h, 0.7 - 0.56 * h, 0.56, 0.6 * h * h});
    }
    lathe.turn(body, kAround);
    ellipsoid(0.09, 0.36, 0.09, 24);
    return lathe;
}

std::string pawnScene(const Lathe& lathe) {
    const std::string vertices = std::to_string(lathe.vertexCount());
    const std::size_t block = 12 * lathe.vertexCount();
    const auto view = [&](std::size_t offset, std::size_t length) {
        return "{\"buffer\": 0, \"byteOffset\": " + std::to_string(offset) +
               ", \"byteLength\": " + std::to_string(length) + "}";
    };
    const auto mesh = [](const char* name, int material) {
        return std::string("{\"name\": \"") + name +
               "\", \"primitives\": [{\"attributes\": {\"POSITION\": 0, \"NORMAL\": 1}, "
               "\"indices\": 2, \"material\": " +
               std::to_string(material) + "}]}";
    };
    const auto material = [](const char* name, const char* color) {
        return std::string("{\"name\": \"") + name +
               "\", \"pbrMetallicRoughness\": {\"baseColorFactor\": " + color +
               ", \"metallicFactor\": 0}}";
    };
    return "{\n\"asset\": {\"version\": \"2.0\", \"generator\": \"scenes/make_assets.cpp\"},\n"
           "\"scene\": 0,\n\"scenes\": [{\"nodes\": [0]}],\n\"nodes\": [\n"
           "  {\"name\": \"pawns\", \"children\": [1, 2, 3]},\n"
           "  {\"name\": \"standing\", \"mesh\": 0, \"translation\": [-0.75, 0, 0.1]},\n"
           "  {\"name\": \"tall\", \"mesh\": 1, \"translation\": [0.7, 0, -0.5], \"scale\": [1.1, "
           "1.35, 1.1]},\n"
           "  {\"name\": \"place\", \"children\": [4], \"translation\": [-0.2, 0, 0.9], "
           "\"rotation\": [0, 0.1736, 0, 0.9848]},\n"
           "  {\"name\": \"fallen\", \"mesh\": 0, \"translation\": [0, 0.371, 0], "
           "\"rotation\": [0, 0, -0.7896, 0.6136]}],\n\"meshes\": [\n  " +
           mesh("ivory pawn", 0) + ",\n  " + mesh("ebony pawn", 1) + "],\n\"materials\": [\n  " +
           material("ivory", "[0.87, 0.76, 0.55, 1]") + ",\n  " +
           material("ebony", "[0.11, 0.07, 0.05, 1]") +
           "],\n\"buffers\": [{\"uri\": \"pawns.bin\", \"byteLength\": " +
           std::to_string(2 * block + 2 * lathe.indexCount()) + "}],\n\"bufferViews\": [\n  " +
           view(0, block) + ",\n  " + view(block, block) + ",\n  " +
           view(2 * block, 2 * lathe.indexCount()) + "],\n\"accessors\": [\n" +
           "  {\"bufferView\": 0, \"componentType\": 5126, \"type\": \"VEC3\", \"count\": " +
           vertices + ", \"min\": [-0.36, 0, -0.36], \"max\": [0.36, 1.03, 0.36]},\n" +
           "  {\"bufferView\": 1, \"componentType\": 5126, \"type\": \"VEC3\", \"count\": " +
           vertices +
           "},\n  {\"bufferView\": 2, \"componentType\": 5123, \"type\": \"SCALAR\", \"count\": " +
           std::to_string(lathe.indexCount()) + "}]\n}\n";
}

// ---- textures -------------------------------------------------------------------------------------------

/// Lattice value in [0, 1) from a hash; the lattice repeats every `period` cells in x.
double lattice(std::int64_t x, std::int64_t y, std::int64_t period) {
    std::uint64_t h = std::uint64_t((x % period + period) % period) * 0x9E3779B97F4A7C15u ^
                      std::uint64_t(y) * 0xC2B2AE3D27D4EB4Fu;
    h = (h ^ (h >> 31)) * 0xD6E8FEB86659FD93u;
    h = (h ^ (h >> 32)) * 0xD6E8FEB86659FD93u;
    return double((h ^ (h >> 29)) >> 11) / 9007199254740992.0;
}

double smoothNoise(double x, double y, std::int64_t period) {
    const double fx = std::floor(x), fy = std::floor(y), u = x - fx, v = y - fy;
    const auto i = std::int64_t(fx), j = std::int64_t(fy);
    const double a = u * u * (3 - 2 * u), b = v * v * (3 - 2 * v);
    const double lower = lattice(i, j, period) * (1 - a) + lattice(i + 1, j, period) * a;
    const double upper = lattice(i, j + 1, period) * (1 - a) + lattice(i + 1, j + 1, period) * a;
    return lower * (1 - b) + upper * b;
}

double fractalNoise(double x, double y, std::int64_t period, int octaves) {
    double sum = 0, weight = 0.5;
    for (int o = 0; o < octaves; ++o, weight *= 0.5) {
        const double scale = double(1 << o);
        sum += weight * smoothNoise(x * scale, y * scale, period << o);
    }
    return sum;
}

Vec3 mix(const Vec3& a, const Vec3& b, double t) { return a * (1 - t) + b * t; }
double step(double low, double high, double x) {
    const double t = x <= low ? 0 : x >= high ? 1 : (x - low) / (high - low);
    return t * t * (3 - 2 * t);
}

/// Binary PPM of sRGB-encoded values; u runs right, v down, both in (0, 1).
std::string ppm(std::uint32_t width, std::uint32_t height,
                const std::function<Vec3(double u, double v)>& color) {
    std::string text = "P6\n" + std::to_string(width) + ' ' + std::to_string(height) + "\n255\n";
    for (std::uint32_t y = 0; y < height; ++y)
        for (std::uint32_t x = 0; x < width; ++x) {
            const Vec3 c = color((x + 0.5) / width, (y + 0.5) / height);
            for (int k = 0; k < 3; ++k)
                text += char(std::uint8_t(std::nearbyint(255 * std::fmin(1, std::fmax(0, c[k])))));
        }
    return text;
}

/// An evening sky, lat-long: zenith at the top, horizon in the middle, haze and water below.
Vec3 sky(double u, double v) {
    const double height = 1 - 2 * v; // 1 zenith, 0 horizon, -1 nadir
    const Vec3 zenith{0.16, 0.30, 0.58}, high{0.45, 0.62, 0.83}, glow{0.98, 0.80, 0.62},
        ground{0.34, 0.33, 0.36};
    if (height < 0) return mix(glow, ground, step(0, 0.3, -height));
    Vec3 c = mix(mix(glow, high, step(0, 0.28, height)), zenith, step(0.2, 0.95, height));
    const double dx = std::fmin(std::fabs(u - 0.62), 1 - std::fabs(u - 0.62)) * 2,
                 dy = height - 0.22;
    const double sun = dx * dx + dy * dy;
    c += Vec3(1.0, 0.85, 0.6) * (0.55 / (1 + 60 * sun));
    const double cloud = fractalNoise(u * 12, v * 26, 12, 6);
    const double cover =
        step(0.50, 0.72, cloud) * step(0.02, 0.14, height) * (1 - 0.6 * step(0.6, 1, height));
    return mix(c, mix(Vec3(1.0, 0.92, 0.86), Vec3(0.80, 0.80, 0.86), step(0.6, 0.85, cloud)),
               0.85 * cover);
}

/// Veined stone that repeats in u and, closely enough for a floor of large slabs, in v.
Vec3 marble(double u, double v) {
    const double warp = fractalNoise(u * 6, v * 6, 6, 5);
    const double vein = std::fabs(rt::numeric::sin(kTau * (u + v + 1.6 * warp)));
    const double sharp = step(0, 0.35, vein);
    return mix(Vec3(0.42, 0.34, 0.30), mix(Vec3(0.93, 0.90, 0.85), Vec3(0.80, 0.78, 0.76), warp),
               sharp);
}

/// Brown bands and growth lines for the shell; u along a turn, v round the tube.
Vec3 shellColor(double u, double v) {
    const double wave = 0.06 * smoothNoise(u * 16, v * 4, 16);
    const double bands = step(0.35, 0.75, 0.5 + 0.5 * rt::numeric::sin(kTau * (5 * (v + wave))));
    const double growth = fractalNoise(u * 48, v * 3, 48, 4);
    const Vec3 cream{0.96, 0.90, 0.80}, brown{0.56, 0.31, 0.17};
    return mix(mix(cream, brown, 0.85 * bands), Vec3(0.93, 0.78, 0.66),
               0.7 * step(0.55, 0.8, growth));
}

void write(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream file(path, std::ios::binary);
    file << bytes;
    if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

} // namespace

int main(int argc, char** argv) try {
    if (argc != 2) return std::fputs("usage: make_assets FOLDER\n", stderr), 2;
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder);
    write(folder / "knot.obj", knot(480, 40));
    write(folder / "coarse_knot.obj", knot(36, 7));
    write(folder / "gem.obj", gem());
    write(folder / "shell.obj", shell(720, 40));
    const Lathe piece = pawn();
    write(folder / "pawns.gltf", pawnScene(piece));
    write(folder / "pawns.bin", piece.bytes());
    write(folder / "sky.ppm", ppm(2048, 1024, sky));
    write(folder / "marble.ppm", ppm(1024, 1024, marble));
    write(folder / "shell.ppm", ppm(512, 512, shellColor));
    return 0;
} catch (const std::exception& error) {
    return std::fprintf(stderr, "make_assets: %s\n", error.what()), 6;
}
