// A test of each of the mixed scenes.
#pragma once
#include "scenes.hpp"

#include <gtest/gtest.h>

namespace rt::test {

/// Its parameter is the number of the scene.
class OnMixedScenes : public testing::TestWithParam<int> {
protected:
    const Scene& scene() const {
        static const std::vector<Scene> all = mixedScenes();
        return all[static_cast<std::size_t>(GetParam())];
    }
};

} // namespace rt::test
