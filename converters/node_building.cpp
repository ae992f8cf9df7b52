#include <converters/node_building.hpp>

#include <algorithm>

namespace rt::converters {
namespace {

using scene::Node;

/// Plain YAML text that can be taken for nothing but text: a letter, then letters, digits and - _ . /
bool isPlain(std::string_view text) {
    const auto letter = [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
    };
    static constexpr std::string_view kReserved[] = {"true", "false", "null", "yes", "no",
                                                     "on",   "off",   "y",    "n"};
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; });
    return !text.empty() && letter(text.front()) &&
           std::ranges::find(kReserved, lower) == std::end(kReserved) &&
           std::ranges::all_of(text, [&](char c) {
               return letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '.' || c == '/';
           });
}

std::string quotedYaml(std::string_view text) {
    std::string out = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + '"';
}

} // namespace

Node textNode(std::string text, const scene::Location& location) {
    Node node = keywordNode(text, location);
    node.quoted = !isPlain(text);
    return node;
}

Node keywordNode(std::string_view text, const scene::Location& location) {
    Node node;
    node.kind = Node::Kind::scalar;
    node.text = text;
    node.location = location;
    return node;
}

Node numberNode(double value, const scene::Location& location) {
    return keywordNode(shortest(value), location);
}

Node vectorNode(std::span<const Number> numbers) {
    Node node = sequenceNode(true, numbers.front().location);
    for (const Number& number : numbers) node.items.push_back(numberNode(number));
    return node;
}

Node mapNode(bool flow, const scene::Location& location) {
    Node node;
    node.kind = Node::Kind::map;
    node.flow = flow;
    node.location = location;
    return node;
}

Node sequenceNode(bool flow, const scene::Location& location) {
    Node node = mapNode(flow, location);
    node.kind = Node::Kind::sequence;
    return node;
}

Node& append(Node& map, std::string_view key, Node value) {
    const scene::Location location = value.location;
    map.members.push_back({std::string(key), location, std::move(value)});
    return map.members.back().value;
}

std::string flowText(const Node& node) {
    std::string text;
    switch (node.kind) {
    case Node::Kind::null:
        return "null";
    case Node::Kind::scalar:
        return node.quoted ? quotedYaml(node.text) : node.text;
    case Node::Kind::sequence:
        for (const Node& item : node.items) text += (text.empty() ? "" : ", ") + flowText(item);
        return "[" + text + "]";
    case Node::Kind::map:
        for (const Node::Member& member : node.members) {
            text += (text.empty() ? "" : ", ") + member.key + ": " + flowText(member.value);
        }
        return "{" + text + "}";
    }
    return text;
}

} // namespace rt::converters
