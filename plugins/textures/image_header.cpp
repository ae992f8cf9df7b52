#include "image_header.hpp"

#include <charconv>
#include <optional>

namespace {

constexpr const char* kDamaged = "has a damaged header";
constexpr const char* kTruncated = "is truncated";

/// Bounds-checked reads; beyond the end everything is 0 and `past` says so.
class Bytes {
public:
    explicit Bytes(std::string_view file) : file_(file) {}

    std::uint64_t byte(std::size_t at) {
        if (at < file_.size()) return static_cast<unsigned char>(file_[at]);
        past = true;
        return 0;
    }
    std::uint64_t big(std::size_t at, int count) {
        std::uint64_t value = 0;
        for (int i = 0; i < count; ++i) value = value << 8 | byte(at + static_cast<std::size_t>(i));
        return value;
    }
    std::uint64_t little(std::size_t at, int count) {
        std::uint64_t value = 0;
        for (int i = count - 1; i >= 0; --i)
            value = value << 8 | byte(at + static_cast<std::size_t>(i));
        return value;
    }

    bool past = false;

private:
    std::string_view file_;
};

using Result = std::variant<ImageHeader, std::string>;

Result jpeg(std::string_view file) {
    Bytes bytes(file);
    std::optional<ImageHeader> header;
    for (std::size_t at = 2; at < file.size();) {
        if (bytes.byte(at) != 0xFF) return kDamaged;
        const std::uint64_t marker = bytes.byte(at + 1);
        if (marker == 0xFF) { // padding
            ++at;
            continue;
        }
        if (marker == 0xD9) return header ? Result(*header) : Result(kDamaged); // end of image
        if (marker >= 0xD0 && marker <= 0xD7) {
            at += 2;
            continue;
        }
        const std::uint64_t length = bytes.big(at + 2, 2);
        if (bytes.past) return kTruncated;
        if (length < 2) return kDamaged;
        const bool isFrame =
            marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
        if (isFrame) header = ImageHeader{"JPEG", bytes.big(at + 7, 2), bytes.big(at + 5, 2)};
        at += 2 + length;
        if (marker ==
            0xDA) // entropy-coded data runs to the next marker that is neither a stuffed 0 nor a restart
            while (at < file.size()) {
                at = file.find('\xFF', at);
                if (at == std::string_view::npos || at + 1 >= file.size()) return kTruncated;
                const std::uint64_t next = bytes.byte(at + 1);
                if (next != 0 && !(next >= 0xD0 && next <= 0xD7)) break;
                at += 2;
            }
    }
    return kTruncated;
}

Result bmp(std::string_view file) {
    Bytes bytes(file);
    const bool os2 = bytes.little(14, 4) == 12;
    const std::uint64_t width = os2 ? bytes.little(18, 2) : bytes.little(18, 4);
    const std::uint64_t height = os2 ? bytes.little(20, 2) : bytes.little(22, 4);
    if (bytes.past) return kTruncated;
    constexpr std::uint64_t kNegative = std::uint64_t{1}
                                        << 31; // a negative height means top to bottom
    return ImageHeader{"BMP", width, height >= kNegative && !os2 ? 2 * kNegative - height : height};
}

Result exr(std::string_view file) {
    Bytes bytes(file);
    for (std::size_t at = 8; at < file.size() && file[at] != '\0';) {
        const std::size_t nameEnd = file.find('\0', at);
        const std::size_t typeEnd =
            nameEnd == std::string_view::npos ? nameEnd : file.find('\0', nameEnd + 1);
        if (typeEnd == std::string_view::npos) return kTruncated;
        const std::string_view name = file.substr(at, nameEnd - at);
        const std::uint64_t size = bytes.little(typeEnd + 1, 4);
        const std::size_t data = typeEnd + 5;
        if (bytes.past || size > file.size() - data) return kTruncated;
        if (name == "dataWindow" && size == 16) {
            std::int64_t box[4];
            for (int i = 0; i < 4; ++i)
                box[i] = static_cast<std::int32_t>(
                    bytes.little(data + 4 * static_cast<std::size_t>(i), 4));
            if (box[2] < box[0] || box[3] < box[1]) return kDamaged;
            return ImageHeader{"EXR", static_cast<std::uint64_t>(box[2] - box[0] + 1),
                               static_cast<std::uint64_t>(box[3] - box[1] + 1)};
        }
        at = data + size;
    }
    return kDamaged;
}

/// Numbers between blanks, with PNM's comments.
class Words {
public:
    explicit Words(std::string_view rest) : rest_(rest) {}

    std::string_view next() {
        for (;;) {
            const std::size_t start = rest_.find_first_not_of(" \t\r\n");
            if (start == std::string_view::npos) return {};
            rest_.remove_prefix(start);
            if (rest_[0] != '#') break;
            rest_.remove_prefix(std::min(rest_.size(), rest_.find('\n')));
        }
        const std::string_view word = rest_.substr(0, rest_.find_first_of(" \t\r\n"));
        rest_.remove_prefix(word.size());
        return word;
    }

private:
    std::string_view rest_;
};

std::optional<std::uint64_t> number(std::string_view word) {
    std::uint32_t value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size()) return {};
    return value;
}

Result sizeOf(const char* format, std::string_view width, std::string_view height) {
    const auto w = number(width), h = number(height);
    if (!w || !h) return kDamaged;
    return ImageHeader{format, *w, *h};
}

Result pnm(std::string_view file) {
    Words words(file.substr(2));
    const std::string_view width = words.next();
    return sizeOf(file[1] == 'F' || file[1] == 'f'   ? "PFM"
                  : file[1] == '2' || file[1] == '5' ? "PGM"
                                                     : "PPM",
                  width, words.next());
}

Result hdr(std::string_view file) {
    std::size_t end = file.find("\n\n");
    if (end == std::string_view::npos) return kTruncated;
    Words words(file.substr(end));
    const std::string_view axisA = words.next(), sizeA = words.next(), axisB = words.next(),
                           sizeB = words.next();
    if (axisA != "-Y" || axisB != "+X")
        return "is turned or mirrored (its size must be '-Y height +X width')";
    return sizeOf("HDR", sizeB, sizeA);
}

} // namespace

std::variant<ImageHeader, std::string> readImageHeader(std::string_view file) {
    using namespace std::literals;
    Bytes bytes(file);
    if (file.starts_with("\x89PNG\r\n\x1a\n"sv)) {
        const ImageHeader header{"PNG", bytes.big(16, 4), bytes.big(20, 4)};
        if (bytes.past) return kTruncated;
        return header;
    }
    if (file.starts_with("\xFF\xD8\xFF"sv)) return jpeg(file);
    if (file.starts_with("BM"sv)) return bmp(file);
    if (file.starts_with("\x76\x2f\x31\x01"sv)) return exr(file);
    if (file.starts_with("#?RADIANCE\n"sv) || file.starts_with("#?RGBE\n"sv)) return hdr(file);
    if (file.size() > 2 && file[0] == 'P' && "2356Ff"sv.find(file[1]) != std::string_view::npos &&
        " \t\r\n"sv.find(file[2]) != std::string_view::npos)
        return pnm(file);
    return "is not a PNG, JPEG, BMP, HDR, EXR, PFM, PGM or PPM file";
}
