// One value of the language: text to value by its row, value back to text. Core sections and plugin types share it.
#pragma once
#include <core/scene/description.hpp>
#include <core/scene/node.hpp>

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace rt::scene {

/// Why a node is not what its row wants: "must be > 0 (got -1)".
struct Fault {
    Code code;
    Location location;
    std::string clause;
    std::string suggestion;
};

template <class T> using Parsed = std::variant<T, Fault>;

// Flags that only core rows carry.
inline constexpr std::uint32_t kUniform = 1u << 16; // RT_VECTOR3: one number stands for three

/// Coordinates and lengths lie within this, and lengths that must be positive are no smaller than its inverse: f32
/// boxes hold them, and their squares and quotients stay finite and above 0.
inline constexpr double kMaxLength = 1e18;

/// `file` values come back absolute, relative paths starting at the folder of the file that `node` stands in.
/// Texture references come back as their name.
Parsed<Value> parseValue(const Node& node, const rt_param& row);

/// A whole number without leading zeros, signs but '-', points or exponents.
Parsed<std::int64_t> parseInteger(const Node& node);

/// The value that an absent key has; monostate where "" means absent. The row must have a fallback.
Parsed<Value> parseFallback(const rt_param& row);

/// The node that parseValue reads back as `value`; numbers at their shortest.
Node nodeOf(const Value& value, const rt_param& row);

Node scalarNode(std::string text);
Node flowNode(Node::Kind kind);
std::string shortest(double number);
std::vector<std::string> choicesOf(const rt_param& row);
/// "a number > 0", "three numbers [x, y, z]", "one of flat, smooth": what parseValue accepts.
std::string describe(const rt_param& row);
/// "a list", "a map", "text": what a node is, for "not a list".
std::string_view kindName(const Node& node);

} // namespace rt::scene
