// A loader that reads nothing: two triangles of two materials, a note, or a failure.
#include <rt/plugin.hpp>

struct Toy {
    std::string act;
    double size;
    rt::File picture;
};

constexpr std::array kParameters{
    rt::parameter<&Toy::act>("act", "", "What to do."),
    rt::parameter<&Toy::size>("size", RT_UNIT_LENGTH, "1", rt::positive, "Length of an edge."),
    rt::parameter<&Toy::picture>("picture", rt::absent, "Image of the first material.")};

namespace {
void load(const Toy& toy, const rt::File& file, rt::Kind kind, rt::Geometry& out) {
    if (toy.act == "fail")
        throw std::runtime_error(file.path.substr(file.path.rfind('/') + 1) +
                                 ":3:1: no such vertex");
    if (toy.act == "parameter") throw rt::ParameterError("size", "is too large for this file");
    if (toy.act == "note") out.note("2 faces were mended");
    rt::Mesh mesh;
    mesh.kind = kind;
    const double s = toy.size;
    mesh.positions = {{0, 0, 0}, {s, 0, 0}, {s, s, 0}, {0, s, 0}};
    mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 1, 3}};
    rt::Material red, blue;
    red.name = "red", red.color = {1, 0, 0}, red.colorFile = toy.picture;
    blue.name = "blue", blue.color = {0, 0, 1};
    const std::uint32_t first = out.material(red), second = out.material(blue);
    mesh.materials = {first, second, RT_NO_INDEX};
    mesh.sourceFaces = {0, 0, 7};
    out.mesh(mesh);
}
} // namespace

RT_LOADER_PLUGIN("toy_loader", "1.0.0", "toy", kParameters, load, "Two triangles.", "")
