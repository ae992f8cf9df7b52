#include <core/scene/language.hpp>

#include <core/scene/values.hpp>

#include <array>
#include <limits>
#include <type_traits>

namespace rt::scene {
namespace {

// ---- rows ----------------------------------------------------------------------------------------------------

struct Limits {
    double min = -std::numeric_limits<double>::infinity(),
           max = std::numeric_limits<double>::infinity();
    std::uint32_t flags = 0;
};

constexpr Limits kUnlimited{};
constexpr Limits kPositive{0, std::numeric_limits<double>::infinity(), RT_MIN_EXCLUSIVE};
constexpr Limits kNotNegative{0};
constexpr Limits kColorRange{0, 1e6}; // sums of six decades keep nine digits of the smallest term
constexpr double kMaxCount = 4294967295.0;

constexpr rt_param row(const char* name, std::uint32_t type, std::uint32_t unit,
                       const char* fallback, Limits limits, const char* doc,
                       const char* choices = nullptr) {
    return {name, fallback, choices, doc, limits.min, limits.max, type, unit, limits.flags, 0};
}
constexpr rt_param real(const char* name, std::uint32_t unit, const char* fallback, Limits limits,
                        const char* doc) {
    return row(name, RT_REAL, unit, fallback, limits, doc);
}
constexpr rt_param count(const char* name, const char* fallback, Limits limits, const char* doc) {
    return row(name, RT_INTEGER, RT_UNIT_COUNT, fallback, limits, doc);
}
constexpr rt_param point(const char* name, const char* fallback, const char* doc) {
    return row(name, RT_VECTOR3, RT_UNIT_LENGTH, fallback, kUnlimited, doc);
}
constexpr rt_param direction(const char* name, const char* fallback, const char* doc) {
    return row(name, RT_VECTOR3, RT_UNIT_LENGTH, fallback, kUnlimited, doc);
}
constexpr rt_param color(const char* name, const char* fallback, const char* doc) {
    return row(name, RT_COLOR, RT_UNIT_LINEAR_RGB, fallback, kColorRange, doc);
}
constexpr rt_param choice(const char* name, const char* choices, const char* fallback,
                          const char* doc) {
    return row(name, RT_CHOICE, RT_UNIT_NONE, fallback, kUnlimited, doc, choices);
}
constexpr rt_param boolean(const char* name, const char* fallback, const char* doc) {
    return row(name, RT_BOOL, RT_UNIT_NONE, fallback, kUnlimited, doc);
}
constexpr rt_param text(const char* name, const char* doc) {
    return row(name, RT_TEXT, RT_UNIT_NONE, "", kUnlimited, doc);
}
constexpr rt_param special(const char* name, std::uint32_t type, const char* fallback,
                           const char* doc) {
    return row(name, type, RT_UNIT_NONE, fallback, kUnlimited, doc);
}

// ---- binding -------------------------------------------------------------------------------------------------

template <class T> struct IsOptional : std::false_type {};
template <class T> struct IsOptional<std::optional<T>> : std::true_type {};

template <class T> void fill(T& member, const Value& value) {
    if constexpr (IsOptional<T>::value) {
        typename T::value_type inner{};
        fill(inner, value);
        member = std::move(inner);
    } else if constexpr (std::is_same_v<T, Radians>) {
        member.value = std::get<double>(value.data);
    } else if constexpr (std::is_same_v<T, LinearRgb>) {
        const Vec3& rgb = std::get<Vec3>(value.data);
        member = {rgb.x, rgb.y, rgb.z};
    } else if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, double> ||
                         std::is_same_v<T, std::string>) {
        member = std::get<T>(value.data);
    } else {
        member =
            static_cast<T>(std::get<std::int64_t>(value.data)); // integers, bool, enums by choice
    }
}

template <class T> Value told(const T& member) {
    if constexpr (IsOptional<T>::value)
        return member ? told(*member) : Value{};
    else if constexpr (std::is_same_v<T, Radians>)
        return {member.value, {}};
    else if constexpr (std::is_same_v<T, LinearRgb>)
        return {Vec3(member.r, member.g, member.b), {}};
    else if constexpr (std::is_same_v<T, std::string>)
        return member.empty() ? Value{} : Value{member, {}};
    else if constexpr (std::is_same_v<T, Vec3> || std::is_same_v<T, double>)
        return {member, {}};
    else
        return {static_cast<std::int64_t>(member), {}};
}

template <auto member> struct MemberOf;
template <class T, class M, M T::*member> struct MemberOf<member> { using Owner = T; };

/// The field that fills one member.
template <auto member> constexpr Field field(rt_param description) {
    using Owner = typename MemberOf<member>::Owner;
    return {
        .row = description,
        .assign = [](void* section,
                     const Value& value) { fill(static_cast<Owner*>(section)->*member, value); },
        .fetch =
            [](const void* section) { return told(static_cast<const Owner*>(section)->*member); }};
}

constexpr Field byHand(rt_param description, std::span<const Field> fields = {}) {
    return {.row = description, .form = Form::byHand, .fields = fields};
}

constexpr Field section(const char* name, const char* fallback, std::span<const Field> fields,
                        const char* doc) {
    return {.row = special(name, kTypeMap, fallback, doc), .form = Form::section, .fields = fields};
}

// ---- image ---------------------------------------------------------------------------------------------------

constexpr Field kImage[] = {
    field<&Image::width>(count("width", "640", {1, kMaxCount}, "Width of the picture in pixels.")),
    field<&Image::height>(
        count("height", "480", {1, kMaxCount}, "Height of the picture in pixels.")),
    field<&Image::encoding>(
        choice("encoding", "srgb|linear", "srgb",
               "Transfer function of 8 and 16 bit files; EXR and PFM are linear in any case.")),
    field<&Image::tone>(
        choice("tone", "limit|clamp", "clamp",
               "Colours over 1: limit divides by the largest channel and keeps the hue, clamp cuts "
               "each channel.")),
    {.row = choice("bits", "8|16", "8", "Bits per channel of a PNG."),
     .assign =
         [](void* image, const Value& value) {
             static_cast<Image*>(image)->bits = std::get<std::int64_t>(value.data) ? 16 : 8;
         },
     .fetch =
         [](const void* image) {
             return Value{std::int64_t{static_cast<const Image*>(image)->bits == 16}, {}};
         }},
    field<&Image::file>(
        text("file", "Where the picture goes, relative to the current folder and without '..'; by "
                     "default the scene's name with .png.")),
};

// ---- camera --------------------------------------------------------------------------------------------------

constexpr Field kScreen[] = {
    field<&Camera::screenWidth>(
        real("width", RT_UNIT_LENGTH, nullptr, kPositive, "Width of the screen rectangle.")),
    field<&Camera::screenHeight>(
        real("height", RT_UNIT_LENGTH, nullptr, kPositive, "Height of the screen rectangle.")),
    field<&Camera::screenDistance>(real("distance", RT_UNIT_LENGTH, nullptr, kPositive,
                                        "Distance of the screen rectangle from the eye.")),
};

constexpr Field kCamera[] = {
    field<&Camera::position>(point("position", nullptr, "The eye.")),
    field<&Camera::forward>(
        direction("forward", "",
                  "Where the camera looks: a direction of any length. Either this or look_at.")),
    field<&Camera::lookAt>(
        point("look_at", "", "A point that the camera looks at. Either this or forward.")),
    field<&Camera::up>(
        direction("up", "[0, 0, 1]",
                  "A direction that is up in the picture; any length, not along the view.")),
    field<&Camera::fieldOfView>(
        real("field_of_view", RT_UNIT_ANGLE, "45deg", {0.001, 179},
             "Vertical angle of view; the width follows from the picture. Either this or screen.")),
    section("screen", "", kScreen,
            "The rectangle that the picture is seen through. Either this or field_of_view."),
};

constexpr Field kBounds[] = {
    field<&Box3d::min>(point("min", nullptr, "The corner of lowest coordinates.")),
    field<&Box3d::max>(point("max", nullptr, "The corner of highest coordinates.")),
};

// ---- render --------------------------------------------------------------------------------------------------

template <class T, auto member> constexpr Field alternative(rt_param description) {
    return {.row = description,
            .assign =
                [](void* render, const Value& value) {
                    T chosen;
                    fill(chosen.*member, value);
                    static_cast<Render*>(render)->antialias = chosen;
                },
            .fetch =
                [](const void* render) {
                    const T* chosen =
                        std::get_if<T>(&static_cast<const Render*>(render)->antialias);
                    return chosen ? told(chosen->*member) : Value{};
                }};
}

constexpr Field kAntialias[] = {
    alternative<AntialiasGrid, &AntialiasGrid::n>(
        count("grid", nullptr, {1, 64}, "n x n samples in each pixel.")),
    alternative<AntialiasMaxError, &AntialiasMaxError::rmse>(
        real("max_error", RT_UNIT_NONE, nullptr, {0.00001, 1},
             "As many samples as bring the root mean square error of the picture below this; 1 is "
             "display white.")),
};

constexpr Field kOctree[] = {
    field<&Render::octreeMaxObjects>(
        count("max_objects", "16", {1, kMaxCount}, "A cell with more primitives is divided.")),
    field<&Render::octreeMinSize>(real("min_size", RT_UNIT_LENGTH, "0", kNotNegative,
                                       "Cells are not divided below this size; 0: no limit.")),
};

constexpr Field kRender[] = {
    field<&Render::depth>(
        count("depth", "5", {0, 1000}, "Mirror and refraction bounces after the primary ray.")),
    {.row = choice("antialias", "none|fsaa4", "none",
                   "Samples per pixel: fsaa4 takes 2x2, each tone-limited before the mean."),
     .form = Form::choiceOrOne,
     .assign =
         [](void* render, const Value& value) {
             if (std::get<std::int64_t>(value.data) == 0)
                 static_cast<Render*>(render)->antialias = AntialiasNone{};
             else
                 static_cast<Render*>(render)->antialias = AntialiasFsaa4{};
         },
     .fetch =
         [](const void* render) {
             const std::size_t index = static_cast<const Render*>(render)->antialias.index();
             return index < 2 ? Value{static_cast<std::int64_t>(index), {}} : Value{};
         },
     .fields = kAntialias},
    field<&Render::smooth>(boolean(
        "smooth", "false",
        "Mean of each pixel and its neighbours right and below, over the finished picture.")),
    field<&Render::sampling>(
        choice("sampling", "center|corner", "center",
               "Where in a pixel a single sample lies; corner is the top left one.")),
    field<&Render::nearPlane>(
        choice("near_plane", "none|screen", "none",
               "screen: rays start on the screen rectangle, and nothing before it is seen.")),
    field<&Render::cutoff>(
        real("cutoff", RT_UNIT_NONE, "0", {0, 1, RT_MAX_EXCLUSIVE},
             "Rays that can add less than this to a pixel are not traced; 0: all are.")),
    section("octree", "{}", kOctree,
            "How finely space is divided; changes the speed only, never the picture."),
};

// ---- background, lights, materials ---------------------------------------------------------------------------

constexpr Field kBackground[] = {
    field<&Background::color>(
        color("color", "0", "Colour where no texture is given; not used beside one.")),
    field<&Background::texture>(
        special("texture", RT_TEXTURE, "", "Name of the texture that surrounds the scene.")),
    field<&Background::mapping>(choice(
        "mapping", "hemisphere|lat_long|legacy_hemisphere", "hemisphere",
        "How directions meet the texture: the sky above, mirrored below; the whole sphere; or "
        "that of old .inf scenes, with center and radius.")),
    field<&Background::center>(
        point("center", "", "legacy_hemisphere: the centre of the sky's sphere.")),
    field<&Background::radius>(real("radius", RT_UNIT_LENGTH, "", kPositive,
                                    "legacy_hemisphere: the radius of the sky's sphere.")),
};

constexpr Field kPointLight[] = {
    field<&PointLight::name>(text("name", "Unique among lights; for animation.")),
    field<&PointLight::position>(point("position", nullptr, "Where the light is.")),
    field<&PointLight::color>(
        color("color", "1", "Colour of the light; there is no falloff with distance.")),
    field<&PointLight::brightness>(
        real("brightness", RT_UNIT_RATIO, "1", kColorRange, "Multiplies the colour.")),
};

constexpr Field kMaterial[] = {
    field<&Material::color>(
        color("color", "1",
              "Colour of the surface: multiplies diffuse, mirrored and transmitted light.")),
    field<&Material::colorTexture>(
        special("texture", RT_TEXTURE, "", "Name of a texture that multiplies the colour.")),
    field<&Material::diffuse>(color(
        "diffuse", "0",
        "Share of light scattered evenly; 1 in a material that has none of the four shares.")),
    field<&Material::specular>(
        color("specular", "0", "Share mirrored, and strength of the highlight.")),
    field<&Material::transmission>(color("transmission", "0", "Share that passes through.")),
    field<&Material::environment>(
        color("environment", "0", "Light added for each light that is visible.")),
    field<&Material::shininess>(real("shininess", RT_UNIT_NONE, "20", {0, 1e6},
                                     "Exponent of the highlight: higher is smaller and sharper.")),
    field<&Material::ior>(real("ior", RT_UNIT_RATIO, "1", {0.01, 100},
                               "Index of refraction, inside over outside: glass 1.5, water 1.33.")),
};

// ---- objects -------------------------------------------------------------------------------------------------

constexpr Field kRotation[] = {
    field<&Placement::Rotation::axis>(direction(
        "axis", "[0, 0, 1]", "Axis through the object's origin, of any length; right-handed.")),
    field<&Placement::Rotation::angle>(
        real("angle", RT_UNIT_ANGLE, nullptr, kUnlimited, "Angle about the axis.")),
};

constexpr Field kObject[] = {
    byHand(text("name", "Unique among objects; invented where it is missing.")),
    byHand(special("material", kTypeMaterial, "", "Name of a material, or the material itself.")),
    byHand(special("loader", kTypeLoader, "",
                   "The loader that reads the object's file, where its suffix does not say so.")),
    {.row = {"scale", "1", nullptr,
             "Factor about the object's origin, one for all axes or one for each; not 0.",
             -kMaxLength, kMaxLength, RT_VECTOR3, RT_UNIT_RATIO, kUniform, 0},
     .assign = field<&Placement::scale>({}).assign,
     .fetch = field<&Placement::scale>({}).fetch},
    {.row = special("rotate", kTypeMap, "",
                    "A rotation, or a list of rotations that follow each other; after the scale."),
     .form = Form::oneOrMany,
     .fields = kRotation,
     .append = [](void* placement) -> void* {
         return &static_cast<Placement*>(placement)->rotations.emplace_back();
     },
     .count =
         [](const void* placement) {
             return static_cast<const Placement*>(placement)->rotations.size();
         },
     .element = [](const void* placement, std::size_t index) -> const void* {
         return &static_cast<const Placement*>(placement)->rotations[index];
     }},
    field<&Placement::translation>(
        point("translate", "[0, 0, 0]", "How far the object is moved, after scale and rotation.")),
};
constexpr std::size_t kObjectOwnFields = 3; // before the placement's

// ---- animation -----------------------------------------------------------------------------------------------

constexpr Field kRotate[] = {
    field<&Rotate::center>(point("center", nullptr, "A point on the axis.")),
    field<&Rotate::axis>(direction("axis", nullptr, "Direction of the axis; right-handed.")),
    field<&Rotate::angle>(
        real("angle", RT_UNIT_ANGLE, nullptr, kUnlimited, "Angle over the whole range of frames.")),
};
constexpr Field kRotateSelf[] = {
    field<&RotateSelf::axis>(
        direction("axis", "", "Axis through the target's own centre; by default its normal.")),
    field<&RotateSelf::angle>(
        real("angle", RT_UNIT_ANGLE, nullptr, kUnlimited, "Angle over the whole range of frames.")),
};
constexpr Field kMove[] = {
    field<&Move::position>(point("position", nullptr, "Where the target's centre ends.")),
};
constexpr Field kMoveRadius[] = {
    field<&MoveRadius::center>(point("center", nullptr, "The point to move away from.")),
    field<&MoveRadius::distance>(real("distance", RT_UNIT_LENGTH, nullptr, kUnlimited,
                                      "How far away, over the whole range; negative: towards it.")),
};
constexpr Field kMoveDirect[] = {
    field<&MoveDirect::direction>(direction("direction", nullptr, "Where to; any length but 0.")),
    field<&MoveDirect::distance>(
        real("distance", RT_UNIT_LENGTH, nullptr, kUnlimited, "How far, over the whole range.")),
};

constexpr Field kTrack[] = {
    byHand(special("target", kTypeNames, "",
                   "What moves: an object or a list of objects; camera.position, camera.front or "
                   "camera.top; for keyframes "
                   "any numeric key, such as moon.radius, lights.key.color, "
                   "materials.steel.diffuse or camera.screen.width.")),
    byHand(special("background", RT_TEXTURE, "",
                   "Name of a texture that the background fades to, instead of a target.")),
    byHand(special("frames", kTypeIndexRange, "",
                   "[first, last]: nothing has happened in image first, all has in image last. "
                   "Keyframes have their own.")),
    byHand(special("rotate", kTypeMap, "", "Turns the target about an axis."), kRotate),
    byHand(special("rotate_self", kTypeMap, "", "Turns the target about its own centre."),
           kRotateSelf),
    byHand(special("move", kTypeMap, "", "Moves the target's centre to a point."), kMove),
    byHand(special("move_radius", kTypeMap, "", "Moves the target away from a point."),
           kMoveRadius),
    byHand(special("move_direct", kTypeMap, "", "Moves the target along a direction."),
           kMoveDirect),
    byHand(special(
        "keyframes", kTypeKeyframes, "",
        "Values at frames, {0: 1, 48: 2.5}; before the first and after the last they stay.")),
    field<&Track::easing>(choice("easing", "linear|smooth", "linear",
                                 "How a motion or fade runs through its frames.")),
    byHand(choice("interpolation", "linear|smooth|step", "linear",
                  "How values run between keyframes.")),
    byHand(special("faces", kTypeIndexRange, "",
                   "[first, last]: only these faces of the one mesh that is the target, counted "
                   "from 0 in its file.")),
    byHand(boolean("each", "false",
                   "Every face of the target moves by itself, about its own centroid.")),
};
constexpr std::size_t kFirstMotion = 3, kMotions = 5;

constexpr Field kAnimation[] = {
    field<&Animation::frames>(
        count("frames", nullptr, {1, 1e6},
              "Number of images; the first is number 0 and shows the scene at rest.")),
    field<&Animation::fps>(
        real("fps", RT_UNIT_NONE, "24", {0.001, 1000}, "Images per second of the film.")),
    byHand(special("tracks", kTypeMap, "", "What moves, and when."), kTrack),
};

constexpr Section kSections[] = {
    {"rt", Section::Kind::version, true, "Version of the scene language.", {}},
    {"image", Section::Kind::map, false, "The picture.", kImage},
    {"camera", Section::Kind::map, true, "The eye.", kCamera},
    {"bounds", Section::Kind::map, false,
     "Only what lies within this box is seen; by default everything.", kBounds},
    {"render", Section::Kind::map, false, "How the picture is computed.", kRender},
    {"textures",
     Section::Kind::namedTypes,
     false,
     "Textures by name; each is a map of one type.",
     {}},
    {"background", Section::Kind::map, false, "What rays see that meet nothing.", kBackground},
    {"lights", Section::Kind::typedList, false, "Lights; each is a map of one type.", kPointLight},
    {"materials", Section::Kind::namedMaps, false, "Materials by name.", kMaterial},
    {"objects", Section::Kind::typedList, false, "Objects; each is a map of one shape.", kObject},
    {"animation", Section::Kind::map, false, "A film.", kAnimation},
};

} // namespace

std::span<const Field> imageFields() { return kImage; }
std::span<const Field> cameraFields() { return kCamera; }
std::span<const Field> boundsFields() { return kBounds; }
std::span<const Field> renderFields() { return kRender; }
std::span<const Field> backgroundFields() { return kBackground; }
std::span<const Field> pointLightFields() { return kPointLight; }
std::span<const Field> materialFields() { return kMaterial; }
std::span<const Field> objectFields() { return kObject; }
std::span<const Field> placementFields() { return std::span(kObject).subspan(kObjectOwnFields); }
std::span<const Field> animationFields() { return kAnimation; }
std::span<const Field> trackFields() { return kTrack; }
std::span<const Field> motionFields() { return std::span(kTrack).subspan(kFirstMotion, kMotions); }
std::span<const Section> sections() { return kSections; }

const Field* findField(std::span<const Field> fields, std::string_view name) {
    for (const Field& field : fields)
        if (name == field.row.name) return &field;
    return nullptr;
}

} // namespace rt::scene
