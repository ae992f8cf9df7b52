// A document as a tree of nodes with places: what formats/yaml_reader makes, converters make, and validation reads.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rt::scene {

struct Node {
    enum class Kind : std::uint8_t { null, scalar, sequence, map };
    struct Member; // key and value

    Kind kind = Kind::null;
    bool quoted = false; // scalar in quotes: text, never a number
    bool flow = false;   // writer: on one line
    Location location;
    std::string text;            // scalar
    std::vector<Node> items;     // sequence
    std::vector<Member> members; // map, in file order, keys unique

    std::vector<std::string> commentsBefore; // writer: lines without '#', above the node
    std::string commentAfter;                // writer: on the node's line
    std::vector<std::string>
        commentsAtEnd; // writer: below the last item or member, indented like it

    const Node* find(std::string_view key) const; // map member's value, or nullptr
};

struct Node::Member {
    std::string key;
    Location keyLocation;
    Node value;
};

} // namespace rt::scene
