// The film's part of validation: tracks, their targets, motions and frames.
#pragma once
#include <core/scene/description.hpp>
#include <core/scene/map_reader.hpp>
#include <core/scene/node.hpp>

namespace rt::scene {

/// Reads the section into description.animation. Targets are looked up in the description, which is otherwise complete.
void validateAnimation(const Node::Member& section, const TextureNames& textures,
                       Description& description, Diagnostics& diagnostics);

} // namespace rt::scene
