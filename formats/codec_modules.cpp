#include <formats/codec_modules.hpp>

#include <formats/module_file.hpp>

#include <array>
#include <mutex>
#include <string>

namespace rt::formats {
namespace {

constexpr std::array<const char*, 4> kNames = {"png", "jpeg", "exr", "opencv"};

const rt_codec_table* load(CodecModule module) {
    const std::string file =
        std::string("rt_codec_") + kNames[static_cast<std::size_t>(module)] + ".so";
    constexpr const char* kWhat = "the image codec";
    const auto* table =
        static_cast<const rt_codec_table*>(openModule(file.c_str(), RT_CODEC_SYMBOL, kWhat));
    if (table->size != sizeof(rt_codec_table)) refuseForeignModule(file.c_str(), kWhat);
    return table;
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
