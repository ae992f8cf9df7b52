// Short hands for making scene-language nodes out of parsed numbers and words.
#pragma once
#include <converters/text.hpp>
#include <core/scene/node.hpp>

#include <span>

namespace rt::converters {

scene::Node textNode(std::string text, const scene::Location& location);
scene::Node keywordNode(std::string_view text, const scene::Location& location); // never quoted
scene::Node numberNode(double value, const scene::Location& location);
inline scene::Node numberNode(const Number& number) {
    return numberNode(number.value, number.location);
}
/// [a, b, ...] on one line.
scene::Node vectorNode(std::span<const Number> numbers);
scene::Node mapNode(bool flow, const scene::Location& location);
scene::Node sequenceNode(bool flow, const scene::Location& location);

/// Appends and returns the value. The reference holds until the next append to `map`.
scene::Node& append(scene::Node& map, std::string_view key, scene::Node value);

/// The node as one line of YAML.
std::string flowText(const scene::Node& node);

} // namespace rt::converters
