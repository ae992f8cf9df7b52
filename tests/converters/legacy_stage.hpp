// From a legacy file to a world that can be drawn, and where the original author's files are.
#pragma once
#include <converters/inf.hpp>
#include <core/octree/octree.hpp>
#include <core/plugin_host/lower.hpp>
#include <core/scene/validate.hpp>

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>

namespace rt::converters {

/// The original author's files and pictures lie beside the project, or where RT_LEGACY_FILES says.
inline std::string legacy(const std::string& name) {
    const char* const elsewhere = std::getenv("RT_LEGACY_FILES");
    return std::string(elsewhere ? elsewhere : RT_LEGACY_FILES) + "/" + name;
}

inline std::string errorsOf(const scene::Diagnostics& diagnostics) {
    std::string text;
    for (const scene::Diagnostic& each : diagnostics.all()) {
        if (each.severity == scene::Severity::error) text += scene::format(each, false);
    }
    return text;
}

struct LegacyStage {
    scene::Description description;
    world::World world;
    octree::Octree octree;
};

/// The catalog outlives the stage.
inline std::unique_ptr<LegacyStage> stageOf(const std::string& path, plugin_host::Catalog& catalog,
                                            bool lenient = false) {
    scene::Diagnostics diagnostics;
    auto stage = std::make_unique<LegacyStage>();
    InfOptions options;
    options.lenient = lenient;
    const auto document = convertInf(path, options, diagnostics);
    const auto description =
        document ? scene::validate(*document, catalog, diagnostics) : std::nullopt;
    auto world =
        description ? plugin_host::lower(*description, catalog, diagnostics) : std::nullopt;
    EXPECT_TRUE(world.has_value()) << errorsOf(diagnostics);
    if (!world) return nullptr;
    stage->description = *description;
    stage->world = std::move(*world);
    stage->octree = octree::Octree::build(stage->world.primitives);
    return stage;
}

} // namespace rt::converters
