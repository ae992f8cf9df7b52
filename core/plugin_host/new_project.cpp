#include <core/plugin_host/new_project.hpp>

#include <core/plugin_host/module.hpp>

#include <rt/plugin.h>

#include <fstream>
#include <string_view>

namespace rt::plugin_host {
namespace {

namespace fs = std::filesystem;

// In the texts below NAME stands for the name of the type and PREFIX for where this rt is installed.

constexpr std::string_view kCmake = R"(cmake_minimum_required(VERSION 3.21)
project(NAME LANGUAGES CXX)
find_package(rt ABI REQUIRED HINTS "PREFIX") # where the rt is that wrote this file
rt_add_plugin(NAME NAME.cpp)
)";

constexpr std::string_view kReadme = R"(# NAME, a KIND plugin for rt

    cmake -B build && cmake --build build
    rt render scene.yaml --plugin-dir build

The second command writes `scene.png`. `rt plugins NAME --plugin-dir build` shows what the plugin offers, and
`rt plugins --check build/NAME.rtplugin.so` holds it against the rules. The SDK is two headers, `rt/plugin.hpp` and
`rt/plugin.h`; every rule stands in the second.
)";

constexpr std::string_view kShape = R"(// A pyramid on a square: change it into your shape.
#include <rt/plugin.hpp>

struct Shape {
    double width, height;
};

// One row per parameter: key, unit, default, limits, one sentence. It parses, checks and documents.
constexpr std::array kParameters{
    rt::parameter<&Shape::width>("width", RT_UNIT_LENGTH, "1", rt::positive, "Length of a side of the base."),
    rt::parameter<&Shape::height>("height", RT_UNIT_LENGTH, "1", rt::positive, "Height of the tip over the base.")};

void lower(const Shape& shape, rt::Geometry& out) {
    if (shape.height > 1000 * shape.width) throw rt::ParameterError("height", "makes a needle; widen the base");
    const double h = shape.width / 2;
    rt::Mesh mesh;
    mesh.kind = rt::Kind::solid; // closed: light enters and leaves it
    mesh.positions = {{-h, -h, 0}, {h, -h, 0}, {h, h, 0}, {-h, h, 0}, {0, 0, shape.height}};
    // Counter-clockwise seen from outside.
    mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
    out.mesh(mesh);
}

RT_SHAPE_PLUGIN("NAME", "1.0.0", kParameters, lower, "A pyramid on a square.",
                "- NAME: {width: 2, height: 1.5, material: red}\n")
)";

constexpr std::string_view kTexture = R"(// Stripes: change them into your texture.
#include <rt/plugin.hpp>

struct Texture {
    rt::Color a, b;
    double count;

    // Called by many threads at once: nothing here may allocate, lock or throw.
    rt::Color at(const rt_surface_point& point) const {
        const double x = point.uv[0] * count;
        return x - std::floor(x) < 0.5 ? a : b;
    }
};

// One row per parameter: key, unit, default, limits, one sentence. It parses, checks and documents.
constexpr std::array kParameters{
    rt::parameter<&Texture::a>("a", "1", "Color of the first stripe."),
    rt::parameter<&Texture::b>("b", "[0.8, 0.1, 0.1]", "Color of the second stripe."),
    rt::parameter<&Texture::count>("count", RT_UNIT_COUNT, "8", rt::positive, "Pairs of stripes per unit of u.")};

Texture create(const Texture& texture, rt::Host&) { return texture; }

RT_TEXTURE_PLUGIN("NAME", "1.0.0", kParameters, create, "Stripes of two colors.",
                  "stripes: {NAME: {a: 1, b: [0.1, 0.1, 0.8], count: 4}}\n")
)";

constexpr std::string_view kLoader =
    R"(// Spheres from lines "x y z radius": change it into your file format.
#include <rt/plugin.hpp>

#include <charconv>
#include <fstream>

struct Loader {
    double scale;
};

// One row per parameter: key, unit, default, limits, one sentence. It parses, checks and documents.
constexpr std::array kParameters{
    rt::parameter<&Loader::scale>("scale", RT_UNIT_RATIO, "1", rt::positive, "Multiplies every number of the file.")};

void load(const Loader& loader, const rt::File& file, rt::Kind, rt::Geometry& out) {
    std::ifstream lines(file.path);
    std::vector<rt_sphere> spheres;
    int number = 1;
    for (std::string line; std::getline(lines, line); ++number) {
        double values[4];
        const char *at = line.data(), *const end = at + line.size();
        for (double& value : values) {
            while (at != end && *at == ' ') ++at;
            const auto [next, error] = std::from_chars(at, end, value); // the same in every locale
            if (error != std::errc()) // a file is somebody else's: say where it is wrong
                throw std::runtime_error("line " + std::to_string(number) + " is not 'x y z radius'");
            at = next;
            value *= loader.scale;
        }
        spheres.push_back({{values[0], values[1], values[2]}, values[3]});
    }
    out.spheres(spheres);
}

RT_LOADER_PLUGIN("NAME", "1.0.0", "txt", kParameters, load, "Spheres from lines of four numbers.",
                 "- mesh: {file: spheres.txt, loader: NAME}\n")
)";

constexpr std::string_view kSceneStart = R"(rt: 1
image: {width: 640, height: 360}
camera: {position: [3, -5, 3], look_at: [0, 0, 0.6], up: [0, 0, 1], field_of_view: 30deg}
render: {antialias: {grid: 3}}
background: {color: [0.6, 0.75, 0.95]}
lights:
  - point: {position: [4, -6, 8], color: 0.9}
)";

constexpr std::string_view kShapeScene = R"(materials:
  red: {color: [0.8, 0.15, 0.1], diffuse: 0.8, specular: 0.1, environment: 0.1}
  ground: {color: 0.8, diffuse: 0.8, environment: 0.1}
objects:
  - plane: {size: 100, material: ground}
  - NAME: {width: 2, height: 1.5, material: red}
)";

constexpr std::string_view kTextureScene = R"(textures:
  stripes: {NAME: {count: 4}}
materials:
  striped: {texture: stripes, diffuse: 0.8, environment: 0.1}
  ground: {color: 0.8, diffuse: 0.8, environment: 0.1}
objects:
  - plane: {size: 100, material: ground}
  - sphere: {center: [0, 0, 1], material: striped}
)";

constexpr std::string_view kLoaderScene = R"(materials:
  red: {color: [0.8, 0.15, 0.1], diffuse: 0.8, specular: 0.1, environment: 0.1}
  ground: {color: 0.8, diffuse: 0.8, environment: 0.1}
objects:
  - plane: {size: 100, material: ground}
  - mesh: {file: spheres.txt, loader: NAME, material: red}
)";

constexpr std::string_view kSpheres =
    "0 0 0.5 0.5\n0.9 0 0.4 0.4\n0 0.9 0.3 0.3\n-0.8 -0.2 0.3 0.3\n";

struct Template {
    const char* kind;
    std::string_view source, scene;
};

Template templateOf(scene::TypeKind kind) {
    switch (kind) {
    case scene::TypeKind::shape:
        return {"shape", kShape, kShapeScene};
    case scene::TypeKind::texture:
        return {"texture", kTexture, kTextureScene};
    case scene::TypeKind::loader:
        break;
    }
    return {"loader", kLoader, kLoaderScene};
}

std::string replaced(std::string text, std::string_view word, std::string_view by) {
    for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += by.size())
        text.replace(at, word.size(), by);
    return text;
}

} // namespace

std::variant<std::vector<fs::path>, std::string>
writeNewProject(scene::TypeKind kind, const std::string& name, const fs::path& folder) {
    if (!isTypeName(name))
        return "the name of a type is [a-z][a-z0-9_]*, at most 64 characters (got '" + name + "')";
    std::error_code error;
    if (fs::exists(folder, error) &&
        !(fs::is_directory(folder, error) && fs::is_empty(folder, error)))
        return "'" + folder.string() + "' exists already, and nothing in it is overwritten";
    fs::create_directories(folder, error);
    if (error) return "cannot create the folder '" + folder.string() + "': " + error.message();

    const Template from = templateOf(kind);
    const fs::path prefix = fs::read_symlink("/proc/self/exe", error).parent_path().parent_path();
    const std::string abi = std::to_string(RT_ABI_MAJOR) + "." + std::to_string(RT_ABI_MINOR);
    std::vector<fs::path> files;
    std::string failure;
    const auto write = [&](const std::string& file, std::string text) {
        text = replaced(replaced(std::move(text), "NAME", name), "KIND", from.kind);
        text = replaced(replaced(std::move(text), "PREFIX", prefix.string()), "ABI", abi);
        const fs::path path = folder / file;
        std::ofstream out(path, std::ios::binary);
        out << text;
        out.close();
        if (!out && failure.empty()) failure = "cannot write '" + path.string() + "'";
        files.push_back(path);
    };
    write(name + ".cpp", std::string(from.source));
    write("CMakeLists.txt", std::string(kCmake));
    write("scene.yaml", std::string(kSceneStart) + std::string(from.scene));
    write("README.md", std::string(kReadme));
    if (kind == scene::TypeKind::loader) write("spheres.txt", std::string(kSpheres));
    if (!failure.empty()) return failure;
    return files;
}

} // namespace rt::plugin_host
