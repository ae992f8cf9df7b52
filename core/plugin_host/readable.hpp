// Is a path a file that a plugin can read? Asked before the plugin is.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

namespace rt::plugin_host {

/// Why `path` is no readable regular file of at most `maxBytes`, with the code that says so; nothing if it is one.
std::optional<std::pair<scene::Code, std::string>> whyUnreadable(const std::string& path,
                                                                 std::uint64_t maxBytes);

/// "did you mean 'dragon.obj'?", from the files beside a missing one.
std::string suggestionFor(const std::string& missing);

} // namespace rt::plugin_host
