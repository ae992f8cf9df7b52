// `rt view`: fly through a scene, coarse to fine, interrupted by any key.
#pragma once
#include <core/octree/octree.hpp>
#include <core/scene/description.hpp>
#include <core/view/display.hpp>
#include <core/world/world.hpp>

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace rt::view {

/// A scene ready to trace. The octree refers to the world, so neither moves.
struct Stage {
    scene::Description description;
    world::World world;
    octree::Octree octree;
};

struct Reload {
    std::shared_ptr<const Stage> stage; // none: the files have errors
    std::vector<std::string> errors;    // one line each, said already
};

struct ViewOptions {
    int threads = 0;
    bool overlay = true;
    double frameSeconds = 1.0 / 60; // what a picture may take while the camera moves
};

/// What the viewer asks of the program around it.
struct Services {
    /// Reads the scene again; called when `changed` says that a file of it has.
    std::function<Reload()> reload;
    std::function<bool()> changed;
    /// The scene at one frame of its animation; null where the scene has none.
    std::function<std::shared_ptr<const Stage>(std::uint32_t frame)> frame;
    std::function<void(const std::string& text)> print;  // results: camera, clicked object
    std::function<void(const Picture& picture)> savePng; // P
};

/// Runs until the display closes or Esc. Returns after the last render has stopped.
void run(std::shared_ptr<const Stage> stage, Display& display, const Services& services,
         const ViewOptions& options);

/// The keys and what they do, one line each.
const std::vector<std::string>& helpLines();

} // namespace rt::view
