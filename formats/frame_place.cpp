#include <formats/frame_place.hpp>

#include <filesystem>

namespace rt::formats {

std::string FramePlace::fileOf(std::uint32_t frame) const {
    std::string number = std::to_string(frame);
    if (number.size() < digits) number.insert(0, digits - number.size(), '0');
    return before + number + after;
}

std::string FramePlace::pathOf(const std::string& file) const {
    return folder == "." ? file : folder + '/' + file;
}

FramePlace framesBeside(const std::string& film) {
    return {.folder = std::filesystem::path(film).replace_extension(".frames").string()};
}

std::optional<FramePlace> framePattern(const std::string& pattern) {
    constexpr unsigned kMostDigits = 9;
    const std::filesystem::path path(pattern);
    const std::string name = path.filename().string();
    FramePlace place{.manifest = "." + name + ".manifest", .before = "", .digits = 0, .after = ""};
    if (path.has_parent_path()) place.folder = path.parent_path().string();
    bool found = false;
    for (std::size_t i = 0; i < name.size(); ++i) {
        std::string& literal = found ? place.after : place.before;
        if (name[i] != '%') {
            literal += name[i];
            continue;
        }
        const std::size_t digit = name.find_first_not_of("0123456789", i + 1);
        if (digit == std::string::npos) return {};
        const std::string width = name.substr(i + 1, digit - i - 1);
        if (name[digit] == '%' && width.empty()) {
            literal += '%';
        } else if (name[digit] == 'd' && !found && width.size() <= 2) {
            found = true;
            place.digits = width.empty() ? 1 : static_cast<unsigned>(std::stoul(width));
            if (place.digits > kMostDigits) return {};
        } else {
            return {};
        }
        i = digit;
    }
    return found ? std::optional(place) : std::nullopt;
}

} // namespace rt::formats
