// `rt new shape torus`: a third party's project that builds and renders at once.
#pragma once
#include <core/scene/type_catalog.hpp>

#include <filesystem>
#include <string>
#include <variant>
#include <vector>

namespace rt::plugin_host {

/// Writes `folder`/NAME.cpp, CMakeLists.txt, scene.yaml and README.md, creating the folder; returns the files, or a
/// sentence that says why nothing was written. Never overwrites: `folder` must not exist, or be empty.
/// Precondition: none; a bad name is such a sentence.
std::variant<std::vector<std::filesystem::path>, std::string>
writeNewProject(scene::TypeKind kind, const std::string& name, const std::filesystem::path& folder);

} // namespace rt::plugin_host
