// Bytes as the file of a plugin: its stamp is read without opening it, or there is a reason why not.
#include <core/plugin_host/stamp.hpp>

#include <cstdint>
#include <cstdlib>

#include <sys/mman.h>
#include <unistd.h>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const int file = ::memfd_create("module", MFD_CLOEXEC);
    if (file < 0 || ::ftruncate(file, 0) != 0 ||
        ::pwrite(file, data, size, 0) != static_cast<ssize_t>(size))
        std::abort();
    const auto read = rt::plugin_host::readStamp(file);
    if (const auto* const why = std::get_if<std::string>(&read)) {
        if (why->empty()) std::abort();
    } else {
        (void)rt::plugin_host::whyIncompatible(std::get<rt::plugin_host::Stamp>(read));
    }
    return 0;
}
