// OpenEXR by its own library: OpenCV's encoder goes through a file in the temporary folder and its errors to stderr.
#include <formats/codec/guarded.hpp>

#include <OpenEXR/ImfArray.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfOutputFile.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <vector>

namespace {

struct MemoryOutput : Imf::OStream {
    std::vector<char> bytes;
    std::size_t position = 0;

    MemoryOutput() : OStream("memory") {}
    void write(const char* from, int count) override {
        const std::size_t n = static_cast<std::size_t>(count);
        if (position + n > bytes.size()) bytes.resize(position + n);
        std::memcpy(bytes.data() + position, from, n);
        position += n;
    }
    std::uint64_t tellp() override { return position; }
    void seekp(std::uint64_t to) override { position = to; }
};

struct MemoryInput : Imf::IStream {
    const char* bytes;
    std::uint64_t count, position = 0;

    MemoryInput(const void* from, std::size_t n)
        : IStream("memory"), bytes(static_cast<const char*>(from)), count(n) {}
    bool read(char* to, int n) override {
        if (position > count || static_cast<std::uint64_t>(n) > count - position)
            throw std::runtime_error("the file is truncated");
        std::memcpy(to, bytes + position, static_cast<std::size_t>(n));
        position += static_cast<std::uint64_t>(n);
        return position < count;
    }
    std::uint64_t tellg() override { return position; }
    void seekg(std::uint64_t to) override { position = to; }
};

/// Three f32 channels of one row buffer, whose first pixel is column `left`; a single luminance channel fills all three.
Imf::FrameBuffer rgbSlices(char* row, int left, std::size_t rowStride, bool luminance) {
    constexpr std::size_t pixel = 3 * sizeof(float);
    Imf::FrameBuffer slices;
    const char* const names[] = {"R", "G", "B"};
    for (std::size_t c = 0; c < (luminance ? 1 : 3); ++c)
        slices.insert(
            luminance ? "Y" : names[c],
            Imf::Slice(Imf::FLOAT,
                       row + c * sizeof(float) -
                           static_cast<std::ptrdiff_t>(left) * static_cast<std::ptrdiff_t>(pixel),
                       pixel, rowStride));
    return slices;
}

void encodeOrThrow(const rt_samples& samples, const rt_codec_host& host) {
    MemoryOutput out;
    {
        Imf::Header header(static_cast<int>(samples.width), static_cast<int>(samples.height));
        header.compression() = Imf::ZIP_COMPRESSION; // lossless
        for (const char* name : {"R", "G", "B"})
            header.channels().insert(name, Imf::Channel(Imf::FLOAT));
        Imf::OutputFile file(out, header, 0);
        file.setFrameBuffer(rgbSlices(static_cast<char*>(samples.data), 0,
                                      std::size_t(samples.width) * 3 * sizeof(float), false));
        file.writePixels(static_cast<int>(samples.height));
    }
    if (!host.append(host.context, out.bytes.data(), out.bytes.size())) throw std::bad_alloc();
}

void decodeOrThrow(const void* bytes, std::size_t count, const rt_codec_host& host) {
    MemoryInput in(bytes, count);
    Imf::InputFile file(in, 0);
    const Imath::Box2i shown = file.header().displayWindow(), stored = file.header().dataWindow();
    const auto extent = [](int from, int to) {
        return static_cast<std::uint32_t>(std::int64_t(to) - from + 1);
    };
    const std::uint32_t width = extent(shown.min.x, shown.max.x),
                        height = extent(shown.min.y, shown.max.y);
    const std::uint32_t storedWidth = extent(stored.min.x, stored.max.x);
    const Imf::ChannelList& channels = file.header().channels();
    const bool rgb =
        channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    const bool luminance = !rgb && channels.findChannel("Y");
    if (!rgb && !luminance) throw std::runtime_error("it has neither R, G and B nor Y channels");
    for (const char* name : {"R", "G", "B", "Y"})
        if (const Imf::Channel* channel = channels.findChannel(name);
            channel && (channel->xSampling != 1 || channel->ySampling != 1))
            throw std::runtime_error("its channels are subsampled");
    auto* pixels = static_cast<float*>(host.allocate(host.context, width, height, 32));
    if (!pixels || storedWidth > (1u << 26)) throw std::runtime_error("too large");
    std::fill_n(pixels, std::size_t(width) * height * 3, 0.0f); // outside the stored window

    std::vector<float> row(std::size_t(storedWidth) * 3);
    file.setFrameBuffer(rgbSlices(reinterpret_cast<char*>(row.data()), stored.min.x, 0, luminance));
    const int left = std::max(shown.min.x, stored.min.x),
              right = std::min(shown.max.x, stored.max.x);
    for (int y = std::max(shown.min.y, stored.min.y); y <= std::min(shown.max.y, stored.max.y);
         ++y) {
        file.readPixels(y);
        for (int x = left; x <= right; ++x) {
            const float* from = row.data() + std::size_t(x - stored.min.x) * 3;
            float* to =
                pixels + (std::size_t(y - shown.min.y) * width + std::size_t(x - shown.min.x)) * 3;
            for (int c = 0; c < 3; ++c) to[c] = from[luminance ? 0 : c];
        }
    }
}

int encode(std::uint32_t, const rt_samples* samples, const rt_encode_settings*,
           const rt_codec_host* host) {
    return guarded(host, [&] { encodeOrThrow(*samples, *host); });
}

int decode(std::uint32_t, const void* bytes, std::size_t count, const rt_codec_host* host) {
    return guarded(host, [&] { decodeOrThrow(bytes, count, *host); });
}

} // namespace

extern "C" {
RT_CODEC_EXPORT extern const rt_codec_table rt_codec;
const rt_codec_table rt_codec = {sizeof(rt_codec_table), encode, decode};
}
