#include <converters/movie_tracks.hpp>

#include <converters/comment_lines.hpp>
#include <converters/node_building.hpp>

#include <algorithm>
#include <utility>

namespace rt::converters {
namespace {

using scene::Code;
using scene::Location;
using scene::Node;
using scene::quoted;

/// What the scene language takes.
constexpr double kMaxFrames = 1e6, kMaxFps = 1000;

std::span<const Number> slice(const std::vector<Number>& numbers, std::size_t first,
                              std::size_t count) {
    return std::span(numbers).subspan(first, count);
}

/// Turned the other way: the original's positive angle is clockwise seen with the axis pointing at the viewer.
/// Negation is exact.
Node angleNode(const Number& angle) {
    return keywordNode(shortest(angle.value == 0 ? 0 : -angle.value) + "rad", angle.location);
}

Node motionNode(const MovieStatement& statement, std::string& key) {
    const auto& n = statement.numbers;
    Node motion = mapNode(true, statement.spelled.location);
    switch (statement.type) {
    case MotionType::rotate:
        key = "rotate";
        append(motion, "center", vectorNode(slice(n, 0, 3)));
        append(motion, "axis", vectorNode(slice(n, 3, 3)));
        append(motion, "angle", angleNode(n[6]));
        break;
    case MotionType::rotateSelf:
        key = "rotate_self";
        append(motion, "angle", angleNode(n[0]));
        break;
    case MotionType::move:
        key = "move";
        append(motion, "position", vectorNode(slice(n, 0, 3)));
        break;
    case MotionType::moveRadius:
        key = "move_radius";
        append(motion, "center", vectorNode(slice(n, 0, 3)));
        append(motion, "distance", numberNode(n[3]));
        break;
    case MotionType::moveDirect:
        key = "move_direct";
        append(motion, "direction", vectorNode(slice(n, 0, 3)));
        append(motion, "distance", numberNode(n[3]));
        break;
    }
    return motion;
}

std::string_view cameraTarget(CameraPoint point) {
    switch (point) {
    case CameraPoint::position:
        return "camera.position";
    case CameraPoint::front:
        return "camera.front";
    case CameraPoint::top:
        break;
    }
    return "camera.top";
}

/// What a track moves: some whole objects, or faces of one mesh.
struct Target {
    std::vector<std::string> names;
    std::optional<std::array<std::uint64_t, 2>> faces;
    bool mesh = false;
};

class AnimationBuilder {
public:
    AnimationBuilder(const MovieContext& context, scene::Diagnostics& diagnostics)
        : context_(context), diagnostics_(diagnostics) {}

    Node build(const MovieText& movie, const Location& movieFile) {
        Node animation = mapNode(false, movieFile);
        Node tracks = sequenceNode(false, movieFile);
        for (const auto& commented : movie.statements) add(commented, animation, tracks);
        std::vector<std::string> tail;
        for (const auto& comment : movie.tail) tail.push_back(textOf(comment));
        if (!animation.find("frames")) {
            const std::string message = "the movie file has no 'movie FRAMES FPS' line";
            if (context_.lenient) {
                diagnostics_.note(movieFile,
                                  message + "; the original then drew the start image alone");
            } else {
                diagnostics_.error(Code{390}, movieFile, message);
            }
            append(animation, "frames", numberNode(1, movieFile));
        }
        if (tracks.items.empty()) {
            for (std::string& line : held_) animation.comments->atEnd.push_back(std::move(line));
            for (std::string& line : tail) animation.comments->atEnd.push_back(std::move(line));
        } else {
            for (std::string& line : held_) tracks.comments->atEnd.push_back(std::move(line));
            for (std::string& line : tail) tracks.comments->atEnd.push_back(std::move(line));
            append(animation, "tracks", std::move(tracks));
        }
        return animation;
    }

private:
    void add(const Commented<MovieStatement>& commented, Node& animation, Node& tracks) {
        const MovieStatement& statement = commented.statement;
        for (const auto& comment : commented.before) held_.push_back(textOf(comment));
        noteChanges(statement);
        if (statement.kind == MovieStatement::Kind::header) {
            addHeader(commented, animation);
            return;
        }
        for (Node& track : trackNodes(statement, diagnostics_, held_)) {
            track.comments->before = std::move(held_);
            held_.clear();
            if (commented.after) track.comments->after = commentText(commented.after->text);
            tracks.items.push_back(std::move(track));
        }
    }

    /// Is there anything but spheres among what it moves?
    bool movesPlanes(const MovieStatement& statement) const {
        return !statement.camera && std::ranges::any_of(context_.objects, [&](const auto& object) {
            return object.keyword != Keyword::sphere &&
                   object.first <= statement.objectNumbers[1] &&
                   statement.objectNumbers[0] <
                       object.first + object.count.value_or(UINT64_MAX - object.first);
        });
    }

    /// What moves otherwise than in the original: said once for each.
    void noteChanges(const MovieStatement& statement) {
        if (statement.kind != MovieStatement::Kind::motion) return;
        const auto note = [&](bool& said, const std::string& message) {
            if (!std::exchange(said, true)) diagnostics_.note(statement.spelled.location, message);
        };
        if (statement.type == MotionType::rotate || statement.type == MotionType::rotateSelf) {
            note(saidSign_, "the original's angles run clockwise about their axis, rt's "
                            "counter-clockwise: the sign is turned");
        }
        if (statement.type == MotionType::rotate) {
            note(saidRigid_, "what lies above or below the pivot keeps its distance: the original "
                             "drew it nearer with every step");
        } else if (statement.type != MotionType::rotateSelf && movesPlanes(statement)) {
            note(saidPlanes_, "moved triangles, rects and meshes are drawn where they are: the "
                              "original left them on their old "
                              "plane until they turned");
        }
        const double first = statement.numbers[statement.numbers.size() - 2].value;
        const double last = statement.numbers.back().value;
        for (const auto& [other, otherFirst, otherLast] : earlierMotions_) {
            const bool sameTarget =
                statement.camera
                    ? other->camera == statement.camera
                    : !other->camera && other->objectNumbers[0] <= statement.objectNumbers[1] &&
                          statement.objectNumbers[0] <= other->objectNumbers[1];
            const bool sorted = std::pair(otherFirst, otherLast) <= std::pair(first, last);
            const double earlierEnd = sorted ? otherLast : last,
                         laterFirst = sorted ? first : otherFirst;
            const double laterEnd = sorted ? last : otherLast;
            if (sameTarget && laterFirst < earlierEnd && laterEnd < earlierEnd) {
                note(saidOverlap_, "a motion ends at its last frame: where one that began earlier "
                                   "was still running, the "
                                   "original carried on with both");
            }
        }
        earlierMotions_.push_back({&statement, first, last});
    }

    void addHeader(const Commented<MovieStatement>& commented, Node& animation) {
        const MovieStatement& statement = commented.statement;
        if (animation.find("frames")) {
            diagnostics_.note(statement.spelled.location,
                              "this 'movie' line replaces the one before it");
            std::erase_if(animation.members, [&](Node::Member& member) {
                if (member.key == "frames")
                    held_.insert(held_.begin(), member.value.comments->before.begin(),
                                 member.value.comments->before.end());
                return member.key == "frames" || member.key == "fps";
            });
        }
        const Number& steps = statement.numbers[0];
        const Number& fps = statement.numbers[1];
        if (steps.value < 0 || steps.value >= kMaxFrames) {
            outOfRange(steps, "'movie': the number of frames",
                       "from 0 to " + shortest(kMaxFrames - 1));
        }
        if (!(fps.value > 0 && fps.value <= kMaxFps)) {
            outOfRange(fps, "'movie': the number of frames per second",
                       "more than 0 and at most " + shortest(kMaxFps));
        }
        diagnostics_.note(statement.spelled.location,
                          "'movie " + shortest(steps.value) + "' drew its start and " +
                              shortest(steps.value) + " steps: frames is " +
                              shortest(steps.value + 1));
        Node& frames = append(animation, "frames", numberNode(steps.value + 1, steps.location));
        frames.comments->before = std::move(held_);
        held_.clear();
        if (commented.after) frames.comments->after = commentText(commented.after->text);
        append(animation, "fps", numberNode(fps));
    }

    void outOfRange(const Number& number, const std::string& what, const std::string& range) {
        diagnostics_.error(Code{384}, number.location,
                           what + " must be " + range + ", not " + shortest(number.value));
    }

    /// A commented-out statement as the track it would be, any other comment as it is.
    std::string textOf(const Comment<MovieStatement>& comment) {
        if (!comment.statement) return commentText(comment.text);
        if (comment.statement->kind == MovieStatement::Kind::header) {
            return "frames: " + shortest(comment.statement->numbers[0].value + 1) +
                   ", fps: " + shortest(comment.statement->numbers[1].value);
        }
        scene::Diagnostics ignored;
        std::vector<std::string> leftOut;
        const auto tracks = trackNodes(*comment.statement, ignored, leftOut);
        if (ignored.failed() || tracks.size() != 1) return commentText(comment.text);
        return "- " + flowText(tracks.front());
    }

    std::vector<Node> trackNodes(const MovieStatement& statement, scene::Diagnostics& diagnostics,
                                 std::vector<std::string>& leftOut) {
        const std::size_t count = statement.numbers.size();
        const Number& first = statement.numbers[count - 2];
        const Number& last = statement.numbers[count - 1];
        if (first.value < 0) {
            diagnostics.error(Code{384}, first.location,
                              "the first frame must be 0 or more, not " + shortest(first.value));
            return {};
        }
        if (last.value <= first.value) {
            diagnostics.note(statement.spelled.location,
                             "nothing happens from frame " + shortest(first.value) + " to " +
                                 shortest(last.value) + "; kept as a comment");
            leftOut.push_back(statement.text);
            return {};
        }
        if (statement.kind == MovieStatement::Kind::motion &&
            (statement.type == MotionType::rotate || statement.type == MotionType::moveDirect)) {
            const std::size_t at = statement.type == MotionType::rotate ? 3 : 0;
            const auto& n = statement.numbers;
            if (n[at].value == 0 && n[at + 1].value == 0 && n[at + 2].value == 0) {
                diagnostics.error(Code{384}, n[at].location,
                                  std::string(at == 3 ? "the axis" : "the direction") +
                                      " must not be 0 0 0");
                return {};
            }
        }
        const Node frames = vectorNode(slice(statement.numbers, count - 2, 2));
        const auto trackFor = [&](std::string_view key, Node target) {
            Node track = mapNode(true, statement.spelled.location);
            append(track, key, std::move(target));
            return track;
        };

        if (statement.kind == MovieStatement::Kind::fade) {
            const Number& id = statement.numbers[0];
            if (id.value < 0 || id.value >= static_cast<double>(context_.textureNames.size())) {
                if (context_.complete) diagnostics.error(Code{391}, id.location, noTexture(id));
                return {};
            }
            if (&diagnostics == &diagnostics_ && overlapsFade(statement, leftOut)) return {};
            Node track = trackFor(
                "background",
                textNode(context_.textureNames[static_cast<std::size_t>(id.value)], id.location));
            append(track, "frames", frames);
            return {track};
        }

        std::string key;
        const Node motion = motionNode(statement, key);
        if (statement.camera) {
            Node track = trackFor(
                "target", keywordNode(cameraTarget(*statement.camera), statement.spelled.location));
            append(track, key, motion);
            append(track, "frames", frames);
            return {track};
        }
        std::vector<Node> tracks;
        for (const Target& target : targets(statement, diagnostics, leftOut)) {
            Node names = textNode(target.names.front(), statement.spelled.location);
            if (target.names.size() > 1) {
                names = sequenceNode(true, statement.spelled.location);
                for (const std::string& name : target.names)
                    names.items.push_back(textNode(name, names.location));
            }
            Node track = trackFor("target", std::move(names));
            if (target.faces) {
                Node faces = sequenceNode(true, statement.spelled.location);
                for (const std::uint64_t face : *target.faces) {
                    faces.items.push_back(keywordNode(std::to_string(face), faces.location));
                }
                append(track, "faces", std::move(faces));
            }
            // These act about or towards each face's own centroid; the others move all faces alike.
            const bool aboutCentre = statement.type == MotionType::rotateSelf ||
                                     statement.type == MotionType::move ||
                                     statement.type == MotionType::moveRadius;
            if (target.mesh && aboutCentre)
                append(track, "each", keywordNode("true", track.location));
            append(track, key, motion);
            append(track, "frames", frames);
            tracks.push_back(std::move(track));
        }
        return tracks;
    }

    /// Reports a fade that runs at the same time as an earlier one; notes its span otherwise.
    bool overlapsFade(const MovieStatement& statement, std::vector<std::string>& leftOut) {
        const double first = statement.numbers[1].value, last = statement.numbers[2].value;
        for (const Span& other : fades_) {
            if (last <= other.first || other.last <= first) continue;
            const std::string message = "this fade overlaps that of line " +
                                        std::to_string(other.statement->spelled.location.line) +
                                        ", and there is one at a time";
            if (context_.lenient) {
                diagnostics_.note(statement.spelled.location, message + "; the line is left out");
                leftOut.push_back(statement.text);
            } else {
                diagnostics_.error(Code{395}, statement.spelled.location, message);
            }
            return true;
        }
        fades_.push_back({&statement, first, last});
        return false;
    }

    std::string noTexture(const Number& id) const {
        const std::size_t count = context_.textureNames.size();
        return "there is no texture " + shortest(id.value) + ": the scene has " +
               (count == 0 ? "none"
                : count == 1
                    ? "one, number 0"
                    : std::to_string(count) + ", numbers 0 to " + std::to_string(count - 1));
    }

    std::vector<Target> targets(const MovieStatement& statement, scene::Diagnostics& diagnostics,
                                std::vector<std::string>& leftOut) {
        auto [first, last] = statement.objectNumbers;
        const Location& place = statement.spelled.location;
        std::uint64_t total = 0;
        for (const NumberedObject& object : context_.objects) {
            if (!object.count) {
                if (last < object.first) break;
                diagnostics.error(Code{392}, place,
                                  "what number " + std::to_string(std::max(first, object.first)) +
                                      " means depends on the faces of the mesh " +
                                      quoted(object.name) + ", whose file cannot be read");
                return {};
            }
            total = object.first + *object.count;
        }
        const bool allCounted = std::ranges::all_of(
            context_.objects, [](const auto& each) { return each.count.has_value(); });
        if (last >= total && allCounted) {
            if (!context_.complete) return {};
            const std::string message =
                "there is no object " + std::to_string(std::max(first, total)) +
                ": the scene has " +
                (total == 0
                     ? "none"
                     : std::to_string(total) + ", numbers 0 to " + std::to_string(total - 1) +
                           ", each face of a mesh counting as one");
            if (!context_.lenient) {
                diagnostics.error(Code{389}, place, message);
                return {};
            }
            diagnostics.note(place, message + "; the rest of the range is left out");
            if (first >= total) {
                leftOut.push_back(statement.text);
                return {};
            }
            last = total - 1;
        }

        std::vector<Target> targets;
        bool joinable = false; // the last target takes further whole objects
        for (const NumberedObject& object : context_.objects) {
            if (!object.count || *object.count == 0) continue;
            const std::uint64_t objectLast = object.first + *object.count - 1;
            if (objectLast < first || object.first > last) continue;
            if (object.keyword == Keyword::sphere && statement.type == MotionType::rotateSelf) {
                diagnostics.note(place, "rotateSelf does nothing to the sphere " +
                                            quoted(object.name) + "; left out");
                continue;
            }
            if (object.keyword != Keyword::mesh) {
                if (!joinable) targets.emplace_back();
                targets.back().names.push_back(object.name);
                joinable = true;
                continue;
            }
            joinable = false;
            Target target{{object.name}, std::nullopt, true};
            if (first > object.first || last < objectLast) {
                target.faces = {std::max(first, object.first) - object.first,
                                std::min(last, objectLast) - object.first};
            }
            targets.push_back(std::move(target));
        }
        if (targets.empty()) leftOut.push_back(statement.text);
        return targets;
    }

    const MovieContext& context_;
    scene::Diagnostics& diagnostics_;
    std::vector<std::string> held_; // comments for the next track

    struct Span {
        const MovieStatement* statement;
        double first, last;
    };
    std::vector<Span> earlierMotions_, fades_;
    bool saidSign_ = false, saidRigid_ = false, saidPlanes_ = false, saidOverlap_ = false;
};

} // namespace

Node animationNode(const MovieText& movie, const Location& movieFile, const MovieContext& context,
                   scene::Diagnostics& diagnostics) {
    return AnimationBuilder(context, diagnostics).build(movie, movieFile);
}

} // namespace rt::converters
