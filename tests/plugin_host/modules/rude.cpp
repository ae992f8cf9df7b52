// Lets exceptions out, asks for more memory than there is, and fails without a word; written against the C header alone.
#include <rt/plugin.h>

#include <new>
#include <stdexcept>
#include <string>

namespace {
const rt_param kRows[] = {{"act", "", nullptr, "What to do.", 0, 0, RT_TEXT, RT_UNIT_NONE, 0, 0}};

rt_status lower(const rt_host* host, const rt_value* values, rt_sink*) {
    const std::string act = values[0].text;
    if (act == "throw") throw std::runtime_error("out of my way");
    if (act == "throw int") throw 7;
    if (act == "allocate") ::operator delete(::operator new (~std::size_t{0} / 4));
    if (act == "null reason") return host->fail(host, -1, nullptr);
    if (act == "bad parameter") return host->fail(host, 99, "parameter 99 is wrong");
    return RT_FAILED;
}

const rt_shape kShape = {sizeof(rt_shape), 1, kRows, lower};
} // namespace

extern "C" RT_EXPORT const rt_module rt_plugin_entry = {
    RT_ABI_MAGIC, RT_ABI_MAJOR, RT_ABI_MINOR, RT_ABI_LAYOUT, sizeof(rt_module), "rude",
    "1.0.0",      "Is rude.",   "",           &kShape,       nullptr,           nullptr};
