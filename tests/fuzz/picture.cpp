// Any bytes as a picture file: read or refused with one error.
#include <formats/image_reader.hpp>

#include <cstdlib>

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
    rt::formats::ReadPictureOptions options;
    options.maxPixels = 1 << 16;
    rt::scene::Diagnostics diagnostics;
    const auto picture = rt::formats::decodePicture({reinterpret_cast<const char*>(data), size},
                                                    options, diagnostics, {});
    if (picture.has_value() == diagnostics.failed() || diagnostics.errorCount() > 1) std::abort();
    return 0;
}
