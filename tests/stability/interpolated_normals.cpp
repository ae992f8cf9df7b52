// N: normals that are not the facet's own: mirrored rays stay above it, its shadows do not show.
#include <tests/stability/cases.hpp>

#include <core/trace/direction.hpp>
#include <core/trace/ray_tree.hpp>
#include <tests/stability/counting.hpp>
#include <tests/trace/scene_maker.hpp>

namespace rt::stability {

namespace {

using numeric::dot;
using numeric::Vec3;
using trace::RayTree;
using trace::SceneMaker;

Vec3 facetOf(const SceneMaker& scene, geometry::PrimitiveId id) {
    const auto& t = scene.world.primitives.triangles;
    const auto& f = t.indices[static_cast<std::uint32_t>(id)];
    return geometry::triangleNormal(t.positions[f[0]], t.positions[f[1]], t.positions[f[2]]);
}

struct Facets {
    Tally below, black;
    std::uint64_t leaned = 0, faced = 0; // would have gone below; would have been black
    Facets& operator+=(const Facets& o) {
        below += o.below, black += o.black, leaned += o.leaned, faced += o.faced;
        return *this;
    }
};

Facets look(int level, const Load& load) {
    SceneMaker scene;
    material::Material m = trace::mirror(0.5);
    m.diffuse = {1, 1, 1};
    const Vec3 light{2, 0, 3};
    scene.icosphere({0, 3, 0}, 1, level, true, scene.add(m));
    scene.light(light);
    const std::uint32_t width = load.width(64, 640), height = width * 3 / 4;
    scene.description.image.width = width, scene.description.image.height = height;
    scene.description.camera.screenDistance = 1.3;
    scene.octree();
    std::vector<Facets> rows(height);
    parallel::forEach(height, 0, [&](std::size_t y) {
        for (std::uint32_t x = 0; x < width; ++x) {
            const RayTree tree = trace::tracePixel(scene.octree(), scene.world, scene.description,
                                                   x, static_cast<std::uint32_t>(y));
            for (const auto& node : tree.nodes) {
                if (node.hit) {
                    const Vec3 toLight = light - node.position;
                    if (!(dot(toLight, node.normal) > 0)) continue;
                    rows[y].faced += dot(toLight, facetOf(scene, node.primitive)) < 0;
                    rows[y].black.add(node.lights.empty() || node.lights[0].visible.isBlack());
                }
                if (node.kind != RayTree::Kind::reflected || node.fate != RayTree::Fate::traced)
                    continue;
                const auto& from = tree.nodes[node.parent];
                const Vec3 facet = facetOf(scene, from.primitive);
                rows[y].leaned += dot(trace::reflected(from.direction, from.normal), facet) < 0;
                rows[y].below.add(!(dot(node.direction, facet) > 0) || node.hit);
            }
        }
    });
    Facets sum;
    for (const Facets& row : rows) sum += row;
    return sum;
}

} // namespace

void interpolatedNormals(const Load& load, Table& table) {
    for (int level = 1; level <= 5; ++level) {
        const Facets f = look(level, load);
        const std::string mesh = "icosphere " + std::to_string(20 << (2 * level));
        table.count("N1",
                    mesh + ": mirrored rays below the facet (" + std::to_string(f.leaned) +
                        " without the clamp)",
                    f.below.wrong, f.below.of);
        table.count("N2",
                    mesh + ": lit points in the facet's own shadow (" + std::to_string(f.faced) +
                        " face away)",
                    f.black.wrong, f.black.of);
    }
}

} // namespace rt::stability
