#include <core/plugin_host/values.hpp>

namespace rt::plugin_host {
namespace {

double realOf(const scene::Value& value) {
    if (const auto* integer = std::get_if<std::int64_t>(&value.data))
        return static_cast<double>(*integer);
    const auto* real = std::get_if<double>(&value.data);
    return real != nullptr ? *real : 0;
}

} // namespace

const std::string& pathOf(const scene::Value& value) {
    static const std::string absent;
    const auto* text = std::get_if<std::string>(&value.data);
    return text != nullptr ? *text : absent;
}

ValueArray::ValueArray(std::span<const rt_param> rows, const std::vector<scene::Value>& values,
                       std::span<const rt_texture* const> textures)
    : values_(rows.size()) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const scene::Value& from = values[i];
        rt_value& to = values_[i];
        to = rt_value{};
        switch (rows[i].type) {
        case RT_BOOL:
        case RT_INTEGER:
        case RT_CHOICE:
            if (const auto* integer = std::get_if<std::int64_t>(&from.data)) to.integer = *integer;
            break;
        case RT_REAL:
            to.real = realOf(from);
            break;
        case RT_VECTOR3:
        case RT_COLOR:
            if (const auto* v = std::get_if<scene::Vec3>(&from.data)) {
                to.vector[0] = v->x, to.vector[1] = v->y, to.vector[2] = v->z;
            }
            break;
        case RT_TEXT:
        case RT_FILE:
            to.text = pathOf(from).c_str();
            break;
        case RT_TEXTURE:
            to.texture = nullptr;
            if (const auto* index = std::get_if<std::int64_t>(&from.data))
                to.texture = textures[static_cast<std::size_t>(*index)];
            break;
        case RT_VECTOR3_LIST: {
            std::vector<double>& items = items_.emplace_back();
            if (const auto* list = std::get_if<scene::Value::VectorList>(&from.data))
                for (const scene::Vec3& v : list->items) items.insert(items.end(), {v.x, v.y, v.z});
            to.list = {items.data(), nullptr, items.size() / 3};
            break;
        }
        case RT_INTEGER_LISTS: {
            std::vector<double>& items = items_.emplace_back();
            std::vector<std::uint32_t>& counts = counts_.emplace_back();
            if (const auto* lists = std::get_if<scene::Value::IntegerLists>(&from.data))
                for (const auto& entry : lists->entries) {
                    counts.push_back(static_cast<std::uint32_t>(entry.size()));
                    for (std::int64_t integer : entry)
                        items.push_back(static_cast<double>(integer));
                }
            to.list = {items.data(), counts.data(), counts.size()};
            break;
        }
        default:
            break;
        }
    }
}

} // namespace rt::plugin_host
