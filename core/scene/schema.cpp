#include <core/scene/language.hpp>
#include <core/scene/validate.hpp>
#include <core/scene/values.hpp>

#include <nlohmann/json.hpp>

#include <cmath>

namespace rt::scene {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kAnglePattern =
    R"(^[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)? ?(deg|rad)$)";
constexpr std::string_view kColorPattern = "^#[0-9a-fA-F]{6}$";
constexpr std::string_view kFramePattern = "^(0|[1-9][0-9]*)$";

void addLimits(Json& number, const rt_param& row) {
    const double low = row.unit == RT_UNIT_LENGTH ? std::max(row.min, -kMaxLength) : row.min;
    const double high = row.unit == RT_UNIT_LENGTH ? std::min(row.max, kMaxLength) : row.max;
    const auto spelled = [](double limit) {
        return limit == std::floor(limit) && std::fabs(limit) < 9e15
                   ? Json(static_cast<std::int64_t>(limit))
                   : Json(limit);
    };
    if (std::isfinite(low))
        number[row.flags & RT_MIN_EXCLUSIVE && low == row.min ? "exclusiveMinimum" : "minimum"] =
            spelled(low);
    if (std::isfinite(high))
        number[row.flags & RT_MAX_EXCLUSIVE && high == row.max ? "exclusiveMaximum" : "maximum"] =
            spelled(high);
}

Json number(const rt_param& row) {
    Json json;
    if (row.unit == RT_UNIT_ANGLE) {
        json["type"] = "string";
        json["pattern"] = kAnglePattern;
    } else {
        json["type"] =
            row.type == RT_INTEGER || row.type == RT_INTEGER_LISTS ? "integer" : "number";
        addLimits(json, row);
    }
    return json;
}

Json listOf(Json items, int size = 0) {
    Json json{{"type", "array"}, {"items", std::move(items)}};
    if (size != 0) json["minItems"] = json["maxItems"] = size;
    return json;
}

Json anyOf(std::initializer_list<Json> alternatives) {
    return {{"anyOf", Json::array_t(alternatives)}};
}

/// A scalar of the file as JSON: YAML's own reading of it, so that editors accept what the program accepts.
Json scalar(const std::string& text) {
    if (text == "true") return true;
    if (text == "false") return false;
    const Node node = scalarNode(text);
    if (const auto integer = parseInteger(node); std::holds_alternative<std::int64_t>(integer))
        return std::get<std::int64_t>(integer);
    rt_param real{};
    real.type = RT_REAL, real.min = -kMaxLength, real.max = kMaxLength;
    if (const auto value = parseValue(node, real); std::holds_alternative<Value>(value))
        return std::get<double>(std::get<Value>(value).data);
    return text;
}

Json json(const Node& node) {
    if (node.kind != Node::Kind::sequence) return node.quoted ? Json(node.text) : scalar(node.text);
    Json list = Json::array();
    for (const Node& item : node.items) list.push_back(json(item));
    return list;
}

Json schemaOf(std::span<const Field> fields);

/// What parseValue accepts.
Json valueSchema(const rt_param& row) {
    switch (row.type) {
    case RT_BOOL:
        return {{"type", "boolean"}};
    case RT_INTEGER:
    case RT_REAL:
        return number(row);
    case RT_VECTOR3:
        return row.flags & kUniform ? anyOf({number(row), listOf(number(row), 3)})
                                    : listOf(number(row), 3);
    case RT_COLOR:
        return anyOf({number(row), listOf(number(row), 3),
                      Json{{"type", "string"}, {"pattern", kColorPattern}}});
    case RT_CHOICE: {
        Json choices = Json::array();
        for (const std::string& choice : choicesOf(row)) choices.push_back(scalar(choice));
        return {{"enum", std::move(choices)}};
    }
    case RT_VECTOR3_LIST:
        return listOf(listOf(number(row), 3));
    case RT_INTEGER_LISTS:
        return listOf(listOf(number(row)));
    case kTypeNames:
        return anyOf({Json{{"type", "string"}}, listOf({{"type", "string"}})});
    case kTypeIndexRange:
        return listOf({{"type", "integer"}, {"minimum", 0}}, 2);
    case kTypeKeyframes:
        return {{"type", "object"},
                {"minProperties", 1},
                {"patternProperties", {{kFramePattern, {{"type", {"number", "string", "array"}}}}}},
                {"additionalProperties", false}};
    case kTypeMaterial:
        return anyOf({Json{{"type", "string"}}, schemaOf(materialFields())});
    default:
        return {{"type", {"string", "number", "boolean"}}}; // text: any scalar
    }
}

Json described(Json schema, const rt_param& row) {
    Json result{{"description", row.doc}};
    if (row.fallback && *row.fallback && row.type < kTypeMap)
        if (const auto value = defaultValue(row);
            std::holds_alternative<Value>(value) && std::get<Value>(value).data.index() != 0)
            result["default"] = json(nodeOf(std::get<Value>(value), row));
    result.update(schema);
    return result;
}

Json one(const std::string& key, Json value) {
    return {{"type", "object"},
            {"properties", {{key, std::move(value)}}},
            {"required", {key}},
            {"additionalProperties", false}};
}

Json fieldSchema(const Field& field) {
    switch (field.form) {
    case Form::section:
        return schemaOf(field.fields);
    case Form::oneOrMany:
        return anyOf({schemaOf(field.fields), listOf(schemaOf(field.fields))});
    case Form::choiceOrOne: {
        Json alternatives = Json::array({valueSchema(field.row)});
        for (const Field& alternative : field.fields)
            alternatives.push_back(one(alternative.row.name,
                                       described(valueSchema(alternative.row), alternative.row)));
        return {{"oneOf", std::move(alternatives)}};
    }
    case Form::byHand:
        if (field.fields.empty()) return valueSchema(field.row);
        return std::string_view(field.row.name) == "tracks" ? listOf(schemaOf(field.fields))
                                                            : schemaOf(field.fields);
    case Form::value:
        break;
    }
    return valueSchema(field.row);
}

void add(Json& map, const rt_param& row, Json schema) {
    map["properties"][row.name] = described(std::move(schema), row);
    if (!row.fallback) map["required"].push_back(row.name);
}

Json emptyMap() {
    return {{"type", "object"}, {"properties", Json::object()}, {"additionalProperties", false}};
}

Json schemaOf(std::span<const Field> fields) {
    Json map = emptyMap();
    for (const Field& field : fields) add(map, field.row, fieldSchema(field));
    return map;
}

void addRows(Json& map, std::span<const rt_param> rows) {
    for (const rt_param& row : rows) add(map, row, valueSchema(row));
}

/// One alternative for each type of the kind that opens; refused modules are left out.
Json typesSchema(TypeCatalog& catalog, TypeKind kind) {
    Json alternatives = Json::array();
    for (const std::string& name : catalog.names(kind)) {
        const auto found = catalog.find(kind, name);
        const auto* type = std::get_if<TypeRows>(&found);
        if (!type) continue;
        Json map = emptyMap();
        if (kind == TypeKind::shape) {
            const bool loads =
                std::any_of(type->rows.begin(), type->rows.end(),
                            [](const rt_param& row) { return (row.flags & RT_LOADS) != 0; });
            for (const Field& field : objectFields())
                if (field.row.type != kTypeLoader || loads) add(map, field.row, fieldSchema(field));
            if (loads)
                for (const std::string& loader : catalog.names(TypeKind::loader))
                    if (const auto rows = catalog.find(TypeKind::loader, loader);
                        std::holds_alternative<TypeRows>(rows))
                        for (const rt_param& row : std::get<TypeRows>(rows).rows)
                            if (!map["properties"].contains(row.name))
                                map["properties"][row.name] = described(valueSchema(row), row);
        }
        addRows(map, type->rows);
        alternatives.push_back(one(name, std::move(map)));
    }
    return {{"oneOf", std::move(alternatives)}};
}

Json sectionSchema(const Section& section, TypeCatalog& catalog) {
    switch (section.kind) {
    case Section::Kind::version:
        return {{"type", "integer"}, {"const", kLanguageVersion}};
    case Section::Kind::map:
        return schemaOf(section.fields);
    case Section::Kind::namedTypes:
        return {{"type", "object"},
                {"additionalProperties", typesSchema(catalog, TypeKind::texture)}};
    case Section::Kind::namedMaps:
        return {{"type", "object"}, {"additionalProperties", schemaOf(section.fields)}};
    case Section::Kind::typedList:
        break;
    }
    return listOf(section.name == "lights" ? one("point", schemaOf(section.fields))
                                           : typesSchema(catalog, TypeKind::shape));
}

} // namespace

std::string jsonSchema(TypeCatalog& catalog) {
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                {"title", "Scene of rt, language version " + std::to_string(kLanguageVersion)},
                {"type", "object"},
                {"properties", Json::object()},
                {"required", Json::array()},
                {"additionalProperties", false}};
    for (const Section& section : sections()) {
        Json part{{"description", section.doc}};
        part.update(sectionSchema(section, catalog));
        schema["properties"][std::string(section.name)] = std::move(part);
        if (section.required) schema["required"].push_back(section.name);
    }
    // Editors know '<<' as a plain key.
    return schema.dump(2) + "\n";
}

} // namespace rt::scene
