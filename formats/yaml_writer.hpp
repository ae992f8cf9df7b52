// Nodes to YAML text: block style with flow vectors, comments kept, numbers as the nodes spell them.
#pragma once
#include <core/scene/node.hpp>

#include <string>

namespace rt::formats {

/// Text that parseYaml reads back as the same nodes. Ends with one newline.
std::string writeYaml(const scene::Node& root);

} // namespace rt::formats
