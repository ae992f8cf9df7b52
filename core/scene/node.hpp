// A document as a tree of nodes with places: what formats/yaml_reader makes, converters make, and validation reads.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace rt::scene {

/// A value that most owners leave as it is made: only one that is written to, or read where it might be, takes memory.
template <class T> class Seldom {
public:
    Seldom() = default;
    Seldom(const Seldom& other)
        : value_(other.value_ ? std::make_unique<T>(*other.value_) : nullptr) {}
    Seldom(Seldom&&) noexcept = default;
    Seldom& operator=(Seldom other) noexcept {
        value_ = std::move(other.value_);
        return *this;
    }

    T* operator->() {
        if (!value_) value_ = std::make_unique<T>();
        return value_.get();
    }
    const T* operator->() const {
        static const T untouched;
        return value_ ? value_.get() : &untouched;
    }

private:
    std::unique_ptr<T> value_;
};

/// What the writer puts around a node: lines without '#'.
struct Comments {
    std::vector<std::string> before; // above it
    std::string after;               // on its line
    std::vector<std::string> atEnd;  // below the last item or member, indented like it
};

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

    Seldom<Comments> comments;

    const Node* find(std::string_view key) const; // map member's value, or nullptr
};

struct Node::Member {
    std::string key;
    Location keyLocation;
    Node value;
};

} // namespace rt::scene
