#include <core/scene/override.hpp>

#include <core/scene/codes.hpp>
#include <core/scene/language.hpp>
#include <core/scene/names.hpp>

#include <algorithm>
#include <charconv>
#include <memory>
#include <optional>

namespace rt::scene {
namespace {

using Kind = Node::Kind;

/// Flow-style YAML without anchors, tags and comments: what fits on a command line.
class FlowParser {
public:
    FlowParser(std::shared_ptr<const Source> source, std::size_t at)
        : source_(std::move(source)), text_(source_->text), at_(at) {}

    std::optional<Node> parse() {
        std::optional<Node> node = parseNode(0, true);
        skipBlanks();
        return at_ == text_.size() ? std::move(node) : std::nullopt;
    }

private:
    static constexpr int kMaxDepth = 64;

    Location here() const { return {source_, 1, static_cast<std::uint32_t>(at_ + 1)}; }
    void skipBlanks() {
        while (at_ < text_.size() &&
               (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n'))
            ++at_;
    }
    bool take(char c) {
        skipBlanks();
        if (at_ >= text_.size() || text_[at_] != c) return false;
        ++at_;
        return true;
    }

    std::optional<Node> parseNode(int depth, bool isWhole) {
        skipBlanks();
        Node node;
        node.location = here();
        node.flow = true;
        if (depth > kMaxDepth) return std::nullopt;
        if (take('[')) {
            node.kind = Kind::sequence;
            while (!take(']')) {
                std::optional<Node> item = parseNode(depth + 1, false);
                if (!item) return std::nullopt;
                node.items.push_back(std::move(*item));
                if (!take(',') && !(at_ < text_.size() && text_[at_] == ']')) return std::nullopt;
            }
            return node;
        }
        if (take('{')) {
            node.kind = Kind::map;
            while (!take('}')) {
                skipBlanks();
                const Location keyPlace = here();
                const std::optional<Node> key = parseScalar(":");
                if (!key || key->kind != Kind::scalar || !take(':')) return std::nullopt;
                std::optional<Node> value = parseNode(depth + 1, false);
                if (!value || node.find(key->text)) return std::nullopt;
                node.members.push_back({key->text, keyPlace, std::move(*value)});
                if (!take(',') && !(at_ < text_.size() && text_[at_] == '}')) return std::nullopt;
            }
            return node;
        }
        return parseScalar(isWhole ? "" : ",]}");
    }

    std::optional<Node> parseScalar(std::string_view stops) {
        skipBlanks();
        Node node;
        node.kind = Kind::scalar;
        node.location = here();
        if (at_ < text_.size() && (text_[at_] == '"' || text_[at_] == '\'')) {
            const char quote = text_[at_];
            const std::size_t end = text_.find(quote, at_ + 1);
            if (end == std::string::npos) return std::nullopt;
            node.quoted = true;
            node.text = text_.substr(at_ + 1, end - at_ - 1);
            at_ = end + 1;
            return node;
        }
        const std::size_t end =
            stops.empty() ? text_.size() : std::min(text_.find_first_of(stops, at_), text_.size());
        node.text = text_.substr(at_, end - at_);
        while (node.text.ends_with(' ')) node.text.pop_back();
        at_ = end;
        if (node.text.empty() || node.text == "~" || node.text == "null") node.kind = Kind::null;
        return node;
    }

    std::shared_ptr<const Source> source_;
    const std::string& text_;
    std::size_t at_;
};

/// One step down from `- TYPE: {name: NAME, ...}` or from a plain node.
class Walker {
public:
    Walker(std::shared_ptr<const Source> source, Diagnostics& diagnostics)
        : source_(std::move(source)), diagnostics_(diagnostics) {}

    /// The member `key` of `map`, added where it is missing.
    Node* intoMap(Node& map, const std::string& key, std::uint32_t column) {
        for (Node::Member& member : map.members)
            if (member.key == key) return &member.value;
        const Location place{source_, 1, column};
        map.members.push_back({key, place, Node{}});
        map.members.back().value.location = place;
        return &map.members.back().value;
    }

    /// The item of `list` that is called `key` or has that number; a typed item's own map.
    Node* intoList(Node& list, const std::string& key, std::uint32_t column,
                   const std::string& path) {
        const std::vector<std::string> names = namesOf(list);
        if (const auto found = std::find(names.begin(), names.end(), key); found != names.end())
            return &innerOf(list.items[static_cast<std::size_t>(found - names.begin())]);
        std::size_t number = 0;
        const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), number);
        if (error == std::errc{} && end == key.data() + key.size()) {
            if (number < list.items.size()) return &innerOf(list.items[number]);
            return fail(column, path + " has " + std::to_string(list.items.size()) +
                                    " items, numbered from 0; there is none of number " + key);
        }
        const std::string near = nearest(key, names);
        return fail(column, path + " has no item named " + quoted(key),
                    near.empty() ? "" : "did you mean '" + near + "'?");
    }

    Node* fail(std::uint32_t column, std::string message, std::string suggestion = {}) {
        diagnostics_.error(codes::kOverride, {source_, 1, column}, std::move(message),
                           std::move(suggestion));
        return nullptr;
    }

    /// One per item of `list`, as the description will have them.
    static std::vector<std::string> namesOf(const Node& list) {
        std::vector<TypedName> items;
        for (const Node& item : list.items) {
            const Node* name = innerOf(item).find("name");
            items.push_back({isTyped(item) ? item.members.front().key : std::string_view(),
                             name && name->kind == Kind::scalar ? name->text : std::string_view()});
        }
        return withInventedNames(items);
    }

private:
    static bool isTyped(const Node& item) {
        return item.kind == Kind::map && item.members.size() == 1 &&
               item.members.front().value.kind == Kind::map;
    }
    template <class NodeOrConst> static NodeOrConst& innerOf(NodeOrConst& item) {
        return isTyped(item) ? item.members.front().value : item;
    }

    std::shared_ptr<const Source> source_;
    Diagnostics& diagnostics_;
};

/// The keys of the camera that exclude each other: whoever sets one means it instead of the other.
void dropOther(Node& camera, std::string_view key) {
    constexpr std::pair<std::string_view, std::string_view> kExclusive[] = {
        {"forward", "look_at"}, {"screen", "field_of_view"}};
    for (const auto& [a, b] : kExclusive)
        if (key == a || key == b)
            std::erase_if(camera.members, [other = key == a ? b : a](const Node::Member& member) {
                return member.key == other;
            });
}

} // namespace

bool applyOverride(Node& root, const std::string& assignment, Diagnostics& diagnostics) {
    const auto source = std::make_shared<const Source>(Source{"--set", assignment});
    Walker walker(source, diagnostics);
    const std::size_t equals = assignment.find('=');
    if (equals == std::string::npos || equals == 0) {
        walker.fail(1, "must be PATH=VALUE, such as render.depth=3");
        return false;
    }
    std::optional<Node> value = FlowParser(source, equals + 1).parse();
    if (!value) {
        walker.fail(static_cast<std::uint32_t>(equals + 2),
                    "the value is no number, text, [list] or {map}");
        return false;
    }

    Node* node = &root;
    std::string path;
    for (std::size_t begin = 0; begin <= equals;) {
        const std::size_t end = std::min(assignment.find('.', begin), equals);
        const std::string key = assignment.substr(begin, end - begin);
        const auto column = static_cast<std::uint32_t>(begin + 1);
        if (key.empty()) return walker.fail(column, "a key is missing in the path"), false;
        if (path.empty()) {
            std::vector<std::string> names;
            for (const Section& section : sections()) names.emplace_back(section.name);
            if (std::find(names.begin(), names.end(), key) == names.end()) {
                // moon.radius is short for objects.moon.radius
                const Node* objects = root.find("objects");
                for (const std::string& name :
                     objects ? walker.namesOf(*objects) : std::vector<std::string>{})
                    names.push_back(name);
                if (end == equals || std::find(names.begin(), names.end(), key) == names.end()) {
                    const std::string near = nearest(key, names);
                    walker.fail(column, "the scene has no section and no object " + quoted(key),
                                near.empty() ? "" : "did you mean '" + near + "'?");
                    return false;
                }
                node = walker.intoList(*walker.intoMap(root, "objects", column), key, column,
                                       "objects");
                path = key;
                begin = end + 1;
                continue;
            }
        }
        if (node->kind == Kind::null)
            node->kind = Kind::map; // a section or map that the scene lacks
        if (node->kind == Kind::scalar)
            return walker.fail(column, path + " is a single value and has no key " + quoted(key)),
                   false;
        const bool isTexture = path.starts_with("textures.") && path.find('.') == path.rfind('.');
        if (isTexture && node->members.size() == 1 && node->members.front().key != key)
            node = &node->members.front().value;
        if (path == "camera") dropOther(*node, key);
        node = node->kind == Kind::sequence ? walker.intoList(*node, key, column, path)
                                            : walker.intoMap(*node, key, column);
        if (!node) return false;
        path += (path.empty() ? "" : ".") + key;
        begin = end + 1;
    }
    *node = std::move(*value);
    return true;
}

} // namespace rt::scene
