#include <core/scene/names.hpp>

#include <cstdint>
#include <map>
#include <set>

namespace rt::scene {

std::vector<std::string> withInventedNames(const std::vector<TypedName>& items) {
    std::set<std::string, std::less<>> taken;
    for (const TypedName& item : items) taken.emplace(item.name);
    std::map<std::string_view, std::uint32_t> next;
    std::vector<std::string> names;
    names.reserve(items.size());
    for (const TypedName& item : items) {
        std::uint32_t& number = next[item.type];
        const auto invented = [&] { return std::string(item.type) + "_" + std::to_string(number); };
        if (item.name.empty()) {
            while (!taken.insert(invented()).second) ++number;
            names.push_back(invented());
        } else {
            names.emplace_back(item.name);
        }
        ++number;
    }
    return names;
}

} // namespace rt::scene
