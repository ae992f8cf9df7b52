#include "meshes.hpp"

#include <charconv>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <stdexcept>

#include <stdlib.h>
#include <zlib.h>

namespace rt::loaders::testing {
namespace {

std::string digits(double value) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

} // namespace

std::string Polygons::obj() const {
    std::string out;
    for (const Vector3& v : vertices)
        out += "v " + digits(v.x) + " " + digits(v.y) + " " + digits(v.z) + "\n";
    for (const Face& f : faces) {
        out += "f";
        for (const std::uint32_t v : f) out += " " + std::to_string(v + 1);
        out += "\n";
    }
    return out;
}

Polygons cube(Vector3 corner, double size) {
    Polygons mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.push_back(corner +
                                Vector3{double(i & 1), double(i >> 1 & 1), double(i >> 2)} * size);
    mesh.faces = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    return mesh;
}

Polygons torus(std::uint32_t columns, std::uint32_t rows) {
    Polygons mesh;
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const double a = 2 * std::numbers::pi * i / columns,
                         b = 2 * std::numbers::pi * j / rows;
            const double r = 1 + 0.3 * std::cos(b);
            mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), 0.3 * std::sin(b)});
        }
    for (std::uint32_t j = 0; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const std::uint32_t right = (i + 1) % columns, up = (j + 1) % rows;
            mesh.faces.push_back(
                {j * columns + i, j * columns + right, up * columns + right, up * columns + i});
        }
    return mesh;
}

Polygons ball(std::uint32_t columns, std::uint32_t rows) {
    Polygons mesh;
    mesh.vertices.push_back({0, 0, -1});
    for (std::uint32_t j = 1; j < rows; ++j)
        for (std::uint32_t i = 0; i < columns; ++i) {
            const double a = 2 * std::numbers::pi * i / columns,
                         b = std::numbers::pi * (double(j) / rows - 0.5);
            mesh.vertices.push_back(
                {std::cos(b) * std::cos(a), std::cos(b) * std::sin(a), std::sin(b)});
        }
    mesh.vertices.push_back({0, 0, 1});
    const auto at = [&](std::uint32_t j, std::uint32_t i) {
        return 1 + (j - 1) * columns + i % columns;
    };
    const auto last = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
    for (std::uint32_t i = 0; i < columns; ++i) {
        mesh.faces.push_back({0, at(1, i + 1), at(1, i)});
        for (std::uint32_t j = 1; j + 1 < rows; ++j)
            mesh.faces.push_back({at(j, i), at(j, i + 1), at(j + 1, i + 1), at(j + 1, i)});
        mesh.faces.push_back({last, at(rows - 1, i), at(rows - 1, i + 1)});
    }
    return mesh;
}

Polygons moebius(std::uint32_t n) {
    Polygons mesh;
    for (std::uint32_t i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * i / n;
        for (const double side : {-0.3, 0.3}) {
            const double r = 1 + side * std::cos(a / 2);
            mesh.vertices.push_back({r * std::cos(a), r * std::sin(a), side * std::sin(a / 2)});
        }
    }
    for (std::uint32_t i = 0; i + 1 < n; ++i)
        mesh.faces.push_back({2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2});
    mesh.faces.push_back({2 * n - 2, 2 * n - 1, 0, 1});
    return mesh;
}

void append(Polygons& to, const Polygons& from) {
    const auto base = static_cast<std::uint32_t>(to.vertices.size());
    to.vertices.insert(to.vertices.end(), from.vertices.begin(), from.vertices.end());
    for (Face f : from.faces) {
        for (std::uint32_t& v : f) v += base;
        to.faces.push_back(std::move(f));
    }
}

void reverse(Face& face) { std::reverse(face.begin(), face.end()); }

Polygons shuffled(Polygons mesh, double share, std::uint32_t seed) {
    std::mt19937 random(seed);
    for (Face& f : mesh.faces)
        if (random() < share * 4294967296.0) reverse(f);
    return mesh;
}

MeshFile parse(const std::string& obj) { return readObj("folder/test.obj", obj); }

RepairedMesh repairObj(const std::string& obj, Repair level) { return repair(parse(obj), level); }

Import import(const std::string& obj, const ImportOptions& options) {
    return importMesh(parse(obj), options);
}

std::string messageOf(const std::function<void()>& call) {
    try {
        call();
    } catch (const FileError& e) {
        return e.what();
    }
    return "";
}

std::string refusal(const std::string& obj) {
    return messageOf([&] { parse(obj); });
}

double area(const Vector3& a, const Vector3& b, const Vector3& c) {
    return length(cross(b - a, c - a)) / 2;
}

TemporaryFolder::TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "rt-mesh-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
    path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& bytes) const {
    const std::filesystem::path file = path_ / name;
    std::filesystem::create_directories(file.parent_path());
    std::ofstream(file, std::ios::binary) << bytes;
    return file.string();
}

std::string gzip(const std::string& bytes) {
    z_stream stream{};
    constexpr int kGzip = 16;
    deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, MAX_WBITS + kGzip, 8,
                 Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

} // namespace rt::loaders::testing
