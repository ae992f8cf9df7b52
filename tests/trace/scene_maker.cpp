#include <tests/trace/scene_maker.hpp>

#include <core/trace/direction.hpp>

#include <cmath>
#include <map>

namespace rt::trace {

ObjectId SceneMaker::icosphere(const Vec3& center, double radius, int level, bool smoothNormals,
                               MaterialId material) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    std::vector<Vec3> points;
    for (const auto& p : {Vec3{-1, g, 0},
                          {1, g, 0},
                          {-1, -g, 0},
                          {1, -g, 0},
                          {0, -1, g},
                          {0, 1, g},
                          {0, -1, -g},
                          {0, 1, -g},
                          {g, 0, -1},
                          {g, 0, 1},
                          {-g, 0, -1},
                          {-g, 0, 1}})
        points.push_back(unit(p));
    std::vector<std::array<std::uint32_t, 3>> faces{
        {0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
        {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
        {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (; level > 0; --level) {
        std::map<std::array<std::uint32_t, 2>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, isNew] =
                middles.try_emplace({std::min(a, b), std::max(a, b)}, points.size());
            if (isNew) points.push_back(unit(points[a] + points[b]));
            return at->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : faces) {
            const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        faces = std::move(finer);
    }
    const std::vector<Vec3> normals = smoothNormals ? points : std::vector<Vec3>{};
    for (Vec3& p : points) p = center + radius * p;
    return mesh(points, faces, true, material, normals);
}

namespace {

void uvAsColor(const void*, const rt_surface_point* points, std::uint32_t count, double* rgb) {
    for (std::uint32_t i = 0; i < count; ++i)
        rgb[3 * i] = points[i].uv[0], rgb[3 * i + 1] = points[i].uv[1], rgb[3 * i + 2] = 0;
}

const std::uint32_t* texels(const void* state) { return static_cast<const std::uint32_t*>(state); }

/// Column and row of the texel, as shares of 256, and how far uv is from its middle.
void texelAsColor(const void* state, const rt_surface_point* points, std::uint32_t count,
                  double* rgb) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const double column = points[i].uv[0] * texels(state)[0];
        const double row = (1 - points[i].uv[1]) * texels(state)[1];
        rgb[3 * i] = std::floor(column) / 256;
        rgb[3 * i + 1] = std::floor(row) / 256;
        rgb[3 * i + 2] = std::max(std::fabs(column - std::floor(column) - 0.5),
                                  std::fabs(row - std::floor(row) - 0.5));
    }
}

void texelSize(const void* state, std::uint32_t size[2]) {
    size[0] = texels(state)[0], size[1] = texels(state)[1];
}

const rt_texture_type kUvType{
    sizeof(rt_texture_type), 0, nullptr, nullptr, uvAsColor, nullptr, nullptr};
const rt_texture_type kTexelType{
    sizeof(rt_texture_type), 0, nullptr, nullptr, texelAsColor, nullptr, texelSize};

} // namespace

material::Texture uvTexture() { return {&kUvType, nullptr}; }

material::Texture texelTexture(std::uint32_t width, std::uint32_t height) {
    static std::vector<std::array<std::uint32_t, 2>> sizes;
    sizes.reserve(64);
    sizes.push_back({width, height});
    return {&kTexelType, sizes.back().data()};
}

} // namespace rt::trace
