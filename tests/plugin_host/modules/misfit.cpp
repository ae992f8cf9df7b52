// Does on request what no plugin may do, and what few do.
#include <rt/plugin.hpp>

#include <cstdlib>

struct Misfit {
    std::string act;
    std::int64_t counter; // address of an int in the test that counts releases; 0: none
};

constexpr std::array kParameters{rt::parameter<&Misfit::act>("act", "", "What to do."),
                                 rt::parameter<&Misfit::counter>("counter", RT_UNIT_NONE, "0",
                                                                 rt::unlimited,
                                                                 "Address of an int.")};

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

rt::Mesh oneTriangle() {
    rt::Mesh mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
}

struct Slab {
    double lower, upper;
    int* counter = nullptr;

    Slab(double l, double u, int* c) : lower(l), upper(u), counter(c) {}
    Slab(Slab&& other) noexcept
        : lower(other.lower), upper(other.upper), counter(std::exchange(other.counter, nullptr)) {}
    ~Slab() {
        if (counter != nullptr) ++*counter;
    }
    rt::Box bounds() const { return {{lower, lower, lower}, {upper, upper, upper}}; }
    bool intersect(const rt_ray&, rt_hit&) const { return false; }
};

void lower(const Misfit& misfit, rt::Geometry& out) {
    const std::string& act = misfit.act;
    int* const counter = reinterpret_cast<int*>(misfit.counter);
    rt::Mesh mesh = oneTriangle();
    if (act == "nan vertex")
        mesh.positions[1].y = kNaN;
    else if (act == "far vertex")
        mesh.positions[2].x = 1e40;
    else if (act == "vertex index")
        mesh.triangles[0][1] = 3;
    else if (act == "normal index")
        mesh.normals = {{0, 0, 1}}, mesh.normalIndices = {{0, 0, 1}};
    else if (act == "zero normal")
        mesh.normals = {{0, 0, 0}}, mesh.normalIndices = {{0, 0, 0}};
    else if (act == "uv index")
        mesh.uvs = {{0, 0}}, mesh.uvIndices = {{0, 1, 0}};
    else if (act == "nan uv")
        mesh.uvs = {{0, kNaN}}, mesh.uvIndices = {{0, 0, 0}};
    else if (act == "material index")
        mesh.materials = {0};
    else if (act == "kind")
        mesh.kind = static_cast<rt::Kind>(7);
    else if (act == "flat triangle")
        mesh.triangles.push_back({0, 1, 1});
    else if (act == "negative radius")
        return out.sphere({}, -1);
    else if (act == "nan radius")
        return out.sphere({}, kNaN);
    else if (act == "nan center")
        return out.sphere({kNaN, 0, 0}, 1);
    else if (act == "tiny radius")
        return out.sphere({}, std::numeric_limits<double>::denorm_min());
    else if (act == "parallel edges")
        return out.parallelogram({}, {1, 0, 0}, {2, 0, 0});
    else if (act == "empty bounds")
        return out.custom(Slab(1, -1, counter), rt::Kind::surface);
    else if (act == "nan bounds")
        return out.custom(Slab(kNaN, 1, counter), rt::Kind::surface);
    else if (act == "infinite bounds")
        return out.custom(Slab(-rt::kInfinity, 1, counter), rt::Kind::surface);
    else if (act == "no primitives")
        return out.custom(std::vector<Slab>(), rt::Kind::surface);
    else if (act == "custom")
        return out.custom(Slab(-1, 1, counter), rt::Kind::solid);
    else if (act == "material color") {
        rt::Material material;
        material.color.r = -1;
        out.material(material);
    } else if (act == "parameter")
        throw rt::ParameterError("counter", "must be even");
    else if (act == "unknown parameter")
        throw rt::ParameterError("nonsense", "must be even");
    else if (act == "throw")
        throw std::runtime_error("the sky is falling");
    else if (act == "throw int")
        throw 7;
    else if (act == "memory")
        throw std::bad_alloc();
    else if (act == "note")
        out.note("one thing was mended");
    else if (act == "load")
        return out.load("act", rt::Kind::surface);
    else if (act == "nothing")
        return;
    else if (act == "ignore") { // a plugin that goes on after a refusal does not hide it
        try {
            out.sphere({}, -1);
        } catch (...) {
        }
    }
    out.mesh(mesh);
}

} // namespace

RT_SHAPE_PLUGIN("misfit", "1.0.0", kParameters, lower, "Breaks one rule.", "")
