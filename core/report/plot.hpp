// Plots on two log axes, as SVG that needs no other file: told apart by colour and by marker, so that print in grey will do.
#pragma once
#include <string>
#include <vector>

namespace rt::report {

struct Dot {
    double x, y;        // above 0
    std::string series; // in the legend: one colour and marker
    std::string label;  // beside the dot; may be empty
    std::string hover;
    bool filled = true;
    bool bound = false; // nothing was counted, y is what may have been missed
};

struct Plot {
    std::string title, xName, yName;
    std::vector<Dot> dots;          // at least one
    std::vector<std::size_t> front; // dots; a dashed line joins them as far as it falls
    std::string filled, hollow;     // what these say; empty: not in the legend
};

std::string asSvg(const Plot& plot);

/// In text or attributes of HTML or SVG.
std::string escaped(const std::string& text);

/// 0.0123, 1420, 1.5e-12.
std::string digits(double value, int significant = 3);

} // namespace rt::report
