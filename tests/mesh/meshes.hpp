// Meshes that the tests generate, and what they ask of results.
#pragma once
#include <plugins/loaders/mesh_import.hpp>
#include <plugins/loaders/obj_text.hpp>
#include <plugins/loaders/repair.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace rt::loaders::testing {

using Face = std::vector<std::uint32_t>; // corners from 0

struct Polygons {
    std::vector<Vector3> vertices;
    std::vector<Face> faces;

    std::string obj() const;
};

/// Unit cube, quads wound outward.
Polygons cube(Vector3 corner = {0, 0, 0}, double size = 1);
/// A torus of columns x rows quads, wound outward.
Polygons torus(std::uint32_t columns, std::uint32_t rows);
/// Icosphere-like ball: `rows` rings of `columns`, quads with triangles at the poles, wound outward.
Polygons ball(std::uint32_t columns, std::uint32_t rows);
/// A strip of `n` quads with one half turn.
Polygons moebius(std::uint32_t n);

void append(Polygons& to, const Polygons& from);
void reverse(Face& face);
/// Turns each face with probability `share`, by a fixed generator.
Polygons shuffled(Polygons mesh, double share, std::uint32_t seed);

MeshFile parse(const std::string& obj);
RepairedMesh repairObj(const std::string& obj, Repair level = Repair::full);
Import import(const std::string& obj, const ImportOptions& options = {});

/// The message with which reading `obj` is refused; empty when it is not.
std::string refusal(const std::string& obj);
std::string messageOf(const std::function<void()>& call);

/// Area-weighted normal of face f, by the file's positions.
double area(const Vector3& a, const Vector3& b, const Vector3& c);

/// A folder that is removed with everything in it.
class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    std::string write(const std::string& name, const std::string& bytes) const;
    const std::filesystem::path& path() const { return path_; }

private:
    std::filesystem::path path_;
};

std::string gzip(const std::string& bytes);

} // namespace rt::loaders::testing
