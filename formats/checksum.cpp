#include <formats/checksum.hpp>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <fstream>
#include <vector>

namespace rt::formats {
namespace {

std::string spelled(const XXH128_hash_t& hash) {
    std::string text;
    for (const std::uint64_t half : {hash.high64, hash.low64})
        for (int shift = 60; shift >= 0; shift -= 4) text += "0123456789abcdef"[half >> shift & 15];
    return text;
}

} // namespace

std::string checksum(std::span<const std::byte> bytes) {
    return spelled(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string checksum(std::string_view text) { return checksum(std::as_bytes(std::span(text))); }

std::optional<std::string> checksumOfFile(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    XXH3_state_t state; // one that XXH3_createState allocates may be none
    XXH3_128bits_reset(&state);
    std::vector<char> buffer(std::size_t(1) << 20);
    while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())), file.gcount() > 0)
        XXH3_128bits_update(&state, buffer.data(), static_cast<std::size_t>(file.gcount()));
    if (!file.eof()) return {};
    return spelled(XXH3_128bits_digest(&state));
}

} // namespace rt::formats
