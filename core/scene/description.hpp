// A validated scene: every number finite and in range, every name resolved, angles in radians, paths absolute.
#pragma once
#include <core/numeric/angle.hpp>
#include <core/numeric/box.hpp>
#include <core/numeric/colour.hpp>
#include <core/numeric/transform.hpp>
#include <core/scene/diagnostic.hpp>
#include <rt/plugin.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace rt::scene {

using numeric::AffineTransform;
using numeric::Box3d;
using numeric::LinearRgb;
using numeric::Radians;
using numeric::Vec3;

enum class Encoding : std::uint8_t { srgb, linear };
enum class Tone : std::uint8_t {
    limit,
    clamp
}; // limit: divide by the largest channel when it is over 1

struct Image {
    std::uint32_t width = 640, height = 480;
    Encoding encoding = Encoding::srgb;
    Tone tone = Tone::clamp;
    std::uint32_t bits = 8; // per channel, PNG only: 8 or 16
    std::string file;       // relative to the current folder; empty: <scene's stem>.png
};

struct Camera {
    Vec3 position{0}, forward{0, 1, 0}, up{0, 0, 1}; // forward and up: any length, not parallel
    double screenWidth = 1, screenHeight = 1, screenDistance = 1;

    // What the file says, where it says it so; resolve() turns them into the members above.
    std::optional<Vec3> lookAt;         // forward is lookAt - position
    std::optional<Radians> fieldOfView; // vertical; the screen is at distance 1
};

/// Screen and forward from fieldOfView and lookAt; `aspect` is the picture's width / height.
void resolve(Camera& camera, double aspect);

struct AntialiasNone {};
struct AntialiasFsaa4 {}; // 2x2 corner samples, each tone-limited, then averaged
struct AntialiasGrid {
    std::uint32_t n = 4;
}; // n x n per pixel
struct AntialiasMaxError {
    double rmse = 0.01;
};
using Antialias = std::variant<AntialiasNone, AntialiasFsaa4, AntialiasGrid, AntialiasMaxError>;

enum class Sampling : std::uint8_t { center, corner };
enum class NearPlane : std::uint8_t { none, screen }; // screen: rays start on the screen rectangle

struct Render {
    std::uint32_t depth = 5; // bounces after the primary ray
    Antialias antialias;
    bool smooth = false; // 2x2 mean of neighbours over the finished picture
    Sampling sampling = Sampling::center;
    NearPlane nearPlane = NearPlane::none;
    double cutoff = 0; // rays that can add less than this to a pixel are not traced; 0: all are
    std::uint32_t octreeMaxObjects = 16;
    double octreeMinSize = 0;
};

/// One value of a plugin's parameter row, in row order. monostate: absent.
struct Value {
    struct VectorList {
        std::vector<Vec3> items;
    };
    struct IntegerLists {
        std::vector<std::vector<std::int64_t>> entries;
    };
    std::variant<std::monostate, std::int64_t, double, Vec3, std::string, VectorList, IntegerLists>
        data;
    Location location; // of the value, or of the object's key when defaulted
};

/// A plugin type with its values. A texture reference is the texture's index (std::int64_t).
struct Instance {
    std::string type;
    std::vector<Value> values;
    Location location; // of the type's key
    std::span<const rt_param>
        rows; // of the values; the type's own, for as long as its catalog lives
};

struct Texture {
    std::string name;
    Instance instance;
};

enum class Mapping : std::uint8_t { hemisphere, latLong, legacyHemisphere };

struct Background {
    LinearRgb color{0, 0, 0};
    std::optional<std::uint32_t> texture; // index into textures
    Mapping mapping = Mapping::hemisphere;
    Vec3 center{0};    // legacyHemisphere
    double radius = 0; // legacyHemisphere

    /// Of a cross-fade: texture * (1 - share) + this one * share. Set by animation, never by a file.
    struct Fade {
        std::uint32_t texture;
        double share;
    };
    std::optional<Fade> fade;
};

struct PointLight {
    std::string name;
    Vec3 position{0};
    LinearRgb color{1, 1, 1};
    double brightness = 1; // multiplies color; >= 0
};

struct Material {
    std::string name;
    LinearRgb color{1, 1, 1};
    std::optional<std::uint32_t> colorTexture; // multiplies color
    LinearRgb diffuse, specular, transmission, environment;
    double shininess = 20;
    double ior = 1; // inside over outside
    Location location;
};

/// Where an object stands in the world: scaled, then turned by each rotation in turn, then moved.
struct Placement {
    struct Rotation {
        Vec3 axis{0, 0, 1}; // any length but 0
        Radians angle;
    };
    Vec3 scale{1}; // no component is 0
    std::vector<Rotation> rotations;
    Vec3 translation{0};
};

AffineTransform worldFromObject(const Placement& placement);

struct Object {
    std::string name; // unique; invented where the file has none
    Instance shape;
    std::optional<Instance> loader; // of the shape's RT_LOADS file
    std::optional<std::uint32_t>
        material; // index; none: what the file says, or the default material
    Placement placement;
    AffineTransform worldFromObject; // of the placement
    Location location;
};

// ---- animation: parsed and validated here, turned into poses by core/animation ----------------------------

struct FrameRange {
    std::uint32_t first = 0, last = 0;
}; // acts in steps first <= q < last

enum class Easing : std::uint8_t { linear, smooth };

struct Rotate {
    Vec3 center, axis;
    Radians angle;
}; // total over the range; positive: right-handed about axis
struct RotateSelf {
    std::optional<Vec3> axis;
    Radians angle;
}; // none: each primitive about its normal
struct Move {
    Vec3 position;
}; // the centre ends here
struct MoveRadius {
    Vec3 center;
    double distance;
}; // away from center
struct MoveDirect {
    Vec3 direction;
    double distance;
};
struct Keyframes {
    enum class Interpolation : std::uint8_t { linear, smooth, step };
    struct Key {
        std::uint32_t frame;
        std::vector<double> values;
    };
    std::vector<Key> keys; // by rising frame
    Interpolation interpolation = Interpolation::linear;
};
using Motion = std::variant<Rotate, RotateSelf, Move, MoveRadius, MoveDirect, Keyframes>;

/// A numeric parameter of a description; core/scene/parameter.hpp finds and sets it.
struct Parameter {
    enum class Owner : std::uint8_t {
        camera,
        background,
        light,
        material,
        texture,
        shape,
        loader,
        placement
    };
    Owner owner = Owner::camera;
    std::uint32_t index = 0; // light, material, texture; object for shape, loader and placement
    std::uint32_t value = 0; // texture, shape, loader: index into the instance's rows
    const struct Field* field = nullptr; // otherwise
    const rt_param* row = nullptr;       // type, unit and limits
    std::size_t components = 1;          // 1 or 3
};

enum class CameraPoint : std::uint8_t { position, front, top };

/// Faces first..last of a mesh in file order, inclusive. each: every face moves about its own centroid.
struct ObjectTarget {
    std::vector<std::uint32_t> objects;
    std::optional<std::array<std::uint32_t, 2>> faces;
    bool each = false;
};
struct CameraTarget {
    CameraPoint point;
};
/// Any numeric parameter, for keyframes only: "moon.radius", "lights.key.color", "materials.steel.diffuse", "camera.screen.width".
struct ParameterTarget {
    std::string path;
    Parameter parameter;
};
struct BackgroundFade {
    std::uint32_t texture;
};

struct Track {
    std::variant<ObjectTarget, CameraTarget, ParameterTarget, BackgroundFade> target;
    std::optional<Motion> motion; // none for a background fade
    FrameRange frames;
    Easing easing = Easing::linear;
    Location location;
};

struct Animation {
    std::uint32_t frames = 1; // number of images
    double fps = 24;
    std::vector<Track> tracks; // in file order
};

struct Description {
    std::string path; // of the scene file
    Image image;
    Camera camera;
    std::optional<Box3d> bounds;
    Render render;
    std::vector<Texture> textures;
    Background background;
    std::vector<PointLight> lights;
    std::vector<Material> materials;
    std::vector<Object> objects;
    std::optional<Animation> animation;
};

} // namespace rt::scene
