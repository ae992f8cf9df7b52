#include <core/scene/validate.hpp>

#include <core/numeric/rounding.hpp>
#include <core/scene/codes.hpp>
#include <core/scene/file_suffix.hpp>
#include <core/scene/map_reader.hpp>
#include <core/scene/names.hpp>
#include <core/scene/validate_animation.hpp>

#include <algorithm>
#include <filesystem>
#include <map>
#include <unordered_map>

namespace rt::scene {
namespace {

using Kind = Node::Kind;

/// Object names that paths such as camera.position use for something else.
bool isReservedName(std::string_view name) {
    return std::any_of(sections().begin(), sections().end(),
                       [name](const Section& section) { return section.name == name; });
}

std::string_view kindWord(TypeKind kind) {
    return kind == TypeKind::shape ? "shape" : kind == TypeKind::texture ? "texture" : "loader";
}

bool isTypeName(std::string_view name) {
    constexpr std::size_t kMaxTypeName = 64;
    return !name.empty() && name.size() <= kMaxTypeName && name[0] >= 'a' && name[0] <= 'z' &&
           std::all_of(name.begin(), name.end(), [](char c) {
               return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
           });
}

/// Why `name` cannot name a thing of the scene, or "".
std::string nameFault(std::string_view name) {
    constexpr std::size_t kMaxName = 200;
    if (name.empty()) return "must not be empty";
    if (name.size() > kMaxName)
        return "must not be longer than " + std::to_string(kMaxName) + " bytes";
    if (name.front() == ' ' || name.back() == ' ') return "must not start or end with a blank";
    for (const char c : name)
        if (c == '.' || c == '=' || static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            return "must not contain " + scene::quoted(std::string_view(&c, 1)) +
                   ", which paths such as moon.radius use";
    return {};
}

class Validator {
public:
    Validator(TypeCatalog& catalog, Diagnostics& diagnostics, const Limits& limits)
        : catalog_(catalog), diagnostics_(diagnostics), limits_(limits) {}

    void run(const Node& root) {
        description_.path = root.location.source ? root.location.source->path : "";
        const Location start{root.location.source, root.location.source ? 1u : 0u, 1};
        if (root.kind != Kind::map) {
            diagnostics_.error(codes::kWrongKind, root.location,
                               "a scene is a map of sections that starts with 'rt: 1'; this is " +
                                   std::string(kindName(root)));
            return;
        }
        MapReader scene(root, start, "the scene", textures_, diagnostics_);
        if (!readVersion(scene)) return;

        // Textures before those who name them; the film last, for it names everything.
        readTextures(scene.takeMember("textures"));
        readImage(section(scene, "image"));
        readCamera(section(scene, "camera"), scene);
        readBounds(section(scene, "bounds"));
        readRender(section(scene, "render"));
        const Node::Member* background = section(scene, "background");
        readBackground(background);
        readLights(scene.take("lights"));
        readMaterials(scene.takeMember("materials"));
        readObjects(scene.take("objects"));
        if (const Node::Member* animation = scene.takeMember("animation"))
            validateAnimation(*animation, textures_, description_, diagnostics_);
        refuseIdleMapping(background);
        scene.finish();
    }

    Description& description() { return description_; }

private:
    using NamedPlaces = std::unordered_map<std::string, Location>;

    const Node::Member* section(MapReader& scene, std::string_view name) {
        return scene.takeMember(name);
    }

    /// False where nothing else of the scene can be judged.
    bool readVersion(MapReader& scene) {
        const Node* node = scene.take("rt");
        if (!node) {
            diagnostics_.error(codes::kMissingKey, scene.place(),
                               "the scene needs the key 'rt', the version of its language",
                               "start with 'rt: 1'");
            return true;
        }
        const Parsed<std::int64_t> version = parseInteger(*node);
        if (const auto* fault = std::get_if<Fault>(&version)) {
            scene.report("rt", *fault);
            return true;
        }
        const std::int64_t number = std::get<std::int64_t>(version);
        if (number == kLanguageVersion) return true;
        diagnostics_.error(codes::kVersion, node->location,
                           number > kLanguageVersion
                               ? "the scene needs version " + std::to_string(number) +
                                     " of the scene language; this program knows version " +
                                     std::to_string(kLanguageVersion)
                               : "there is no version " + std::to_string(number) +
                                     " of the scene language",
                           number > kLanguageVersion ? "install a newer rt" : "write 'rt: 1'");
        return false;
    }

    /// Reads the whole section into `target`. The places of its keys are asked from the node.
    void readMap(const Node::Member& member, std::span<const Field> fields, void* target,
                 const std::string& subject) {
        MapReader reader(member.value, member.keyLocation, subject, textures_, diagnostics_);
        reader.readFields(fields, target);
        reader.finish();
    }

    static Location placeOf(const Node::Member& member, std::string_view key) {
        const Node* node = member.value.find(key);
        return node ? node->location : member.keyLocation;
    }

    void readImage(const Node::Member* member) {
        Image& image = description_.image;
        if (!member) return applyDefaults(imageFields(), &image);
        readMap(*member, imageFields(), &image, "image");
        if (std::uint64_t{image.width} * image.height > limits_.pixels)
            diagnostics_.error(codes::kTooManyPixels, placeOf(*member, "width"),
                               "the picture has " + std::to_string(image.width) + " x " +
                                   std::to_string(image.height) + " = " +
                                   std::to_string(std::uint64_t{image.width} * image.height) +
                                   " pixels; the limit is " + std::to_string(limits_.pixels),
                               "--limit-pixels raises it");
        const std::filesystem::path file(image.file);
        if (file.is_absolute() ||
            std::any_of(file.begin(), file.end(), [](const auto& part) { return part == ".."; }))
            diagnostics_.error(
                codes::kPath, placeOf(*member, "file"),
                "image, file: must be below the current folder, relative and without '..' (got " +
                    image.file + ")",
                "name any other place with -o");
    }

    void readCamera(const Node::Member* member, MapReader& scene) {
        Camera& camera = description_.camera;
        if (!member) {
            scene.require("camera");
            return;
        }
        const std::size_t errorsBefore = diagnostics_.errorCount();
        readMap(*member, cameraFields(), &camera, "camera");
        if (member->value.kind != Kind::map) return;
        const Node &map = member->value, *forward = map.find("forward"),
                   *lookAt = map.find("look_at");
        if (forward && lookAt)
            diagnostics_.error(codes::kExclusive, lookAt->location,
                               "camera: 'forward' and 'look_at' exclude each other");
        if (!forward && !lookAt)
            diagnostics_.error(codes::kMissingKey, member->keyLocation,
                               "camera needs the key 'forward' or the key 'look_at'");
        if (map.find("screen")) {
            if (const Node* fieldOfView = map.find("field_of_view"))
                diagnostics_.error(codes::kExclusive, fieldOfView->location,
                                   "camera: 'screen' and 'field_of_view' exclude each other");
            camera.fieldOfView.reset();
        }
        if (diagnostics_.errorCount() != errorsBefore) return;

        resolve(camera, static_cast<double>(description_.image.width) / description_.image.height);
        const Location aim = lookAt ? lookAt->location : forward->location;
        if (camera.forward == Vec3(0))
            diagnostics_.error(codes::kDirection, aim,
                               lookAt ? "camera, look_at: is the camera's own position"
                                      : "camera, forward: must not be [0, 0, 0]");
        else if (camera.up == Vec3(0))
            diagnostics_.error(codes::kDirection, placeOf(*member, "up"),
                               "camera, up: must not be [0, 0, 0]");
        else if (areParallel(camera.forward, camera.up))
            diagnostics_.error(codes::kDirection, map.find("up") ? placeOf(*member, "up") : aim,
                               "camera: looks along 'up', so that no side of the picture is up",
                               "name another direction with 'up'");
    }

    /// To rounding: the sine of the angle is bounded by what the cross product of exactly parallel vectors can leave.
    static bool areParallel(Vec3 a, Vec3 b) {
        a /= numeric::maxComponent(numeric::abs(a)), b /= numeric::maxComponent(numeric::abs(b));
        return numeric::length(numeric::cross(a, b)) <=
               numeric::gamma(4) * numeric::length(a) * numeric::length(b);
    }

    void readBounds(const Node::Member* member) {
        if (!member) return;
        const std::size_t errorsBefore = diagnostics_.errorCount();
        Box3d& bounds = description_.bounds.emplace();
        readMap(*member, boundsFields(), &bounds, "bounds");
        if (diagnostics_.errorCount() != errorsBefore) return;
        for (int i = 0; i < 3; ++i)
            if (!(bounds.min[i] < bounds.max[i]))
                return diagnostics_.error(
                    codes::kBounds, placeOf(*member, "max"),
                    std::string("bounds: max must be above min on every axis, but on ") + "xyz"[i] +
                        " " + shortest(bounds.max[i]) + " is not above " + shortest(bounds.min[i]));
    }

    void readRender(const Node::Member* member) {
        if (member)
            readMap(*member, renderFields(), &description_.render, "render");
        else
            applyDefaults(renderFields(), &description_.render);
    }

    void readBackground(const Node::Member* member) {
        Background& background = description_.background;
        if (!member) return applyDefaults(backgroundFields(), &background);
        readMap(*member, backgroundFields(), &background, "background");
        if (member->value.kind != Kind::map) return;
        const bool isLegacy = background.mapping == Mapping::legacyHemisphere;
        for (const char* key : {"center", "radius"}) {
            const Node* node = member->value.find(key);
            if (isLegacy && !node)
                diagnostics_.error(
                    codes::kMissingKey, placeOf(*member, "mapping"),
                    std::string("background: mapping legacy_hemisphere needs the key '") + key +
                        "'");
            if (!isLegacy && node)
                diagnostics_.error(codes::kExclusive, node->location,
                                   std::string("background, ") + key +
                                       ": belongs to mapping legacy_hemisphere only");
        }
    }

    /// Of a plain background that never fades to a texture.
    void refuseIdleMapping(const Node::Member* background) {
        if (!background || background->value.find("texture")) return;
        const Node* mapping = background->value.find("mapping");
        const auto isFade = [](const Track& track) {
            return std::holds_alternative<BackgroundFade>(track.target);
        };
        if (mapping && !(description_.animation &&
                         std::ranges::any_of(description_.animation->tracks, isFade)))
            diagnostics_.error(codes::kExclusive, mapping->location,
                               "background, mapping: has no meaning without a texture");
    }

    // ---- types ---------------------------------------------------------------------------------------------

    /// The type's rows, or nothing after an error. A plugin that is refused is reported once.
    std::optional<TypeRows> findType(TypeKind kind, std::string_view name, const Location& place) {
        const std::string what = std::string(kindWord(kind)) + " " + scene::quoted(name);
        if (!isTypeName(name)) {
            diagnostics_.error(
                codes::kTypeName, place,
                what + ": the name of a type is [a-z][a-z0-9_]*, at most 64 characters");
            return std::nullopt;
        }
        const auto key = std::pair(kind, std::string(name));
        if (const auto known = types_.find(key); known != types_.end()) return known->second;
        const auto found = catalog_.find(kind, name);
        if (const auto* rows = std::get_if<TypeRows>(&found)) {
            types_.emplace(key, *rows);
            return *rows;
        }
        std::vector<std::string> names = catalog_.names(kind);
        const bool exists = std::find(names.begin(), names.end(), name) != names.end();
        std::string near = exists ? "" : nearest(name, names);
        // What is not opened yet may be of another kind.
        while (!near.empty() && !std::holds_alternative<TypeRows>(catalog_.find(kind, near))) {
            std::erase(names, near);
            near = nearest(name, names);
        }
        if (!near.empty()) {
            diagnostics_.error(codes::kUnknownType, place, "there is no " + what,
                               "did you mean '" + near + "'?");
        } else {
            diagnostics_.error(codes::kNoPlugin, place,
                               what + ": " + std::get<TypeRefusal>(found).reason);
            types_.emplace(key, std::nullopt);
        }
        return std::nullopt;
    }

    /// `TYPE: {...}` as the only member of `item`, or null after an error.
    const Node::Member* oneType(const Node& item, const std::string& subject, std::string_view noun,
                                std::string_view example) {
        if (item.kind == Kind::map && item.members.size() == 1) return &item.members.front();
        const bool isFlat = item.kind == Kind::map && item.members.size() > 1 &&
                            item.members.front().value.kind == Kind::null;
        const std::string wanted =
            "must be a map of one " + std::string(noun) + ", such as " + std::string(example);
        diagnostics_.error(codes::kOneType,
                           item.kind == Kind::map && isFlat ? item.members[1].keyLocation
                                                            : item.location,
                           isFlat ? subject + ": this key stands beside '" +
                                        item.members.front().key + "' and must stand below it"
                           : item.kind == Kind::map
                               ? subject + ": " + wanted + ", but has " +
                                     std::to_string(item.members.size()) + " keys"
                               : subject + ": " + wanted + ", not " + std::string(kindName(item)),
                           isFlat ? "indent it further" : "");
        return nullptr;
    }

    // ---- textures, lights, materials -------------------------------------------------------------------------

    void checkName(std::string_view name, const Location& place, const std::string& subject) {
        if (const std::string fault = nameFault(name); !fault.empty())
            diagnostics_.error(codes::kName, place, subject + ": a name " + fault);
    }

    bool isMapOf(const Node::Member& section, std::string_view nouns, std::string_view example) {
        if (section.value.kind == Kind::map) return true;
        diagnostics_.error(codes::kWrongKind, section.value.location,
                           section.key + ": must be a map of " + std::string(nouns) + ", such as " +
                               std::string(example) + ", not " +
                               std::string(kindName(section.value)));
        return false;
    }

    bool isListOf(const Node& section, std::string_view name, std::string_view nouns,
                  std::string_view example) {
        if (section.kind == Kind::sequence) return true;
        diagnostics_.error(codes::kWrongKind, section.location,
                           std::string(name) + ": must be a list of " + std::string(nouns) +
                               ", such as " + std::string(example) + ", not " +
                               std::string(kindName(section)));
        return false;
    }

    void readTextures(const Node::Member* section) {
        if (!section || !isMapOf(*section, "textures", "'sky: {image: {file: sky.png}}'")) return;
        const std::vector<Node::Member>& members = section->value.members;
        for (const Node::Member& member : members) {
            textures_.indices.emplace(member.key,
                                      static_cast<std::uint32_t>(textures_.names.size()));
            textures_.names.push_back(member.key);
        }
        for (const Node::Member& member : members) {
            const std::string subject = "texture " + scene::quoted(member.key);
            checkName(member.key, member.keyLocation, subject);
            Texture& texture = description_.textures.emplace_back();
            texture.name = member.key;
            if (const Node::Member* type =
                    oneType(member.value, subject, "type", "'{image: {file: sky.png}}'")) {
                MapReader reader(type->value, type->keyLocation, subject, textures_, diagnostics_);
                texture.instance.type = type->key;
                texture.instance.location = type->keyLocation;
                if (const auto rows = findType(TypeKind::texture, type->key, type->keyLocation)) {
                    texture.instance.rows = rows->rows;
                    texture.instance.values = reader.readRows(rows->rows);
                    reader.finish();
                }
            }
        }
        for (std::uint32_t i = 0; i < description_.textures.size(); ++i)
            if (needsItself(i)) return; // one report of a cycle is enough
    }

    /// Reports a cycle of textures that leads back to texture `start`.
    bool needsItself(std::uint32_t start) {
        std::vector<std::uint32_t> open{start};
        std::vector<bool> seen(description_.textures.size());
        while (!open.empty()) {
            const Instance& instance = description_.textures[open.back()].instance;
            open.pop_back();
            for (std::size_t i = 0; i < instance.values.size(); ++i) {
                const auto* index = std::get_if<std::int64_t>(&instance.values[i].data);
                if (instance.rows[i].type != RT_TEXTURE || !index) continue;
                const auto needed = static_cast<std::uint32_t>(*index);
                if (needed == start) {
                    diagnostics_.error(codes::kTextureCycle, instance.values[i].location,
                                       "texture " +
                                           scene::quoted(description_.textures[start].name) +
                                           " needs itself");
                    return true;
                }
                if (!seen[needed]) seen[needed] = true, open.push_back(needed);
            }
        }
        return false;
    }

    void readLights(const Node* list) {
        if (!list || !isListOf(*list, "lights", "lights", "'- point: {position: [0, 0, 9]}'"))
            return;
        NamedPlaces places;
        for (std::size_t i = 0; i < list->items.size(); ++i) {
            const std::string subject = "lights[" + std::to_string(i) + "]";
            const Node::Member* type =
                oneType(list->items[i], subject, "light", "'- point: {position: [0, 0, 9]}'");
            if (!type) continue;
            if (type->key != "point") {
                const std::string near = nearest(type->key, {"point"});
                diagnostics_.error(codes::kUnknownType, type->keyLocation,
                                   "there is no light " + scene::quoted(type->key),
                                   near.empty() ? "lights are of type 'point'"
                                                : "did you mean 'point'?");
                continue;
            }
            PointLight& light = description_.lights.emplace_back();
            readMap(*type, pointLightFields(), &light, "point light");
            if (!light.name.empty())
                claimName(light.name, placeOf(*type, "name"), "point light, name", places);
        }
        inventNames(description_.lights,
                    [](const PointLight&) { return std::string_view("point"); });
    }

    /// Valid and not taken yet.
    void claimName(const std::string& name, const Location& place, const std::string& subject,
                   NamedPlaces& places) {
        checkName(name, place, subject);
        const auto [taken, isFree] = places.emplace(name, place);
        if (!isFree)
            diagnostics_.error(codes::kDuplicateName, place,
                               subject + ": the name " + scene::quoted(name) +
                                   " is taken in line " + std::to_string(taken->second.line));
    }

    template <class T, class TypeOf> static void inventNames(std::vector<T>& list, TypeOf typeOf) {
        std::vector<TypedName> items;
        for (const T& item : list) items.push_back({typeOf(item), item.name});
        std::vector<std::string> names = withInventedNames(items);
        for (std::size_t i = 0; i < list.size(); ++i) list[i].name = std::move(names[i]);
    }

    void readMaterial(const Node& map, const Location& place, const std::string& subject,
                      Material& material) {
        MapReader reader(map, place, subject, textures_, diagnostics_);
        reader.readFields(materialFields(), &material);
        reader.finish();
        material.location = place;
        constexpr std::string_view kShares[] = {"diffuse", "specular", "transmission",
                                                "environment"};
        const bool hasShare =
            std::any_of(std::begin(kShares), std::end(kShares),
                        [&](std::string_view key) { return map.find(key) != nullptr; });
        if (!hasShare) material.diffuse = LinearRgb::grey(1);
    }

    void readMaterials(const Node::Member* section) {
        if (!section || !isMapOf(*section, "materials", "'red: {color: [1, 0, 0]}'")) return;
        for (const Node::Member& member : section->value.members) {
            const std::string subject = "material " + scene::quoted(member.key);
            checkName(member.key, member.keyLocation, subject);
            materialNames_.push_back(member.key);
            materialIndices_.emplace(member.key,
                                     static_cast<std::uint32_t>(description_.materials.size()));
            Material& material = description_.materials.emplace_back();
            material.name = member.key;
            readMaterial(member.value, member.keyLocation, subject, material);
        }
    }

    // ---- objects -------------------------------------------------------------------------------------------

    void readObjects(const Node* list) {
        if (!list || !isListOf(*list, "objects", "objects", "'- sphere: {radius: 1}'")) return;
        NamedPlaces places;
        std::vector<std::pair<std::uint32_t, const Node::Member*>>
            inlineMaterials; // object and its material
        for (std::size_t i = 0; i < list->items.size(); ++i) {
            const std::string subject = "objects[" + std::to_string(i) + "]";
            const Node::Member* type =
                oneType(list->items[i], subject, "shape", "'- sphere: {radius: 1}'");
            if (!type) continue;
            const auto index = static_cast<std::uint32_t>(description_.objects.size());
            Object& object = description_.objects.emplace_back();
            if (const Node::Member* material = readObject(*type, object, places))
                inlineMaterials.emplace_back(index, material);
        }
        inventNames(description_.objects,
                    [](const Object& object) -> std::string_view { return object.shape.type; });
        for (const auto& [index, node] : inlineMaterials) {
            Object& object = description_.objects[index];
            object.material = static_cast<std::uint32_t>(description_.materials.size());
            Material& material = description_.materials.emplace_back();
            material.name = object.name + ".material"; // no name in a file has a dot
            readMaterial(node->value, node->keyLocation,
                         object.shape.type + " " + scene::quoted(object.name) + ", material",
                         material);
        }
    }

    /// Returns the member of a material that stands inside the object, to be read when names are known.
    const Node::Member* readObject(const Node::Member& type, Object& object, NamedPlaces& places) {
        object.location = object.shape.location = type.keyLocation;
        object.shape.type = type.key;
        MapReader reader(type.value, type.keyLocation, type.key, textures_, diagnostics_);

        if (const Node* name = reader.take("name")) {
            const Parsed<Value> parsed = parseValue(*name, findField(objectFields(), "name")->row);
            if (const auto* fault = std::get_if<Fault>(&parsed)) {
                reader.report("name", *fault);
            } else {
                object.name = std::get<std::string>(std::get<Value>(parsed).data);
                claimName(object.name, name->location, type.key + ", name", places);
                if (isReservedName(object.name))
                    diagnostics_.error(codes::kName, name->location,
                                       type.key + ", name: " + scene::quoted(object.name) +
                                           " is a section of the scene and no name for an object");
                reader.rename(type.key + " " + scene::quoted(object.name));
            }
        }
        const Node::Member* inlineMaterial = readMaterialReference(reader, object);
        reader.readFields(placementFields(), &object.placement);
        checkPlacement(type.value, object.placement, reader);
        object.worldFromObject = worldFromObject(object.placement);

        if (const auto rows = findType(TypeKind::shape, type.key, type.keyLocation)) {
            if (refuseReservedRows(*rows, type.keyLocation)) return inlineMaterial;
            object.shape.rows = rows->rows;
            object.shape.values = reader.readRows(rows->rows);
            if (readLoader(reader, object)) reader.finish();
        }
        return inlineMaterial;
    }

    const Node::Member* readMaterialReference(MapReader& reader, Object& object) {
        const Node::Member* member = reader.takeMember("material");
        if (!member || member->value.kind == Kind::map) return member;
        if (member->value.kind != Kind::scalar) {
            reader.report("material", {codes::kWrongKind,
                                       member->value.location,
                                       "must be the name of a material or a map, not " +
                                           std::string(kindName(member->value)),
                                       {}});
            return nullptr;
        }
        const std::string& name = member->value.text;
        if (const auto found = materialIndices_.find(name); found != materialIndices_.end()) {
            object.material = found->second;
            return nullptr;
        }
        const std::string near = nearest(name, materialNames_);
        reader.report("material",
                      {codes::kUnknownMaterial, member->value.location,
                       "there is no material " + scene::quoted(name),
                       !near.empty() ? "did you mean '" + near + "'?"
                       : materialNames_.empty()
                           ? "the scene has no section 'materials'; a material may also "
                             "stand here: {color: [1, 0, 0]}"
                           : ""});
        return nullptr;
    }

    void checkPlacement(const Node& map, const Placement& placement, MapReader& reader) {
        for (int i = 0; i < 3; ++i)
            if (!(std::fabs(placement.scale[i]) * kMaxLength >=
                  1)) { // so that the inverse is finite
                reader.report("scale",
                              {codes::kZeroScale,
                               map.find("scale")->location,
                               placement.scale[i] == 0 ? "must not be 0" : "is too close to 0",
                               {}});
                break;
            }
        for (const Placement::Rotation& rotation : placement.rotations)
            if (rotation.axis == Vec3(0)) {
                reader.report("rotate", {codes::kDirection,
                                         map.find("rotate")->location,
                                         "an axis must not be [0, 0, 0]",
                                         {}});
                break;
            }
    }

    bool refuseReservedRows(const TypeRows& rows, const Location& place) {
        for (const rt_param& row : rows.rows)
            if (findField(objectFields(), row.name)) {
                diagnostics_.error(codes::kReservedRow, place,
                                   "the plugin of shape " + scene::quoted(rows.name) +
                                       " has a parameter '" + row.name +
                                       "', a key that every object has");
                return true;
            }
        return false;
    }

    /// The loader of the shape's file, if it has one. False where the object's keys cannot be known.
    bool readLoader(MapReader& reader, Object& object) {
        const auto row = std::find_if(
            object.shape.rows.begin(), object.shape.rows.end(),
            [](const rt_param& candidate) { return (candidate.flags & RT_LOADS) != 0; });
        if (row == object.shape.rows.end()) return true;
        const Value& file =
            object.shape.values[static_cast<std::size_t>(row - object.shape.rows.begin())];
        const auto* path = std::get_if<std::string>(&file.data);
        const Node* named = reader.take("loader");
        if (!path) return true; // absent, or an error already

        std::string type;
        Location place = file.location;
        if (named) {
            if (named->kind != Kind::scalar) {
                reader.report("loader",
                              {codes::kWrongKind,
                               named->location,
                               "must be the name of a loader, not " + std::string(kindName(*named)),
                               {}});
                return false;
            }
            type = named->text;
            place = named->location;
        } else {
            const std::string suffix = fileSuffix(*path);
            type = suffix.empty() ? "" : catalog_.loaderFor(suffix);
            if (type.empty()) {
                std::string loaders; // names() offers what is not opened yet as everything
                for (const std::string& name : catalog_.names(TypeKind::loader))
                    if (std::holds_alternative<TypeRows>(catalog_.find(TypeKind::loader, name)))
                        loaders += (loaders.empty() ? "" : ", ") + name;
                reader.report(
                    row->name,
                    {codes::kNoLoader, file.location,
                     suffix.empty() ? "the file's name has no suffix that says what reads it"
                                    : "no loader is known for files that end with " +
                                          scene::quoted("." + suffix),
                     loaders.empty() ? "" : "name one with the key 'loader': " + loaders});
                return false;
            }
        }
        const auto rows = findType(TypeKind::loader, type, place);
        if (!rows) return false;
        Instance& loader = object.loader.emplace();
        loader.type = type;
        loader.location = place;
        loader.rows = rows->rows;
        loader.values = reader.readRows(rows->rows);
        return true;
    }

    TypeCatalog& catalog_;
    Diagnostics& diagnostics_;
    const Limits limits_;
    Description description_;
    TextureNames textures_;
    std::map<std::pair<TypeKind, std::string>, std::optional<TypeRows>> types_; // none: refused
    std::vector<std::string> materialNames_;
    std::unordered_map<std::string, std::uint32_t> materialIndices_;
};

} // namespace

std::optional<Description> validate(const Node& root, TypeCatalog& catalog,
                                    Diagnostics& diagnostics, const Limits& limits) {
    Diagnostics found;
    Validator validator(catalog, found, limits);
    validator.run(root);
    found.sortByPlace();
    diagnostics.add(found);
    if (found.failed()) return std::nullopt;
    return std::move(validator.description());
}

} // namespace rt::scene
