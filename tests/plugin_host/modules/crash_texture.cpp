// A texture that reads beyond itself when it is evaluated.
#include <rt/plugin.hpp>

namespace {

struct Nothing {};

struct Crashing {
    const volatile double* nowhere = nullptr;
    rt::Color at(const rt_surface_point&) const { return {*nowhere, 0, 0}; }
};

Crashing create(const Nothing&, rt::Host&) { return {}; }

} // namespace

RT_TEXTURE_PLUGIN("crash_texture", "1.0.0", rt::noParameters<Nothing>, create, "Crashes.",
                  "t: {crash_texture: {}}\n")
