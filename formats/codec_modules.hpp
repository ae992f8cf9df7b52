// Opens the codec modules: once each, by absolute path, on a thread of their own.
#pragma once
#include <formats/codec/codec.h>

#include <cstdint>
#include <future>

namespace rt::formats {

enum class CodecModule : std::uint8_t { png, jpeg, exr, opencv };

/// Starts opening <exe>/../lib/rt/rt_codec_<name>.so if nobody has. get() throws std::runtime_error where it is missing,
/// damaged or of another build. Opening takes 0.3 ms (libpng, libjpeg), 2 ms (OpenEXR), 70 to 100 ms (OpenCV: 140 libraries).
std::shared_future<const rt_codec_table*> openCodecModule(CodecModule module);

} // namespace rt::formats
