// The materials of a legacy scene: equal ones are one, under a name that says what it looks like.
#pragma once
#include <converters/statements.hpp>
#include <core/scene/node.hpp>

#include <map>

namespace rt::converters {

class MaterialNames {
public:
    /// The name of the material with these numbers; made up at their first use. A number beside the kind counts from 0.
    const std::string& nameOf(const MaterialNumbers& numbers);
    /// Did the last nameOf make the name up?
    bool isNew() const { return isNew_; }

private:
    std::map<std::array<std::uint64_t, kMaterialNumbers>, std::string>
        names_; // by the bits of the numbers
    std::map<std::string_view, int> kinds_;
    bool isNew_ = false;
};

bool transmits(const MaterialNumbers& numbers);

/// Coefficients that are 0, the default, are left out; so is refractivity where nothing is transmitted and it is no index.
scene::Node materialNode(const MaterialNumbers& numbers);

} // namespace rt::converters
