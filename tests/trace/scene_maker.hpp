// Small worlds put together by hand, so that tests of tracing need neither reader nor plugins.
#pragma once
#include <core/octree/octree.hpp>
#include <core/scene/description.hpp>
#include <core/trace/render.hpp>
#include <core/world/world.hpp>

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace rt::trace {

using geometry::Kind;
using geometry::MaterialId;
using geometry::ObjectId;
using geometry::PrimitiveId;
using geometry::Vec3;
using material::Material;
using numeric::LinearRgb;

class SceneMaker {
public:
    SceneMaker() {
        description.image.width = 32, description.image.height = 24;
        description.camera.screenWidth = 4.0 / 3, description.camera.screenHeight = 1;
        description.render.depth = 8;
    }

    MaterialId add(const Material& material) {
        world.materials.push_back(material);
        world.materialNames.push_back("material_" + std::to_string(world.materials.size() - 1));
        return MaterialId(world.materials.size() - 1);
    }

    ObjectId sphere(const Vec3& center, double radius, MaterialId material) {
        auto& spheres = world.primitives.spheres;
        spheres.push_back({center, radius});
        return object(1, Kind::sphere, true, spheres.size() - 1, material);
    }

    ObjectId parallelogram(const Vec3& origin, const Vec3& u, const Vec3& v, MaterialId material) {
        auto& all = world.primitives.parallelograms;
        all.push_back({origin, u, v});
        return object(1, Kind::parallelogram, false, all.size() - 1, material);
    }

    /// Corners by rising x, then y, then z (bits 2, 1, 0); triangles face outward.
    ObjectId box(const Vec3& low, const Vec3& high, MaterialId material) {
        std::vector<Vec3> corners;
        for (int i = 0; i < 8; ++i)
            corners.emplace_back(i & 4 ? high.x : low.x, i & 2 ? high.y : low.y,
                                 i & 1 ? high.z : low.z);
        return mesh(corners,
                    {{{0, 1, 3}},
                     {{0, 3, 2}},
                     {{4, 6, 7}},
                     {{4, 7, 5}},
                     {{0, 4, 5}},
                     {{0, 5, 1}},
                     {{2, 3, 7}},
                     {{2, 7, 6}},
                     {{0, 2, 6}},
                     {{0, 6, 4}},
                     {{1, 5, 7}},
                     {{1, 7, 3}}},
                    true, material);
    }

    /// With one normal per vertex when `normals` is given.
    ObjectId mesh(const std::vector<Vec3>& positions,
                  const std::vector<std::array<std::uint32_t, 3>>& faces, bool solid,
                  MaterialId material, const std::vector<Vec3>& normals = {}) {
        auto& t = world.primitives.triangles;
        const auto firstVertex = static_cast<std::uint32_t>(t.positions.size());
        const auto firstNormal = static_cast<std::uint32_t>(t.normals.size());
        const std::size_t first = t.indices.size();
        t.positions.insert(t.positions.end(), positions.begin(), positions.end());
        t.normals.insert(t.normals.end(), normals.begin(), normals.end());
        if (!normals.empty() && t.normalIndices.empty()) t.normalIndices.assign(first, flat());
        for (const auto& f : faces) {
            t.indices.push_back({f[0] + firstVertex, f[1] + firstVertex, f[2] + firstVertex});
            if (!t.normalIndices.empty() || !normals.empty())
                t.normalIndices.push_back(
                    normals.empty()
                        ? flat()
                        : std::array{f[0] + firstNormal, f[1] + firstNormal, f[2] + firstNormal});
        }
        return object(faces.size(), Kind::triangle, solid, first, material);
    }

    /// A sphere of `20 * 4^level` triangles, vertices on the sphere, with or without their normals.
    ObjectId icosphere(const Vec3& center, double radius, int level, bool smoothNormals,
                       MaterialId material);

    void light(const Vec3& position, const LinearRgb& color = {1, 1, 1}) {
        description.lights.push_back({"light", position, color});
    }

    void look(const Vec3& from, const Vec3& forward, const Vec3& up = {0, 0, 1}) {
        description.camera.position = from;
        description.camera.forward = forward;
        description.camera.up = up;
    }

    const octree::Octree& octree() {
        if (!octree_) octree_ = octree::Octree::build(world.primitives);
        return *octree_;
    }

    Result render(const Options& options = {}) {
        return trace::render(octree(), world, description, options);
    }

    /// What a ray through the middle of a one-pixel picture sees, before no tone is needed.
    LinearRgb along(const Vec3& from, const Vec3& direction) {
        const Vec3 up = std::abs(direction.z) < std::abs(direction.x) + std::abs(direction.y)
                            ? Vec3{0, 0, 1}
                            : Vec3{0, 1, 0};
        look(from, direction, up);
        description.image.width = description.image.height = 1;
        return render().frame.at(0, 0);
    }

    world::World world;
    scene::Description description;

private:
    static std::array<std::uint32_t, 3> flat() {
        return {geometry::kNoIndex, geometry::kNoIndex, geometry::kNoIndex};
    }

    ObjectId object(std::size_t count, Kind kind, bool solid, std::size_t index,
                    MaterialId material) {
        octree_.reset();
        const auto id = ObjectId(world.objectNames.size());
        world.objectNames.push_back("object_" + std::to_string(world.objectNames.size()));
        world.primitives.segments.push_back({PrimitiveId(world.primitives.count()),
                                             static_cast<std::uint32_t>(count), kind, solid,
                                             static_cast<std::uint32_t>(index), id, material});
        return id;
    }

    std::optional<octree::Octree> octree_;
};

inline Material matte(const LinearRgb& color) {
    Material m;
    m.color = color;
    m.diffuse = {1, 1, 1};
    return m;
}

/// Shows its color in full wherever a light of color 1 is seen, from any angle.
inline Material flatColored(const LinearRgb& color) {
    Material m;
    m.environment = color;
    return m;
}

inline Material mirror(double share = 1) {
    Material m;
    m.specular = LinearRgb::grey(share);
    return m;
}

inline Material clear(double ior, const LinearRgb& transmission = {1, 1, 1}) {
    Material m;
    m.transmission = transmission;
    m.ior = ior;
    return m;
}

/// A texture that answers with direction or uv as a color; owns nothing.
material::Texture uvTexture();
material::Texture texelTexture(std::uint32_t width, std::uint32_t height);

} // namespace rt::trace
