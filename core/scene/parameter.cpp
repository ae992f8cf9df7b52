#include <core/scene/parameter.hpp>

#include <core/scene/codes.hpp>
#include <core/scene/language.hpp>

#include <algorithm>

namespace rt::scene {
namespace {

using Owner = Parameter::Owner;

bool isNumeric(const rt_param& row) {
    return row.type == RT_INTEGER || row.type == RT_REAL || row.type == RT_VECTOR3 ||
           row.type == RT_COLOR;
}

std::size_t componentsOf(const rt_param& row) {
    return row.type == RT_VECTOR3 || row.type == RT_COLOR ? 3 : 1;
}

/// "a.b.c" -> "a", leaving "b.c".
std::string_view takeWord(std::string_view& path) {
    const std::size_t dot = std::min(path.find('.'), path.size());
    const std::string_view word = path.substr(0, dot);
    path.remove_prefix(std::min(dot + 1, path.size()));
    return word;
}

class Finder {
public:
    Finder(const Description& description, std::string_view path, const Location& location)
        : description_(description), path_(path), location_(location) {}

    Parsed<Parameter> find() const {
        std::string_view rest = path_;
        const std::string_view first = takeWord(rest);
        if (first == "camera")
            return inFields({.owner = Owner::camera}, cameraFields(), rest, "camera");
        if (first == "background")
            return inFields({.owner = Owner::background}, backgroundFields(), rest, "background");
        if (first == "lights") {
            const std::string_view name = takeWord(rest);
            const auto index = indexOf(description_.lights, name);
            if (!index) return unknownName("light", name, description_.lights);
            return inFields({.owner = Owner::light, .index = *index}, pointLightFields(), rest,
                            "a light");
        }
        if (first == "materials") {
            const std::string_view name = takeWord(rest);
            const auto index = indexOf(description_.materials, name);
            if (!index) return unknownName("material", name, description_.materials);
            return inFields({.owner = Owner::material, .index = *index}, materialFields(), rest,
                            "a material");
        }
        if (first == "textures") {
            const std::string_view name = takeWord(rest);
            const auto index = indexOf(description_.textures, name);
            if (!index) return unknownName("texture", name, description_.textures);
            const Instance& instance = description_.textures[*index].instance;
            if (auto found =
                    inRows({.owner = Owner::texture, .index = *index}, instance.rows, rest))
                return *found;
            return unknownKey(rest, namesOf(instance.rows), instance.type);
        }
        const std::string_view name = first == "objects" ? takeWord(rest) : first;
        const auto index = indexOf(description_.objects, name);
        if (!index) return unknownName("object", name, description_.objects);
        return inObject(*index, rest);
    }

private:
    template <class T>
    std::optional<std::uint32_t> indexOf(const std::vector<T>& list, std::string_view name) const {
        const auto found = std::find_if(list.begin(), list.end(),
                                        [name](const T& item) { return item.name == name; });
        if (found == list.end()) return std::nullopt;
        return static_cast<std::uint32_t>(found - list.begin());
    }

    Fault fault(std::string clause, std::string suggestion = {}) const {
        return {codes::kTarget, location_, std::move(clause), std::move(suggestion)};
    }

    template <class T>
    Fault unknownName(std::string_view kind, std::string_view name,
                      const std::vector<T>& list) const {
        std::vector<std::string> names;
        for (const T& item : list) names.push_back(item.name);
        const std::string near = nearest(name, names);
        return fault("there is no " + std::string(kind) + " " + quoted(name),
                     near.empty() ? "" : "did you mean '" + near + "'?");
    }

    Fault unknownKey(std::string_view key, const std::vector<std::string>& names,
                     std::string_view subject) const {
        if (key.empty())
            return fault("names no key of " + std::string(subject),
                         "write " + std::string(path_) + ".KEY");
        const std::string near = nearest(key, names);
        return fault(std::string(subject) + " has no key " + quoted(key),
                     near.empty() ? "" : "did you mean '" + near + "'?");
    }

    static std::vector<std::string> namesOf(std::span<const rt_param> rows) {
        std::vector<std::string> names;
        for (const rt_param& row : rows) names.emplace_back(row.name);
        return names;
    }
    static std::vector<std::string> namesOf(std::span<const Field> fields) {
        std::vector<std::string> names;
        for (const Field& field : fields) names.emplace_back(field.row.name);
        return names;
    }

    Parsed<Parameter> checked(Parameter parameter, const rt_param& row) const {
        if (!isNumeric(row)) return fault(quoted(path_) + " is no number: it is " + describe(row));
        parameter.row = &row;
        parameter.components = componentsOf(row);
        return parameter;
    }

    Parsed<Parameter> inFields(Parameter parameter, std::span<const Field> fields,
                               std::string_view key, std::string_view subject) const {
        std::string_view rest = key;
        const Field* field = findField(fields, takeWord(rest));
        if (field && field->form == Form::section && !rest.empty())
            return inFields(parameter, field->fields, rest,
                            std::string(subject) + "." + field->row.name);
        if (!field || !rest.empty()) return unknownKey(key, namesOf(fields), subject);
        if (field->form != Form::value) return fault(quoted(path_) + " is no number");
        if (parameter.owner == Owner::camera) {
            const Camera& camera = description_.camera;
            const std::string_view name = field->row.name;
            if (name == "forward" && camera.lookAt)
                return fault("the scene states look_at, not forward", "use camera.look_at");
            if (name == "look_at" && !camera.lookAt)
                return fault("the scene states forward, not look_at", "use camera.forward");
            if (name == "field_of_view" && !camera.fieldOfView)
                return fault("the scene states screen, not field_of_view",
                             "use camera.screen.height and camera.screen.width");
            if (subject == "camera.screen" && camera.fieldOfView)
                return fault("the scene states field_of_view, not screen",
                             "use camera.field_of_view");
        }
        parameter.field = field;
        return checked(parameter, field->row);
    }

    std::optional<Parsed<Parameter>> inRows(Parameter parameter, std::span<const rt_param> rows,
                                            std::string_view key) const {
        for (std::size_t i = 0; i < rows.size(); ++i)
            if (key == rows[i].name) {
                parameter.value = static_cast<std::uint32_t>(i);
                return checked(parameter, rows[i]);
            }
        return std::nullopt;
    }

    Parsed<Parameter> inObject(std::uint32_t index, std::string_view key) const {
        const Object& object = description_.objects[index];
        std::string_view rest = key;
        const std::string_view first = takeWord(rest);
        if (first == "material" && !rest.empty()) {
            const auto material = indexOf(description_.materials, object.name + ".material");
            if (!material)
                return fault("the material of " + quoted(object.name) + " has a name",
                             "use materials.NAME." + std::string(rest));
            return inFields({.owner = Owner::material, .index = *material}, materialFields(), rest,
                            "a material");
        }
        if (const Field* field = findField(placementFields(), first)) {
            if (field->form == Form::oneOrMany) {
                if (object.placement.rotations.size() != 1)
                    return fault(
                        quoted(object.name) + " has " +
                        (object.placement.rotations.empty() ? "no rotation" : "several rotations") +
                        ", so none can be animated by keyframes");
                return inFields({.owner = Owner::placement, .index = index}, field->fields, rest,
                                "rotate");
            }
            return inFields({.owner = Owner::placement, .index = index}, placementFields(), key,
                            "an object");
        }
        if (auto found = inRows({.owner = Owner::shape, .index = index}, object.shape.rows, key))
            return *found;
        std::vector<std::string> names = namesOf(object.shape.rows);
        if (object.loader) {
            if (auto found =
                    inRows({.owner = Owner::loader, .index = index}, object.loader->rows, key))
                return *found;
            for (std::string& name : namesOf(object.loader->rows)) names.push_back(std::move(name));
        }
        for (std::string& name : namesOf(placementFields())) names.push_back(std::move(name));
        return unknownKey(key, names, object.shape.type);
    }

    const Description& description_;
    std::string_view path_;
    const Location& location_;
};

bool isOfRotation(const Parameter& parameter) {
    return parameter.owner == Owner::placement &&
           findField(placementFields(), parameter.field->row.name) != parameter.field;
}

/// The struct whose member the parameter's field fills.
void* sectionOf(Description& description, const Parameter& parameter) {
    switch (parameter.owner) {
    case Owner::camera:
        return &description.camera;
    case Owner::background:
        return &description.background;
    case Owner::light:
        return &description.lights[parameter.index];
    case Owner::material:
        return &description.materials[parameter.index];
    case Owner::placement: {
        Placement& placement = description.objects[parameter.index].placement;
        return isOfRotation(parameter) ? static_cast<void*>(&placement.rotations.front())
                                       : &placement;
    }
    default:
        return nullptr;
    }
}

Value& instanceValue(Description& description, const Parameter& parameter) {
    Instance& instance =
        parameter.owner == Owner::texture  ? description.textures[parameter.index].instance
        : parameter.owner == Owner::loader ? *description.objects[parameter.index].loader
                                           : description.objects[parameter.index].shape;
    return instance.values[parameter.value];
}

Value valueOf(const rt_param& row, std::span<const double> numbers) {
    if (row.type == RT_INTEGER) return {static_cast<std::int64_t>(numbers[0]), {}};
    if (row.type == RT_REAL) return {numbers[0], {}};
    return {Vec3(numbers[0], numbers[1], numbers[2]), {}};
}

} // namespace

Parsed<Parameter> findParameter(const Description& description, std::string_view path,
                                const Location& location) {
    return Finder(description, path, location).find();
}

void setParameter(Description& description, const Parameter& parameter,
                  std::span<const double> values) {
    const Value value = valueOf(*parameter.row, values);
    if (!parameter.field) {
        instanceValue(description, parameter).data = value.data;
        return;
    }
    parameter.field->assign(sectionOf(description, parameter), value);
    if (parameter.owner == Owner::camera)
        resolve(description.camera,
                description.camera.screenWidth / description.camera.screenHeight);
    if (parameter.owner == Owner::placement) {
        Object& object = description.objects[parameter.index];
        object.worldFromObject = worldFromObject(object.placement);
    }
}

std::vector<double> parameterValue(const Description& description, const Parameter& parameter) {
    Description& mutableDescription = const_cast<Description&>(description); // read only below
    const Value value = parameter.field
                            ? parameter.field->fetch(sectionOf(mutableDescription, parameter))
                            : instanceValue(mutableDescription, parameter);
    if (const auto* integer = std::get_if<std::int64_t>(&value.data))
        return {static_cast<double>(*integer)};
    if (const auto* number = std::get_if<double>(&value.data)) return {*number};
    const Vec3& vector = std::get<Vec3>(value.data);
    return {vector.x, vector.y, vector.z};
}

} // namespace rt::scene
