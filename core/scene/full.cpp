#include <core/scene/full.hpp>

#include <core/scene/language.hpp>
#include <core/scene/values.hpp>

#include <algorithm>
#include <string_view>

namespace rt::scene {
namespace {

using Kind = Node::Kind;

Node textNode(const std::string& text) {
    Node node = scalarNode(text);
    node.quoted = true; // the writer leaves quotes out where it may
    return node;
}

Node block(Kind kind) {
    Node node = flowNode(kind);
    node.flow = false;
    return node;
}

void append(Node& map, std::string_view key, Node value) {
    map.members.push_back({std::string(key), {}, std::move(value)});
}

/// An item `- TYPE: {...}` of a list.
Node item(std::string_view type, Node value) {
    Node map = block(Kind::map);
    append(map, type, std::move(value));
    return map;
}

Node one(std::string_view key, Node value) {
    Node map = flowNode(Kind::map);
    append(map, key, std::move(value));
    return map;
}

class Writer {
public:
    explicit Writer(const Description& description) : description_(description) {}

    Node scene() const {
        Node root = block(Kind::map);
        append(root, "rt", scalarNode(std::to_string(kLanguageVersion)));
        append(root, "image", blockOf(imageFields(), &description_.image));
        append(root, "camera", camera());
        if (description_.bounds)
            append(root, "bounds", mapOf(boundsFields(), &*description_.bounds));
        append(root, "render", blockOf(renderFields(), &description_.render));
        appendIfAny(root, "textures", textures());
        append(root, "background", background());
        appendIfAny(root, "lights", lights());
        appendIfAny(root, "materials", materials());
        appendIfAny(root, "objects", objects());
        if (description_.animation) append(root, "animation", animation(*description_.animation));
        return root;
    }

private:
    static void appendIfAny(Node& root, std::string_view key, Node section) {
        if (!section.items.empty() || !section.members.empty())
            append(root, key, std::move(section));
    }

    Node valueNode(const Value& value, const rt_param& row) const {
        const auto* index = std::get_if<std::int64_t>(&value.data);
        if (row.type == RT_TEXTURE && index)
            return textNode(description_.textures[static_cast<std::size_t>(*index)].name);
        return nodeOf(value, row);
    }

    static bool isSaid(const Value& value) {
        return !std::holds_alternative<std::monostate>(value.data);
    }

    void appendField(Node& map, const Field& field, const void* section) const {
        const char* name = field.row.name;
        switch (field.form) {
        case Form::byHand:
            return;
        case Form::section:
            return append(map, name, mapOf(field.fields, section));
        case Form::oneOrMany: {
            Node list = flowNode(Kind::sequence);
            for (std::size_t i = 0; i < field.count(section); ++i)
                list.items.push_back(mapOf(field.fields, field.element(section, i)));
            if (!list.items.empty()) append(map, name, std::move(list));
            return;
        }
        case Form::choiceOrOne:
            for (const Field& alternative : field.fields)
                if (const Value value = alternative.fetch(section); isSaid(value))
                    append(map, name, one(alternative.row.name, valueNode(value, alternative.row)));
            break;
        case Form::value:
            break;
        }
        if (const Value value = field.fetch(section); isSaid(value))
            append(map, name, valueNode(value, field.row));
    }

    Node mapOf(std::span<const Field> fields, const void* section) const {
        Node map = flowNode(Kind::map);
        for (const Field& field : fields) appendField(map, field, section);
        return map;
    }
    Node blockOf(std::span<const Field> fields, const void* section) const {
        Node map = mapOf(fields, section);
        map.flow = false;
        return map;
    }

    static void erase(Node& map, std::string_view key) {
        std::erase_if(map.members, [key](const Node::Member& member) { return member.key == key; });
    }

    Node camera() const {
        Node map = blockOf(cameraFields(), &description_.camera);
        erase(map, description_.camera.lookAt ? "forward" : "look_at");
        erase(map, description_.camera.fieldOfView ? "screen" : "field_of_view");
        return map;
    }

    Node background() const {
        const Background& background = description_.background;
        Node map = blockOf(backgroundFields(), &background);
        if (!background.texture && background.mapping == Mapping::hemisphere) erase(map, "mapping");
        if (background.mapping != Mapping::legacyHemisphere)
            erase(map, "center"), erase(map, "radius");
        return map;
    }

    void appendRows(Node& map, const Instance& instance) const {
        for (std::size_t i = 0; i < instance.rows.size(); ++i)
            if (isSaid(instance.values[i]))
                append(map, instance.rows[i].name, valueNode(instance.values[i], instance.rows[i]));
    }

    Node textures() const {
        Node map = block(Kind::map);
        for (const Texture& texture : description_.textures) {
            Node rows = flowNode(Kind::map);
            appendRows(rows, texture.instance);
            append(map, texture.name, one(texture.instance.type, std::move(rows)));
        }
        return map;
    }

    Node lights() const {
        Node list = block(Kind::sequence);
        for (const PointLight& light : description_.lights)
            list.items.push_back(item("point", mapOf(pointLightFields(), &light)));
        return list;
    }

    /// A material that stands inside its object has the object's name and a dot in its own.
    static bool isInline(const Material& material) {
        return material.name.find('.') != std::string::npos;
    }

    Node materials() const {
        Node map = block(Kind::map);
        for (const Material& material : description_.materials)
            if (!isInline(material)) append(map, material.name, mapOf(materialFields(), &material));
        return map;
    }

    Node objects() const {
        Node list = block(Kind::sequence);
        for (const Object& object : description_.objects) {
            Node map = flowNode(Kind::map);
            append(map, "name", textNode(object.name));
            appendRows(map, object.shape);
            if (object.loader) {
                append(map, "loader", textNode(object.loader->type));
                appendRows(map, *object.loader);
            }
            if (object.material) {
                const Material& material = description_.materials[*object.material];
                append(map, "material",
                       isInline(material) ? mapOf(materialFields(), &material)
                                          : textNode(material.name));
            }
            for (const Field& field : placementFields()) appendField(map, field, &object.placement);
            list.items.push_back(item(object.shape.type, std::move(map)));
        }
        return list;
    }

    // ---- animation -----------------------------------------------------------------------------------------

    static Node range(std::uint32_t first, std::uint32_t last) {
        Node list = flowNode(Kind::sequence);
        list.items = {scalarNode(std::to_string(first)), scalarNode(std::to_string(last))};
        return list;
    }

    Node target(const ObjectTarget& target) const {
        if (target.objects.size() == 1)
            return textNode(description_.objects[target.objects.front()].name);
        Node list = flowNode(Kind::sequence);
        for (const std::uint32_t object : target.objects)
            list.items.push_back(textNode(description_.objects[object].name));
        return list;
    }

    static Node keyframes(const Keyframes& keyframes, const rt_param& row) {
        Node map = flowNode(Kind::map);
        for (const Keyframes::Key& key : keyframes.keys) {
            Value value;
            if (row.type == RT_INTEGER)
                value.data = static_cast<std::int64_t>(key.values[0]);
            else if (row.type == RT_REAL)
                value.data = key.values[0];
            else
                value.data = Vec3(key.values[0], key.values[1], key.values[2]);
            append(map, std::to_string(key.frame), nodeOf(value, row));
        }
        return map;
    }

    /// The struct that the motion's fields fill, and their key.
    static std::pair<std::string_view, const void*> motionOf(const Motion& motion) {
        if (const auto* rotate = std::get_if<Rotate>(&motion)) return {"rotate", rotate};
        if (const auto* rotateSelf = std::get_if<RotateSelf>(&motion))
            return {"rotate_self", rotateSelf};
        if (const auto* move = std::get_if<Move>(&motion)) return {"move", move};
        if (const auto* moveRadius = std::get_if<MoveRadius>(&motion))
            return {"move_radius", moveRadius};
        return {"move_direct", &std::get<MoveDirect>(motion)};
    }

    Node track(const Track& track) const {
        Node map = flowNode(Kind::map);
        if (const auto* parameter = std::get_if<ParameterTarget>(&track.target)) {
            const auto& frames = std::get<Keyframes>(*track.motion);
            append(map, "target", textNode(parameter->path));
            append(map, "keyframes", keyframes(frames, *parameter->parameter.row));
            const Value interpolation{static_cast<std::int64_t>(frames.interpolation), {}};
            append(map, "interpolation",
                   nodeOf(interpolation, findField(trackFields(), "interpolation")->row));
            return map;
        }
        if (const auto* fade = std::get_if<BackgroundFade>(&track.target)) {
            append(map, "background", textNode(description_.textures[fade->texture].name));
        } else {
            if (const auto* point = std::get_if<CameraTarget>(&track.target)) {
                append(map, "target",
                       textNode(point->point == CameraPoint::position ? "camera.position"
                                : point->point == CameraPoint::front  ? "camera.front"
                                                                      : "camera.top"));
            } else {
                const auto& objects = std::get<ObjectTarget>(track.target);
                append(map, "target", target(objects));
                if (objects.faces)
                    append(map, "faces", range((*objects.faces)[0], (*objects.faces)[1]));
                append(map, "each", scalarNode(objects.each ? "true" : "false"));
            }
            const auto [key, section] = motionOf(*track.motion);
            append(map, key, mapOf(findField(motionFields(), key)->fields, section));
        }
        append(map, "frames", range(track.frames.first, track.frames.last));
        for (const Field& field : trackFields()) appendField(map, field, &track);
        return map;
    }

    Node animation(const Animation& animation) const {
        Node map = blockOf(animationFields(), &animation);
        Node tracks = block(Kind::sequence);
        for (const Track& each : animation.tracks) tracks.items.push_back(track(each));
        if (!tracks.items.empty()) append(map, "tracks", std::move(tracks));
        return map;
    }

    const Description& description_;
};

} // namespace

Node fullScene(const Description& description) { return Writer(description).scene(); }

} // namespace rt::scene
