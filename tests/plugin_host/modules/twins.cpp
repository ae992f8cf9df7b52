// Three equal spheres in one place.
#include <rt/plugin.hpp>

struct Twins {};

namespace {
void lower(const Twins&, rt::Geometry& out) {
    out.spheres({{{0, 0, 0}, 1}, {{0, 0, 0}, 1}, {{0, 0, 0}, 1}});
}
} // namespace

RT_SHAPE_PLUGIN("twins", "1.0.0", rt::noParameters<Twins>, lower, "Three equal spheres.", "")
