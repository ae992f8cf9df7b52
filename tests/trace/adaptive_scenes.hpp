// Scenes that are hard to sample, each for a reason of its own.
#pragma once
#include <tests/trace/scene_maker.hpp>

#include <functional>
#include <string>
#include <vector>

namespace rt::trace {

struct NamedScene {
    std::string name;
    std::function<void(SceneMaker&)> make;
};

const std::vector<NamedScene>& scenesThatAreHardToSample();

} // namespace rt::trace
