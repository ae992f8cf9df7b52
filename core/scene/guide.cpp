#include <core/scene/guide.hpp>

#include <core/scene/language.hpp>
#include <core/scene/values.hpp>

namespace rt::scene {
namespace {

constexpr std::string_view kIntroduction = R"(# The scene language, version 1

This page is generated from the table that reads scenes (`core/scene/language.cpp`); a test holds it up to date.
`rt schema` prints the same table as a JSON Schema for editors, `rt plugins TYPE` the keys of each shape, texture and
loader, `rt check SCENE` says whether a scene is valid, `rt info --full SCENE` fills in every default.

- A scene is one YAML document in UTF-8, a map of the sections below. Anchors, aliases and merge keys (`<<`) work; tags do not.
- Keys that are unknown or stand twice are errors.
- Numbers are decimal and finite. Lengths and coordinates lie between -1e18 and 1e18; text in quotes is never a number.
- Angles carry a unit: `45deg`, `0.8rad`.
- Colours are linear light: one number for grey, `[r, g, b]`, or `"#rrggbb"` (sRGB, in quotes, since `#` starts a comment).
- Files are relative to the folder of the scene.
- Space is right-handed; positive angles turn counter-clockwise, seen with the axis pointing at the viewer.
)";

std::string cell(std::string_view text) {
    std::string escaped;
    for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
    return escaped;
}

std::string wanted(const Field& field) {
    const rt_param& row = field.row;
    if (field.form == Form::section) return "map, see below";
    if (field.form == Form::oneOrMany) return "map, or list of maps, see below";
    if (field.form == Form::choiceOrOne) {
        std::string text = describe(row);
        for (const Field& alternative : field.fields)
            text +=
                ", {" + std::string(alternative.row.name) + ": " + describe(alternative.row) + "}";
        return text;
    }
    switch (row.type) {
    case kTypeNames:
        return "name, or list of names";
    case kTypeIndexRange:
        return "[first, last]";
    case kTypeKeyframes:
        return "{frame: value, ...}";
    case kTypeMaterial:
        return "name, or map of a material's keys";
    case kTypeLoader:
        return "name of a loader";
    case kTypeMap:
        return "map, see below";
    default:
        return describe(row);
    }
}

std::string fallback(const Field& field) {
    if (!field.row.fallback) return "required";
    return *field.row.fallback && field.row.type != kTypeMap
               ? "`" + std::string(field.row.fallback) + "`"
               : "";
}

std::string table(std::span<const Field> fields) {
    std::string text = "| key | value | default | |\n|---|---|---|---|\n";
    for (const Field& field : fields)
        text += "| `" + std::string(field.row.name) + "` | " + cell(wanted(field)) + " | " +
                cell(fallback(field)) + " | " + cell(field.row.doc) + " |\n";
    return text;
}

/// The table of a section, then those of the maps inside.
void addTables(std::string& text, const std::string& name, std::span<const Field> fields,
               const std::string& level) {
    text += "\n" + table(fields);
    for (const Field& field : fields) {
        if (field.fields.empty() || field.form == Form::choiceOrOne) continue;
        const std::string inner = name + "." + field.row.name;
        text += "\n" + level + " " + inner + "\n\n" + field.row.doc + "\n";
        addTables(text, inner, field.fields, level);
    }
}

std::string_view shapeOf(Section::Kind kind) {
    switch (kind) {
    case Section::Kind::version:
        return "`rt: 1`";
    case Section::Kind::namedTypes:
        return "`NAME: {TYPE: {...}}`; the keys are those of the type, `rt plugins TYPE`.";
    case Section::Kind::namedMaps:
        return "`NAME: {...}`";
    case Section::Kind::typedList:
        return "`- TYPE: {...}`";
    case Section::Kind::map:
        break;
    }
    return "";
}

} // namespace

std::string languageGuide() {
    std::string text(kIntroduction);
    for (const Section& section : sections()) {
        text += "\n## " + std::string(section.name) + "\n\n" + std::string(section.doc) +
                (section.required ? " Required." : "") + "\n";
        if (const std::string_view shape = shapeOf(section.kind); !shape.empty())
            text += "\n" + std::string(shape) + "\n";
        if (section.name == "lights") text += "\nThe one type is `point`:\n";
        if (section.name == "objects")
            text += "\nEvery object has these keys beside those of its type (`rt plugins TYPE`) "
                    "and, where a loader reads its file, "
                    "those of the loader:\n";
        if (!section.fields.empty())
            addTables(text, std::string(section.name), section.fields, "###");
    }
    return text;
}

} // namespace rt::scene
