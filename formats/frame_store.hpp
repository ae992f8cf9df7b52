// A folder of finished frames and the manifest that vouches for them. A frame is done when the manifest has its line and
// its file has the size and checksum that the line says.
//
// Lines of the manifest are words between tabs, the last being the checksum of those before it, so that a torn line is
// recognised: `set FIELD VALUE` for what all frames depend on, then `frame NUMBER FILE SIZE CHECKSUM` as they are done.
// Lines that name anything but their frame's file in this folder are no lines.
#pragma once
#include <core/scene/diagnostic.hpp>
#include <formats/frame_place.hpp>

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace rt::formats {

/// What pictures depend on, as fields and values; neither holds a tab or a line end.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// The first field whose values differ, as a clause: "materials.red.diffuse was '0.8' and is '0.7'"; "" for none.
std::string firstDifference(const Settings& before, const Settings& now);

class FrameStore {
public:
    enum class Mode : std::uint8_t {
        fresh,    // refuse a folder that has frames
        resume,   // keep frames that were made with the same settings
        overwrite // delete the frames
    };
    /// Makes the folder if its parent exists, and locks it until destruction. Errors: E0608 in use by another process;
    /// E0609 has frames and the mode is fresh; E0610 the settings differ and the mode is resume; E0605 cannot be made,
    /// read or written.
    static std::optional<FrameStore> open(const FramePlace& place, const Settings& settings,
                                          Mode mode, scene::Diagnostics& diagnostics);
    /// For reading; not locked. Error E0406 where there is no manifest.
    static std::optional<FrameStore> read(const FramePlace& place, scene::Diagnostics& diagnostics);

    FrameStore(FrameStore&& other) noexcept;
    FrameStore& operator=(FrameStore&&) = delete;
    ~FrameStore();

    const FramePlace& place() const { return place_; }
    const Settings& settings() const { return settings_; }
    /// The value of a field, or "".
    std::string setting(const std::string& field) const;
    /// Frames that the manifest has, rising; their files are not looked at.
    std::vector<std::uint32_t> listed() const;
    bool isListed(std::uint32_t frame) const { return entries_.contains(frame); }
    /// The bytes of a frame, if it is done: size and checksum agree.
    std::optional<std::vector<std::byte>> load(std::uint32_t frame) const;
    bool isDone(std::uint32_t frame) const { return load(frame).has_value(); }

    /// Writes the frame's file atomically, then its line. Throws std::system_error; the earlier frames stay as they are.
    void commit(std::uint32_t frame, std::span<const std::byte> bytes);

private:
    struct Entry {
        std::string file, checksum;
        std::uint64_t size;
    };
    explicit FrameStore(FramePlace place) : place_(std::move(place)) {}
    static std::string lineOf(std::uint32_t frame, const Entry& entry);
    std::string manifest() const;
    /// Takes what is whole; false when a line is torn, foreign, or said twice.
    bool parse(std::string_view manifest);

    FramePlace place_;
    Settings settings_;
    std::map<std::uint32_t, Entry> entries_;
    int lock_ = -1, manifest_ = -1; // file descriptors
};

} // namespace rt::formats
