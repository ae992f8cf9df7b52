#include <converters/scene_converter.hpp>

#include <converters/comment_lines.hpp>
#include <converters/legacy_paths.hpp>
#include <converters/material_names.hpp>
#include <converters/movie_tracks.hpp>
#include <converters/node_building.hpp>
#include <converters/obj_faces.hpp>
#include <core/numeric/vec.hpp>

#include <algorithm>
#include <cmath>
#include <set>

namespace rt::converters {
namespace {

using numeric::Vec3;
using scene::Code;
using scene::Location;
using scene::Node;
using scene::quoted;

using Entry = Commented<Statement>;

/// The original left the screen alone where |forward . upward| of the unit vectors was at most this.
constexpr double kPerpendicular = 1 / 1e6;
/// Centre of the original's background sphere, whatever the scene.
constexpr double kBackgroundCenter[] = {50, 50, 0};
constexpr double kDefaultBackground[] = {0, 0, 1};
constexpr double kDefaultDepth = 2;
/// What the scene language takes; beyond that a number is a slip.
constexpr double kMaxDepth = 1000, kMaxIntensity = 1e6, kMaxIndex = 1000;
/// How far from square a pixel may be for a window to fit a screen: pictures are cut to whole pixels and screens
/// stated to two or three digits.
constexpr double kSquarePixel = 0.02;

bool isObject(Keyword keyword) {
    return keyword == Keyword::sphere || keyword == Keyword::triangle ||
           keyword == Keyword::parallelogram || keyword == Keyword::mesh;
}

/// The top-level key that a statement contributes to.
std::string_view sectionOf(Keyword keyword) {
    switch (keyword) {
    case Keyword::window:
    case Keyword::save:
        return "image";
    case Keyword::scene:
        return "bounds";
    case Keyword::camera:
        return "camera";
    case Keyword::depth:
    case Keyword::smooth:
    case Keyword::antialias:
        return "render";
    case Keyword::texture:
        return "textures";
    case Keyword::background:
        return "background";
    case Keyword::light:
        return "lights";
    case Keyword::movie:
        return "animation";
    default:
        return "objects";
    }
}

/// One of many entries of its section.
bool isItem(Keyword keyword) {
    return isObject(keyword) || keyword == Keyword::light || keyword == Keyword::texture;
}

std::string_view shapeOf(Keyword keyword) {
    switch (keyword) {
    case Keyword::sphere:
        return "sphere";
    case Keyword::triangle:
        return "triangle";
    case Keyword::parallelogram:
        return "parallelogram";
    default:
        return "mesh";
    }
}

std::span<const Number> slice(const std::vector<Number>& numbers, std::size_t first,
                              std::size_t count) {
    return std::span(numbers).subspan(first, count);
}

Vec3 toVec3(const std::vector<Number>& numbers, std::size_t first) {
    return {numbers[first].value, numbers[first + 1].value, numbers[first + 2].value};
}

/// "on only when exactly 1".
bool isOn(const Statement& statement) { return statement.numbers[0].value == 1; }

class SceneConverter {
public:
    SceneConverter(const std::shared_ptr<const scene::Source>& source, bool complete,
                   const InfOptions& options, scene::Diagnostics& diagnostics)
        : file_{source, 0, 0}, complete_(complete), options_(options), diagnostics_(diagnostics),
          root_(mapNode(false, {source, 1, 1})) {
        const std::size_t slash = source->path.rfind('/');
        sceneFolder_ = slash == std::string::npos ? "" : source->path.substr(0, slash + 1);
    }

    Node convert(SceneText text) {
        root_.comments->before = {"yaml-language-server: $schema=./rt.schema.json",
                                  "$schema: ./rt.schema.json"};
        append(root_, "rt", numberNode(1, root_.location));
        collect(text);
        for (const Entry& entry : text.statements) {
            placeComments(entry.before, entry.statement.keyword);
            add(entry);
        }
        placeComments(text.tail, std::nullopt);
        addDefaults();
        if (!findSection("animation") && !options_.moviePath.empty()) addMovie({}, file_);
        placeRemainingComments();
        return std::move(root_);
    }

private:
    // ---- first pass: what later statements are needed for --------------------------------------------------

    void collect(SceneText& text) {
        for (Entry& entry : text.statements) {
            Statement& statement = entry.statement;
            if (!isItem(statement.keyword)) effective_[statement.keyword] = &statement;
            if (statement.keyword == Keyword::texture) collectTexture(statement);
            if (statement.keyword == Keyword::mesh) takeName(statement, statement.words[1]);
            if (statement.name) takeName(statement, *statement.name);
            if (statement.material) collectMaterial(statement);
        }
        for (Entry& entry : text.statements) {
            if (isObject(entry.statement.keyword)) collectObject(entry.statement);
        }
        static constexpr std::pair<Keyword, std::string_view> kMandatory[] = {
            {Keyword::window, "window WIDTH HEIGHT"},
            {Keyword::scene, "scene"},
            {Keyword::camera, "camera"}};
        for (const auto& [keyword, spelling] : kMandatory) {
            if (complete_ && !effective_.count(keyword)) {
                diagnostics_.error(Code{390}, file_,
                                   "the file has no " + quoted(spelling) + " statement");
            }
        }
    }

    std::string unused(const std::string& wanted, std::set<std::string>& taken) {
        std::string name = wanted;
        for (int i = 2; !taken.insert(name).second; ++i) name = wanted + "_" + std::to_string(i);
        return name;
    }

    void takeName(const Statement& statement, const Word& word) {
        const std::string name = unused(toName(word.text), objectNames_);
        if (name != word.text) {
            diagnostics_.note(word.location,
                              quoted(word.text) + " becomes " + quoted(name) +
                                  ": names are letters, digits, - and _, each used once");
        }
        names_[&statement] = name;
    }

    void collectTexture(const Statement& statement) {
        const FoundPath path =
            findPath(statement.words[0].text, sceneFolder_, options_.outputFolder);
        textures_.push_back(unused(toName(stemOf(path.spelled)), textureNames_));
    }

    void collectMaterial(Statement& statement) {
        MaterialNumbers& material = *statement.material;
        Number& refractivity = material[15];
        for (std::size_t i = 0; i < material.size(); ++i) {
            const double highest = i == 15 ? kMaxIndex : kMaxIntensity;
            if (material[i].value > highest || (material[i].value < 0 && i != 15)) {
                outOfRange(material[i], statement, "'" + std::string(materialNumberName(i)) + "'",
                           "from 0 to " + shortest(highest));
            }
        }
        if (refractivity.value <= 0 && transmits(material)) {
            const std::string message =
                "light passes through this object, so its refractivity must be more than 0, not " +
                shortest(refractivity.value);
            if (options_.lenient) {
                diagnostics_.note(refractivity.location, message + "; 1 is taken");
                refractivity.value = 1;
            } else {
                diagnostics_.error(Code{393}, refractivity.location, message);
            }
        }
        const std::string name = materials_.nameOf(material);
        if (!materials_.isNew()) return;
        if (refractivity.value <= 0) {
            diagnostics_.note(refractivity.location,
                              "refractivity " + shortest(refractivity.value) +
                                  " is dropped: nothing passes through " + quoted(name));
        }
        materialNodes_.push_back({name, material[0].location, materialNode(material)});
    }

    void collectObject(const Statement& statement) {
        std::string& name = names_[&statement];
        if (name.empty()) {
            const std::string shape(shapeOf(statement.keyword));
            do name = shape + "_" + std::to_string(shapeCounts_[statement.keyword]++);
            while (!objectNames_.insert(name).second);
        }
        NumberedObject object{name, statement.keyword, nextNumber_, 1, statement.spelled.location};
        if (statement.keyword == Keyword::mesh) object.count = countFaces(statement);
        nextNumber_ += object.count.value_or(0);
        hasSheet_ |= statement.keyword != Keyword::sphere &&
                     (statement.words.empty() || statement.words[2].text == "normal");
        numbered_.push_back(std::move(object));
    }

    std::optional<std::uint64_t> countFaces(const Statement& statement) {
        const Location& place = statement.words[0].location;
        const FoundPath path = find(statement.words[0]);
        const auto faces = path.exists ? readObjFaces(path.local) : std::nullopt;
        if (!faces) return std::nullopt;
        if (faces->refusedLine) {
            diagnostics_.note(
                place,
                "the original refused this mesh (line " + std::to_string(faces->refusedLine) +
                    " has an index that is not a number from 1 to the vertices' count) and drew "
                    "nothing; movie files count no face of it");
        } else if (faces->polygons) {
            diagnostics_.note(place, std::to_string(faces->polygons) +
                                         " of its faces have more than three corners: the "
                                         "original drew the first triangle of each, rt "
                                         "draws them whole");
        }
        return faces->count;
    }

    // ---- sections of the document --------------------------------------------------------------------------

    Node* findSection(std::string_view key) {
        const auto found = std::ranges::find(root_.members, key, &Node::Member::key);
        return found == root_.members.end() ? nullptr : &found->value;
    }

    /// The top-level value of `key`, created at the end where there is none.
    Node& section(std::string_view key, const Location& location) {
        if (Node* existing = findSection(key)) return *existing;
        const bool list = key == "objects" || key == "lights";
        Node& created =
            append(root_, key, list ? sequenceNode(false, location) : mapNode(false, location));
        comments_.moveTo(created.comments->before, "");
        return created;
    }

    /// The same, but created before the things that a scene is made of.
    Node& settingsSection(std::string_view key) {
        if (Node* existing = findSection(key)) return *existing;
        static constexpr std::string_view kAfter[] = {"textures",  "background", "lights",
                                                      "materials", "objects",    "animation"};
        const auto at = std::ranges::find_if(root_.members, [&](const Node::Member& member) {
            return std::ranges::find(kAfter, member.key) != std::end(kAfter) && member.key != key;
        });
        return root_.members.insert(at, {std::string(key), file_, mapNode(false, file_)})->value;
    }

    // ---- comments ------------------------------------------------------------------------------------------

    /// Lines that stand between two statements. What a commented-out statement makes waits for its own section; other
    /// comments go with the commented-out statement that follows them, or with the next statement.
    void placeComments(const std::vector<Comment<Statement>>& block, std::optional<Keyword> next) {
        std::vector<std::string> prose;
        for (const auto& comment : block) {
            if (!comment.statement) {
                prose.push_back(commentText(comment.text));
                continue;
            }
            const Keyword keyword = comment.statement->keyword;
            const bool withNext = next == keyword && !isItem(keyword);
            prose.push_back(commentedOut(*comment.statement, withNext));
            for (std::string& line : prose) {
                if (withNext)
                    nextComments_.push_back(std::move(line));
                else
                    comments_.hold(isItem(keyword) ? sectionOf(keyword) : "", std::move(line));
            }
            prose.clear();
        }
        for (std::string& line : prose) {
            if (next)
                nextComments_.push_back(std::move(line));
            else
                comments_.hold("", std::move(line));
        }
    }

    /// A commented-out statement as the YAML that it would have become. `inPlace`: it stands where its section's own
    /// members do.
    std::string commentedOut(const Statement& statement, bool inPlace) {
        const auto member = [&](std::string_view key, const Node& value) {
            const std::string text = std::string(key) + ": " + flowText(value);
            return inPlace ? text : std::string(sectionOf(statement.keyword)) + ": {" + text + "}";
        };
        const auto whole = [&](const Node& value) {
            return std::string(sectionOf(statement.keyword)) + ": " + flowText(value);
        };
        switch (statement.keyword) {
        case Keyword::sphere:
        case Keyword::triangle:
        case Keyword::parallelogram:
        case Keyword::mesh: {
            const std::string material = materials_.nameOf(*statement.material);
            if (materials_.isNew()) {
                comments_.hold("materials",
                               material + ": " + flowText(materialNode(*statement.material)));
            }
            const std::string name = statement.keyword == Keyword::mesh
                                         ? toName(statement.words[1].text)
                                     : statement.name ? toName(statement.name->text)
                                                      : "";
            return itemText(objectNode(statement, name, material));
        }
        case Keyword::light:
            return itemText(lightNode(statement));
        case Keyword::texture: {
            const FoundPath path =
                findPath(statement.words[0].text, sceneFolder_, options_.outputFolder);
            return toName(stemOf(path.spelled)) + ": " +
                   flowText(textureNode(statement.words[0], path));
        }
        case Keyword::window:
            return whole(windowNode(statement, false));
        case Keyword::scene:
            return whole(boundsNode(statement));
        case Keyword::camera:
            return whole(cameraNode(statement, 1));
        case Keyword::depth:
            return member("depth", numberNode(statement.numbers[0]));
        case Keyword::smooth:
            return member("smooth", onOffNode(statement));
        case Keyword::antialias:
            return member("antialias", antialiasNode(statement));
        case Keyword::save:
            return member("file", textNode(statement.words[0].text, statement.words[0].location));
        case Keyword::background:
            if (const auto background = backgroundNode(statement)) return whole(*background);
            return statement.text;
        case Keyword::movie:
            break; // its tracks stand in another file
        }
        return statement.text;
    }

    static std::string itemText(const Node& item) {
        return "- " + item.members[0].key + ": " + flowText(item.members[0].value);
    }

    /// The comments of `entry` above `node` and beside it.
    void comment(Node& node, const Entry& entry) {
        for (std::string& line : nextComments_) node.comments->before.push_back(std::move(line));
        nextComments_.clear();
        if (entry.after) node.comments->after = commentText(entry.after->text);
    }

    void placeRemainingComments() {
        for (const std::string_view key : {"textures", "lights", "materials", "objects"}) {
            if (Node* list = findSection(key)) comments_.moveTo(list->comments->atEnd, key);
        }
        for (const auto& [key, lines] : comments_.all()) {
            if (!key.empty()) root_.comments->atEnd.push_back(key + ":");
            for (const std::string& line : lines)
                root_.comments->atEnd.push_back((key.empty() ? "" : "  ") + line);
        }
        for (std::string& line : nextComments_) root_.comments->atEnd.push_back(std::move(line));
    }

    // ---- statements ----------------------------------------------------------------------------------------

    void add(const Entry& entry) {
        const Statement& statement = entry.statement;
        const Location& place = statement.spelled.location;
        if (!isItem(statement.keyword) && effective_[statement.keyword] != &statement) {
            const Location& later = effective_[statement.keyword]->spelled.location;
            diagnostics_.note(place, "line " + std::to_string(later.line) + " replaces this " +
                                         quoted(statement.spelled.text) + "; kept as a comment");
            nextComments_.push_back(statement.text);
            return;
        }
        switch (statement.keyword) {
        case Keyword::window:
            addWindow(entry);
            break;
        case Keyword::save:
            addSave(entry);
            break;
        case Keyword::scene:
            checkBounds(statement);
            comment(setSection("bounds", place, boundsNode(statement)), entry);
            break;
        case Keyword::camera:
            addCamera(entry);
            break;
        case Keyword::depth:
            addDepth(entry);
            break;
        case Keyword::smooth:
            addSwitch(entry, "smooth", onOffNode(statement));
            break;
        case Keyword::antialias:
            addSwitch(entry, "antialias", antialiasNode(statement));
            break;
        case Keyword::texture:
            addTexture(entry);
            break;
        case Keyword::background:
            addBackground(entry);
            break;
        case Keyword::light:
            if (!notedLight_ && hasSheet_) {
                diagnostics_.note(place, "light that falls on the back of a sheet adds nothing: "
                                         "the original subtracted it");
            }
            notedLight_ = true;
            for (const Number& number : slice(statement.numbers, 3, statement.numbers.size() - 3)) {
                if (number.value < 0 || number.value > kMaxIntensity) {
                    outOfRange(number, statement, "colour and brightness",
                               "from 0 to " + shortest(kMaxIntensity));
                }
            }
            addItem("lights", lightNode(statement), entry);
            break;
        case Keyword::movie:
            addMovie(entry, place);
            break;
        case Keyword::sphere:
        case Keyword::triangle:
        case Keyword::parallelogram:
        case Keyword::mesh:
            addObject(entry);
            break;
        }
    }

    /// The section `key`, now `value` under the comments that already stand above it.
    Node& setSection(std::string_view key, const Location& place, Node value) {
        Node& target = section(key, place);
        value.comments->before = std::move(target.comments->before);
        return target = std::move(value);
    }

    void addItem(std::string_view key, Node value, const Entry& entry) {
        Node& list = section(key, entry.statement.spelled.location);
        comments_.moveTo(value.comments->before, key);
        comment(value, entry);
        list.items.push_back(std::move(value));
    }

    void outOfRange(const Number& number, const Statement& statement, std::string_view what,
                    std::string_view range) {
        diagnostics_.error(Code{384}, number.location,
                           quoted(statement.spelled.text) + ": " + std::string(what) + " must be " +
                               std::string(range) + ", not " + shortest(number.value));
    }

    // ---- image ---------------------------------------------------------------------------------------------

    bool isHeightFirst(const Statement& window, std::string& why) const {
        why = "as --window-order says";
        if (options_.windowOrder != WindowOrder::automatic)
            return options_.windowOrder == WindowOrder::heightWidth;
        const auto camera = effective_.find(Keyword::camera);
        why = "this is how the original read them";
        if (camera == effective_.end()) return false; // reported
        const double screenWidth = camera->second->numbers[0].value,
                     screenHeight = camera->second->numbers[1].value;
        const double first = window.numbers[0].value, second = window.numbers[1].value;
        const auto fits = [&](double width, double height) {
            return std::fabs(width * screenHeight - height * screenWidth) <=
                   kSquarePixel * std::fabs(height * screenWidth);
        };
        const bool asRead = fits(first, second), swapped = fits(second, first);
        why = asRead != swapped ? "the order whose ratio fits the camera's screen"
              : asRead
                  ? "both orders fit the camera's screen, and this is how the original read them"
                  : "no order fits the camera's screen, and this is how the original read them";
        return swapped && !asRead;
    }

    Node windowNode(const Statement& statement, bool heightFirst) {
        Node image = mapNode(false, statement.spelled.location);
        append(image, "width", numberNode(statement.numbers[heightFirst ? 1 : 0]));
        append(image, "height", numberNode(statement.numbers[heightFirst ? 0 : 1]));
        return image;
    }

    void addWindow(const Entry& entry) {
        const Statement& statement = entry.statement;
        std::string why;
        const bool heightFirst = isHeightFirst(statement, why);
        Node window = windowNode(statement, heightFirst);
        for (std::size_t i = 0; i < 2; ++i) {
            if (statement.numbers[i].value < 1)
                outOfRange(statement.numbers[i], statement, i == heightFirst ? "width" : "height",
                           "1 or more");
        }
        diagnostics_.note(statement.spelled.location,
                          "window: width " + window.members[0].value.text + ", height " +
                              window.members[1].value.text + ": " + why);
        const auto isOdd = [](const Number& number) { return std::fmod(number.value, 2) != 0; };
        if ((isOdd(statement.numbers[0]) || isOdd(statement.numbers[1])) && !isAntialiased()) {
            diagnostics_.note(statement.spelled.location,
                              "the original left pictures of an odd size unfilled; rt draws them");
        }
        Node& image = section("image", statement.spelled.location);
        comment(image, entry);
        image.members.insert(image.members.begin(), window.members.begin(), window.members.end());
    }

    bool isAntialiased() const {
        const auto found = effective_.find(Keyword::antialias);
        return found != effective_.end() && isOn(*found->second);
    }

    bool hasMovie() const {
        return effective_.count(Keyword::movie) || !options_.moviePath.empty();
    }

    void addSave(const Entry& entry) {
        const Word& word = entry.statement.words[0];
        std::string file = word.text;
        std::ranges::replace(file, '\\', '/');
        const bool outside = file.starts_with('/') || file.find("..") != std::string::npos ||
                             (file.size() > 1 && file[1] == ':');
        if (outside) {
            file = file.substr(file.find_last_of("/:") + 1);
            diagnostics_.note(word.location, "rt writes below the current folder: " +
                                                 quoted(word.text) + " becomes " + quoted(file));
        }
        const std::string stem = stemOf(file);
        std::string suffix = file.substr(file.rfind('/') + 1).substr(stem.size());
        std::ranges::transform(suffix, suffix.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        static constexpr std::string_view kFilms[] = {".avi", ".mp4", ".mkv", ".webm"};
        static constexpr std::string_view kPictures[] = {".png", ".jpg", ".jpeg",
                                                         ".bmp", ".exr", ".pfm"};
        const bool film = std::ranges::find(kFilms, suffix) != std::end(kFilms);
        const bool picture = std::ranges::find(kPictures, suffix) != std::end(kPictures);
        if (!(hasMovie() ? film : picture)) {
            if (film || picture) file.resize(file.size() - suffix.size());
            file += hasMovie() ? ".avi" : ".png";
            diagnostics_.note(word.location, quoted(word.text) + " names no " +
                                                 (hasMovie() ? "film" : "picture") +
                                                 " that rt writes: " + quoted(file));
        }
        Node& image = section("image", entry.statement.spelled.location);
        comment(append(image, "file", textNode(file, word.location)), entry);
    }

    // ---- bounds, camera ------------------------------------------------------------------------------------

    Node boundsNode(const Statement& statement) {
        Node bounds = mapNode(true, statement.spelled.location);
        append(bounds, "min", vectorNode(slice(statement.numbers, 0, 3)));
        append(bounds, "max", vectorNode(slice(statement.numbers, 3, 3)));
        return bounds;
    }

    void checkBounds(const Statement& statement) {
        static constexpr std::string_view kSides[] = {"right", "back", "up"};
        for (std::size_t i = 0; i < 3; ++i) {
            const Number &low = statement.numbers[i], &high = statement.numbers[i + 3];
            if (!(low.value < high.value))
                outOfRange(high, statement, kSides[i], "more than " + shortest(low.value));
        }
    }

    /// Sine of the angle between forward and upward, by which the original's screen shrank; 1 where it did not.
    static double screenShrink(const Statement& camera) {
        const Vec3 forward = numeric::normalize(toVec3(camera.numbers, 6)),
                   up = numeric::normalize(toVec3(camera.numbers, 9));
        if (std::fabs(numeric::dot(forward, up)) <= kPerpendicular) return 1;
        return numeric::length(numeric::cross(forward, up));
    }

    Node cameraNode(const Statement& statement, double shrink) {
        const auto& n = statement.numbers;
        Node camera = mapNode(false, statement.spelled.location);
        append(camera, "position", vectorNode(slice(n, 3, 3)));
        append(camera, "forward", vectorNode(slice(n, 6, 3)));
        append(camera, "up", vectorNode(slice(n, 9, 3)));
        Node screen = mapNode(true, n[0].location);
        append(screen, "width", numberNode(n[0].value * shrink, n[0].location));
        append(screen, "height", numberNode(n[1].value * shrink, n[1].location));
        append(screen, "distance", numberNode(n[2]));
        append(camera, "screen", std::move(screen));
        return camera;
    }

    void addCamera(const Entry& entry) {
        const Statement& statement = entry.statement;
        const auto& n = statement.numbers;
        static constexpr std::string_view kScreen[] = {"screen width", "screen height", "focus"};
        for (std::size_t i = 0; i < 3; ++i) {
            if (!(n[i].value > 0)) outOfRange(n[i], statement, kScreen[i], "more than 0");
        }
        const Vec3 forward = toVec3(n, 6), up = toVec3(n, 9);
        double shrink = 1;
        if (numeric::lengthSquared(numeric::cross(forward, up)) == 0) {
            diagnostics_.error(Code{394}, n[6].location,
                               "'camera': forward and upward must be two different directions");
        } else {
            shrink = screenShrink(statement);
        }
        Node camera = cameraNode(statement, shrink);
        if (shrink != 1) {
            const std::string stated = shortest(n[0].value) + " x " + shortest(n[1].value);
            camera.members.back().value.comments->after = "stated as " + stated;
            std::string message =
                "upward is not perpendicular to forward, so the original's screen was not " +
                stated + " but " + shortest(shrink) + " times that, which is written";
            if (hasMovie())
                message += "; after its first image the field of view jumped, and in rt it stays";
            diagnostics_.note(n[0].location, message);
        }
        diagnostics_.note(statement.spelled.location,
                          "rays start on the screen rectangle, and nothing nearer than that is "
                          "seen, as in the original: near_plane: screen");
        comment(setSection("camera", statement.spelled.location, std::move(camera)), entry);
    }

    // ---- render --------------------------------------------------------------------------------------------

    Node onOffNode(const Statement& statement) {
        return keywordNode(isOn(statement) ? "true" : "false", statement.numbers[0].location);
    }

    Node antialiasNode(const Statement& statement) {
        return keywordNode(isOn(statement) ? "fsaa4" : "none", statement.numbers[0].location);
    }

    void addDepth(const Entry& entry) {
        const Number& depth = entry.statement.numbers[0];
        if (depth.value < 0 || depth.value > kMaxDepth) {
            outOfRange(depth, entry.statement, "the number of bounces",
                       "from 0 to " + shortest(kMaxDepth));
        }
        comment(
            append(section("render", entry.statement.spelled.location), "depth", numberNode(depth)),
            entry);
    }

    void addSwitch(const Entry& entry, std::string_view key, Node value) {
        const Number& number = entry.statement.numbers[0];
        if (number.value != 0 && number.value != 1) {
            diagnostics_.note(number.location, quoted(entry.statement.spelled.text) +
                                                   " is on for 1 alone, so " +
                                                   shortest(number.value) + " is off");
        }
        comment(append(section("render", entry.statement.spelled.location), key, std::move(value)),
                entry);
    }

    // ---- textures, background ------------------------------------------------------------------------------

    /// Where the file is; notes what is odd about it.
    FoundPath find(const Word& word) {
        const FoundPath path = findPath(word.text, sceneFolder_, options_.outputFolder);
        if (path.caseDiffers) {
            diagnostics_.note(word.location, quoted(word.text) + " is " + quoted(path.spelled) +
                                                 " on disk: here case matters");
        }
        return path;
    }

    Node textureNode(const Word& word, const FoundPath& path) {
        Node image = mapNode(true, word.location);
        append(image, "file", textNode(path.spelled, word.location));
        append(image, "encoding", keywordNode("linear", word.location));
        append(image, "filter", keywordNode("nearest", word.location));
        append(image, "wrap", keywordNode("horizontal", word.location));
        Node texture = mapNode(true, word.location);
        append(texture, "image", std::move(image));
        return texture;
    }

    void addTexture(const Entry& entry) {
        const Word& word = entry.statement.words[0];
        const FoundPath path = find(word);
        if (!path.exists)
            diagnostics_.warning(word.location, "there is no file " + quoted(path.local));
        Node& textures = section("textures", entry.statement.spelled.location);
        Node texture = textureNode(word, path);
        comments_.moveTo(texture.comments->before, "textures");
        comment(texture, entry);
        append(textures, textures_[textures.members.size()], std::move(texture));
    }

    /// The original's mapping, with its numbers.
    void appendMapping(Node& background) {
        const auto bounds = effective_.find(Keyword::scene);
        if (bounds == effective_.end()) return; // reported
        const Vec3 side = toVec3(bounds->second->numbers, 3) - toVec3(bounds->second->numbers, 0);
        const Location& place = background.location;
        append(background, "mapping", keywordNode("legacy_hemisphere", place));
        Node center = sequenceNode(true, place);
        for (const double value : kBackgroundCenter)
            center.items.push_back(numberNode(value, place));
        append(background, "center", std::move(center));
        append(background, "radius",
               numberNode(std::sqrt(side.x / 2 * (side.x / 2) + side.y / 2 * (side.y / 2) +
                                    side.z * side.z),
                          place));
    }

    Node plainBackground(const Location& place) {
        Node background = mapNode(false, place);
        Node color = sequenceNode(true, place);
        for (const double value : kDefaultBackground)
            color.items.push_back(numberNode(value, place));
        append(background, "color", std::move(color));
        if (hasMovie() && !textures_.empty())
            appendMapping(background); // a fade may bring a texture
        return background;
    }

    /// Nothing where the texture does not exist.
    std::optional<Node> backgroundNode(const Statement& statement) {
        const Number& id = statement.numbers[0];
        if (id.value == -1) return plainBackground(statement.spelled.location);
        if (id.value < 0 || id.value >= static_cast<double>(textures_.size())) return std::nullopt;
        Node background = mapNode(false, statement.spelled.location);
        append(background, "texture",
               textNode(textures_[static_cast<std::size_t>(id.value)], id.location));
        appendMapping(background);
        return background;
    }

    void addBackground(const Entry& entry) {
        const Statement& statement = entry.statement;
        const Number& id = statement.numbers[0];
        auto background = backgroundNode(statement);
        if (!background && !complete_) return;
        if (!background) {
            const std::size_t count = textures_.size();
            diagnostics_.error(Code{391}, id.location,
                               "there is no texture " + shortest(id.value) + ": the scene has " +
                                   (count == 0   ? "none"
                                    : count == 1 ? "one, number 0"
                                                 : std::to_string(count) + ", numbers 0 to " +
                                                       std::to_string(count - 1)));
            return;
        }
        if (background->find("texture")) {
            diagnostics_.note(statement.spelled.location,
                              "the background's sphere stands at (50, 50, 0) and is looked up "
                              "about the origin, as in the "
                              "original: mapping: legacy_hemisphere");
        }
        comment(setSection("background", statement.spelled.location, std::move(*background)),
                entry);
    }

    // ---- lights, objects -----------------------------------------------------------------------------------

    Node lightNode(const Statement& statement) {
        Node point = mapNode(true, statement.spelled.location);
        append(point, "position", vectorNode(slice(statement.numbers, 0, 3)));
        append(point, "color", vectorNode(slice(statement.numbers, 3, 3)));
        if (statement.numbers.size() > 6)
            append(point, "brightness", numberNode(statement.numbers[6]));
        Node light = mapNode(false, statement.spelled.location);
        append(light, "point", std::move(point));
        return light;
    }

    Node objectNode(const Statement& statement, const std::string& name,
                    const std::string& material) {
        const auto& n = statement.numbers;
        Node shape = mapNode(true, statement.spelled.location);
        if (!name.empty()) append(shape, "name", textNode(name, statement.spelled.location));
        switch (statement.keyword) {
        case Keyword::sphere:
            append(shape, "center", vectorNode(slice(n, 0, 3)));
            append(shape, "radius", numberNode(n[3]));
            break;
        case Keyword::triangle:
            append(shape, "a", vectorNode(slice(n, 0, 3)));
            append(shape, "b", vectorNode(slice(n, 3, 3)));
            append(shape, "c", vectorNode(slice(n, 6, 3)));
            break;
        case Keyword::parallelogram:
            append(shape, "origin", vectorNode(slice(n, 0, 3)));
            append(shape, "edge_u", vectorNode(slice(n, 3, 3)));
            append(shape, "edge_v", vectorNode(slice(n, 6, 3)));
            break;
        default: {
            const FoundPath path =
                findPath(statement.words[0].text, sceneFolder_, options_.outputFolder);
            const Word& mode = statement.words[2];
            append(shape, "file", textNode(path.spelled, statement.words[0].location));
            append(shape, "kind",
                   keywordNode(mode.text == "normal" ? "surface" : "solid", mode.location));
            append(shape, "normals", keywordNode("flat", mode.location));
            append(shape, "scale", numberNode(n[3]));
            append(shape, "translate", vectorNode(slice(n, 0, 3)));
        }
        }
        append(shape, "material", textNode(material, (*statement.material)[0].location));
        Node object = mapNode(false, statement.spelled.location);
        append(object, shapeOf(statement.keyword), std::move(shape));
        return object;
    }

    void addObject(const Entry& entry) {
        const Statement& statement = entry.statement;
        const Location& place = statement.spelled.location;
        if (statement.keyword == Keyword::sphere && !(statement.numbers[3].value > 0)) {
            outOfRange(statement.numbers[3], statement, "radius", "more than 0");
        }
        if (statement.keyword == Keyword::mesh) {
            if (statement.numbers[3].value == 0)
                outOfRange(statement.numbers[3], statement, "scale", "anything else");
            const FoundPath path =
                findPath(statement.words[0].text, sceneFolder_, options_.outputFolder);
            if (!path.exists) {
                diagnostics_.warning(
                    statement.words[0].location,
                    "there is no file " + quoted(path.local) +
                        ": the object is kept; rt render --allow-missing draws without it");
            }
        }
        if (transmits(*statement.material) && !notedGlass_) {
            notedGlass_ = true;
            diagnostics_.note(place, "clear objects look different: the original sent rays that "
                                     "leave a solid back into it, "
                                     "and let clear sheets pass light from their front alone");
        }
        if (!findSection("materials")) {
            Node& materials = section("materials", place);
            for (const Node::Member& material : materialNodes_)
                materials.members.push_back(material);
        }
        addItem("objects",
                objectNode(statement, names_[&statement], materials_.nameOf(*statement.material)),
                entry);
    }

    // ---- what the file does not say ------------------------------------------------------------------------

    void addDefaults() {
        Node& image = settingsSection("image");
        append(image, "encoding", keywordNode("linear", file_));
        append(image, "tone", keywordNode("limit", file_));
        Node& render = settingsSection("render");
        if (!render.find("depth")) {
            render.members.insert(render.members.begin(),
                                  {"depth", file_, numberNode(kDefaultDepth, file_)});
            diagnostics_.note(file_,
                              "no 'depth' statement: the original's default, depth 2, is written");
        }
        append(render, "sampling", keywordNode("corner", file_));
        append(render, "near_plane", keywordNode("screen", file_));
        if (!findSection("background") && !effective_.count(Keyword::background)) {
            settingsSection("background") = plainBackground(file_);
            diagnostics_.note(file_,
                              "no 'back' statement: the original's default, blue, is written");
        }
    }

    void addMovie(const Entry& entry, const Location& place) {
        const bool given = !options_.moviePath.empty();
        std::string path = options_.moviePath;
        Location namedAt; // of a --movie file: the command line
        if (!given) {
            const Word& word = entry.statement.words[0];
            path = find(word).local, namedAt = word.location;
            if (options_.lenient && !findPath(word.text, sceneFolder_, "").exists) {
                diagnostics_.note(word.location, "there is no movie file " + quoted(path) +
                                                     ": a still picture, as in the original");
                nextComments_.push_back(entry.statement.text);
                return;
            }
        }
        const auto source = readText(path, namedAt, diagnostics_);
        if (!source) return;
        const MovieText text = parseMovieText(source, options_.lenient, diagnostics_);
        Node animation =
            animationNode(text, {source, 0, 0}, {numbered_, textures_, options_.lenient, complete_},
                          diagnostics_);
        comment(setSection("animation", place, std::move(animation)), entry);
    }

    const Location file_;
    const bool complete_; // false: statements are missing, so counts mean nothing
    const InfOptions& options_;
    scene::Diagnostics& diagnostics_;
    std::string sceneFolder_; // with its '/', or empty
    Node root_;

    std::map<Keyword, const Statement*>
        effective_; // the last of its kind, for statements that replace each other
    std::vector<std::string> textures_; // names by legacy index
    std::set<std::string> textureNames_;
    // Paths in tracks, such as camera.position, begin with these.
    std::set<std::string> objectNames_{"rt",        "image",    "camera",     "bounds",
                                       "render",    "textures", "background", "lights",
                                       "materials", "objects",  "animation"};
    std::map<const Statement*, std::string> names_;
    std::map<Keyword, int> shapeCounts_;
    MaterialNames materials_;
    std::vector<Node::Member> materialNodes_;
    std::vector<NumberedObject> numbered_;
    std::uint64_t nextNumber_ = 0;
    bool hasSheet_ = false, notedGlass_ = false, notedLight_ = false;

    HeldComments comments_;
    std::vector<std::string> nextComments_; // for the statement that is added next
};

} // namespace

Node sceneDocument(SceneText text, const std::shared_ptr<const scene::Source>& source,
                   bool complete, const InfOptions& options, scene::Diagnostics& diagnostics) {
    return SceneConverter(source, complete, options, diagnostics).convert(std::move(text));
}

} // namespace rt::converters
