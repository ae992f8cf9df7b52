// The names of objects and lights.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace rt::scene {

/// What a list of typed items says about one of them; `name` is empty where the scene gives none.
struct TypedName {
    std::string_view type, name;
};

/// One name per item: its own, or an invented one: sphere_0 for the first sphere, and so on; numbers whose name
/// is taken are passed over.
std::vector<std::string> withInventedNames(const std::vector<TypedName>& items);

} // namespace rt::scene
