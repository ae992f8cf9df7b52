#include <core/plugin_host/call.hpp>

namespace rt::plugin_host {
namespace {

rt_status fail(const rt_host* host, std::int32_t parameter, const char* message) {
    Call& call = callOf(host);
    const std::string why = message != nullptr ? message : "it gave no reason";
    if (parameter >= 0 && static_cast<std::size_t>(parameter) < call.rows.size()) {
        const auto i = static_cast<std::size_t>(parameter);
        call.diagnostics->error(call.rows[i].type == RT_FILE ? call.fileCode : kValueRefused,
                                (*call.values)[i].location,
                                call.subject + ", " + call.rows[i].name + ": " + why);
        call.failed = true;
    } else {
        call.refuse(call.otherCode, why);
    }
    return RT_FAILED;
}

rt_status exceeds(const rt_host* host, std::int32_t parameter, const char* message) {
    Call& call = callOf(host);
    const auto i = static_cast<std::size_t>(parameter);
    const bool named = parameter >= 0 && i < call.rows.size();
    call.diagnostics->error(kPluginLimit, named ? (*call.values)[i].location : call.location,
                            call.subject + (named ? std::string(", ") + call.rows[i].name : "") +
                                ": " + (message != nullptr ? message : "it gave no reason"));
    call.failed = true;
    return RT_FAILED;
}

void note(const rt_host* host, const char* message) {
    const Call& call = callOf(host);
    call.diagnostics->note(call.location, call.subject + ": " + message);
}

void warn(const rt_host* host, const char* message) {
    const Call& call = callOf(host);
    call.diagnostics->warning(call.location, call.subject + ": " + message);
}

rt_status loadNothing(const rt_host* host, std::int32_t, std::uint32_t, rt_sink*) {
    callOf(host).refuse(kPluginFailed, "only a shape may load files");
    return RT_FAILED;
}

} // namespace

Call callFor(const char* kind, const scene::Instance& instance, std::span<const rt_param> rows,
             scene::Code fileCode, scene::Code otherCode, const scene::Limits& limits,
             scene::Diagnostics& diagnostics) {
    Call call{};
    call.host.struct_size = sizeof(rt_host);
    call.host.abi_minor = RT_ABI_MINOR;
    call.host.fail = &fail;
    call.host.note = &note;
    call.host.warn = &warn;
    call.host.load = &loadNothing;
    call.host.max_texels = limits.texturePixels;
    call.host.exceeds = &exceeds;
    call.diagnostics = &diagnostics;
    call.subject = std::string(kind) + " '" + instance.type + "'";
    call.rows = rows;
    call.values = &instance.values;
    call.location = instance.location;
    call.fileCode = fileCode;
    call.otherCode = otherCode;
    return call;
}

} // namespace rt::plugin_host
