// The 24-byte stamp of a module, read from the ELF file without opening it: dlopen would run its
// constructors, and map a truncated file into a SIGBUS.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <variant>

namespace rt::plugin_host {

/// The first 24 bytes of rt_module, whose layout never changes.
struct Stamp {
    std::array<char, 8> magic;
    std::uint32_t abiMajor, abiMinor, layout, structSize;
};
static_assert(sizeof(Stamp) == 24);

/// What the ELF file open at `fd` says in the object `rt_plugin_entry`, or why it says nothing: a
/// clause that continues "PATH was refused: ".
std::variant<Stamp, std::string> readStamp(int fd);

/// Empty: this rt can load a module with this stamp. Otherwise such a clause.
std::string whyIncompatible(const Stamp& stamp);

} // namespace rt::plugin_host
