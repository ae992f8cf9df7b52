#include <core/scene/validate_animation.hpp>

#include <core/scene/codes.hpp>
#include <core/scene/language.hpp>
#include <core/scene/parameter.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace rt::scene {
namespace {

using Kind = Node::Kind;

class TrackReader {
public:
    TrackReader(const Node& node, std::size_t number, const TextureNames& textures,
                Description& description, Diagnostics& diagnostics)
        : node_(node), description_(description), animation_(*description.animation),
          diagnostics_(diagnostics),
          reader_(node, node.location, "tracks[" + std::to_string(number) + "]", textures,
                  diagnostics) {}

    /// The track, or nothing after an error.
    std::optional<Track> read() {
        const std::size_t errorsBefore = diagnostics_.errorCount();
        track_.location = node_.location;
        reader_.readFields(trackFields(), &track_); // easing
        for (const Field& field : trackFields())
            if (field.form == Form::byHand)
                nodes_.emplace(field.row.name, reader_.takeMember(field.row.name));
        if (node_.kind == Kind::map) readAll();
        reader_.finish();
        if (diagnostics_.errorCount() != errorsBefore) return std::nullopt;
        return std::move(track_);
    }

private:
    const Node::Member* written(const char* key) const { return nodes_.at(key); }

    void report(const char* key, Code code, const Location& place, std::string clause,
                std::string suggestion = {}) {
        reader_.report(key, {code, place, std::move(clause), std::move(suggestion)});
    }

    /// "tracks[2]: sentence" at the track itself.
    void reportWhole(Code code, const std::string& sentence) {
        diagnostics_.error(code, node_.location, reader_.subject() + ": " + sentence);
    }

    void readAll() {
        const Node::Member *target = written("target"), *background = written("background");
        if (target && background)
            return report("background", codes::kExclusive, background->keyLocation,
                          "excludes 'target': a track moves the one or fades to the other");
        if (!target && !background)
            return reportWhole(codes::kMissingKey,
                               "needs the key 'target' or the key 'background'");

        const Node::Member* motion = findMotion();
        const Node::Member* keyframes = written("keyframes");
        if (background) {
            readFade(background->value, motion ? motion : keyframes);
        } else if (!motion && !keyframes) {
            reportWhole(
                codes::kMissingKey,
                "needs a motion: rotate, rotate_self, move, move_radius, move_direct or keyframes");
        } else if (keyframes) {
            readKeyframes(target->value, *keyframes);
        } else {
            readMotion(*motion);
            readTarget(target->value, *motion);
            readFrames();
        }
        if (keyframes)
            forbid("frames", "the keyframes say when"),
                forbid("easing", "keyframes have 'interpolation'");
        else
            forbid("interpolation", "only keyframes have it");
        if (background || keyframes || !std::holds_alternative<ObjectTarget>(track_.target))
            forbid("faces", "only objects have faces"), forbid("each", "only objects have faces");
    }

    void forbid(const char* key, const char* reason) {
        const auto known = nodes_.find(key);
        const Node::Member* member = known != nodes_.end() ? known->second : nullptr;
        if (!member && std::string_view(key) == "easing")
            for (const Node::Member& candidate : node_.members)
                if (candidate.key == key) member = &candidate;
        if (member)
            report(key, codes::kExclusive, member->keyLocation,
                   std::string("does not belong to this track: ") + reason);
    }

    /// The one motion that is written; a second one is an error.
    const Node::Member* findMotion() {
        const Node::Member *first = nullptr, *motion = nullptr;
        for (const Node::Member& member : node_.members) {
            const bool isKeyframes = member.key == "keyframes";
            if (!isKeyframes && !findField(motionFields(), member.key)) continue;
            if (first)
                report(member.key.c_str(), codes::kExclusive, member.keyLocation,
                       "excludes '" + first->key + "': a track has one motion",
                       "write a second track for the same target");
            else {
                first = &member;
                if (!isKeyframes) motion = &member;
            }
        }
        return motion;
    }

    // ---- frames ------------------------------------------------------------------------------------------------

    /// [first, last] of whole numbers >= 0, or nothing after an error.
    std::optional<std::array<std::uint32_t, 2>> readRange(const char* key, const Node& node,
                                                          double highest) {
        if (node.kind != Kind::sequence || node.items.size() != 2) {
            report(key, codes::kWrongKind, node.location,
                   std::string("must be [first, last]") +
                       (node.kind == Kind::sequence
                            ? " (got " + std::to_string(node.items.size()) +
                                  (node.items.size() == 1 ? " entry)" : " entries)")
                            : ", not " + std::string(kindName(node))));
            return std::nullopt;
        }
        std::array<std::uint32_t, 2> range{};
        for (std::size_t i = 0; i < 2; ++i) {
            rt_param row{};
            row.type = RT_INTEGER, row.min = 0, row.max = highest;
            const Parsed<Value> parsed = parseValue(node.items[i], row);
            if (const auto* fault = std::get_if<Fault>(&parsed)) {
                reader_.report(key, *fault);
                return std::nullopt;
            }
            range[i] =
                static_cast<std::uint32_t>(std::get<std::int64_t>(std::get<Value>(parsed).data));
        }
        return range;
    }

    void readFrames() {
        const Node::Member* member = written("frames");
        if (!member) return reportWhole(codes::kMissingKey, "needs the key 'frames'");
        const auto range = readRange("frames", member->value, highestFrame());
        if (!range) return;
        if ((*range)[0] >= (*range)[1])
            return report("frames", codes::kFrames, member->value.location,
                          "must rise: the first frame " + std::to_string((*range)[0]) +
                              " is not before the last, " + std::to_string((*range)[1]));
        track_.frames = {(*range)[0], (*range)[1]};
        if (track_.frames.first + 1 >= animation_.frames)
            diagnostics_.warning(member->value.location, reader_.subject() +
                                                             ": begins with the last frame, " +
                                                             std::to_string(animation_.frames - 1) +
                                                             ", or later and is never seen");
    }

    /// A motion may end beyond the last frame: the film then shows the beginning of it.
    static double highestFrame() { return findField(animationFields(), "frames")->row.max; }

    void readFade(const Node& node, const Node::Member* motion) {
        if (motion)
            report(motion->key.c_str(), codes::kMotion, motion->keyLocation,
                   "the background fades and has no motion");
        Background faded; // the row of background.texture says what a texture's name may be
        Node map;
        map.kind = Kind::map;
        map.members.push_back({"texture", node.location, node});
        MapReader name(map, node.location, reader_.subject() + ", background", textures(),
                       diagnostics_);
        const Field texture = *findField(backgroundFields(), "texture");
        name.readFields(std::span(&texture, 1), &faded);
        track_.target = BackgroundFade{faded.texture.value_or(0)};
        readFrames();
    }

    const TextureNames& textures() const { return reader_.textures(); }

    // ---- motions -----------------------------------------------------------------------------------------------

    template <class T> T readFields(const Node::Member& motion) {
        T result{};
        MapReader map(motion.value, motion.keyLocation, reader_.subject() + "." + motion.key,
                      textures(), diagnostics_);
        map.readFields(findField(motionFields(), motion.key)->fields, &result);
        map.finish();
        return result;
    }

    void readMotion(const Node::Member& motion) {
        const std::size_t errorsBefore = diagnostics_.errorCount();
        const auto requireDirection = [&](const char* key, const Vec3& direction) {
            if (diagnostics_.errorCount() == errorsBefore && direction == Vec3(0))
                diagnostics_.error(codes::kDirection, motion.value.find(key)->location,
                                   reader_.subject() + "." + motion.key + ", " + key +
                                       ": must not be [0, 0, 0]");
        };
        if (motion.key == "rotate") {
            const auto rotate = readFields<Rotate>(motion);
            requireDirection("axis", rotate.axis);
            track_.motion = rotate;
        } else if (motion.key == "rotate_self") {
            const auto rotate = readFields<RotateSelf>(motion);
            if (rotate.axis) requireDirection("axis", *rotate.axis);
            track_.motion = rotate;
        } else if (motion.key == "move") {
            track_.motion = readFields<Move>(motion);
        } else if (motion.key == "move_radius") {
            track_.motion = readFields<MoveRadius>(motion);
        } else {
            const auto move = readFields<MoveDirect>(motion);
            requireDirection("direction", move.direction);
            track_.motion = move;
        }
    }

    // ---- targets -----------------------------------------------------------------------------------------------

    void readTarget(const Node& node, const Node::Member& motion) {
        if (node.kind == Kind::scalar)
            if (const auto point = cameraPoint(node.text)) {
                track_.target = CameraTarget{*point};
                if (motion.key == "rotate_self")
                    report("target", codes::kMotion, node.location,
                           "a point of the camera cannot turn about itself", "use rotate");
                return;
            }
        ObjectTarget target;
        if (node.kind == Kind::scalar) {
            addObject(node, target);
        } else if (node.kind == Kind::sequence && !node.items.empty()) {
            for (const Node& item : node.items) {
                if (item.kind != Kind::scalar)
                    return report("target", codes::kWrongKind, item.location,
                                  "must be the name of an object, not " +
                                      std::string(kindName(item)));
                addObject(item, target);
            }
        } else {
            return report("target", codes::kWrongKind, node.location,
                          node.kind == Kind::sequence ? "is an empty list"
                                                      : "must be the name of an object, a list of "
                                                        "names or a point of the camera, not " +
                                                            std::string(kindName(node)));
        }
        readFaces(target);
        track_.target = std::move(target);
    }

    static std::optional<CameraPoint> cameraPoint(std::string_view path) {
        if (path == "camera.position") return CameraPoint::position;
        if (path == "camera.front") return CameraPoint::front;
        if (path == "camera.top") return CameraPoint::top;
        return std::nullopt;
    }

    void addObject(const Node& name, ObjectTarget& target) {
        const auto& objects = description_.objects;
        const auto found = std::find_if(objects.begin(), objects.end(), [&](const Object& object) {
            return object.name == name.text;
        });
        if (found == objects.end()) return reportUnknownTarget(name);
        const auto index = static_cast<std::uint32_t>(found - objects.begin());
        if (std::find(target.objects.begin(), target.objects.end(), index) != target.objects.end())
            return report("target", codes::kTarget, name.location,
                          "names " + quoted(name.text) + " twice");
        target.objects.push_back(index);
    }

    void reportUnknownTarget(const Node& name) {
        const Parsed<Parameter> parameter = findParameter(description_, name.text, name.location);
        if (std::holds_alternative<Parameter>(parameter))
            return report("target", codes::kTarget, name.location,
                          quoted(name.text) + " is a number, which only keyframes change",
                          "write 'keyframes: {FRAME: VALUE, ...}'");
        std::vector<std::string> names{"camera.position", "camera.front", "camera.top"};
        for (const Object& object : description_.objects) names.push_back(object.name);
        const std::string near = nearest(name.text, names);
        report("target", codes::kTarget, name.location, "there is no object " + quoted(name.text),
               near.empty() ? "" : "did you mean '" + near + "'?");
    }

    void readFaces(ObjectTarget& target) {
        if (const Node::Member* member = written("each")) {
            const Parsed<Value> parsed =
                parseValue(member->value, findField(trackFields(), "each")->row);
            if (const auto* fault = std::get_if<Fault>(&parsed))
                reader_.report("each", *fault);
            else
                target.each = std::get<std::int64_t>(std::get<Value>(parsed).data) != 0;
        }
        const Node::Member* member = written("faces");
        if (!member) return;
        if (target.objects.size() > 1)
            return report("faces", codes::kTarget, member->keyLocation,
                          "needs a target of one object, whose faces they are");
        const auto range = readRange("faces", member->value, 4294967294.0);
        if (!range) return;
        if ((*range)[0] > (*range)[1])
            return report("faces", codes::kFrames, member->value.location,
                          "must rise: the first face " + std::to_string((*range)[0]) +
                              " is after the last, " + std::to_string((*range)[1]));
        target.faces = *range;
    }

    // ---- keyframes ---------------------------------------------------------------------------------------------

    void readKeyframes(const Node& target, const Node::Member& member) {
        if (target.kind != Kind::scalar)
            return report("target", codes::kWrongKind, target.location,
                          "keyframes change one number, such as moon.radius; this is " +
                              std::string(kindName(target)));
        if (const auto point = cameraPoint(target.text); point && *point != CameraPoint::position)
            return report("target", codes::kTarget, target.location,
                          quoted(target.text) + " has no keyframes",
                          *point == CameraPoint::front ? "use camera.look_at or camera.forward"
                                                       : "use camera.up");
        const Parsed<Parameter> found = findParameter(description_, target.text, target.location);
        if (const auto* fault = std::get_if<Fault>(&found)) return reader_.report("target", *fault);
        const Parameter& parameter = std::get<Parameter>(found);
        track_.target = ParameterTarget{target.text, parameter};

        Keyframes keyframes;
        if (const Node::Member* interpolation = written("interpolation")) {
            const Parsed<Value> parsed =
                parseValue(interpolation->value, findField(trackFields(), "interpolation")->row);
            if (const auto* fault = std::get_if<Fault>(&parsed))
                return reader_.report("interpolation", *fault);
            keyframes.interpolation = static_cast<Keyframes::Interpolation>(
                std::get<std::int64_t>(std::get<Value>(parsed).data));
        }
        if (parameter.row->type == RT_INTEGER &&
            keyframes.interpolation != Keyframes::Interpolation::step)
            return report("interpolation", codes::kKeyframes, member.keyLocation,
                          quoted(target.text) + " is a whole number and has no values in between",
                          "write 'interpolation: step'");
        if (member.value.kind != Kind::map || member.value.members.empty())
            return report("keyframes", codes::kWrongKind, member.value.location,
                          "must be a map of frames and values, such as {0: 1, 48: 2.5}");
        for (const Node::Member& key : member.value.members) readKey(key, parameter, keyframes);
        std::sort(keyframes.keys.begin(), keyframes.keys.end(),
                  [](const auto& a, const auto& b) { return a.frame < b.frame; });
        checkScale(target.text, parameter, keyframes, member);
        if (!keyframes.keys.empty())
            track_.frames = {keyframes.keys.front().frame, keyframes.keys.back().frame};
        track_.motion = std::move(keyframes);
    }

    void readKey(const Node::Member& key, const Parameter& parameter, Keyframes& keyframes) {
        Node frame;
        frame.kind = Kind::scalar;
        frame.text = key.key;
        frame.location = key.keyLocation;
        rt_param frameRow{};
        frameRow.type = RT_INTEGER, frameRow.min = 0, frameRow.max = highestFrame();
        const Parsed<Value> parsedFrame = parseValue(frame, frameRow);
        if (const auto* fault = std::get_if<Fault>(&parsedFrame))
            return reader_.report("keyframes", {fault->code, fault->location,
                                                "a frame " + fault->clause, fault->suggestion});
        const Parsed<Value> parsed = parseValue(key.value, *parameter.row);
        if (const auto* fault = std::get_if<Fault>(&parsed))
            return reader_.report("keyframes", *fault);
        Keyframes::Key& added = keyframes.keys.emplace_back();
        added.frame =
            static_cast<std::uint32_t>(std::get<std::int64_t>(std::get<Value>(parsedFrame).data));
        const Value& value = std::get<Value>(parsed);
        if (const auto* integer = std::get_if<std::int64_t>(&value.data))
            added.values = {static_cast<double>(*integer)};
        else if (const auto* number = std::get_if<double>(&value.data))
            added.values = {*number};
        else if (const auto* vector = std::get_if<Vec3>(&value.data))
            added.values = {vector->x, vector->y, vector->z};
        if (isDirection(parameter) && added.values == std::vector<double>{0, 0, 0})
            report("keyframes", codes::kDirection, key.value.location,
                   "a direction must not be [0, 0, 0]");
    }

    static bool isDirection(const Parameter& parameter) {
        const std::string_view name = parameter.row->name;
        return parameter.field && (name == "forward" || name == "up" || name == "axis");
    }

    /// A scale that changes its sign would be 0 on the way.
    void checkScale(const std::string& path, const Parameter& parameter, const Keyframes& keyframes,
                    const Node::Member& member) {
        if (parameter.owner != Parameter::Owner::placement ||
            std::string_view(parameter.row->name) != "scale")
            return;
        for (std::size_t i = 0; i < keyframes.keys.size(); ++i)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double scale = keyframes.keys[i].values[axis];
                if (!(std::fabs(scale) * kMaxLength >= 1))
                    return report("keyframes", codes::kZeroScale, member.keyLocation,
                                  path + " must not be 0");
                if (i > 0 && keyframes.interpolation != Keyframes::Interpolation::step &&
                    std::signbit(scale) != std::signbit(keyframes.keys[i - 1].values[axis]))
                    return report("keyframes", codes::kZeroScale, member.keyLocation,
                                  path + " changes its sign and would be 0 on the way",
                                  "use interpolation: step");
            }
    }

    const Node& node_;
    Description& description_;
    const Animation& animation_;
    Diagnostics& diagnostics_;
    MapReader reader_;
    std::map<std::string_view, const Node::Member*>
        nodes_; // of the keys that are read by hand; null: not written
    Track track_;
};

/// Two fades, or keyframes of one number, at the same time contradict each other.
void checkOverlaps(const std::vector<Track>& tracks, Diagnostics& diagnostics) {
    std::vector<const Track*> fades;
    std::map<std::string, const Track*> keyframed;
    for (const Track& track : tracks) {
        if (std::holds_alternative<BackgroundFade>(track.target)) {
            for (const Track* other : fades)
                if (track.frames.first < other->frames.last &&
                    other->frames.first < track.frames.last)
                    diagnostics.error(codes::kOverlap, track.location,
                                      "this fade of the background overlaps that of line " +
                                          std::to_string(other->location.line));
            fades.push_back(&track);
        } else if (const auto* target = std::get_if<ParameterTarget>(&track.target)) {
            std::string path = target->path;
            if (path.starts_with("objects.")) path.erase(0, std::string_view("objects.").size());
            const auto [other, isNew] = keyframed.emplace(path, &track);
            if (!isNew)
                diagnostics.error(codes::kOverlap, track.location,
                                  quoted(target->path) + " has keyframes in line " +
                                      std::to_string(other->second->location.line) + " already");
        }
    }
}

} // namespace

void validateAnimation(const Node::Member& section, const TextureNames& textures,
                       Description& description, Diagnostics& diagnostics) {
    Animation& animation = description.animation.emplace();
    MapReader reader(section.value, section.keyLocation, "animation", textures, diagnostics);
    const std::size_t errorsBefore = diagnostics.errorCount();
    reader.readFields(animationFields(), &animation);
    const bool isLengthKnown = diagnostics.errorCount() == errorsBefore && reader.has("frames");
    if (const Node* tracks = reader.take("tracks")) {
        if (tracks->kind != Kind::sequence)
            diagnostics.error(codes::kWrongKind, tracks->location,
                              "animation, tracks: must be a list of tracks, such as '- {target: "
                              "moon, move: {position: [0, 0, 9]}, "
                              "frames: [0, 24]}', not " +
                                  std::string(kindName(*tracks)));
        else if (isLengthKnown)
            for (std::size_t i = 0; i < tracks->items.size(); ++i)
                if (auto track =
                        TrackReader(tracks->items[i], i, textures, description, diagnostics).read())
                    animation.tracks.push_back(std::move(*track));
    }
    reader.finish();
    checkOverlaps(animation.tracks, diagnostics);
}

} // namespace rt::scene
