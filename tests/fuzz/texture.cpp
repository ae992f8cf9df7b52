// Bytes as the file of the texture `image`: texels, or a reason why not. What it is made of is looked at from many places.
#include <rt/plugin.hpp>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

namespace {

void require(bool holds) {
    if (!holds) std::abort();
}

bool said = false;

rt_status say(const rt_host*, std::int32_t, const char* message) {
    require(message != nullptr && *message != '\0');
    said = true;
    return RT_FAILED;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    static const int file = ::memfd_create("texture", MFD_CLOEXEC);
    static const std::string path = "/proc/self/fd/" + std::to_string(file);
    require(file >= 0 && ::ftruncate(file, 0) == 0 &&
            ::pwrite(file, data + 1, size - 1, 0) == static_cast<ssize_t>(size - 1));
    rt_host host{};
    host.struct_size = sizeof host;
    host.abi_minor = RT_ABI_MINOR;
    host.fail = host.exceeds = say;
    host.note = [](const rt_host*, const char*) {};
    host.max_texels = 1 << 16;
    rt_value values[4]{};
    values[0].text = path.c_str();
    for (int i = 1; i < 4; ++i) values[i].integer = (data[0] >> (2 * i)) % 3;
    said = false;
    void* state = nullptr;
    const rt_texture_type& type = *rt_plugin_entry.texture;
    const rt_status status = type.create(&host, values, &state);
    require(status == RT_OK || status == RT_OUT_OF_MEMORY || said);
    if (status != RT_OK) return 0;
    std::uint32_t texels[2];
    type.resolution(state, texels);
    require(std::uint64_t{texels[0]} * texels[1] <= host.max_texels && texels[0] * texels[1] > 0);
    constexpr double kPlaces[] = {-1e308, -1, -0.25, 0, 0.5, 1, 1.75, 1e18, INFINITY, NAN};
    for (const double u : kPlaces)
        for (const double v : kPlaces) {
            const rt_surface_point point{{u, v}, {}, {}};
            double rgb[3];
            type.evaluate(state, &point, 1, rgb);
            for (const double channel : rgb) require(std::isfinite(channel) && channel >= 0);
        }
    type.destroy(state);
    return 0;
}
