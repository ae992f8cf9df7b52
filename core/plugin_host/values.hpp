// A validated instance's values as the rt_value array that its plugin reads.
#pragma once
#include <core/scene/description.hpp>
#include <rt/plugin.h>

#include <deque>
#include <span>
#include <vector>

namespace rt::plugin_host {

/// In row order. Borrows texts from `values` and textures from `textures`, which must outlive it.
class ValueArray {
public:
    ValueArray(std::span<const rt_param> rows, const std::vector<scene::Value>& values,
               std::span<const rt_texture* const> textures);

    const rt_value* data() const { return values_.data(); }

private:
    std::vector<rt_value> values_;
    std::deque<std::vector<double>> items_;
    std::deque<std::vector<std::uint32_t>> counts_;
};

/// The path in a value of type RT_FILE; "" when absent.
const std::string& pathOf(const scene::Value& value);

} // namespace rt::plugin_host
