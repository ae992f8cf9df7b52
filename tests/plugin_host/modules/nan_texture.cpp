// A texture whose every colour is no number.
#include <rt/plugin.hpp>

namespace {

rt_status create(const rt_host*, const rt_value*, void** state) {
    *state = nullptr;
    return RT_OK;
}
void evaluate(const void*, const rt_surface_point*, std::uint32_t count, double* rgb) {
    for (std::uint32_t i = 0; i < 3 * count; ++i) rgb[i] = std::numeric_limits<double>::quiet_NaN();
}
void destroy(void*) {}

constexpr rt_texture_type kTexture{
    sizeof(rt_texture_type), 0, nullptr, create, evaluate, destroy, nullptr};

} // namespace

extern "C" RT_EXPORT constexpr rt_module rt_plugin_entry = {
    RT_ABI_MAGIC,  RT_ABI_MAJOR,      RT_ABI_MINOR,
    RT_ABI_LAYOUT, sizeof(rt_module), "nan_texture",
    "1.0.0",       "Is no colour.",   "x: {nan_texture: {}}\n",
    nullptr,       &kTexture,         nullptr};
