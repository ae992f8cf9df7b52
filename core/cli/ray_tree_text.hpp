// --pixel X,Y --trace: a pixel's ray tree for people.
#pragma once
#include <core/scene/description.hpp>
#include <core/trace/ray_tree.hpp>

#include <string>

namespace rt::cli {

/// One block per ray, indented by its depth. Numbers have six digits.
std::string rayTreeText(const trace::RayTree& tree, std::uint32_t x, std::uint32_t y,
                        const world::World& world, const scene::Description& description);

} // namespace rt::cli
