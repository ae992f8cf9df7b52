// The core's part of the scene language as one table: what is parsed, checked, documented, and put into the JSON
// Schema. A field is a parameter row, as plugins have them, bound to the member that it fills.
#pragma once
#include <core/scene/description.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace rt::scene {

// Types of the core beside those of rt_param.
enum : std::uint32_t {
    kTypeMap = 100,  // fields of its own
    kTypeNames,      // a name or a list of names
    kTypeIndexRange, // [first, last], whole numbers
    kTypeKeyframes,  // {frame: value, ...}
    kTypeMaterial,   // a material's name, or a map of a material's fields
    kTypeLoader      // the name of a loader
};

enum class Form : std::uint8_t {
    value, // parseValue reads it
    byHand, // its reader is in validate.cpp or validate_animation.cpp; `fields`, if any, are its map's
    section,     // a map whose fields fill the same struct; absent: every field's default
    choiceOrOne, // one of the row's choices, or a map of exactly one of `fields`
    oneOrMany    // a map of `fields`, or a list of such maps
};

struct Field {
    rt_param row{}; // fallback "" of any type: absent is allowed and leaves the member alone
    Form form = Form::value;
    void (*assign)(void* section, const Value& value) = nullptr;
    Value (*fetch)(const void* section) = nullptr; // monostate: not said
    std::span<const Field> fields = {};
    void* (*append)(void* section) = nullptr; // oneOrMany: a new element
    std::size_t (*count)(const void* section) = nullptr;
    const void* (*element)(const void* section, std::size_t index) = nullptr;
};

/// May an absent key stand for its default? False for keys that must be written.
inline bool isRequired(const Field& field) { return field.row.fallback == nullptr; }

std::span<const Field> imageFields();      // Image
std::span<const Field> cameraFields();     // Camera
std::span<const Field> boundsFields();     // Box3d
std::span<const Field> renderFields();     // Render
std::span<const Field> backgroundFields(); // Background
std::span<const Field> pointLightFields(); // PointLight
std::span<const Field> materialFields();   // Material
std::span<const Field> objectFields();     // name, material and loader by hand, then Placement
std::span<const Field> placementFields();  // Placement
std::span<const Field> animationFields();  // Animation; tracks by hand
std::span<const Field> trackFields();  // by hand; the motions' fields fill Rotate, RotateSelf, ...
std::span<const Field> motionFields(); // the motions among trackFields

const Field* findField(std::span<const Field> fields, std::string_view name);

/// The document's sections in the order of the guide.
struct Section {
    enum class Kind : std::uint8_t {
        version,    // rt: 1
        map,        // `fields`
        namedTypes, // textures: NAME: {TYPE: {...}}
        namedMaps,  // materials: NAME: {fields}
        typedList   // lights, objects: - TYPE: {...}
    };
    std::string_view name;
    Kind kind;
    bool required;
    std::string_view doc;
    std::span<const Field> fields;
};
std::span<const Section> sections();

/// What the language calls itself in `rt: 1`.
inline constexpr std::int64_t kLanguageVersion = 1;

} // namespace rt::scene
