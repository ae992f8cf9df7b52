#include <tests/stability/closed_meshes.hpp>

#include <core/octree/octree.hpp>
#include <tests/stability/counting.hpp>

namespace rt::stability {

using geometry::Primitives;
using geometry::Ray;
using numeric::Vec3;
using octree::Coherence;
using octree::Octree;
using octree::Simd;
using test::Mesh;

Mesh placed(const Mesh& mesh, double scale, const Vec3& offset) {
    Mesh m = mesh;
    for (Vec3& p : m.positions) p = p * scale + offset;
    return m;
}

ClosedMesh::ClosedMesh(Mesh mesh, const Vec3& inside, double reach)
    : mesh_(std::move(mesh)), inside_(inside), reach_(reach),
      primitives_(std::make_unique<Primitives>()) {
    test::addMesh(*primitives_, mesh_.positions, mesh_.indices);
    for (const Simd simd : {Simd::avx512, Simd::avx2, Simd::baseline})
        if (Octree::supports(simd)) trees_.push_back(Octree::build(*primitives_, {.simd = simd}));
}

Leaks ClosedMesh::leaks(Aim aim, std::uint64_t rays, std::uint64_t seed) const {
    constexpr std::size_t kGroup = 16; // rays to the weak spots of one face
    const auto faces = static_cast<std::uint32_t>(mesh_.indices.size());
    return sumOver<Leaks>(rays / kGroup, seed, [&](Random& random, Leaks& sum) {
        const auto& face = mesh_.indices[random.below(faces)];
        std::array<Ray, kGroup> group;
        for (Ray& ray : group) {
            const std::size_t corner = random.below(3);
            const Vec3 a = mesh_.positions[face[corner]],
                       b = mesh_.positions[face[(corner + 1) % 3]];
            ray.origin = inside_ + random.inBox(reach_);
            ray.direction = aim == Aim::anywhere   ? random.direction()
                            : aim == Aim::vertices ? a - ray.origin
                                                   : a + random.unit() * (b - a) - ray.origin;
        }
        const std::uint64_t number = sum.rays / kGroup;
        sum.rays += kGroup;
        const Octree& tree = trees_[number % 16 < trees_.size() ? number % 16 : 0];
        std::array<geometry::Hit, kGroup> hits;
        if (const std::uint64_t way = number / 16 % 4; way == 0)
            for (std::size_t i = 0; i < kGroup; ++i) hits[i] = tree.closest(group[i]);
        else
            tree.closest(group, hits, way == 1 ? Coherence::incoherent : Coherence::coherent);
        for (const geometry::Hit& hit : hits) sum.leaks += !hit;
        const Ray& ray = group[0];
        sum.shadows += !tree.occluded(ray);
        std::vector<geometry::Crossing> crossings;
        tree.crossings(ray, {}, crossings);
        ++sum.crossed;
        sum.even += crossings.size() % 2 == 0;
    });
}

namespace {

struct Aimed {
    Aim aim;
    const char* name;
    std::uint64_t rays;
    Leaks sum;
};

/// At five sizes, around the origin and a million sizes away from it.
void leaks(const char* id, const std::string& name, const Mesh& mesh, double reach,
           std::vector<Aimed> aims, const Load& load, Table& table) {
    const double scales[] = {0.000001, 0.001, 1, 1e3, 1e6}, offsets[] = {0, 1e6};
    for (const double scale : scales)
        for (const double away : offsets) {
            const Vec3 offset = Vec3(1, -0.7, 0.4) * (away * scale);
            const ClosedMesh closed(placed(mesh, scale, offset), offset, reach * scale);
            for (Aimed& a : aims) a.sum += closed.leaks(a.aim, a.rays / 10, load.seed);
        }
    for (const Aimed& a : aims) {
        const std::string what = name + ", " + a.name;
        table.count(a.aim == Aim::anywhere ? "T3" : id, what + ": rays that leave it", a.sum.leaks,
                    a.sum.rays);
        table.count("T5", what + ": shadow rays that leave it", a.sum.shadows, a.sum.crossed);
        table.count("T5", what + ": crossed an even number of times", a.sum.even, a.sum.crossed);
    }
}

} // namespace

void closedMeshes(const Load& load, Table& table) {
    const std::uint64_t rays = load.of(2'500'000, 250'000'000);
    const Mesh ball = test::icosphere(5, 1, Vec3(0.0));
    leaks("T1", "icosphere 20480", ball, 0.4,
          {{Aim::vertices, "vertices", rays, {}},
           {Aim::edges, "edges", rays, {}},
           {Aim::anywhere, "random directions", load.of(200'000, 20'000'000), {}}},
          load, table);
    // Concave, with sharp edges, and with faces in planes of the axes.
    leaks("T1", "torus 5400", test::torus(90, 30, 1, 0.4, Vec3(-1, 0, 0)), 0.1,
          {{Aim::edges, "edges", load.of(100'000, 20'000'000), {}}}, load, table);
    leaks("T1", "box 1728", test::box(12, {1, 0.5, 0.25}, Vec3(0.0)), 0.2,
          {{Aim::edges, "edges", load.of(100'000, 20'000'000), {}}}, load, table);
    leaks("T2", "needles 2000 x 8", test::needles(2000, 8, Vec3(1.0), Vec3(0.0)), 0.3,
          {{Aim::vertices, "vertices", rays, {}}, {Aim::edges, "edges", rays, {}}}, load, table);
    // Far smaller than any determinant that a program would dare to call zero.
    Leaks tiny;
    for (const double scale : {1 / 1e3, 1 / 1e9, 1 / 1e15, 1 / 1e30, 1e30})
        tiny += ClosedMesh(placed(ball, scale, Vec3(0.0)), Vec3(0.0), 0.4 * scale)
                    .leaks(Aim::edges, load.of(20'000, 4'000'000), load.seed);
    table.count("T4", "icosphere 20480 x 1e-3, 1e-9, 1e-15, 1e-30, 1e30: rays that leave it",
                tiny.wrong(), tiny.rays);
}

} // namespace rt::stability
