// No exception leaves a codec module.
#pragma once
#include <formats/codec/codec.h>

#include <cstdio>
#include <exception>

/// 1, or 0 with the reason in host->error.
template <class Work> int guarded(const rt_codec_host* host, Work work) {
    try {
        work();
        return 1;
    } catch (const std::exception& e) {
        std::snprintf(host->error, host->error_size, "%s", e.what());
    } catch (...) {
        std::snprintf(host->error, host->error_size, "unknown error");
    }
    return 0;
}
