#include <core/geometry/intersect.hpp>

#include <algorithm>
#include <cmath>

namespace rt::geometry {
namespace {

struct Product {
    double high, low; // high + low is the exact product, barring over- and underflow
};

/// [Dekker 1971], with Veltkamp's splitting.
Product exactProduct(double a, double b) {
    constexpr double kSplitter = 134217729.0; // 2^27 + 1
    const double p = a * b;
    const double ca = kSplitter * a, cb = kSplitter * b;
    const double ah = ca - (ca - a), al = a - ah;
    const double bh = cb - (cb - b), bl = b - bh;
    return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
}

int signOf(double x) { return (x > 0) - (x < 0); }

/// Sign of a·b − c·d after the line has been moved by (ε, ε²); `edgeY` and `edgeX` are the
/// differences along the edge that decide where the exact value is 0.
int perturbedSign(double value, double a, double b, double c, double d, double edgeY,
                  double edgeX) {
    if (value != 0) return signOf(value);
    const Product p = exactProduct(a, b), q = exactProduct(c, d);
    if (const int sign = signOf((p.high - q.high) + (p.low - q.low))) return sign;
    if (edgeY != 0) return signOf(edgeY);
    return signOf(edgeX);
}

struct Sheared {
    double x, y, z;
};

Sheared shear(const RayFrame& ray, const Vec3& p) {
    const double* const c = &p.x;
    const double z = c[ray.kz] - ray.origin[ray.kz];
    return {(c[ray.kx] - ray.origin[ray.kx]) - ray.shearX * z,
            (c[ray.ky] - ray.origin[ray.ky]) - ray.shearY * z, z};
}

struct EdgeFunctions {
    double u, v, w; // opposite corners a, b, c

    bool inside() const { return (u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0); }
    bool touches() const { return u == 0 || v == 0 || w == 0; }
};

EdgeFunctions edgeFunctions(const Sheared& a, const Sheared& b, const Sheared& c) {
    return {c.x * b.y - c.y * b.x, a.x * c.y - a.y * c.x, b.x * a.y - b.y * a.x};
}

/// Weights of b and c, and t. False where the triangle is seen exactly edge-on.
bool solve(const RayFrame& ray, const EdgeFunctions& e, const Sheared& a, const Sheared& b,
           const Sheared& c, double& weightB, double& weightC, double& t) {
    const double determinant = (e.u + e.v) + e.w;
    if (!(determinant != 0)) return false;
    const double inverse = 1 / determinant;
    weightB = e.v * inverse;
    weightC = e.w * inverse;
    t = ray.shearZ * (a.z + (weightB * (b.z - a.z) + weightC * (c.z - a.z)));
    return true;
}

bool between(double t, double tMax) { return t > 0 && t < tMax; }

bool crossSheared(const RayFrame& ray, const Sheared& a, const Sheared& b, const Sheared& c,
                  double tMax, double& t) {
    const EdgeFunctions e = edgeFunctions(a, b, c);
    if (!e.inside()) return false;
    if (e.touches()) {
        const int u = perturbedSign(e.u, c.x, b.y, c.y, b.x, c.y - b.y, b.x - c.x);
        const int v = perturbedSign(e.v, a.x, c.y, a.y, c.x, a.y - c.y, c.x - a.x);
        const int w = perturbedSign(e.w, b.x, a.y, b.y, a.x, b.y - a.y, a.x - b.x);
        if (u == 0 || u != v || v != w) return false;
    }
    double weightB, weightC, s;
    if (!solve(ray, e, a, b, c, weightB, weightC, s) || !between(s, tMax)) return false;
    t = s;
    return true;
}

rt_ray objectRay(const CustomShape& shape, const Ray& ray, double tMin, double tMax) {
    const Vec3 o = shape.objectFromWorld.point(ray.origin);
    const Vec3 d = shape.objectFromWorld.direction(ray.direction);
    return {{o.x, o.y, o.z}, tMin, {d.x, d.y, d.z}, tMax};
}

} // namespace

RayFrame frameOf(const Ray& ray) {
    RayFrame f;
    for (int i = 0; i < 3; ++i) {
        f.origin[i] = (&ray.origin.x)[i];
        f.direction[i] = (&ray.direction.x)[i];
    }
    const double x = std::fabs(f.direction[0]), y = std::fabs(f.direction[1]),
                 z = std::fabs(f.direction[2]);
    f.kz = x > y ? (x > z ? 0 : 2) : (y > z ? 1 : 2);
    f.kx = f.kz == 2 ? 0 : f.kz + 1;
    f.ky = f.kx == 2 ? 0 : f.kx + 1;
    f.shearZ = 1 / f.direction[f.kz];
    f.shearX = f.direction[f.kx] * f.shearZ;
    f.shearY = f.direction[f.ky] * f.shearZ;
    f.squared = (f.direction[0] * f.direction[0] + f.direction[1] * f.direction[1]) +
                f.direction[2] * f.direction[2];
    f.inverseSquared = 1 / f.squared;
    return f;
}

std::array<Vec3, 4> cornersOf(const Parallelogram& p) {
    const Vec3 u = p.origin + p.edgeU, v = p.origin + p.edgeV;
    return {p.origin, u, u + p.edgeV, v};
}

bool intersectTriangle(const RayFrame& ray, const Vec3& a, const Vec3& b, const Vec3& c,
                       double tMax, Hit& hit) {
    const Sheared sa = shear(ray, a), sb = shear(ray, b), sc = shear(ray, c);
    const EdgeFunctions e = edgeFunctions(sa, sb, sc);
    if (!e.inside()) return false;
    double u, v, t;
    if (!solve(ray, e, sa, sb, sc, u, v, t) || !between(t, tMax)) return false;
    hit.t = t;
    hit.u = u;
    hit.v = v;
    return true;
}

bool intersectParallelogram(const RayFrame& ray, const std::array<Vec3, 4>& corners, double tMax,
                            Hit& hit) {
    const Sheared a = shear(ray, corners[0]), b = shear(ray, corners[1]),
                  c = shear(ray, corners[2]), d = shear(ray, corners[3]);
    const EdgeFunctions first = edgeFunctions(a, b, c), second = edgeFunctions(a, c, d);
    double p, q, t;
    if (first.inside() && solve(ray, first, a, b, c, p, q, t)) {
        if (!between(t, tMax)) return false;
        hit.t = t;
        hit.u = p + q;
        hit.v = q;
        return true;
    }
    if (second.inside() && solve(ray, second, a, c, d, p, q, t) && between(t, tMax)) {
        hit.t = t;
        hit.u = p;
        hit.v = p + q;
        return true;
    }
    return false;
}

bool intersectSphereLine(const RayFrame& ray, const Sphere& sphere, double t[2]) {
    const double* const d = ray.direction;
    const double* const centre = &sphere.center.x;
    const double fx = centre[0] - ray.origin[0], fy = centre[1] - ray.origin[1],
                 fz = centre[2] - ray.origin[2];
    const double b = (fx * d[0] + fy * d[1]) + fz * d[2];
    const double k = b * ray.inverseSquared;
    const double lx = fx - k * d[0], ly = fy - k * d[1], lz = fz - k * d[2];
    const double r2 = sphere.radius * sphere.radius;
    const double discriminant = r2 - ((lx * lx + ly * ly) + lz * lz);
    const double c = ((fx * fx + fy * fy) + fz * fz) - r2;
    const bool inside = c < 0;
    if (!(inside || discriminant > 0)) return false; // a tangent passes by
    const double root = std::sqrt(inside ? b * b - ray.squared * c : ray.squared * discriminant);
    const double q = b < 0 ? b - root : b + root;
    const double t0 = c / q, t1 = q * ray.inverseSquared;
    t[0] = t0 < t1 ? t0 : t1;
    t[1] = t0 > t1 ? t0 : t1;
    return true;
}

bool intersectSphere(const RayFrame& ray, const Sphere& sphere, double tMax, Hit& hit) {
    double t[2];
    if (!intersectSphereLine(ray, sphere, t)) return false;
    const double first = t[0] > 0 ? t[0] : t[1];
    if (!between(first, tMax)) return false;
    hit.t = first;
    hit.u = hit.v = 0;
    return true;
}

bool intersectCustom(const CustomShape& shape, const std::uint32_t* primitives, std::uint32_t count,
                     const Ray& ray, double tMax, double& t, std::uint32_t& primitive) {
    const rt_ray object = objectRay(shape, ray, 0, tMax);
    rt_hit hit;
    if (!shape.shape.intersect(shape.shape.data, primitives, count, &object, &hit)) return false;
    // What a plugin answers is held against what was asked.
    if (!between(hit.t, tMax)) return false;
    if (std::find(primitives, primitives + count, hit.primitive) == primitives + count)
        return false;
    t = hit.t;
    primitive = hit.primitive;
    return true;
}

bool crossTriangle(const RayFrame& ray, const Vec3& a, const Vec3& b, const Vec3& c, double tMax,
                   double& t) {
    return crossSheared(ray, shear(ray, a), shear(ray, b), shear(ray, c), tMax, t);
}

bool crossParallelogram(const RayFrame& ray, const std::array<Vec3, 4>& corners, double tMax,
                        double& t) {
    const Sheared a = shear(ray, corners[0]), b = shear(ray, corners[1]),
                  c = shear(ray, corners[2]), d = shear(ray, corners[3]);
    return crossSheared(ray, a, b, c, tMax, t) || crossSheared(ray, a, c, d, tMax, t);
}

void crossCustom(const CustomShape& shape, std::uint32_t primitive, PrimitiveId id, const Ray& ray,
                 std::vector<Crossing>& out) {
    constexpr std::uint32_t kCapacity = 32; // per call; more are fetched from the last t on
    double last = 0;
    if (!shape.shape.crossings) {
        for (rt_ray object = objectRay(shape, ray, 0, ray.tMax);;) {
            rt_hit hit;
            if (!shape.shape.intersect(shape.shape.data, &primitive, 1, &object, &hit)) return;
            if (!(hit.t > last && hit.t < ray.tMax)) return;
            out.push_back({hit.t, id});
            object.t_min = last = hit.t;
        }
    }
    for (rt_ray object = objectRay(shape, ray, 0, ray.tMax);;) {
        double t[kCapacity];
        const std::uint32_t found = std::min(
            kCapacity, shape.shape.crossings(shape.shape.data, primitive, &object, t, kCapacity));
        for (std::uint32_t i = 0; i < found; ++i) {
            if (!(t[i] >= last && t[i] > 0 && t[i] < ray.tMax)) return;
            out.push_back({t[i], id});
            last = t[i];
        }
        if (found < kCapacity || last == object.t_min) return;
        object.t_min = last;
    }
}

} // namespace rt::geometry
