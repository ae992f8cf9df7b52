#include <core/report/arithmetic.hpp>

#include <core/geometry/bounds.hpp>
#include <core/geometry/surface.hpp>
#include <core/numeric/elementary.hpp>
#include <core/parallel/parallel.hpp>
#include <core/report/boxes.hpp>
#include <core/report/vector.hpp>
#include <core/trace/stage.hpp>
#include <core/trace/tone.hpp>

#include <algorithm>
#include <array>
#include <numbers>

namespace rt::report {

namespace {

using geometry::Kind;
using numeric::LinearRgb;
using numeric::Vec3;

/// The original program's: hits nearer than this are taken for the surface that a ray starts on.
constexpr double kNaiveStart = 1.0 / 1000;

constexpr std::uint32_t kNone = 0xFFFFFFFFu;

template <class Real> struct RayOf {
    Vector<Real> origin, direction;
    Real tMax = std::numeric_limits<float>::max(); // enough for any scene, in all arithmetics
    std::uint32_t exclude = kNone;
};

template <class Real> struct HitOf {
    Real t{}, u{}, v{};
    std::uint32_t primitive = kNone;
};

template <class Real> struct Primitive {
    Kind kind;
    bool solid;
    std::uint32_t id;
    std::uint32_t material, object;
    std::uint32_t index;                 // in the world's array of its kind
    std::array<Vector<Real>, 4> corners; // 3 or 4; a sphere's center is the first
    Real radius{};
    bool smooth = false;
    std::array<Vector<Real>, 3> normals;
    std::array<bool, 3> bent{}; // corners that have a normal of their own
};

template <class Real> struct Point {
    Vector<Real> position, geometric, shading;
    Real error{};
    double u = 0, v = 0; // texture coordinates
    const Primitive<Real>* primitive;
};

template <class Real, bool kRobust> class Tracer {
public:
    using V = Vector<Real>;
    using Ray = RayOf<Real>;
    using Hit = HitOf<Real>;
    using P = Point<Real>;

    Tracer(const world::World& world, const scene::Description& description)
        : world_(world), description_(description), stage_(noTree(), world, description),
          primitives_(primitivesOf(world)), boxes_(boundsOf(world)) {
        const scene::Camera& camera = description.camera;
        const V forward = unit(V(camera.forward));
        left_ = unit(cross(unit(V(camera.up)), forward));
        up_ = unit(cross(forward, left_));
        toScreen_ = forward * static_cast<Real>(camera.screenDistance);
        pixelHeight_ = static_cast<Real>(camera.screenHeight) / Real(description.image.height);
        pixelWidth_ = static_cast<Real>(camera.screenWidth) / Real(description.image.width);
        for (const trace::Light& light : stage_.lights)
            lights_.push_back({V(light.position), light.color});
    }

    LinearRgb pixel(double column, double row, std::uint64_t& rays) const {
        const Real fromMiddleX = Real(description_.image.width) / 2 - static_cast<Real>(column),
                   fromMiddleY = Real(description_.image.height) / 2 - static_cast<Real>(row);
        const V toSample =
            toScreen_ + up_ * (pixelHeight_ * fromMiddleY) + left_ * (pixelWidth_ * fromMiddleX);
        Ray ray;
        ray.origin = V(description_.camera.position);
        if (description_.render.nearPlane == scene::NearPlane::screen)
            ray.origin = ray.origin + toSample;
        ray.direction = unit(toSample);
        if (!clip(ray, true)) return {};
        return trace::toned(radiance(ray, rays), description_.image.tone);
    }

private:
    struct Work {
        Ray ray;
        LinearRgb weight{1, 1, 1};
        std::uint32_t depth = 0;
    };
    struct Contact { // what a surface lies on, within the errors of both
        double ratio = 1;
        LinearRgb filter{1, 1, 1};
        Real error{};
        Hit end; // the opaque one
    };
    struct LightOf {
        V position;
        LinearRgb color;
    };

    static const octree::Octree& noTree() {
        static const octree::Octree none;
        return none;
    }

    static std::vector<Primitive<Real>> primitivesOf(const world::World& world) {
        const geometry::Primitives& p = world.primitives;
        std::vector<Primitive<Real>> all;
        for (const geometry::Segment& segment : p.segments)
            for (std::uint32_t i = 0; i < segment.count; ++i) {
                Primitive<Real> made;
                made.kind = segment.kind, made.solid = segment.solid;
                made.id = static_cast<std::uint32_t>(segment.first) + i;
                made.object = static_cast<std::uint32_t>(segment.object);
                made.material = static_cast<std::uint32_t>(
                    geometry::materialOf(p, geometry::PrimitiveId{made.id}));
                const std::uint32_t index = made.index = segment.index + i;
                if (segment.kind == Kind::sphere) {
                    made.corners[0] = V(p.spheres[index].center);
                    made.radius = static_cast<Real>(p.spheres[index].radius);
                } else if (segment.kind == Kind::parallelogram) {
                    const geometry::Parallelogram& g = p.parallelograms[index];
                    const V o(g.origin), u(g.edgeU), v(g.edgeV);
                    made.corners = {o, o + u, o + u + v, o + v};
                } else {
                    const auto& t = p.triangles;
                    for (std::size_t k = 0; k < 3; ++k) {
                        made.corners[k] = V(t.positions[t.indices[index][k]]);
                        if (t.normalIndices.empty()) continue;
                        const std::uint32_t n = t.normalIndices[index][k];
                        if (n == geometry::kNoIndex) continue;
                        made.smooth = made.bent[k] = true;
                        made.normals[k] = V(t.normals[n]);
                    }
                }
                all.push_back(made);
            }
        return all;
    }

    static std::vector<numeric::Box3d> boundsOf(const world::World& world) {
        std::vector<numeric::Box3d> all;
        for (const geometry::Segment& segment : world.primitives.segments)
            for (std::uint32_t i = 0; i < segment.count; ++i) {
                geometry::Segment one = segment;
                one.index += i, one.count = 1;
                all.push_back(geometry::boundsOf(world.primitives, one));
            }
        return all;
    }

    // ---- intersections -------------------------------------------------------------------------

    static Real start() { return kRobust ? Real(0) : static_cast<Real>(kNaiveStart); }

    static bool between(Real t, Real tMax) { return t > start() && t < tMax; }

    struct Shear {
        int x, y, z;
        Real sx, sy, sz;
    };
    static Shear shearOf(const V& d) {
        const V a = magnitudes(d);
        Shear s;
        s.z = a.x > a.y ? (a.x > a.z ? 0 : 2) : (a.y > a.z ? 1 : 2);
        s.x = (s.z + 1) % 3, s.y = (s.z + 2) % 3;
        s.sz = 1 / d[s.z], s.sx = d[s.x] * s.sz, s.sy = d[s.y] * s.sz;
        return s;
    }

    /// As geometry::intersectTriangle.
    static bool sheared(const Ray& ray, const Shear& s, const V& a, const V& b, const V& c,
                        Hit& hit) {
        const auto to = [&](const V& p) {
            const Real z = p[s.z] - ray.origin[s.z];
            return V{(p[s.x] - ray.origin[s.x]) - s.sx * z, (p[s.y] - ray.origin[s.y]) - s.sy * z,
                     z};
        };
        const V A = to(a), B = to(b), C = to(c);
        const Real u = C.x * B.y - C.y * B.x, v = A.x * C.y - A.y * C.x, w = B.x * A.y - B.y * A.x;
        if (!((u >= 0 && v >= 0 && w >= 0) || (u <= 0 && v <= 0 && w <= 0))) return false;
        const Real determinant = (u + v) + w;
        if (!(determinant != 0)) return false;
        const Real inverse = 1 / determinant;
        hit.u = v * inverse, hit.v = w * inverse;
        hit.t = s.sz * (A.z + (hit.u * (B.z - A.z) + hit.v * (C.z - A.z)));
        return true;
    }

    /// [Möller, Trumbore 1997]
    static bool plain(const Ray& ray, const V& a, const V& ab, const V& ac, bool whole, Hit& hit) {
        const V p = cross(ray.direction, ac);
        const Real determinant = dot(ab, p);
        if (determinant == 0) return false;
        const Real inverse = 1 / determinant;
        const V s = ray.origin - a, q = cross(s, ab);
        hit.u = dot(s, p) * inverse, hit.v = dot(ray.direction, q) * inverse;
        if (!(hit.u >= 0 && hit.v >= 0)) return false;
        if (!(whole ? hit.u <= 1 && hit.v <= 1 : hit.u + hit.v <= 1)) return false;
        hit.t = dot(ac, q) * inverse;
        return true;
    }

    static bool meetSphere(const Ray& ray, const Primitive<Real>& p, Real t[2]) {
        const V f = p.corners[0] - ray.origin;
        const V& d = ray.direction;
        if constexpr (kRobust) { // as geometry::intersectSphereLine
            const Real squared = dot(d, d), b = dot(f, d), k = b / squared,
                       r2 = p.radius * p.radius;
            const V l = f - d * k;
            const Real discriminant = r2 - dot(l, l), c = dot(f, f) - r2;
            const bool inside = c < 0;
            if (!(inside || discriminant > 0)) return false;
            const Real root = squareRoot(inside ? b * b - squared * c : squared * discriminant);
            const Real q = b < 0 ? b - root : b + root, t0 = c / q, t1 = q / squared;
            t[0] = t0 < t1 ? t0 : t1, t[1] = t0 > t1 ? t0 : t1;
        } else {
            const Real a = dot(d, d), b = -2 * dot(f, d), c = dot(f, f) - p.radius * p.radius;
            const Real discriminant = b * b - 4 * a * c;
            if (!(discriminant > 0)) return false;
            const Real root = squareRoot(discriminant);
            t[0] = (-b - root) / (2 * a), t[1] = (-b + root) / (2 * a);
        }
        return true;
    }

    bool meet(const Ray& ray, const Shear& s, std::uint32_t index, Real tMax, Hit& hit) const {
        const Primitive<Real>& p = primitives_[index];
        if (kRobust && index == ray.exclude && p.kind != Kind::sphere) return false;
        Hit found;
        if (p.kind == Kind::sphere) {
            Real t[2];
            if (!meetSphere(ray, p, t)) return false;
            found.t = t[0] > start() ? t[0] : t[1];
        } else if (p.kind == Kind::triangle) {
            const auto& [a, b, c, none] = p.corners;
            if (!(kRobust ? sheared(ray, s, a, b, c, found)
                          : plain(ray, a, b - a, c - a, false, found)))
                return false;
        } else {
            const auto& [a, b, c, d] = p.corners;
            if constexpr (kRobust) {
                if (sheared(ray, s, a, b, c, found)) {
                    found.u += found.v; // u along both edges of the first half
                } else if (sheared(ray, s, a, c, d, found)) {
                    found.v += found.u;
                } else {
                    return false;
                }
            } else if (!plain(ray, a, b - a, d - a, true, found)) {
                return false;
            }
        }
        if (!between(found.t, tMax)) return false;
        found.primitive = index;
        hit = found;
        return true;
    }

    Hit closest(const Ray& ray) const {
        const Shear s = shearOf(ray.direction);
        Hit best;
        best.t = ray.tMax;
        boxes_.visit(ray.origin, ray.direction, ray.tMax, [&](std::uint32_t index, Real& limit) {
            Hit hit;
            if (!meet(ray, s, index, std::numeric_limits<float>::max(), hit)) return;
            if (!(hit.t < ray.tMax) || hit.t > best.t) return;
            if (hit.t == best.t && best.primitive < index) return; // the lowest of equals
            best = hit;
            limit = hit.t;
        });
        return best;
    }

    /// Calls each(primitive, t) for every surface that the ray passes.
    template <class Each> void crossings(const Ray& ray, const Each& each) const {
        const Shear s = shearOf(ray.direction);
        boxes_.visit(ray.origin, ray.direction, ray.tMax, [&](std::uint32_t index, Real&) {
            if (primitives_[index].kind == Kind::sphere) {
                Real t[2];
                if (!meetSphere(ray, primitives_[index], t)) return;
                for (const Real one : t)
                    if (between(one, ray.tMax)) each(index, one);
            } else if (Hit hit; meet(ray, s, index, ray.tMax, hit)) {
                each(index, hit.t);
            }
        });
    }

    /// As trace::lowestOfTied, on the faces that the tracer found to tie.
    Hit settled(const Ray& ray, const Hit& hit) const {
        if (!kRobust || stage_.ties.none() || hit.primitive == kNone ||
            !stage_.ties.isHigher[primitives_[hit.primitive].id])
            return hit;
        const P point = pointOf(ray, hit);
        const Real cosine = magnitude(dot(ray.direction, point.geometric));
        if (cosine == 0) return hit;
        Ray upTo = ray;
        upTo.tMax = std::min(ray.tMax, hit.t + errorOfBoth(point) / cosine);
        const Shear s = shearOf(ray.direction);
        Hit lowest = hit;
        boxes_.visit(ray.origin, ray.direction, upTo.tMax, [&](std::uint32_t index, Real&) {
            const Primitive<Real>& p = primitives_[index];
            if (index >= lowest.primitive || p.kind == Kind::sphere ||
                p.object == point.primitive->object)
                return;
            Hit other;
            if (!meet(upTo, s, index, upTo.tMax, other)) return;
            if (magnitude(other.t - hit.t) * cosine <= point.error + pointOf(upTo, other).error)
                lowest = other;
        });
        return lowest;
    }

    /// As in trace::Whitted: an eye in the plane of a face does not see that face.
    bool startsOn(const Ray& ray, const Hit& hit) const {
        const P point = pointOf(ray, hit);
        return point.primitive->kind != Kind::sphere && stage_.box.unbounded() &&
               hit.t * magnitude(dot(ray.direction, point.geometric)) <= point.error;
    }

    // ---- surfaces ------------------------------------------------------------------------------

    static Real gamma(int n) { return static_cast<Real>(n * dataRoundoffOf<Real>()); }

    /// Of a point and of what lies on its primitive.
    Real errorOfBoth(const P& point) const {
        const double beside = stage_.ties.errorBesideOf(geometry::PrimitiveId{point.primitive->id});
        return point.error +
               std::max(point.error, static_cast<Real>(beside * dataRoundoffOf<Real>() /
                                                       numeric::kUnitRoundoff));
    }

    /// As geometry::surfaceAt.
    P pointOf(const Ray& ray, const Hit& hit) const {
        const Primitive<Real>& p = primitives_[hit.primitive];
        P point;
        point.primitive = &p;
        const V there = ray.origin + ray.direction * hit.t;
        if (p.kind == Kind::sphere) {
            const V n = unit(there - p.corners[0]);
            point.position = kRobust ? p.corners[0] + n * p.radius : there;
            point.geometric = point.shading = n;
            point.error =
                gamma(2) * dot(magnitudes(n), magnitudes(p.corners[0])) + gamma(12) * p.radius;
            const Vec3 at(n);
            const double longitude = numeric::atan2(at.y, at.x) / (2 * std::numbers::pi);
            point.u = longitude < 0 ? longitude + 1 : longitude;
            point.v =
                1 - numeric::atan2(std::sqrt(at.x * at.x + at.y * at.y), at.z) / std::numbers::pi;
            return point;
        }
        const bool triangle = p.kind == Kind::triangle;
        const V& a = p.corners[0];
        const V ab = p.corners[1] - a, ac = p.corners[triangle ? 2 : 3] - a;
        point.position = kRobust ? a + (ab * hit.u + ac * hit.v) : there;
        const V normal = cross(ab, ac);
        const bool flat = normal == V{};
        point.geometric = flat ? -unit(ray.direction) : unit(normal);
        point.shading = point.geometric;
        const V n = magnitudes(point.geometric);
        point.error = gamma(5) * dot(n, magnitudes(a) + magnitudes(ab) + magnitudes(ac)) +
                      gamma(6) * (largest(magnitudes(ab)) + largest(magnitudes(ac)));
        point.u = static_cast<double>(hit.u), point.v = static_cast<double>(hit.v);
        if (!triangle) return point;
        const Real weights[3] = {(1 - hit.u) - hit.v, hit.u, hit.v};
        if (p.smooth) {
            V sum;
            for (std::size_t k = 0; k < 3; ++k)
                sum = sum + (p.bent[k] ? p.normals[k] : point.geometric) * weights[k];
            if (dot(sum, sum) > gamma(16) * gamma(16)) point.shading = unit(sum);
        }
        const auto& t = world_.primitives.triangles;
        if (!t.uvIndices.empty() &&
            t.uvIndices[p.index] !=
                std::array{geometry::kNoIndex, geometry::kNoIndex, geometry::kNoIndex}) {
            point.u = point.v = 0;
            for (std::size_t k = 0; k < 3; ++k)
                if (const std::uint32_t at = t.uvIndices[p.index][k]; at != geometry::kNoIndex) {
                    point.u += static_cast<double>(weights[k]) * t.uvs[at].x;
                    point.v += static_cast<double>(weights[k]) * t.uvs[at].y;
                }
        }
        return point;
    }

    LinearRgb colorOf(const P& point) const {
        const material::Material& m = world_.materials[point.primitive->material];
        if (!m.colorTexture) return m.color;
        const Vec3 at(point.position);
        const Vec3 object = world_.objectPoint(geometry::ObjectId{point.primitive->object}, at);
        const rt_surface_point where{
            {point.u, point.v}, {object.x, object.y, object.z}, {at.x, at.y, at.z}};
        double rgb[3] = {0, 0, 0};
        m.colorTexture->type->evaluate(m.colorTexture->state, &where, 1, rgb);
        return m.color * LinearRgb{rgb[0], rgb[1], rgb[2]};
    }

    /// As geometry::spawnRay; naively from the point itself.
    Ray leave(const P& point, const V& direction) const {
        Ray ray;
        ray.origin = point.position;
        ray.direction = direction;
        if constexpr (kRobust) {
            const bool outward = dot(direction, point.geometric) >= 0;
            const Real error = errorOfBoth(point);
            ray.origin = ray.origin + point.geometric * (outward ? error : -error);
            ray.exclude = static_cast<std::uint32_t>(point.primitive - primitives_.data());
        }
        return ray;
    }

    /// As trace::smoothPosition.
    static V smoothPosition(const P& point, const Hit& hit, Real side) {
        const Primitive<Real>& p = *point.primitive;
        if (!p.smooth) return point.position;
        const Real weights[3] = {(1 - hit.u) - hit.v, hit.u, hit.v};
        V position = point.position;
        for (std::size_t k = 0; k < 3; ++k) {
            if (!p.bent[k]) continue;
            const V normal = p.normals[k] * side;
            const Real depth = dot(point.position - p.corners[k], normal);
            if (depth < 0) position = position - normal * (weights[k] * depth);
        }
        return position;
    }

    // ---- light ---------------------------------------------------------------------------------

    /// As trace::SceneBox.
    bool clip(Ray& ray, bool startToo) const {
        if (!description_.bounds) return true;
        const numeric::Box3d& box = *description_.bounds;
        const V low(box.min), high(box.max);
        const Real slack = gamma(32) * (largest(magnitudes(low)) + largest(magnitudes(high)) +
                                        largest(magnitudes(ray.origin)));
        Real enter = 0, leave = ray.tMax;
        for (int i = 0; i < 3; ++i) {
            const Real a = low[i] - slack - ray.origin[i], b = high[i] + slack - ray.origin[i];
            if (ray.direction[i] == 0) {
                if (a > 0 || b < 0) return false;
                continue;
            }
            const Real s = a / ray.direction[i], t = b / ray.direction[i];
            enter = std::max(enter, std::min(s, t)), leave = std::min(leave, std::max(s, t));
        }
        if (!startToo) {
            ray.tMax = std::max(leave, Real(0));
            return true;
        }
        if (!(enter <= leave && leave > 0)) return false;
        ray.origin = ray.origin + ray.direction * enter;
        ray.tMax = leave - enter;
        return ray.tMax > 0;
    }

    LinearRgb background(const Ray& ray) const {
        geometry::Ray seen;
        seen.origin = Vec3(ray.origin), seen.direction = Vec3(ray.direction);
        return stage_.background.seenBy(seen);
    }

    LinearRgb radiance(const Ray& primary, std::uint64_t& rays) const {
        LinearRgb sum;
        std::vector<Work> pending{{primary}};
        while (!pending.empty()) {
            const Work work = pending.back();
            pending.pop_back();
            ++rays;
            const Hit hit = settled(work.ray, closest(work.ray));
            if (hit.primitive == kNone) {
                sum += work.weight * background(work.ray);
            } else if (kRobust && work.depth == 0 && startsOn(work.ray, hit)) {
                Work beyond = work;
                beyond.ray = leave(pointOf(work.ray, hit), work.ray.direction);
                beyond.ray.tMax = work.ray.tMax;
                pending.push_back(beyond);
            } else {
                shade(work, hit, pending, sum, rays);
            }
        }
        return sum;
    }

    void shade(const Work& work, const Hit& hit, std::vector<Work>& pending, LinearRgb& sum,
               std::uint64_t& rays) const {
        P point = pointOf(work.ray, hit);
        const material::Material& m = world_.materials[point.primitive->material];
        const bool leaving = dot(work.ray.direction, point.geometric) > 0;
        const V normal = leaving ? -point.shading : point.shading,
                geometric = leaving ? -point.geometric : point.geometric;
        const LinearRgb color = colorOf(point);
        sum += work.weight * lit(work, hit, point, m, color, normal, leaving, rays);
        LinearRgb mirror = m.specular;
        if (!m.isOpaque() &&
            !transmit(work, hit, point, m, color, normal, geometric, leaving, pending, sum, rays))
            mirror += m.transmission;
        if (mirror.isBlack()) return;
        const V& d = work.ray.direction;
        V out = unit(d - normal * (2 * dot(d, normal)));
        if (const Real height = dot(out, geometric); height < 0)
            out = out - geometric * (2 * height);
        push(work, leave(point, out), color * mirror, pending);
    }

    LinearRgb lit(const Work& work, const Hit& hit, const P& point, const material::Material& m,
                  const LinearRgb& color, const V& normal, bool leaving,
                  std::uint64_t& rays) const {
        LinearRgb sum;
        const bool shines = !m.diffuse.isBlack() || !m.specular.isBlack(),
                   glows = !m.environment.isBlack();
        if (!shines && !glows) return sum;
        P from = point;
        from.position = smoothPosition(point, hit, leaving ? Real(-1) : Real(1));
        for (const LightOf& light : lights_) {
            const V to = light.position - point.position;
            if (!(dot(to, to) > 0)) continue;
            const V direction = unit(to);
            const Real cosine = dot(direction, normal);
            const bool front = cosine > 0;
            if (!front && (!glows || m.isOpaque())) continue;
            ++rays;
            LinearRgb visible = visibleLight(light, front ? from : point);
            if (!front) visible *= m.transmission;
            sum += m.environment * visible;
            if (!front) continue;
            sum += color * m.diffuse * static_cast<double>(cosine) * visible;
            if (m.specular.isBlack()) continue;
            const V halfway = direction - work.ray.direction;
            const Real shine = dot(unit(halfway), normal);
            if (shine > 0)
                sum += m.specular *
                       numeric::pow(std::min(static_cast<double>(shine), 1.0), m.shininess) *
                       visible;
        }
        return sum;
    }

    LinearRgb visibleLight(const LightOf& light, const P& from) const {
        Ray ray = leave(from, light.position - from.position);
        ray.direction = light.position - ray.origin;
        ray.tMax = 1;
        if constexpr (!kRobust) { // its hits are ignored by distance, so t has to be one
            const Real length = squareRoot(dot(ray.direction, ray.direction));
            ray.direction = ray.direction * (1 / length);
            ray.tMax = length;
        }
        clip(ray, false);
        LinearRgb color = light.color;
        crossings(ray, [&](std::uint32_t index, Real) {
            color *= world_.materials[primitives_[index].material].transmission;
        });
        return color;
    }

    /// As trace::findCoincident.
    Contact contactOf(const Ray& ray, const Hit& hit, const P& point) const {
        Contact contact;
        contact.error = point.error;
        const Real cosine = magnitude(dot(ray.direction, point.geometric));
        if (cosine == 0) return contact;
        Ray upTo = ray;
        upTo.tMax = hit.t + 2 * errorOfBoth(point) / cosine;
        std::vector<std::uint32_t> met;
        crossings(upTo, [&](std::uint32_t index, Real t) {
            if (primitives_[index].object != point.primitive->object &&
                magnitude(t - hit.t) * cosine <= 2 * errorOfBoth(point))
                met.push_back(index);
        });
        std::sort(met.begin(), met.end());
        std::vector<std::uint32_t> entered, left;
        const Shear s = shearOf(ray.direction);
        for (const std::uint32_t index : met) {
            Hit other;
            if (!meet(upTo, s, index, upTo.tMax, other)) continue;
            const P there = pointOf(upTo, other);
            if (!(magnitude(other.t - hit.t) * cosine <= point.error + there.error)) continue;
            contact.error = std::max(contact.error, there.error);
            const Primitive<Real>& p = primitives_[index];
            const material::Material& m = world_.materials[p.material];
            if (m.isOpaque()) {
                if (contact.end.primitive == kNone) contact.end = other;
                continue;
            }
            const bool leaves = dot(ray.direction, there.geometric) > 0;
            auto& list = leaves ? left : entered;
            if (std::find(list.begin(), list.end(), p.object) != list.end()) continue;
            list.push_back(p.object);
            contact.filter *= colorOf(there) * m.transmission;
            if (p.solid) contact.ratio *= leaves ? m.ior : 1 / m.ior;
        }
        return contact;
    }

    /// False on total reflection.
    bool transmit(const Work& work, const Hit& hit, const P& point, const material::Material& m,
                  const LinearRgb& color, const V& normal, const V& geometric, bool leaving,
                  std::vector<Work>& pending, LinearRgb& sum, std::uint64_t& rays) const {
        Real ratio = 1;
        if (point.primitive->solid)
            ratio = leaving ? static_cast<Real>(m.ior) : 1 / static_cast<Real>(m.ior);
        Contact contact;
        P from = point;
        if (kRobust && stage_.mayCoincide[point.primitive->object]) {
            contact = contactOf(work.ray, hit, point);
            ratio *= static_cast<Real>(contact.ratio);
            from.error += contact.error;
        }
        const bool ends = contact.end.primitive != kNone;
        V direction = work.ray.direction;
        if (ratio != 1 && !ends) {
            const V n = dot(direction, normal) < 0 ? normal : geometric;
            const V tangential = (direction - n * dot(direction, n)) * ratio;
            const Real sineSquared = dot(tangential, tangential);
            if (!(sineSquared < 1)) return false;
            direction = unit(tangential - n * squareRoot(1 - sineSquared));
            if (const Real height = dot(direction, geometric); height > 0)
                direction = direction - geometric * (2 * height);
        }
        const LinearRgb share = color * m.transmission * contact.filter;
        if (!ends) {
            push(work, leave(from, direction), share, pending);
            return true;
        }
        Work child;
        child.ray = leave(from, direction);
        child.weight = work.weight * share;
        child.depth = work.depth + 1;
        if (child.depth <= stage_.depth && !child.weight.isBlack())
            shade(child, contact.end, pending, sum, rays);
        return true;
    }

    void push(const Work& parent, const Ray& ray, const LinearRgb& share,
              std::vector<Work>& pending) const {
        Work child{ray, parent.weight * share, parent.depth + 1};
        if (child.weight.isBlack() || child.depth > stage_.depth ||
            child.weight.maxComponent() < stage_.cutoff)
            return;
        clip(child.ray, false);
        pending.push_back(child);
    }

    const world::World& world_;
    const scene::Description& description_;
    trace::Stage stage_;
    std::vector<Primitive<Real>> primitives_;
    Boxes<Real> boxes_;
    std::vector<LightOf> lights_;
    V toScreen_, up_, left_;
    Real pixelHeight_, pixelWidth_;
};

template <class Real, bool kRobust>
Rendered rendered(const world::World& world, const scene::Description& description, int threads) {
    const Tracer<Real, kRobust> tracer(world, description);
    const scene::Image& image = description.image;
    Rendered result{image::Framebuffer(image.width, image.height), 0};
    std::vector<std::uint64_t> rays(image.height);
    const double offset = description.render.sampling == scene::Sampling::center ? 0.5 : 0;
    parallel::forEach(image.height, threads, [&](std::size_t y) {
        for (std::uint32_t x = 0; x < image.width; ++x)
            result.frame.at(x, static_cast<std::uint32_t>(y)) =
                tracer.pixel(x + offset, static_cast<double>(y) + offset, rays[y]);
    });
    for (const std::uint64_t r : rays) result.rays += r;
    return result;
}

} // namespace

const char* nameOf(Arithmetic arithmetic) {
    constexpr const char* kNames[] = {"f32-naive", "f32-robust", "f64-naive", "f64-robust",
                                      "f128-reference"};
    return kNames[static_cast<std::size_t>(arithmetic)];
}

bool isBuiltIn(const world::World& world) {
    return std::none_of(world.primitives.segments.begin(), world.primitives.segments.end(),
                        [](const geometry::Segment& s) { return s.kind == Kind::custom; });
}

Rendered renderIn(Arithmetic arithmetic, const world::World& world,
                  const scene::Description& description, int threads) {
    switch (arithmetic) {
    case Arithmetic::f32Naive:
        return rendered<float, false>(world, description, threads);
    case Arithmetic::f32Robust:
        return rendered<float, true>(world, description, threads);
    case Arithmetic::f64Naive:
        return rendered<double, false>(world, description, threads);
    case Arithmetic::f64Robust:
        return rendered<double, true>(world, description, threads);
    case Arithmetic::f128Reference:
        break;
    }
    return rendered<Quad, true>(world, description, threads);
}

} // namespace rt::report
