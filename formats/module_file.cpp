#include <formats/module_file.hpp>

#include <core/scene/load_failure.hpp>

#include <dlfcn.h>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace rt::formats {
namespace {

std::filesystem::path pathOf(const char* file) {
    return std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() / "lib/rt" /
           file;
}

} // namespace

const void* openModule(const char* file, const char* symbol, const char* what) {
    void* handle = dlopen(pathOf(file).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle)
        throw std::runtime_error(std::string(what) +
                                 " cannot be opened: " + scene::loadFailure(dlerror()));
    const void* address = dlsym(handle, symbol);
    if (!address) refuseForeignModule(file, what);
    return address;
}

void refuseForeignModule(const char* file, const char* what) {
    throw std::runtime_error(std::string(what) + " " + pathOf(file).string() +
                             " belongs to another build of rt");
}

} // namespace rt::formats
