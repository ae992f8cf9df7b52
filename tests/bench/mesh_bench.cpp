// Mesh import against OpenMesh's own reader: mesh_bench [FILE.obj...]; without files, a torus of 871 200 triangles.
// Prints medians of five interleaved runs: our text pass, OpenMesh's reader, their ratio, and the whole import (read, repair,
// connectivity, smooth normals) on one core.
#include <plugins/loaders/file_bytes.hpp>
#include <plugins/loaders/mesh_import.hpp>

#include <OpenMesh/Core/IO/MeshIO.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <numbers>
#include <string>

#include <time.h>
#include <unistd.h>

namespace {

constexpr int kRuns = 5;

struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    using Normal = OpenMesh::Vec3d;
};

/// Processor time: everything here runs on one thread, and other work on the machine does not count.
double seconds(const std::function<void()>& call) {
    const auto now = [] {
        timespec t{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
        return static_cast<double>(t.tv_sec) + static_cast<double>(t.tv_nsec) / 1e9;
    };
    const double from = now();
    call();
    return now() - from;
}

double median(std::array<double, kRuns> times) {
    std::sort(times.begin(), times.end());
    return times[kRuns / 2];
}

std::string torus(const std::filesystem::path& path) {
    constexpr int n = 660;
    std::ofstream out(path);
    char line[128];
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const double a = 2 * std::numbers::pi * i / n, b = 2 * std::numbers::pi * j / n;
            const double r = 1 + 0.3 * std::cos(b) * (1 + 0.05 * std::sin(13 * a));
            std::snprintf(line, sizeof line, "v %.6f %.6f %.6f\n", r * std::cos(a), r * std::sin(a),
                          0.3 * std::sin(b));
            out << line;
        }
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) {
            const int right = (i + 1) % n, up = (j + 1) % n;
            const int p = j * n + i + 1, q = j * n + right + 1, r = up * n + right + 1,
                      s = up * n + i + 1;
            out << "f " << p << ' ' << q << ' ' << r << "\nf " << p << ' ' << r << ' ' << s << '\n';
        }
    return path;
}

void measure(const std::string& path) {
    // Both read the same plain text, also where the file is gzipped.
    const std::string text = rt::loaders::readFile(path, rt::loaders::kLargestMesh);
    const auto plain = std::filesystem::temp_directory_path() /
                       ("mesh_bench." + std::to_string(getpid()) + ".obj");
    std::ofstream(plain, std::ios::binary) << text;
    std::array<double, kRuns> ours{}, openMesh{}, whole{};
    std::uint32_t faces = 0;
    std::size_t triangles = 0;
    for (std::size_t i = 0; i < kRuns; ++i) {
        ours[i] = seconds([&] { faces = rt::loaders::readMesh(plain.string()).faceCount(); });
        openMesh[i] = seconds([&] {
            OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits> mesh;
            OpenMesh::IO::read_mesh(mesh, plain.string());
        });
        whole[i] = seconds([&] {
            const auto import =
                rt::loaders::importMesh(plain.string(), {.normals = rt::loaders::Normals::smooth});
            triangles = import.mesh.triangles.size();
        });
    }
    std::filesystem::remove(plain);
    std::printf("%-28s %8u faces  parse %7.1f ms  OpenMesh %7.1f ms  ratio %5.1f  import %8zu "
                "triangles %6.3f s\n",
                std::filesystem::path(path).filename().c_str(), faces, 1e3 * median(ours),
                1e3 * median(openMesh), median(openMesh) / median(ours), triangles, median(whole));
}

} // namespace

int main(int argc, char** argv) {
    omerr().disconnect(std::cerr); // it has a line for every edge it dislikes
    for (int i = 1; i < argc; ++i) measure(argv[i]);
    if (argc > 1) return 0;
    const auto path =
        std::filesystem::temp_directory_path() / ("torus." + std::to_string(getpid()) + ".obj");
    measure(torus(path));
    std::filesystem::remove(path);
}
