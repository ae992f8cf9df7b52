// How every serial call into a plugin is made.
#pragma once
#include <core/plugin_host/call.hpp>
#include <core/plugin_host/fault_report.hpp>

#include <exception>
#include <string>

namespace rt::plugin_host {

/// Runs a plugin's function and sees to it that a failure has a reason. True: it succeeded.
template <class Function> bool run(Call& call, Function&& function) {
    rt_status status = RT_FAILED;
    const RunningCall running(call);
    try {
        status = function();
    } catch (const std::exception& e) {
        call.refuse(kPluginThrew,
                    std::string("it threw an exception across the plugin boundary: ") + e.what());
    } catch (...) {
        call.refuse(kPluginThrew, "it threw an exception across the plugin boundary");
    }
    if (call.failed) return false;
    if (status == RT_OUT_OF_MEMORY)
        call.refuse(kNoMemory, "there is not enough memory for it");
    else if (status != RT_OK)
        call.refuse(call.otherCode, "it failed and gave no reason");
    return !call.failed;
}

} // namespace rt::plugin_host
