// What each error code means and what to do about it: `rt explain E0312`.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <optional>
#include <span>
#include <string_view>

namespace rt::scene {

struct Explanation {
    Code code;
    std::string_view title; // a few words
    std::string_view
        text; // paragraphs of lines up to 80 columns, examples indented; no newline at the end
};

/// By rising code.
std::span<const Explanation> explanations();
std::optional<Explanation> explanation(Code code);

} // namespace rt::scene
