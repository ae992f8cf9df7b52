// The numbers of a pinhole camera: what a kernel needs to know of it. World space.
#pragma once
#include <core/numeric/vec.hpp>

namespace rt::trace {

/// Columns and rows from the top-left corner of the picture; pixel (x, y) is [x, x + 1) x [y, y + 1).
struct PicturePoint {
    double column, row;
};

struct Pinhole {
    numeric::Vec3 eye;
    numeric::Vec3 toScreen;         // eye to the middle of the screen
    numeric::Vec3 up, left;         // unit
    double pixelHeight, pixelWidth; // on the screen
    double halfRows, halfColumns;   // rows and columns from the corner to the middle
    bool startsOnScreen;
};

} // namespace rt::trace
