#include <core/plugin_host/check.hpp>

#include <core/numeric/rounding.hpp>
#include <core/plugin_host/call.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/scene/validate.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <set>
#include <thread>

namespace rt::plugin_host {
namespace {

using geometry::CustomShape;
using geometry::Vec3;

/// SplitMix64 [Steele, Lea, Flood 2014]: the same sequence everywhere.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t bits() {
        state_ += 0x9E3779B97F4A7C15u;
        std::uint64_t z = state_;
        z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
        z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
        return z ^ (z >> 31);
    }
    /// In [-1, 1).
    double symmetric() { return static_cast<double>(bits() >> 11) * 0x1p-52 - 1; }
    Vec3 vector() {
        const double x = symmetric(), y = symmetric(), z = symmetric();
        return {x, y, z};
    }

private:
    std::uint64_t state_;
};

bool isSentence(const char* text) {
    return text != nullptr && *text > ' ' && text[std::strlen(text) - 1] == '.';
}

std::string show(const Vec3& v) {
    return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) +
           ")";
}

Vec3 vec(const double v[3]) { return {v[0], v[1], v[2]}; }

/// Faults of one kind are said once, with the first case.
class Faults {
public:
    explicit Faults(CheckReport& report) : report_(report) {}
    void add(const std::string& rule, const std::string& example = {}) {
        if (said_.insert(rule).second)
            report_.faults.push_back(rule + (example.empty() ? "" : " (" + example + ")") + ".");
    }

private:
    CheckReport& report_;
    std::set<std::string> said_;
};

// ---- rows and docs -----------------------------------------------------------------------------------------

void checkRows(std::span<const rt_param> rows, Faults& faults) {
    for (const rt_param& row : rows) {
        const std::string name = std::string("the parameter '") + row.name + "'";
        if (!isSentence(row.doc))
            faults.add("the doc of " + name + " is not a sentence with a point at its end");
    }
}

void checkModuleText(const rt_module& module, Faults& faults) {
    if (!isSentence(module.doc))
        faults.add("the module's doc is not a sentence with a point at its end");
    if (*module.version == '\0') faults.add("the module has no version");
    const std::string_view example = module.example;
    if (example.find(std::string(module.name) + ":") == std::string_view::npos &&
        module.loader == nullptr)
        faults.add("the module's example does not use it");
}

// ---- custom shapes -----------------------------------------------------------------------------------------

struct Shot {
    bool hit = false;
    rt_hit at;
};

/// Bytes that no answer has by accident: a signalling NaN in every number.
rt_hit poisoned() {
    rt_hit hit;
    std::memset(&hit, 0xF5, sizeof hit);
    return hit;
}

/// Checks one custom shape in its own space.
class CustomCheck {
public:
    CustomCheck(const rt_custom& custom, int rays, Faults& faults)
        : custom_(custom), rayCount_(rays), faults_(faults) {
        for (std::uint32_t i = 0; i < custom.primitive_count; ++i) {
            geometry::Box3d box;
            custom.bounds(custom.data, i, &box.min.x, &box.max.x);
            boxes_.push_back(box);
            whole_.add(box);
        }
        // Large shapes are given to the plugin in leaves, as the octree does.
        for (std::uint32_t i = 0; i < std::min<std::uint32_t>(custom.primitive_count, kLeaf); ++i)
            ids_.push_back(i);
    }

    void run() {
        const std::vector<rt_ray> rays = makeRays();
        std::vector<Shot> alone = shootAll(rays);
        for (std::size_t i = 0; i < rays.size(); ++i) checkShot(rays[i], alone[i]);
        std::vector<Shot> first, second;
        std::thread other([&] { second = shootAll(rays); });
        first = shootAll(rays);
        other.join();
        for (std::size_t i = 0; i < rays.size(); ++i)
            if (!same(alone[i], first[i]) || !same(alone[i], second[i]))
                faults_.add("two threads get different answers to one ray", describe(rays[i]));
        checkImpossibleRays();
        if (hits_ == 0)
            faults_.add("none of " + std::to_string(rays.size()) +
                        " rays through the bounds hits anything");
    }

    int hits() const { return hits_; }

private:
    static constexpr std::uint32_t kLeaf = 8;

    double size() const { return length(whole_.max - whole_.min) / 2; }

    static std::string describe(const rt_ray& ray) {
        return "ray from " + show(vec(ray.origin)) + " along " + show(vec(ray.direction));
    }
    static bool same(const Shot& a, const Shot& b) {
        return a.hit == b.hit &&
               (!a.hit || std::memcmp(&a.at, &b.at, offsetof(rt_hit, reserved)) == 0);
    }

    Shot shoot(const rt_ray& ray, const std::vector<std::uint32_t>& ids) const {
        Shot shot{false, poisoned()};
        shot.hit = custom_.intersect(custom_.data, ids.data(),
                                     static_cast<std::uint32_t>(ids.size()), &ray, &shot.at) != 0;
        return shot;
    }
    std::vector<Shot> shootAll(const std::vector<rt_ray>& rays) const {
        std::vector<Shot> shots;
        shots.reserve(rays.size());
        for (const rt_ray& ray : rays) shots.push_back(shoot(ray, ids_));
        return shots;
    }

    /// Toward points of the box, from inside and outside and far away, with directions of all lengths and along the axes.
    std::vector<rt_ray> makeRays() const {
        Random random(1);
        std::vector<rt_ray> rays;
        const Vec3 middle = whole_.centre(), half = whole_.diagonal() * 0.5;
        for (int i = 0; i < rayCount_; ++i) {
            const double away = i % 5 == 0 ? 0.5 : i % 5 == 4 ? 1000 : 3;
            Vec3 origin = middle + away * size() * random.vector();
            const Vec3 target = middle + half * random.vector();
            Vec3 direction = target - origin;
            if (i % 7 == 0) { // along an axis
                const int axis = static_cast<int>(random.bits() % 3);
                const double sign = random.bits() & 1 ? 1 : -1;
                origin = target, direction = Vec3(0.0);
                origin[axis] -= sign * away * size(), direction[axis] = sign;
            }
            direction *= i % 3 == 0 ? 1 : i % 3 == 1 ? 1 / length(direction) : 1000.0;
            rays.push_back({{origin.x, origin.y, origin.z},
                            0,
                            {direction.x, direction.y, direction.z},
                            numeric::kInfinity});
        }
        return rays;
    }

    void checkShot(const rt_ray& ray, const Shot& shot) {
        const rt_hit untouched = poisoned();
        if (!shot.hit) {
            if (std::memcmp(&shot.at, &untouched, sizeof untouched) != 0)
                faults_.add("a miss writes into the hit", describe(ray));
            return;
        }
        ++hits_;
        const rt_hit& hit = shot.at;
        const std::string which = describe(ray);
        const Vec3 p = vec(hit.position), n = vec(hit.normal), o = vec(ray.origin),
                   d = vec(ray.direction);
        if (!(hit.t > ray.t_min && hit.t < ray.t_max))
            return faults_.add("a hit lies outside (t_min, t_max)", which);
        if (hit.primitive >= ids_.size())
            return faults_.add("a hit names a primitive that was not asked for", which);
        if (!numeric::isFinite(p) || !std::isfinite(hit.uv[0]) || !std::isfinite(hit.uv[1]))
            return faults_.add("a hit's position or uv is not finite", which);
        if (!(hit.position_error >= 0 && hit.position_error < size()))
            return faults_.add("a hit's position_error is negative, too large or not a number",
                               which);
        if (!(std::fabs(length(n) - 1) <= numeric::gamma(16)))
            return faults_.add("a hit's normal is not unit", which);
        // Where the ray is at t, and where the hit says it is: the difference is the rounding of o + t d and of t.
        const double reach = length(o) + hit.t * length(d) + size();
        if (!(length(p - (o + hit.t * d)) <= std::sqrt(numeric::kUnitRoundoff) * reach))
            faults_.add("a hit's position is not where the ray is at its t", which);
        const geometry::Box3d& box = boxes_[hit.primitive];
        for (int axis = 0; axis < 3; ++axis)
            if (!(p[axis] >= box.min[axis] - hit.position_error &&
                  p[axis] <= box.max[axis] + hit.position_error))
                faults_.add("a hit lies outside the bounds of its primitive", which);

        rt_ray shorter = ray;
        shorter.t_max = hit.t;
        if (const Shot again = shoot(shorter, ids_); again.hit)
            faults_.add("with t_max at the hit it finds one that it had passed over", which);
        std::vector<std::uint32_t> reversed(ids_.rbegin(), ids_.rend());
        if (!same(shot, shoot(ray, reversed)))
            faults_.add("the answer depends on the order of the primitives", which);
        checkCrossings(ray, hit, which);
        checkFromBeside(hit, which);
    }

    void checkCrossings(const rt_ray& ray, const rt_hit& hit, const std::string& which) {
        if (custom_.crossings == nullptr) return;
        constexpr std::uint32_t kCapacity = 64;
        double t[kCapacity];
        const std::uint32_t count =
            custom_.crossings(custom_.data, hit.primitive, &ray, t, kCapacity);
        if (count > kCapacity)
            return faults_.add("crossings returns more than its capacity", which);
        if (count == 0 || t[0] != hit.t)
            return faults_.add("the first crossing is not the closest hit", which);
        for (std::uint32_t i = 1; i < count; ++i)
            if (!(t[i] >= t[i - 1])) faults_.add("crossings are not in rising order", which);
        if (!(t[count - 1] < ray.t_max))
            faults_.add("a crossing lies outside (t_min, t_max)", which);
        const Vec3 o = vec(ray.origin);
        const geometry::Box3d& box = boxes_[hit.primitive];
        const bool outside = !(o.x >= box.min.x && o.x <= box.max.x && o.y >= box.min.y &&
                               o.y <= box.max.y && o.z >= box.min.z && o.z <= box.max.z);
        if (custom_.kind == RT_SOLID && outside && count < kCapacity && count % 2 != 0)
            faults_.add("a solid is entered and not left", which);
        double one;
        if (custom_.crossings(custom_.data, hit.primitive, &ray, &one, 1) != 1 || one != t[0])
            faults_.add("crossings with a capacity of 1 does not return the first", which);
    }

    /// The error bound is taken at its word: from beside the hit the surface is as far away as the bound says, and a ray
    /// that leaves from there does not meet it at once.
    void checkFromBeside(const rt_hit& hit, const std::string& which) {
        const Vec3 p = vec(hit.position), n = vec(hit.normal);
        // What a caller's own arithmetic adds in p + h n, and in t along a unit direction.
        const double own = numeric::gamma(8) * (numeric::maxComponent(numeric::abs(p)) + size());
        const double error = hit.position_error + own, height = 4 * error;
        for (const double side : {1.0, -1.0}) {
            const Vec3 from = p + side * height * n, toward = -side * n;
            const rt_ray back{
                {from.x, from.y, from.z}, 0, {toward.x, toward.y, toward.z}, numeric::kInfinity};
            const Shot shot = shoot(back, ids_);
            if (!shot.hit || !(std::fabs(shot.at.t - height) <= 2 * error))
                faults_.add("the surface is not where a hit and its position_error say", which);
            Vec3 away = random_.vector();
            away /= length(away);
            if (side * dot(away, n) < 0) away = -away;
            if (!(side * dot(away, n) > 0.125))
                continue; // a steep ray would need a bound along itself
            const rt_ray leaving{{from.x, from.y, from.z}, 0, {away.x, away.y, away.z}, 64 * error};
            if (shoot(leaving, ids_).hit)
                faults_.add("a ray that leaves the surface meets it again at once", which);
        }
    }

    void checkImpossibleRays() {
        constexpr double nan = std::numeric_limits<double>::quiet_NaN();
        const Vec3 middle = whole_.centre(),
                   outside = whole_.max + (whole_.diagonal() + Vec3(size()));
        std::vector<std::pair<const char*, rt_ray>> rays;
        for (int i = 0; i < 3; ++i) {
            rt_ray ray{{outside.x, outside.y, outside.z},
                       0,
                       {middle.x - outside.x, middle.y - outside.y, middle.z - outside.z},
                       numeric::kInfinity};
            ray.origin[i] = nan;
            rays.emplace_back("a ray whose origin is not a number", ray);
            ray.origin[i] = outside[i];
            ray.direction[i] = nan;
            rays.emplace_back("a ray whose direction is not a number", ray);
            for (const double sign : {1.0, -1.0}) { // beside the box, along each side of it
                rt_ray beside{{outside.x, outside.y, outside.z}, 0, {0, 0, 0}, numeric::kInfinity};
                beside.direction[i] = sign;
                rays.emplace_back("a ray that passes the bounds", beside);
            }
        }
        for (const auto& [what, ray] : rays) {
            const Shot shot = shoot(ray, ids_);
            const rt_hit untouched = poisoned();
            if (shot.hit)
                faults_.add(std::string(what) + " hits");
            else if (std::memcmp(&shot.at, &untouched, sizeof untouched) != 0)
                faults_.add("a miss writes into the hit");
        }
    }

    const rt_custom& custom_;
    const int rayCount_;
    Faults& faults_;
    std::vector<geometry::Box3d> boxes_;
    geometry::Box3d whole_;
    std::vector<std::uint32_t> ids_;
    Random random_{2};
    int hits_ = 0;
};

// ---- types -------------------------------------------------------------------------------------------------

/// Why nothing was made: a fault, unless the type merely has no use for these values, or an example's file is not there.
void sayWhyNotMade(const char* kind, const std::string& from, const scene::Diagnostics& diagnostics,
                   CheckReport& report, Faults& faults) {
    for (const scene::Diagnostic& d : diagnostics.all()) {
        if (d.severity != scene::Severity::error) continue;
        const std::string what = std::string(kind) + " from " + from + ": " + d.message;
        if (d.code == kValueRefused || d.code == kNoSuchFile || d.code == kMeshFile ||
            d.code == kImageFile)
            report.skipped.push_back(what);
        else
            faults.add("cannot make a " + what);
        return;
    }
}

void checkShape(Catalog& catalog, const scene::Instance& instance, const std::string& from,
                int rays, CheckReport& report, Faults& faults) {
    scene::Description description;
    scene::Object object;
    object.name = instance.type;
    object.shape = instance;
    description.objects.push_back(object);
    scene::Diagnostics diagnostics;
    const auto world = lower(description, catalog, diagnostics);
    if (!world) return sayWhyNotMade("shape", from, diagnostics, report, faults);
    const auto& primitives = world->primitives;
    report.checked.push_back("a shape from " + from + ": " + std::to_string(primitives.count()) +
                             " primitives");
    if (primitives.count() == 0) faults.add("the shape made from " + from + " has no geometry");
    for (const auto& custom : primitives.customs.shapes) {
        CustomCheck check(custom->shape, rays, faults);
        check.run();
        report.checked.push_back(std::to_string(rays) + " rays against a custom shape, " +
                                 std::to_string(check.hits()) + " hits");
    }
}

void checkTexture(Catalog& catalog, const scene::Instance& instance, const std::string& from,
                  int rays, CheckReport& report, Faults& faults) {
    scene::Description description;
    description.textures.push_back({instance.type, instance});
    scene::Diagnostics diagnostics;
    const auto world = lower(description, catalog, diagnostics);
    if (!world) return sayWhyNotMade("texture", from, diagnostics, report, faults);
    const material::Texture& texture = *world->textures[0];

    Random random(3);
    std::vector<rt_surface_point> points(static_cast<std::size_t>(rays));
    const double scales[] = {1, 1, 1000, 0, 1e9};
    for (int i = 0; i < rays; ++i) {
        rt_surface_point& point = points[static_cast<std::size_t>(i)];
        const double scale = scales[i % 5];
        for (double* v : {point.object, point.world})
            for (int k = 0; k < 3; ++k) v[k] = scale * random.symmetric();
        for (double& uv : point.uv)
            uv = i % 4 == 0 ? scale * random.symmetric() : (random.symmetric() + 1) / 2;
        if (i % 11 == 0) point.uv[i & 1] = i % 3 == 0 ? 0 : 1; // the very edges
    }
    const auto evaluate = [&] {
        std::vector<double> rgb(3 * points.size());
        texture.type->evaluate(texture.state, points.data(),
                               static_cast<std::uint32_t>(points.size()), rgb.data());
        return rgb;
    };
    const std::vector<double> all = evaluate();
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (!std::isfinite(all[i]))
            faults.add("the texture is not finite everywhere");
        else if (all[i] < 0)
            faults.add("the texture is negative somewhere");
    }
    std::vector<double> single(all.size()), other;
    for (std::size_t i = 0; i < points.size(); ++i)
        texture.type->evaluate(texture.state, &points[i], 1, &single[3 * i]);
    const auto equal = [&](const std::vector<double>& rgb) {
        return std::memcmp(rgb.data(), all.data(), all.size() * sizeof(double)) == 0;
    };
    if (!equal(single))
        faults.add("the texture's colors depend on how many points are asked for at once");
    std::thread thread([&] { other = evaluate(); });
    const std::vector<double> mine = evaluate();
    thread.join();
    if (!equal(mine) || !equal(other)) faults.add("two threads get different colors");
    report.checked.push_back("a texture from " + from + " at " + std::to_string(rays) + " points");
}

/// The instance with every value by default, or the name of a row that has none.
std::variant<scene::Instance, std::string> defaults(const rt_module& module,
                                                    std::span<const rt_param> rows) {
    scene::Instance instance{module.name, {}, {}, rows};
    for (const rt_param& row : rows) {
        const auto value = scene::defaultValue(row);
        if (!std::holds_alternative<scene::Value>(value)) return std::string(row.name);
        instance.values.push_back(std::get<scene::Value>(value));
    }
    return instance;
}

} // namespace

CheckReport checkModule(Catalog& catalog, const std::string& name,
                        const std::vector<scene::Instance>& examples, int rays) {
    CheckReport report;
    const ModuleInfo info = catalog.open(name);
    if (info.module == nullptr) {
        report.faults.push_back(info.refusal + ".");
        return report;
    }
    Faults faults(report);
    const rt_module& module = *info.module;
    std::span<const rt_param> rows;
    if (module.shape != nullptr)
        rows = {module.shape->params, module.shape->param_count};
    else if (module.texture != nullptr)
        rows = {module.texture->params, module.texture->param_count};
    else
        rows = {module.loader->params, module.loader->param_count};
    checkModuleText(module, faults);
    checkRows(rows, faults);
    report.checked.push_back("the module and " + std::to_string(rows.size()) + " parameters");
    if (module.loader != nullptr) {
        report.skipped.push_back("a loader's geometry is checked when it loads a file");
        return report;
    }
    const auto check = [&](const scene::Instance& instance, const std::string& from) {
        if (module.shape != nullptr)
            checkShape(catalog, instance, from, rays, report, faults);
        else
            checkTexture(catalog, instance, from, rays, report, faults);
    };
    const auto byDefault = defaults(module, rows);
    if (const auto* instance = std::get_if<scene::Instance>(&byDefault))
        check(*instance, "its defaults");
    else
        report.skipped.push_back("nothing was made from the defaults: '" +
                                 std::get<std::string>(byDefault) + "' has none");
    for (std::size_t i = 0; i < examples.size(); ++i)
        check(examples[i], "example " + std::to_string(i + 1));
    return report;
}

} // namespace rt::plugin_host
