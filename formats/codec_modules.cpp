#include <formats/codec_modules.hpp>

#include <array>
#include <dlfcn.h>
#include <filesystem>
#include <mutex>
#include <stdexcept>
#include <string>

namespace rt::formats {
namespace {

constexpr std::array<const char*, 4> kNames = {"png", "jpeg", "exr", "opencv"};

const rt_codec_table* load(CodecModule module) {
    const std::string file =
        std::string("rt_codec_") + kNames[static_cast<std::size_t>(module)] + ".so";
    const auto path = std::filesystem::read_symlink("/proc/self/exe").parent_path().parent_path() /
                      "lib/rt" / file;
    void* handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle)
        throw std::runtime_error(std::string("the image codec cannot be opened: ") + dlerror());
    const auto* table = static_cast<const rt_codec_table*>(dlsym(handle, RT_CODEC_SYMBOL));
    if (!table || table->size != sizeof(rt_codec_table))
        throw std::runtime_error("the image codec " + path.string() +
                                 " belongs to another build of rt");
    return table; // stays open: OpenCV does not survive dlclose
}

} // namespace

std::shared_future<const rt_codec_table*> openCodecModule(CodecModule module) {
    static std::mutex mutex;
    static std::array<std::shared_future<const rt_codec_table*>, kNames.size()> opened;
    const std::lock_guard lock(mutex);
    auto& future = opened[static_cast<std::size_t>(module)];
    if (!future.valid()) future = std::async(std::launch::async, load, module).share();
    return future;
}

} // namespace rt::formats
