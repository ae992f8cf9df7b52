#include "scenes.hpp"

#include <core/geometry/intersect.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

namespace rt::test {

using geometry::Kind;
using geometry::MaterialId;
using geometry::ObjectId;
using geometry::Parallelogram;
using geometry::PrimitiveId;
using geometry::Sphere;

std::uint64_t Random::bits() { // splitmix64
    std::uint64_t z = (state_ += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

double Random::unit() { return static_cast<double>(bits() >> 11) * numeric::powerOfTwo(-53); }

Vec3 Random::direction() {
    for (;;) {
        const Vec3 v = inBox(1);
        const double l = numeric::length(v);
        if (l > 0.1 && l <= 1) return v / l;
    }
}

namespace {

void addSegment(Primitives& p, Kind kind, std::uint32_t index, std::size_t count, bool solid) {
    const auto object = static_cast<std::uint32_t>(p.segments.size());
    p.segments.push_back({PrimitiveId{p.count()}, static_cast<std::uint32_t>(count), kind, solid,
                          index, ObjectId{object}, MaterialId{object}});
}

struct CustomSpheres {
    std::vector<Sphere> spheres;
};

bool meet(const Sphere& sphere, const rt_ray& ray, double t[2]) {
    const Ray r{{ray.origin[0], ray.origin[1], ray.origin[2]},
                ray.t_max,
                {ray.direction[0], ray.direction[1], ray.direction[2]}};
    return geometry::intersectSphereLine(geometry::frameOf(r), sphere, t);
}

void customBounds(const void* data, std::uint32_t i, double lower[3], double upper[3]) {
    const Sphere& s = static_cast<const CustomSpheres*>(data)->spheres[i];
    for (int a = 0; a < 3; ++a) {
        lower[a] = s.center[a] - s.radius * 1.001;
        upper[a] = s.center[a] + s.radius * 1.001;
    }
}

std::int32_t customIntersect(const void* data, const std::uint32_t* primitives, std::uint32_t count,
                             const rt_ray* ray, rt_hit* hit) {
    const auto& spheres = static_cast<const CustomSpheres*>(data)->spheres;
    std::int32_t found = 0;
    double best = ray->t_max;
    for (std::uint32_t i = 0; i < count; ++i) {
        double t[2];
        const Sphere& s = spheres[primitives[i]];
        if (!meet(s, *ray, t)) continue;
        const double first = t[0] > ray->t_min ? t[0] : t[1];
        if (!(first > ray->t_min) ||
            !(first < best || (found && first == best && primitives[i] < hit->primitive)))
            continue;
        best = first;
        found = 1;
        std::memset(hit, 0, sizeof *hit);
        hit->t = first;
        hit->primitive = primitives[i];
        double length = 0;
        for (int a = 0; a < 3; ++a) {
            hit->normal[a] = ray->origin[a] + first * ray->direction[a] - s.center[a];
            length += hit->normal[a] * hit->normal[a];
        }
        length = std::sqrt(length);
        for (int a = 0; a < 3; ++a) {
            hit->normal[a] /= length;
            hit->position[a] = s.center[a] + s.radius * hit->normal[a];
        }
        hit->position_error =
            numeric::powerOfTwo(-48) *
            (std::fabs(s.center.x) + std::fabs(s.center.y) + std::fabs(s.center.z) + s.radius);
    }
    return found;
}

std::uint32_t customCrossings(const void* data, std::uint32_t primitive, const rt_ray* ray,
                              double* t, std::uint32_t capacity) {
    double both[2];
    if (!meet(static_cast<const CustomSpheres*>(data)->spheres[primitive], *ray, both)) return 0;
    std::uint32_t n = 0;
    for (const double s : both)
        if (s > ray->t_min && s < ray->t_max && n < capacity) t[n++] = s;
    return n;
}

} // namespace

void addMesh(Primitives& p, const std::vector<Vec3>& positions,
             const std::vector<std::array<std::uint32_t, 3>>& indices, bool solid) {
    const auto base = static_cast<std::uint32_t>(p.triangles.positions.size());
    addSegment(p, Kind::triangle, static_cast<std::uint32_t>(p.triangles.indices.size()),
               indices.size(), solid);
    p.triangles.positions.insert(p.triangles.positions.end(), positions.begin(), positions.end());
    for (auto i : indices) p.triangles.indices.push_back({i[0] + base, i[1] + base, i[2] + base});
}

void addSpheres(Primitives& p, const std::vector<Sphere>& spheres) {
    addSegment(p, Kind::sphere, static_cast<std::uint32_t>(p.spheres.size()), spheres.size(), true);
    p.spheres.insert(p.spheres.end(), spheres.begin(), spheres.end());
}

void addParallelograms(Primitives& p, const std::vector<Parallelogram>& all) {
    addSegment(p, Kind::parallelogram, static_cast<std::uint32_t>(p.parallelograms.size()),
               all.size(), false);
    p.parallelograms.insert(p.parallelograms.end(), all.begin(), all.end());
}

void addCustoms(Primitives& p, const std::vector<Sphere>& spheres, bool withCrossings) {
    addSegment(p, Kind::custom, static_cast<std::uint32_t>(p.customs.primitives.size()),
               spheres.size(), true);
    const auto shape = static_cast<std::uint32_t>(p.customs.shapes.size());
    rt_custom custom{sizeof(rt_custom),
                     RT_SOLID,
                     static_cast<std::uint32_t>(spheres.size()),
                     0,
                     new CustomSpheres{spheres},
                     customBounds,
                     customIntersect,
                     withCrossings ? customCrossings : nullptr,
                     [](void* data) { delete static_cast<CustomSpheres*>(data); }};
    p.customs.shapes.push_back(std::shared_ptr<const geometry::CustomShape>(
        new geometry::CustomShape{custom, {}, {}}, [](const geometry::CustomShape* s) {
            s->shape.release(s->shape.data);
            delete s;
        }));
    for (std::uint32_t i = 0; i < spheres.size(); ++i) {
        numeric::Box3d bounds;
        customBounds(custom.data, i, &bounds.min.x, &bounds.max.x);
        p.customs.primitives.push_back({shape, i, bounds});
    }
}

Mesh icosphere(int levels, double radius, Vec3 center, double bumps) {
    const double g = (1 + std::sqrt(5.0)) / 2;
    Mesh m;
    m.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    m.indices = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                 {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                 {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                 {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto key = std::minmax(a, b);
            const auto [it, isNew] =
                middles.try_emplace(key, static_cast<std::uint32_t>(m.positions.size()));
            if (isNew) m.positions.push_back((m.positions[a] + m.positions[b]) * 0.5);
            return it->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto [a, b, c] : m.indices) {
            const auto ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        m.indices = std::move(finer);
    }
    Random random(levels + 17);
    for (Vec3& p : m.positions)
        p = center + p * (radius * (1 + bumps * random.in(-1, 1)) / numeric::length(p));
    return m;
}

Mesh torus(std::uint32_t around, std::uint32_t across, double radius, double tube, Vec3 center) {
    Mesh m;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const double a = 2 * M_PI * i / around, b = 2 * M_PI * j / across;
            const double r = radius + tube * std::cos(b);
            m.positions.push_back(center +
                                  Vec3(r * std::cos(a), r * std::sin(a), tube * std::sin(b)));
            const std::uint32_t i2 = (i + 1) % around, j2 = (j + 1) % across;
            const std::uint32_t p = i * across + j, q = i2 * across + j, s = i2 * across + j2,
                                t = i * across + j2;
            m.indices.push_back({p, q, s});
            m.indices.push_back({p, s, t});
        }
    return m;
}

Mesh box(std::uint32_t n, Vec3 half, Vec3 center) {
    Mesh m;
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> corner;
    const auto at = [&](std::array<std::uint32_t, 3> k) {
        const auto [it, isNew] =
            corner.try_emplace(k, static_cast<std::uint32_t>(m.positions.size()));
        if (isNew) {
            Vec3 p;
            for (int a = 0; a < 3; ++a)
                p[a] = center[a] + half[a] * (2.0 * k[static_cast<std::size_t>(a)] / n - 1);
            m.positions.push_back(p);
        }
        return it->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::uint32_t side = 0; side < 2; ++side)
            for (std::uint32_t i = 0; i < n; ++i)
                for (std::uint32_t j = 0; j < n; ++j) {
                    const auto corner3 = [&](std::uint32_t u, std::uint32_t v) {
                        std::array<std::uint32_t, 3> k;
                        k[axis] = side * n;
                        k[(axis + 1) % 3] = u;
                        k[(axis + 2) % 3] = v;
                        return at(k);
                    };
                    const auto a = corner3(i, j), b = corner3(i + 1, j), c = corner3(i + 1, j + 1),
                               d = corner3(i, j + 1);
                    if (side)
                        m.indices.insert(m.indices.end(), {{a, b, c}, {a, c, d}});
                    else
                        m.indices.insert(m.indices.end(), {{a, c, b}, {a, d, c}});
                }
    return m;
}

Mesh needles(std::uint32_t around, std::uint32_t along, Vec3 half, Vec3 center) {
    Mesh m;
    m.positions = {center - Vec3(0, 0, half.z), center + Vec3(0, 0, half.z)};
    for (std::uint32_t j = 1; j < along; ++j)
        for (std::uint32_t i = 0; i < around; ++i) {
            const double a = 2 * M_PI * i / around, b = M_PI * j / along;
            m.positions.push_back(center + Vec3(half.x * std::sin(b) * std::cos(a),
                                                half.y * std::sin(b) * std::sin(a),
                                                -half.z * std::cos(b)));
        }
    const auto at = [&](std::uint32_t j, std::uint32_t i) {
        return 2 + (j - 1) * around + i % around;
    };
    for (std::uint32_t i = 0; i < around; ++i) {
        m.indices.push_back({0, at(1, i + 1), at(1, i)});
        m.indices.push_back({1, at(along - 1, i), at(along - 1, i + 1)});
        for (std::uint32_t j = 1; j + 1 < along; ++j) {
            m.indices.push_back({at(j, i), at(j, i + 1), at(j + 1, i + 1)});
            m.indices.push_back({at(j, i), at(j + 1, i + 1), at(j + 1, i)});
        }
    }
    return m;
}

namespace {

Scene soup() {
    Scene s;
    s.name = "soup";
    Random random(1);
    Mesh m;
    for (std::uint32_t i = 0; i < 6000; ++i) {
        const Vec3 c = random.inBox(1);
        for (int k = 0; k < 3; ++k) m.positions.push_back(c + random.inBox(0.05));
        m.indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    addMesh(*s.primitives, m.positions, m.indices, false);
    std::vector<Sphere> spheres, customs, others;
    for (int i = 0; i < 2000; ++i) spheres.push_back({random.inBox(1), random.in(0.001, 0.04)});
    addSpheres(*s.primitives, spheres);
    std::vector<Parallelogram> flats;
    for (int i = 0; i < 2000; ++i)
        flats.push_back({random.inBox(1), random.inBox(0.06), random.inBox(0.06)});
    addParallelograms(*s.primitives, flats);
    for (int i = 0; i < 300; ++i) customs.push_back({random.inBox(1), random.in(0.001, 0.05)});
    for (int i = 0; i < 100; ++i) others.push_back({random.inBox(1), random.in(0.001, 0.05)});
    addCustoms(*s.primitives, customs, true);
    addCustoms(*s.primitives, others, false);
    return s;
}

Scene meshes() {
    Scene s;
    s.name = "meshes";
    const Mesh ball = icosphere(4, 1, Vec3(0.0), 0.02), ring = torus(120, 40, 1.3, 0.3, Vec3(0.0));
    addMesh(*s.primitives, ball.positions, ball.indices);
    addMesh(*s.primitives, ring.positions, ring.indices);
    std::vector<Sphere> spheres;
    Random random(2);
    for (int i = 0; i < 500; ++i) spheres.push_back({1.1 * random.direction(), 0.1});
    addSpheres(*s.primitives, spheres);
    s.size = 1.6;
    return s;
}

Scene slivers() {
    Scene s;
    s.name = "slivers";
    const Mesh needle = needles(300, 8, {1, 0.01, 1}, Vec3(0.0));
    addMesh(*s.primitives, needle.positions, needle.indices);
    Random random(3);
    Mesh m;
    for (std::uint32_t i = 0; i < 5000; ++i) {
        const Vec3 c = random.inBox(1), along = 0.5 * random.direction();
        m.positions.insert(m.positions.end(),
                           {c - along, c + along, c + 0.000001 * random.direction()});
        m.indices.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    addMesh(*s.primitives, m.positions, m.indices, false);
    std::vector<Parallelogram> flats;
    for (int i = 0; i < 1500; ++i)
        flats.push_back({random.inBox(1), 0.5 * random.direction(), 0.00001 * random.direction()});
    addParallelograms(*s.primitives, flats);
    return s;
}

Scene axisParallel() {
    Scene s;
    s.name = "axis-parallel";
    const Mesh cube = box(20, {1, 1, 1}, Vec3(0.0));
    addMesh(*s.primitives, cube.positions, cube.indices);
    std::vector<Parallelogram> tiles;
    for (int layer = 0; layer < 4; ++layer)
        for (int i = 0; i < 32; ++i)
            for (int j = 0; j < 32; ++j) // twice the same floor: equal t, the lower id wins
                tiles.push_back({{i / 16.0 - 1, j / 16.0 - 1, (layer / 2) * 0.5},
                                 {1 / 16.0, 0, 0},
                                 {0, 1 / 16.0, 0}});
    addParallelograms(*s.primitives, tiles);
    std::vector<Sphere> spheres;
    for (int i = 0; i < 1200; ++i)
        spheres.push_back(
            {{(i % 10) / 5.0 - 0.9, (i / 10 % 12) / 6.0 - 0.9, (i / 120) / 5.0 - 0.9}, 0.05});
    addSpheres(*s.primitives, spheres);
    return s;
}

Scene teapotInStadium() {
    Scene s;
    s.name = "teapot-in-stadium";
    const Mesh bowl = torus(60, 40, 1e4, 3e3, Vec3(0.0)), pot = icosphere(4, 0.001, {1, 2, 3}, 0.1);
    addMesh(*s.primitives, bowl.positions, bowl.indices);
    addMesh(*s.primitives, pot.positions, pot.indices);
    std::vector<Sphere> spheres;
    Random random(5);
    for (int i = 0; i < 500; ++i)
        spheres.push_back({Vec3(1, 2, 3) + random.inBox(0.01), 0.0001 * random.unit()});
    addSpheres(*s.primitives, spheres);
    s.center = {1, 2, 3};
    s.size = 0.005;
    return s;
}

Scene farAndCoincident() {
    Scene s;
    s.name = "far-and-coincident";
    s.center = {1e6, -2e6, 3e6};
    Random random(6);
    std::vector<Sphere> spheres;
    for (int i = 0; i < 500; ++i) spheres.push_back({s.center, 0.5 + i * 0.001}); // one centre
    for (int i = 0; i < 4000; ++i)
        spheres.push_back({s.center + random.inBox(1), random.in(0.001, 0.02)});
    addSpheres(*s.primitives, spheres);
    const Mesh ball = icosphere(4, 0.7, s.center, 0.01);
    addMesh(*s.primitives, ball.positions, ball.indices);
    addMesh(*s.primitives, ball.positions, ball.indices); // the same again: equal t everywhere
    std::vector<Parallelogram> flats(500, {s.center, {1, 0, 0}, {0, 1, 0}});
    addParallelograms(*s.primitives, flats);
    return s;
}

Vec3 pointOn(const Primitives& p, Random& random) {
    const auto& segment = p.segments[random.below(static_cast<std::uint32_t>(p.segments.size()))];
    const std::uint32_t index = segment.index + random.below(segment.count);
    switch (segment.kind) {
    case Kind::triangle: {
        const auto& c = p.triangles.indices[index];
        const Vec3 a = p.triangles.positions[c[0]], b = p.triangles.positions[c[1]],
                   d = p.triangles.positions[c[2]];
        switch (random.below(4)) {
        case 0:
            return a; // a corner
        case 1:
            return a + random.unit() * (b - a); // an edge
        case 2:
            return (a + b) * 0.5;
        default:
            return a + (b - a) * 0.3 + (d - a) * 0.4;
        }
    }
    case Kind::sphere: {
        const auto& s = p.spheres[index];
        return s.center + s.radius * random.direction();
    }
    case Kind::parallelogram: {
        const auto& q = p.parallelograms[index];
        const double u = random.below(3) * 0.5, v = random.unit();
        return q.origin + u * q.edgeU + v * q.edgeV;
    }
    default:
        return p.customs.primitives[index].bounds.min;
    }
}

} // namespace

std::vector<Scene> mixedScenes() {
    std::vector<Scene> all;
    all.push_back(soup());
    all.push_back(meshes());
    all.push_back(slivers());
    all.push_back(axisParallel());
    all.push_back(teapotInStadium());
    all.push_back(farAndCoincident());
    return all;
}

Ray rayFor(const Scene& scene, std::uint64_t i) {
    Random random(0xABCDEF + 977 * i);
    Ray ray;
    ray.origin = scene.center + random.inBox(1.5 * scene.size);
    switch (i % 8) {
    case 0:
    case 1:
        ray.direction = random.direction();
        break;
    case 2: // at a corner, an edge, a rim
    case 3:
        ray.direction = pointOn(*scene.primitives, random) - ray.origin;
        break;
    case 4: { // along an axis, with zeros of either sign, through a special point
        const int axis = static_cast<int>(random.below(3));
        ray.direction = Vec3(random.below(2) ? 0.0 : -0.0);
        ray.direction[axis] = random.below(2) ? 1 : -1;
        const Vec3 through = pointOn(*scene.primitives, random);
        ray.origin = through - ray.direction * (scene.size * random.in(0, 2));
        break;
    }
    case 5: // from a surface
        ray.origin = pointOn(*scene.primitives, random);
        ray.direction = random.direction();
        break;
    case 6: // in a plane through a special point
        ray.origin = pointOn(*scene.primitives, random);
        ray.direction = random.direction();
        ray.direction[static_cast<int>(random.below(3))] = random.below(2) ? 0.0 : -0.0;
        break;
    default: // from far away, not normalised
        ray.origin = scene.center + 1e3 * scene.size * random.direction();
        ray.direction = 0.001 * (pointOn(*scene.primitives, random) - ray.origin);
        break;
    }
    if (random.below(4) == 0) ray.tMax = random.in(0, 2) * (i % 8 == 7 ? 1e3 : 1);
    if (random.below(8) == 0) ray.exclude = PrimitiveId{random.below(scene.primitives->count())};
    return ray;
}

} // namespace rt::test
