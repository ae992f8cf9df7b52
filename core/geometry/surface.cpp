#include <core/geometry/surface.hpp>

#include <core/geometry/intersect.hpp>
#include <core/numeric/bits.hpp>
#include <core/numeric/elementary.hpp>
#include <core/numeric/rounding.hpp>

#include <cmath>
#include <numbers>

namespace rt::geometry {
namespace {

using numeric::abs;
using numeric::cross;
using numeric::dot;
using numeric::gamma;
using numeric::bits::maxComponent;
using numeric::bits::nextDown;
using numeric::bits::nextUp;
using numeric::bits::reciprocalPowerOfTwo;

Vec3 unit(const Vec3& v) {
    const Vec3 w = v * reciprocalPowerOfTwo(maxComponent(abs(v))); // keeps v·v in range
    return w * (1 / std::sqrt(dot(w, w)));
}

/// An unevaluated sum of two doubles; about 106 bits.
struct Wide {
    double high, low;
};

Wide exactSum(double a, double b) { // [Knuth 1969]
    const double s = a + b, t = s - a;
    return {s, (a - (s - t)) + (b - t)};
}

Wide exactProduct(double a, double b) {       // [Dekker 1971]
    constexpr double kSplitter = 134217729.0; // 2^27 + 1
    const double p = a * b;
    const double ca = kSplitter * a, cb = kSplitter * b;
    const double ah = ca - (ca - a), al = a - ah;
    const double bh = cb - (cb - b), bl = b - bh;
    return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

Wide operator*(const Wide& a, const Wide& b) {
    const Wide p = exactProduct(a.high, b.high);
    return exactSum(p.high, p.low + (a.high * b.low + a.low * b.high));
}

Wide operator-(const Wide& a, const Wide& b) {
    const Wide s = exactSum(a.high, -b.high), t = exactSum(a.low, -b.low);
    const Wide u = exactSum(s.high, s.low + t.high);
    return exactSum(u.high, u.low + t.low);
}

/// Difference of products of edges known to twice the precision, rounded once at the end.
Vec3 wideCross(const Vec3& a, const Vec3& b, const Vec3& c) {
    Wide e[3], f[3];
    for (int i = 0; i < 3; ++i) {
        e[i] = exactSum(b[i], -a[i]);
        f[i] = exactSum(c[i], -a[i]);
    }
    Vec3 n;
    for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        const Wide d = e[j] * f[k] - e[k] * f[j];
        n[i] = d.high + d.low;
    }
    return n;
}

struct Corners {
    Vec3 a, b, c;
};

Corners cornersOfTriangle(const Triangles& triangles, std::uint32_t index) {
    const auto& i = triangles.indices[index];
    return {triangles.positions[i[0]], triangles.positions[i[1]], triangles.positions[i[2]]};
}

void surfaceOfTriangle(const Triangles& triangles, std::uint32_t index, const Ray& ray,
                       const Hit& hit, Surface& s) {
    const auto [a, b, c] = cornersOfTriangle(triangles, index);
    const Vec3 ab = b - a, ac = c - a;
    const Vec3 alongB = hit.u * ab, alongC = hit.v * ac;
    s.position = a + (alongB + alongC);
    s.geometricNormal = triangleNormal(a, b, c);
    if (s.geometricNormal == Vec3(0.0)) s.geometricNormal = -unit(ray.direction);
    // At most 4 roundings touch any term of position: |error| <= γ4 (|a| + |u·ab| + |v·ac|) in each
    // component [Higham 2002, lemma 3.1]; errors of u and v only slide along the plane. The kernel
    // sees its triangles, and those beside this one, through a shear that moves a corner by at most
    // γ3 of its distance in each of two components: with the edges' length for that distance,
    // 2·γ3 <= γ6 of their largest components.
    s.error = gamma(4) * dot(abs(s.geometricNormal), abs(a) + abs(alongB) + abs(alongC)) +
              gamma(6) * (maxComponent(abs(ab)) + maxComponent(abs(ac)));
    s.planar = true;
    s.shadingNormal = s.geometricNormal;
    const double weights[3] = {(1 - hit.u) - hit.v, hit.u, hit.v};
    if (!triangles.normalIndices.empty()) {
        Vec3 sum(0.0);
        for (int i = 0; i < 3; ++i) {
            const std::uint32_t n = triangles.normalIndices[index][static_cast<std::size_t>(i)];
            sum += weights[i] * (n == kNoIndex ? s.geometricNormal : triangles.normals[n]);
        }
        // Opposite normals cancel to nothing, or to something that is rounding only.
        const double squared = dot(sum, sum);
        if (squared > gamma(16) * gamma(16)) s.shadingNormal = sum * (1 / std::sqrt(squared));
    }
    s.uv = {hit.u, hit.v};
    // A mesh without uvs keeps its weights, whether or not another mesh of the scene has some.
    if (!triangles.uvIndices.empty() &&
        triangles.uvIndices[index] != std::array{kNoIndex, kNoIndex, kNoIndex}) {
        s.uv = Vec2(0.0);
        for (int i = 0; i < 3; ++i)
            if (const auto t = triangles.uvIndices[index][static_cast<std::size_t>(i)];
                t != kNoIndex)
                s.uv += weights[i] * triangles.uvs[t];
    }
    if (!triangles.materials.empty()) s.material = triangles.materials[index];
}

void surfaceOfSphere(const Sphere& sphere, const Ray& ray, const Hit& hit, Surface& s) {
    const Vec3 n = unit((ray.origin - sphere.center) + hit.t * ray.direction);
    s.position = sphere.center + sphere.radius * n;
    s.geometricNormal = s.shadingNormal = n;
    // Along n: adding the centre rounds by u(|c| + r) twice over at most (γ2); n is a unit vector to
    // within γ5; the kernel tells inside from outside by f·f − r², whose error γ4(f·f + r²) ≈ 2·γ4·r²
    // is one of γ4·r in the distance.
    s.error = gamma(2) * dot(abs(n), abs(sphere.center)) + gamma(12) * sphere.radius;
    s.planar = false;
}

double errorOf(const Parallelogram& p, const Vec3& normal) {
    // 3 roundings in position; the kernel's corners are rounded at most twice: γ5 in all. Then the
    // shear, as for a triangle.
    return gamma(5) * dot(abs(normal), abs(p.origin) + abs(p.edgeU) + abs(p.edgeV)) +
           gamma(6) * (maxComponent(abs(p.edgeU)) + maxComponent(abs(p.edgeV)));
}

void surfaceOfParallelogram(const Parallelogram& p, const Ray& ray, const Hit& hit, Surface& s) {
    s.position = pointOn(p, hit);
    s.geometricNormal = triangleNormal(Vec3(0.0), p.edgeU, p.edgeV);
    if (s.geometricNormal == Vec3(0.0)) s.geometricNormal = -unit(ray.direction);
    s.shadingNormal = s.geometricNormal;
    s.error = errorOf(p, s.geometricNormal);
    s.planar = true;
    s.uv = {hit.u, hit.v};
}

void surfaceOfCustom(const CustomShape& shape, std::uint32_t primitive, const Ray& ray,
                     const Hit& hit, Surface& s) {
    const Vec3 o = shape.objectFromWorld.point(ray.origin);
    const Vec3 d = shape.objectFromWorld.direction(ray.direction);
    rt_ray object{{o.x, o.y, o.z}, 0, {d.x, d.y, d.z}, nextUp(hit.t)};
    rt_hit answer{};
    if (!shape.shape.intersect(shape.shape.data, &primitive, 1, &object, &answer)) {
        object.t_max = ray.tMax; // a shape whose answer depends on t_max
        if (!shape.shape.intersect(shape.shape.data, &primitive, 1, &object, &answer)) {
            const Vec3 at = o + hit.t * d, back = -unit(d);
            answer = {hit.t, {at.x, at.y, at.z}, 0, {back.x, back.y, back.z}, {0, 0}, primitive, 0};
        }
    }
    const Vec3 objectPosition(answer.position[0], answer.position[1], answer.position[2]);
    const Vec3 objectNormal(answer.normal[0], answer.normal[1], answer.normal[2]);
    const auto& linear = shape.worldFromObject.linear;
    s.position = shape.worldFromObject.point(objectPosition);
    // A normal is a covector: n · objectFromWorld.
    const Vec3 covector = objectNormal * shape.objectFromWorld.linear;
    const double length = numeric::length(covector);
    s.geometricNormal = s.shadingNormal = covector * (1 / length);
    // The surface is within position_error of a plane; mapped, the planes' distance is divided by
    // the covector's length. Mapping the point itself rounds each term at most 4 times.
    const Vec3 magnitude = abs(linear[0]) * std::fabs(objectPosition.x) +
                           abs(linear[1]) * std::fabs(objectPosition.y) +
                           abs(linear[2]) * std::fabs(objectPosition.z) +
                           abs(shape.worldFromObject.translation);
    s.error = answer.position_error / length + gamma(4) * dot(abs(s.geometricNormal), magnitude);
    s.planar = false;
    s.uv = {answer.uv[0], answer.uv[1]};
}

/// position moved `error` along ±normal and rounded away, so that no rounding takes it back.
Vec3 offsetPosition(const Surface& s, bool outward) {
    const Vec3 offset = s.geometricNormal * (outward ? s.error : -s.error);
    Vec3 p = s.position + offset;
    for (int i = 0; i < 3; ++i) {
        if (offset[i] > 0) p[i] = nextUp(p[i]);
        if (offset[i] < 0) p[i] = nextDown(p[i]);
    }
    return p;
}

} // namespace

Vec3 triangleNormal(const Vec3& a, const Vec3& b, const Vec3& c) {
    const Vec3 ab = b - a, ac = c - a;
    const double size = numeric::bits::larger(maxComponent(abs(ab)), maxComponent(abs(ac)));
    if (!(size > 0)) return Vec3(0.0);
    const double scale = reciprocalPowerOfTwo(size);
    const Vec3 n = cross(ab * scale, ac * scale);
    const double squared = dot(n, n);
    // The plain product is off by at most γ4·|ab||ac| in each component, an angle of √3·γ4/sin of the
    // angle at a: below 1e-10 degrees while the sine is above 4.5e-4. Thinner ones are done again.
    constexpr double kPlainSine = 1.0 / 1024;
    const double edges = dot(ab * scale, ab * scale) * dot(ac * scale, ac * scale);
    if (squared > kPlainSine * kPlainSine * edges) return n * (1 / std::sqrt(squared));
    const Vec3 wide = wideCross(a * scale, b * scale, c * scale);
    return wide == Vec3(0.0) ? wide : unit(wide);
}

Plane planeOf(const Parallelogram& p) {
    const Vec3 normal = triangleNormal(Vec3(0.0), p.edgeU, p.edgeV);
    return {normal, errorOf(p, normal)};
}

std::uint32_t sourceFaceOf(const Primitives& primitives, PrimitiveId id) {
    const Segment& segment = primitives.segmentOf(id);
    const auto offset = static_cast<std::uint32_t>(id) - static_cast<std::uint32_t>(segment.first);
    const auto& faces = primitives.triangles.sourceFaces;
    return segment.kind == Kind::triangle && !faces.empty() ? faces[segment.index + offset]
                                                            : offset;
}

void prefetchSurfaces(const Primitives& primitives, std::span<const Hit> hits) {
    const Triangles& triangles = primitives.triangles;
    if (triangles.indices.empty()) return;
    const auto forEachTriangle = [&](const auto& visit) {
        for (const Hit& hit : hits) {
            if (!hit) continue;
            const Segment& segment = primitives.segmentOf(hit.id);
            if (segment.kind == Kind::triangle)
                visit(segment.index + static_cast<std::uint32_t>(hit.id) -
                      static_cast<std::uint32_t>(segment.first));
        }
    };
    forEachTriangle([&](std::uint32_t index) {
        __builtin_prefetch(&triangles.indices[index]);
        if (!triangles.normalIndices.empty()) __builtin_prefetch(&triangles.normalIndices[index]);
    });
    forEachTriangle([&](std::uint32_t index) {
        for (const std::uint32_t corner : triangles.indices[index])
            __builtin_prefetch(&triangles.positions[corner]);
        if (triangles.normalIndices.empty()) return;
        for (const std::uint32_t corner : triangles.normalIndices[index])
            if (corner != kNoIndex) __builtin_prefetch(&triangles.normals[corner]);
    });
}

double errorBoundWithin(const Box3d& box) {
    // Of the bounds above a parallelogram's is the largest. With m for the largest coordinate its origin is m at most
    // and its edges are 2 m: γ5·√3·5 m + γ6·4 m.
    return gamma(70) *
           numeric::bits::larger(maxComponent(abs(box.min)), maxComponent(abs(box.max)));
}

Surface surfaceAt(const Primitives& primitives, const Ray& ray, const Hit& hit) {
    return surfaceAt(primitives, ray, hit, primitives.segmentOf(hit.id));
}

Surface surfaceAt(const Primitives& primitives, const Ray& ray, const Hit& hit,
                  const Segment& segment) {
    const auto offset =
        static_cast<std::uint32_t>(hit.id) - static_cast<std::uint32_t>(segment.first);
    const std::uint32_t index = segment.index + offset;
    Surface s;
    s.segment = &segment;
    s.id = hit.id;
    s.object = segment.object;
    s.material = segment.material;
    s.solid = segment.solid;
    switch (segment.kind) {
    case Kind::triangle:
        surfaceOfTriangle(primitives.triangles, index, ray, hit, s);
        break;
    case Kind::sphere:
        surfaceOfSphere(primitives.spheres[index], ray, hit, s);
        break;
    case Kind::parallelogram:
        surfaceOfParallelogram(primitives.parallelograms[index], ray, hit, s);
        break;
    case Kind::custom: {
        const CustomPrimitive& custom = primitives.customs.primitives[index];
        surfaceOfCustom(*primitives.customs.shapes[custom.shape], custom.primitive, ray, hit, s);
        break;
    }
    }
    return s;
}

Vec2 uvOf(const Surface& surface) {
    if (surface.segment->kind != Kind::sphere) return surface.uv;
    const Vec3& n = surface.geometricNormal;
    const double longitude = numeric::atan2(n.y, n.x) / (2 * std::numbers::pi);
    return {longitude < 0 ? longitude + 1 : longitude,
            1 - numeric::atan2(std::sqrt(n.x * n.x + n.y * n.y), n.z) / std::numbers::pi};
}

Ray spawnRay(const Surface& surface, const Vec3& direction) {
    const bool outward = dot(direction, surface.geometricNormal) >= 0;
    return {offsetPosition(surface, outward), numeric::kInfinity, direction,
            surface.planar ? surface.id : kNoPrimitive};
}

Ray spawnRayTo(const Surface& surface, const Vec3& point) {
    const bool outward = dot(point - surface.position, surface.geometricNormal) >= 0;
    const Vec3 origin = offsetPosition(surface, outward);
    return {origin, 1, point - origin, surface.planar ? surface.id : kNoPrimitive};
}

} // namespace rt::geometry
