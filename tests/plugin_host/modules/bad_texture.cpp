// A texture that breaks every rule that --check holds textures and rows to.
#include <rt/plugin.hpp>

#include <atomic>

namespace {

std::atomic<unsigned> gCalls{0};

constexpr rt_param kRows[] = {
    {"text", "", nullptr, "no sentence", 0, 0, RT_TEXT, RT_UNIT_NONE, 0, 0},
};

rt_status create(const rt_host*, const rt_value*, void** state) {
    *state = nullptr;
    return RT_OK;
}
void evaluate(const void*, const rt_surface_point* points, std::uint32_t count, double* rgb) {
    for (std::uint32_t i = 0; i < count; ++i) {
        rgb[3 * i] = points[i].uv[0] == 0 ? rt::kInfinity : 0;
        rgb[3 * i + 1] = -1;
        rgb[3 * i + 2] = gCalls++;
    }
}
void destroy(void*) {}

constexpr rt_texture_type kTexture{
    sizeof(rt_texture_type), 1, kRows, create, evaluate, destroy, nullptr};

} // namespace

extern "C" RT_EXPORT constexpr rt_module rt_plugin_entry = {
    RT_ABI_MAGIC, RT_ABI_MAJOR, RT_ABI_MINOR, RT_ABI_LAYOUT, sizeof(rt_module), "bad_texture",
    "",           "all wrong",  "",           nullptr,       &kTexture,         nullptr};
