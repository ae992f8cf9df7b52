#include <converters/material_names.hpp>

#include <converters/node_building.hpp>

#include <algorithm>
#include <bit>

namespace rt::converters {
namespace {

constexpr std::size_t kColor = 0, kDiffuse = 3, kSpecular = 6, kTransmission = 9, kEnvironment = 12,
                      kRefractivity = 15, kShininess = 16;

double largest(const MaterialNumbers& numbers, std::size_t first) {
    return std::max({numbers[first].value, numbers[first + 1].value, numbers[first + 2].value});
}

std::string_view kindOf(const MaterialNumbers& numbers) {
    if (transmits(numbers)) return "glass";
    const double specular = largest(numbers, kSpecular), diffuse = largest(numbers, kDiffuse);
    if (specular > diffuse) return "mirror";
    if (specular > 0) return "glossy";
    if (diffuse > 0) return "matte";
    return largest(numbers, kEnvironment) > 0 ? "flat" : "black";
}

} // namespace

bool transmits(const MaterialNumbers& numbers) {
    return numbers[kTransmission].value != 0 || numbers[kTransmission + 1].value != 0 ||
           numbers[kTransmission + 2].value != 0;
}

const std::string& MaterialNames::nameOf(const MaterialNumbers& numbers) {
    std::array<std::uint64_t, kMaterialNumbers> bits;
    std::ranges::transform(numbers, bits.begin(),
                           [](const Number& n) { return std::bit_cast<std::uint64_t>(n.value); });
    std::string& name = names_[bits];
    isNew_ = name.empty();
    if (isNew_) {
        const std::string_view kind = kindOf(numbers);
        name = std::string(kind) + "_" + std::to_string(kinds_[kind]++);
    }
    return name;
}

scene::Node materialNode(const MaterialNumbers& numbers) {
    scene::Node node = mapNode(true, numbers[0].location);
    const auto triple = [&](std::size_t first) { return std::span(numbers).subspan(first, 3); };
    const auto bits = [&](std::size_t i) { return std::bit_cast<std::uint64_t>(numbers[i].value); };
    append(node, "color", vectorNode(triple(kColor)));
    static constexpr std::pair<std::string_view, std::size_t> kCoefficients[] = {
        {"diffuse", kDiffuse},
        {"specular", kSpecular},
        {"transmission", kTransmission},
        {"environment", kEnvironment}};
    for (const auto& [key, first] : kCoefficients) {
        const bool equal = bits(first) == bits(first + 1) && bits(first) == bits(first + 2);
        if (equal && bits(first) == 0) continue;
        append(node, key, equal ? numberNode(numbers[first]) : vectorNode(triple(first)));
    }
    // Without any of the four, rt takes a material for a plain white one.
    if (node.members.size() == 1) append(node, "diffuse", numberNode(numbers[kDiffuse]));
    if (numbers[kRefractivity].value > 0) append(node, "ior", numberNode(numbers[kRefractivity]));
    append(node, "shininess", numberNode(numbers[kShininess]));
    return node;
}

} // namespace rt::converters
