// C++20 sugar over plugin.h: a plugin is a struct of parameters, rows that fill it, one function,
// one macro. Header-only, links nothing; no type declared here crosses the boundary. The guide is
// plugins/README.md.
#pragma once
#include <rt/plugin.h>

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <exception>
#include <limits>
#include <new>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace rt {

// ---- values
// ---------------------------------------------------------------------------------------------

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Bound on the relative error of n rounded operations in a row [Higham 2002, lemma 3.1].
constexpr double gamma(int n) {
    constexpr double u = std::numeric_limits<double>::epsilon() / 2;
    return n * u / (1 - n * u);
}

struct Radians {
    double value = 0;
};

struct Vector3 {
    double x = 0, y = 0, z = 0;

    friend constexpr Vector3 operator+(Vector3 a, Vector3 b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    friend constexpr Vector3 operator-(Vector3 a, Vector3 b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    friend constexpr Vector3 operator-(Vector3 a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vector3 operator*(Vector3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
    friend constexpr Vector3 operator*(double s, Vector3 a) { return a * s; }
    friend constexpr Vector3 operator/(Vector3 a, double s) { return {a.x / s, a.y / s, a.z / s}; }
    friend constexpr bool operator==(Vector3, Vector3) = default;
};

struct Vector2 {
    double x = 0, y = 0;
};

constexpr double dot(Vector3 a, Vector3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vector3 cross(Vector3 a, Vector3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vector3 a) { return std::sqrt(dot(a, a)); }
inline Vector3 normalize(Vector3 a) { return a / length(a); }
constexpr Vector3 vector(const double v[3]) { return {v[0], v[1], v[2]}; }

/// Right-handed, orthonormal.
struct Basis {
    Vector3 u, v, w;
};

/// A basis whose w is `unit` [Duff et al. 2017, JCGT 6(1)].
inline Basis basisAbout(Vector3 unit) {
    const double sign = std::copysign(1.0, unit.z), a = -1 / (sign + unit.z),
                 b = unit.x * unit.y * a;
    return {{1 + sign * unit.x * unit.x * a, sign * b, -sign * unit.x},
            {b, sign + unit.y * unit.y * a, -unit.y},
            unit};
}

/// The angle of (x, y) counter-clockwise from the x axis as a share of a turn, in [0, 1); 0 for (0, 0). Within 4 ulp of 1,
/// and of + - * / only, so the same bits on every machine: the C library's atan2 differs between processors.
inline double turns(double y, double x) {
    // atan(z) = atan(c) + atan((z - c) / (1 + z c)) with c = k / 8 the multiple nearest to z in [0, 1]; the Taylor series
    // of the rest, |w| <= 1/16, is exact to 2^-60 after w^13.
    constexpr double kAtan[9] = {0,
                                 0.12435499454676143503,
                                 0.24497866312686415417,
                                 0.35877067027057222040,
                                 0.46364760900080611621,
                                 0.55859931534356243597,
                                 0.64350110879328438680,
                                 0.71882999962162450542,
                                 0.78539816339744830962};
    constexpr double kTurn = 6.28318530717958647693;
    const double ax = std::fabs(x), ay = std::fabs(y);
    if (!(ax > 0 || ay > 0)) return 0;
    const bool steep = ay > ax;
    const double z = steep ? ax / ay : ay / ax;
    const int k = static_cast<int>(8 * z + 0.5);
    const double c = k / 8.0, w = (z - c) / (1 + z * c), q = w * w;
    double series = 1.0 / 13;
    for (int n = 11; n >= 1; n -= 2) series = 1.0 / n - q * series;
    double share = (kAtan[k] + w * series) / kTurn; // in [0, 1/8]
    if (steep) share = 0.25 - share;
    if (x < 0) share = 0.5 - share;
    if (y < 0) share = 1 - share;
    return share < 1 ? share : 0;
}

/// Linear Rec. 709.
struct Color {
    double r = 0, g = 0, b = 0;

    friend constexpr Color operator+(Color x, Color y) { return {x.r + y.r, x.g + y.g, x.b + y.b}; }
    friend constexpr Color operator*(Color x, Color y) { return {x.r * y.r, x.g * y.g, x.b * y.b}; }
    friend constexpr Color operator*(Color x, double s) { return {x.r * s, x.g * s, x.b * s}; }
    friend constexpr Color operator*(double s, Color x) { return x * s; }
    friend constexpr bool operator==(Color, Color) = default;
};

/// Absolute path of a file, or empty when the scene gives none.
struct File {
    std::string path;
    explicit operator bool() const { return !path.empty(); }
};

/// A texture of the scene, or nothing when the scene names none.
struct TextureReference {
    const rt_texture* texture = nullptr;

    explicit operator bool() const { return texture != nullptr; }
    /// Precondition: there is a texture. [render]
    Color at(const rt_surface_point& point) const {
        double rgb[3];
        texture->type->evaluate(texture->state, &point, 1, rgb);
        return {rgb[0], rgb[1], rgb[2]};
    }
};

/// A sheet, or a closed body with an inside. As a parameter: choice<…>("kind", "surface|solid", …).
enum class Kind : std::uint32_t { surface = RT_SURFACE, solid = RT_SOLID };

struct Box {
    Vector3 lower, upper;
};

// ---- errors
// ---------------------------------------------------------------------------------------------

/// Thrown from a plugin's function; reported at the place in the scene where the parameter has its
/// value.
struct ParameterError : std::runtime_error {
    ParameterError(const char* parameter, const std::string& why)
        : std::runtime_error(why), name(parameter) {}
    const char* name;
};

/// The value is right, but more than the user lets the host take, such as Host::maxTexels.
struct LimitError : ParameterError {
    using ParameterError::ParameterError;
};

namespace detail {
/// The host refused and has said why already.
struct HostRefused {};

inline void check(rt_status status) {
    if (status == RT_OUT_OF_MEMORY) throw std::bad_alloc();
    if (status != RT_OK) throw HostRefused();
}

inline std::uint32_t count32(std::size_t n) {
    if (n > std::numeric_limits<std::uint32_t>::max())
        throw std::length_error("more than 2^32 - 1 elements in one shape");
    return static_cast<std::uint32_t>(n);
}
} // namespace detail

// ---- parameters
// -----------------------------------------------------------------------------------------

struct Limits {
    double min, max;
    std::uint32_t flags = 0;
};
inline constexpr Limits unlimited{-kInfinity, kInfinity};
inline constexpr Limits positive{0, kInfinity, RT_MIN_EXCLUSIVE};
inline constexpr Limits notNegative{0, kInfinity};
inline constexpr Limits colorRange{0, 1e6};
constexpr Limits range(double min, double max) { return {min, max}; }
constexpr Limits above(double min) { return {min, kInfinity, RT_MIN_EXCLUSIVE}; }

/// As a row's default: the scene has to give a value.
inline constexpr const char* required = nullptr;
/// As the default of a text, file or texture: there is none.
inline constexpr const char* absent = "";

template <class T> struct Parameter {
    using Owner = T;
    rt_param row;
    void (*store)(T&, const rt_value&);
};

namespace detail {
template <class M> struct Member;
template <class T, class V> struct Member<V T::*> {
    using Owner = T;
    using Value = V;
};

template <class V> constexpr bool unsupported = false;

template <class V> constexpr std::uint32_t typeOf() {
    if constexpr (std::same_as<V, bool>)
        return RT_BOOL;
    else if constexpr (std::is_enum_v<V>)
        return RT_CHOICE;
    else if constexpr (std::integral<V>)
        return RT_INTEGER;
    else if constexpr (std::same_as<V, double> || std::same_as<V, Radians>)
        return RT_REAL;
    else if constexpr (std::same_as<V, Vector3> || std::same_as<V, std::array<double, 3>>)
        return RT_VECTOR3;
    else if constexpr (std::same_as<V, Color>)
        return RT_COLOR;
    else if constexpr (std::same_as<V, std::string>)
        return RT_TEXT;
    else if constexpr (std::same_as<V, File>)
        return RT_FILE;
    else if constexpr (std::same_as<V, TextureReference>)
        return RT_TEXTURE;
    else if constexpr (std::same_as<V, std::vector<Vector3>>)
        return RT_VECTOR3_LIST;
    else if constexpr (std::same_as<V, std::vector<std::vector<std::int64_t>>>)
        return RT_INTEGER_LISTS;
    else
        static_assert(
            unsupported<V>,
            "no parameter type fills a member of this type (numbers are double, not float)");
}

template <class V> void assign(V& to, const rt_value& from) {
    constexpr std::uint32_t type = typeOf<V>();
    if constexpr (std::same_as<V, bool>)
        to = from.integer != 0;
    else if constexpr (type == RT_INTEGER || type == RT_CHOICE)
        to = static_cast<V>(from.integer);
    else if constexpr (std::same_as<V, Radians>)
        to.value = from.real;
    else if constexpr (type == RT_REAL)
        to = from.real;
    else if constexpr (type == RT_VECTOR3 || type == RT_COLOR)
        to = {from.vector[0], from.vector[1], from.vector[2]};
    else if constexpr (type == RT_TEXT)
        to = from.text;
    else if constexpr (type == RT_FILE)
        to.path = from.text;
    else if constexpr (type == RT_TEXTURE)
        to.texture = from.texture;
    else if constexpr (type == RT_VECTOR3_LIST) {
        to.resize(from.list.size);
        for (std::size_t i = 0; i < to.size(); ++i) to[i] = vector(from.list.items + 3 * i);
    } else {
        to.resize(from.list.size);
        const double* next = from.list.items;
        for (std::size_t i = 0; i < to.size(); ++i)
            for (std::uint32_t k = 0; k < from.list.counts[i]; ++k)
                to[i].push_back(static_cast<std::int64_t>(*next++));
    }
}

constexpr bool isSnakeCase(std::string_view name) {
    if (name.empty() || name[0] < 'a' || name[0] > 'z') return false;
    for (char c : name)
        if (!((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_')) return false;
    return true;
}

template <auto M>
constexpr auto row(const char* name, std::uint32_t unit, const char* fallback, const char* choices,
                   Limits limits, std::uint32_t flags, const char* doc) {
    using T = typename Member<decltype(M)>::Owner;
    using V = typename Member<decltype(M)>::Value;
    // Rows are constants, so each throw below is a compile error.
    if (!isSnakeCase(name)) throw "a parameter's name is snake_case";
    if (std::string_view(doc).empty() || std::string_view(doc).back() != '.')
        throw "a parameter's doc is a sentence";
    if (!(limits.min <= limits.max)) throw "a parameter's limits are in order";
    if constexpr (std::integral<V> && !std::same_as<V, bool>) {
        using Range = std::numeric_limits<V>;
        if (limits.min < static_cast<double>(Range::min()))
            limits.min = static_cast<double>(Range::min());
        if constexpr (sizeof(V) < 8)
            if (limits.max > static_cast<double>(Range::max()))
                limits.max = static_cast<double>(Range::max());
    }
    return Parameter<T>{{name, fallback, choices, doc, limits.min, limits.max, typeOf<V>(), unit,
                         limits.flags | flags, 0},
                        [](T& object, const rt_value& value) { assign(object.*M, value); }};
}
} // namespace detail

/// A number or vector: YAML key, unit, default as YAML text, limits, one sentence. Radians are
/// RT_UNIT_ANGLE, written "45deg", with limits in degrees.
template <auto M>
constexpr auto parameter(const char* name, std::uint32_t unit, const char* fallback, Limits limits,
                         const char* doc) {
    using V = typename detail::Member<decltype(M)>::Value;
    if (std::same_as<V, Radians> != (unit == RT_UNIT_ANGLE))
        throw "angles, and only angles, are Radians";
    return detail::row<M>(name, unit, fallback, nullptr, limits, 0, doc);
}

/// Bool, colour, text, file, texture or list: no unit to state; colours lie in [0, 1e6].
template <auto M>
constexpr auto parameter(const char* name, const char* fallback, const char* doc) {
    using V = typename detail::Member<decltype(M)>::Value;
    constexpr bool isColor = std::same_as<V, Color>;
    static_assert(!std::same_as<V, Radians>, "an angle states RT_UNIT_ANGLE and its limits");
    return detail::row<M>(name, isColor ? RT_UNIT_LINEAR_RGB : RT_UNIT_NONE, fallback, nullptr,
                          isColor ? colorRange : unlimited, 0, doc);
}

/// One of "first|second|…", into an enum whose values count from 0 in that order.
template <auto M>
constexpr auto choice(const char* name, const char* choices, const char* fallback,
                      const char* doc) {
    static_assert(std::is_enum_v<typename detail::Member<decltype(M)>::Value>,
                  "a choice fills an enum");
    return detail::row<M>(name, RT_UNIT_NONE, fallback, choices, unlimited, 0, doc);
}

/// A file that Geometry::load gives to a loader.
template <auto M>
constexpr auto loadedFile(const char* name, const char* fallback, const char* doc) {
    static_assert(std::same_as<typename detail::Member<decltype(M)>::Value, File>,
                  "a loaded file fills a File");
    return detail::row<M>(name, RT_UNIT_NONE, fallback, nullptr, unlimited, RT_LOADS, doc);
}

/// The rows of a type that has none.
template <class T> inline constexpr std::array<Parameter<T>, 0> noParameters{};

// ---- geometry
// -------------------------------------------------------------------------------------------

/// Triangles in object space, counter-clockwise seen from outside. Optional arrays are left empty.
struct Mesh {
    using Corners = std::array<std::uint32_t, 3>;

    std::vector<Vector3> positions;
    std::vector<Corners> triangles;
    std::vector<Vector3> normals; // unit
    std::vector<Corners>
        normalIndices; // per triangle, RT_NO_INDEX: flat corner; empty: as `triangles`
    std::vector<Vector2> uvs;
    std::vector<Corners> uvIndices; // per triangle, RT_NO_INDEX: (0, 0); empty: as `triangles`
    std::vector<std::uint32_t>
        materials; // per triangle, from Geometry::material; RT_NO_INDEX: the object's
    std::vector<std::uint32_t> sourceFaces; // per triangle, number of its face in the file, from 0
    Kind kind = Kind::surface;
};

/// What a material file says; the same meaning as in the scene language.
struct Material {
    std::string name;
    Color color{1, 1, 1}, diffuse, specular, transmission, environment;
    double shininess = 20, ior = 1;
    File colorFile; // image that multiplies color
};

/// What a plugin may tell the user that is no error.
class Host {
public:
    explicit Host(const rt_host* host) : host_(host) {}
    /// One sentence: what was repaired, or ignored.
    void note(const std::string& sentence) { host_->note(host_, sentence.c_str()); }
    /// Most texels that one image may have.
    std::uint64_t maxTexels() const {
        return RT_HAS(host_, rt_host, max_texels) ? host_->max_texels : std::uint64_t{1} << 26;
    }
    /// One sentence: what is likely a mistake in the user's file.
    void warn(const std::string& sentence) {
        const bool can = RT_HAS(host_, rt_host, warn);
        (can ? host_->warn : host_->note)(host_, sentence.c_str());
    }

protected:
    const rt_host* host_;
};

/// A primitive of a custom shape. All in object space; [render], so nothing allocates, locks or
/// throws.
///   Box bounds() const                                     holds every point of the surface
///   bool intersect(const rt_ray&, rt_hit&) const           closest hit with t_min < t < t_max; on
///   a miss: false and
///                                                          the hit untouched; a NaN is a miss
///   std::uint32_t crossings(const rt_ray&, double* t, std::uint32_t capacity) const optional;
///   every crossing
template <class T>
concept CustomPrimitive = requires(const T& primitive, const rt_ray& ray, rt_hit& hit) {
    { primitive.bounds() } -> std::convertible_to<Box>;
    { primitive.intersect(ray, hit) } -> std::same_as<bool>;
};

template <class T>
concept HasCrossings = requires(const T& primitive, const rt_ray& ray, double* t,
                                std::uint32_t capacity) {
    { primitive.crossings(ray, t, capacity) } -> std::same_as<std::uint32_t>;
};

/// Text on its way to a file that the host writes, or to nowhere.
class TextOut {
public:
    explicit TextOut(rt_text_sink* sink) : sink_(sink) {}
    explicit operator bool() const { return sink_ != nullptr; }
    void write(std::string_view text) {
        if (sink_) detail::check(sink_->write(sink_, text.data(), text.size()));
    }

private:
    rt_text_sink* sink_;
};

/// The only door through which a shape or loader hands over geometry. Everything is copied before a
/// call returns.
class Geometry : public Host {
public:
    Geometry(const rt_host* host, rt_sink* sink, const rt_param* params, std::size_t paramCount)
        : Host(host), sink_(sink), params_(params), paramCount_(paramCount) {}

    void mesh(const Mesh& mesh) {
        const auto triangles = mesh.triangles.size();
        for (std::size_t n : {mesh.normalIndices.size(), mesh.uvIndices.size(),
                              mesh.materials.size(), mesh.sourceFaces.size()})
            if (n != 0 && n != triangles)
                throw std::logic_error("an array of the mesh has not one entry per triangle");
        rt_mesh m{};
        m.struct_size = sizeof m;
        m.kind = static_cast<std::uint32_t>(mesh.kind);
        m.vertex_count = detail::count32(mesh.positions.size());
        m.triangle_count = detail::count32(triangles);
        m.positions = mesh.positions.empty() ? nullptr : &mesh.positions[0].x;
        m.indices = corners(mesh.triangles);
        m.normal_count = detail::count32(mesh.normals.size());
        m.uv_count = detail::count32(mesh.uvs.size());
        m.normals = mesh.normals.empty() ? nullptr : &mesh.normals[0].x;
        m.normal_indices = corners(mesh.normalIndices);
        m.uvs = mesh.uvs.empty() ? nullptr : &mesh.uvs[0].x;
        m.uv_indices = corners(mesh.uvIndices);
        m.materials = mesh.materials.empty() ? nullptr : mesh.materials.data();
        m.source_faces = mesh.sourceFaces.empty() ? nullptr : mesh.sourceFaces.data();
        detail::check(sink_->add_mesh(sink_, &m));
    }

    void sphere(Vector3 center, double radius) {
        spheres({{{center.x, center.y, center.z}, radius}});
    }
    void spheres(const std::vector<rt_sphere>& spheres) {
        detail::check(sink_->add_spheres(sink_, spheres.data(), detail::count32(spheres.size())));
    }

    void parallelogram(Vector3 origin, Vector3 u, Vector3 v) {
        parallelograms({{{origin.x, origin.y, origin.z}, {u.x, u.y, u.z}, {v.x, v.y, v.z}}});
    }
    void parallelograms(const std::vector<rt_parallelogram>& parallelograms) {
        detail::check(sink_->add_parallelograms(sink_, parallelograms.data(),
                                                detail::count32(parallelograms.size())));
    }

    template <CustomPrimitive T> void custom(T primitive, Kind kind) {
        std::vector<T> one;
        one.push_back(std::move(primitive));
        custom(std::move(one), kind);
    }
    /// One indirect call per octree leaf, then this loop with T's functions inlined.
    template <CustomPrimitive T> void custom(std::vector<T> primitives, Kind kind) {
        rt_custom c{};
        c.struct_size = sizeof c;
        c.kind = static_cast<std::uint32_t>(kind);
        c.primitive_count = detail::count32(primitives.size());
        c.bounds = [](const void* data, std::uint32_t i, double lower[3],
                      double upper[3]) noexcept {
            const Box box = at<T>(data, i).bounds();
            lower[0] = box.lower.x, lower[1] = box.lower.y, lower[2] = box.lower.z;
            upper[0] = box.upper.x, upper[1] = box.upper.y, upper[2] = box.upper.z;
        };
        c.intersect = [](const void* data, const std::uint32_t* ids, std::uint32_t count,
                         const rt_ray* ray, rt_hit* hit) noexcept -> std::int32_t {
            rt_ray shrinking = *ray;
            bool found = false;
            for (std::uint32_t k = 0; k < count; ++k) {
                rt_hit candidate;
                if (!at<T>(data, ids[k]).intersect(shrinking, candidate)) continue;
                if (found && candidate.t == hit->t && ids[k] > hit->primitive) continue;
                *hit = candidate;
                hit->primitive = ids[k];
                hit->reserved = 0;
                // One step wider than the best, so that an equal hit of a lower primitive can still
                // win.
                const double wider = std::nextafter(hit->t, kInfinity);
                shrinking.t_max = wider < ray->t_max ? wider : ray->t_max;
                found = true;
            }
            return found;
        };
        if constexpr (HasCrossings<T>)
            c.crossings = [](const void* data, std::uint32_t i, const rt_ray* ray, double* t,
                             std::uint32_t capacity) noexcept -> std::uint32_t {
                return at<T>(data, i).crossings(*ray, t, capacity);
            };
        c.release = [](void* data) noexcept { delete static_cast<std::vector<T>*>(data); };
        auto* owned = new std::vector<T>(std::move(primitives));
        c.data = owned;
        if (const rt_status status = sink_->add_custom(sink_, &c); status != RT_OK) {
            delete owned;
            detail::check(status);
        }
    }

    /// Handle for Mesh::materials.
    std::uint32_t material(const Material& material) {
        rt_material m{};
        m.struct_size = sizeof m;
        m.name = material.name.c_str();
        const auto put = [](double to[3], Color from) {
            to[0] = from.r, to[1] = from.g, to[2] = from.b;
        };
        put(m.color, material.color), put(m.diffuse, material.diffuse),
            put(m.specular, material.specular);
        put(m.transmission, material.transmission), put(m.environment, material.environment);
        m.shininess = material.shininess;
        m.ior = material.ior;
        m.color_file = material.colorFile.path.c_str();
        std::uint32_t handle = RT_NO_INDEX;
        detail::check(sink_->add_material(sink_, &m, &handle));
        return handle;
    }

    /// Lets the loader of the file of parameter `parameter` (a loadedFile row that is not absent)
    /// put its geometry here.
    void load(const char* parameter, Kind kind) {
        for (std::size_t i = 0; i < paramCount_; ++i)
            if (std::strcmp(params_[i].name, parameter) == 0)
                return detail::check(host_->load(host_, static_cast<std::int32_t>(i),
                                                 static_cast<std::uint32_t>(kind), sink_));
        throw std::logic_error(std::string("no parameter '") + parameter + "' to load");
    }

private:
    template <class T> static const T& at(const void* data, std::uint32_t i) {
        return (*static_cast<const std::vector<T>*>(data))[i];
    }
    static const std::uint32_t* corners(const std::vector<Mesh::Corners>& list) {
        return list.empty() ? nullptr : list[0].data();
    }

    rt_sink* sink_;
    const rt_param* params_;
    std::size_t paramCount_;
};

// ---- what the macros make
// -------------------------------------------------------------------------------

namespace detail {
template <class T, std::size_t N>
constexpr auto rows(const std::array<Parameter<T>, N>& parameters) {
    std::array<rt_param, N> out{};
    for (std::size_t i = 0; i < N; ++i) out[i] = parameters[i].row;
    return out;
}

template <const auto& P>
using OwnerOf = typename std::remove_cvref_t<decltype(P)>::value_type::Owner;

template <const auto& P> OwnerOf<P> fill(const rt_value* values) {
    OwnerOf<P> object{};
    for (std::size_t i = 0; i < P.size(); ++i) P[i].store(object, values[i]);
    return object;
}

/// The exception barrier: nothing is thrown past this function.
template <const auto& P, class Body> rt_status barrier(const rt_host* host, Body&& body) noexcept {
    try {
        body();
        return RT_OK;
    } catch (const HostRefused&) {
        return RT_FAILED;
    } catch (const std::bad_alloc&) {
        return RT_OUT_OF_MEMORY;
    } catch (const ParameterError& e) {
        std::int32_t parameter = -1;
        for (std::size_t i = 0; i < P.size(); ++i)
            if (std::strcmp(P[i].row.name, e.name) == 0) parameter = static_cast<std::int32_t>(i);
        const bool limit =
            dynamic_cast<const LimitError*>(&e) != nullptr && RT_HAS(host, rt_host, exceeds);
        return (limit ? host->exceeds : host->fail)(host, parameter, e.what());
    } catch (const std::exception& e) {
        return host->fail(host, -1, e.what());
    } catch (...) {
        return host->fail(host, -1, "threw something that is no std::exception");
    }
}

template <const auto& P, const auto& Rows, auto Lower>
rt_status lower(const rt_host* host, const rt_value* values, rt_sink* sink) noexcept {
    return barrier<P>(host, [&] {
        Geometry out(host, sink, Rows.data(), Rows.size());
        Lower(fill<P>(values), out);
    });
}

template <const auto& P, const auto& Rows, auto Load>
rt_status load(const rt_host* host, const char* path, std::uint32_t kind, const rt_value* values,
               rt_sink* sink) noexcept {
    return barrier<P>(host, [&] {
        Geometry out(host, sink, Rows.data(), Rows.size());
        Load(fill<P>(values), File{path}, static_cast<Kind>(kind), out);
    });
}

template <const auto& P, auto Repair>
rt_status repair(const rt_host* host, const char* path, const rt_value* values, rt_text_sink* mesh,
                 rt_text_sink* report, std::uint32_t flags) noexcept {
    return barrier<P>(host, [&] {
        TextOut meshOut(mesh), reportOut(report);
        Repair(fill<P>(values), File{path}, meshOut, reportOut, (flags & RT_REPORT_FACES) != 0);
    });
}

template <const auto& P, auto Create> struct TextureOf {
    using State = std::remove_cvref_t<decltype(Create(std::declval<const OwnerOf<P>&>(),
                                                      std::declval<Host&>()))>;

    static rt_status create(const rt_host* host, const rt_value* values, void** state) noexcept {
        return barrier<P>(host, [&] {
            Host notes(host);
            *state = new State(Create(fill<P>(values), notes));
        });
    }
    static void evaluate(const void* state, const rt_surface_point* points, std::uint32_t count,
                         double* rgb) noexcept {
        for (std::uint32_t i = 0; i < count; ++i) {
            const Color color = static_cast<const State*>(state)->at(points[i]);
            rgb[3 * i] = color.r, rgb[3 * i + 1] = color.g, rgb[3 * i + 2] = color.b;
        }
    }
    static void destroy(void* state) noexcept { delete static_cast<State*>(state); }

    /// Textures made of texels say how many: std::array<std::uint32_t, 2> resolution() const.
    static constexpr auto resolution() -> void (*)(const void*, std::uint32_t*) {
        if constexpr (requires(const State& s) { std::array<std::uint32_t, 2>(s.resolution()); })
            return [](const void* state, std::uint32_t* size) {
                const std::array<std::uint32_t, 2> r =
                    static_cast<const State*>(state)->resolution();
                size[0] = r[0], size[1] = r[1];
            };
        else
            return nullptr;
    }
};

constexpr rt_module module(const char* name, const char* version, const char* doc,
                           const char* example, const rt_shape* shape,
                           const rt_texture_type* texture, const rt_loader* loader) {
    if (!isSnakeCase(name)) throw "a plugin's name is snake_case";
    if (std::string_view(doc).empty() || std::string_view(doc).back() != '.')
        throw "a plugin's doc is a sentence";
    return {RT_ABI_MAGIC, RT_ABI_MAJOR, RT_ABI_MINOR, RT_ABI_LAYOUT, sizeof(rt_module), name,
            version,      doc,          example,      shape,         texture,           loader};
}
} // namespace detail
} // namespace rt

// PARAMETERS is a namespace-scope `constexpr std::array` of rows (or rt::noParameters<T>), DOC one
// sentence, EXAMPLE a few lines of YAML. One macro per file, outside any namespace.

/// LOWER: void (const T&, rt::Geometry&)
#define RT_SHAPE_PLUGIN(NAME, VERSION, PARAMETERS, LOWER, DOC, EXAMPLE)                            \
    namespace {                                                                                    \
    constexpr auto kRtRows = rt::detail::rows(PARAMETERS);                                         \
    constexpr rt_shape kRtShape{sizeof(rt_shape), static_cast<std::uint32_t>(kRtRows.size()),      \
                                kRtRows.data(), &rt::detail::lower<PARAMETERS, kRtRows, LOWER>};   \
    }                                                                                              \
    extern "C" RT_EXPORT constexpr rt_module rt_plugin_entry =                                     \
        rt::detail::module(NAME, VERSION, DOC, EXAMPLE, &kRtShape, nullptr, nullptr);

/// CREATE: State (const T&, rt::Host&), where State has `rt::Color at(const rt_surface_point&)
/// const` [render]
#define RT_TEXTURE_PLUGIN(NAME, VERSION, PARAMETERS, CREATE, DOC, EXAMPLE)                         \
    namespace {                                                                                    \
    constexpr auto kRtRows = rt::detail::rows(PARAMETERS);                                         \
    using RtTexture = rt::detail::TextureOf<PARAMETERS, CREATE>;                                   \
    constexpr rt_texture_type kRtTexture{                                                          \
        sizeof(rt_texture_type), static_cast<std::uint32_t>(kRtRows.size()),                       \
        kRtRows.data(),          &RtTexture::create,                                               \
        &RtTexture::evaluate,    &RtTexture::destroy,                                              \
        RtTexture::resolution()};                                                                  \
    }                                                                                              \
    extern "C" RT_EXPORT constexpr rt_module rt_plugin_entry =                                     \
        rt::detail::module(NAME, VERSION, DOC, EXAMPLE, nullptr, &kRtTexture, nullptr);

/// EXTENSIONS: "obj|ply". LOAD: void (const T&, const rt::File&, rt::Kind, rt::Geometry&)
#define RT_LOADER_PLUGIN(NAME, VERSION, EXTENSIONS, PARAMETERS, LOAD, DOC, EXAMPLE)                \
    RT_LOADER_PLUGIN_(NAME, VERSION, EXTENSIONS, PARAMETERS, LOAD, nullptr, 0, DOC, EXAMPLE)

/// As RT_LOADER_PLUGIN. REPAIR: void (const T&, const rt::File&, rt::TextOut& mesh, rt::TextOut& report,
/// bool everyFace). TRAITS: 0 or RT_LOADS_CONCURRENTLY.
#define RT_REPAIRING_LOADER_PLUGIN(NAME, VERSION, EXTENSIONS, PARAMETERS, LOAD, REPAIR, TRAITS,    \
                                   DOC, EXAMPLE)                                                   \
    RT_LOADER_PLUGIN_(NAME, VERSION, EXTENSIONS, PARAMETERS, LOAD,                                 \
                      (&rt::detail::repair<PARAMETERS, REPAIR>), TRAITS, DOC, EXAMPLE)

#define RT_LOADER_PLUGIN_(NAME, VERSION, EXTENSIONS, PARAMETERS, LOAD, REPAIR_ENTRY, TRAITS, DOC,  \
                          EXAMPLE)                                                                 \
    namespace {                                                                                    \
    constexpr auto kRtRows = rt::detail::rows(PARAMETERS);                                         \
    constexpr rt_loader kRtLoader{sizeof(rt_loader),                                               \
                                  static_cast<std::uint32_t>(kRtRows.size()),                      \
                                  kRtRows.data(),                                                  \
                                  EXTENSIONS,                                                      \
                                  &rt::detail::load<PARAMETERS, kRtRows, LOAD>,                    \
                                  REPAIR_ENTRY,                                                    \
                                  TRAITS,                                                          \
                                  0};                                                              \
    }                                                                                              \
    extern "C" RT_EXPORT constexpr rt_module rt_plugin_entry =                                     \
        rt::detail::module(NAME, VERSION, DOC, EXAMPLE, nullptr, nullptr, &kRtLoader);
