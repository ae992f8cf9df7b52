// What the frames of a film depend on, as fields and values: two runs with the same make the same frames.
#pragma once
#include <core/cli/command_line.hpp>
#include <core/plugin_host/catalog.hpp>
#include <core/scene/description.hpp>
#include <core/world/world.hpp>
#include <formats/frame_store.hpp>

#include <set>

namespace rt::cli {

/// Every key of the scene ("objects.moon.radius"), the content of `files`, materials that came with meshes, plugins and
/// their modules, and the options that change pictures ("--crop"). Paths below the scene's folder are relative to it.
formats::Settings filmSettings(const RenderOptions& options, const scene::Description& description,
                               const world::World& world, const std::set<std::string>& files,
                               const plugin_host::Catalog& catalog);

} // namespace rt::cli
