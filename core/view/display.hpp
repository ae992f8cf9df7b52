// Where the viewer's pictures go and its events come from: a window, or a script that replays keys.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace rt::view {

/// 8-bit RGB as shown, top row first.
struct Picture {
    std::uint32_t width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

/// How finely a shown picture was traced.
struct Detail {
    std::uint32_t width = 0, height = 0; // pixels, at most those of the picture
    bool final = false;                  // nothing finer will follow until something changes
};

struct Event {
    enum class Kind : std::uint8_t { key, press, move, release, wheel };
    Kind kind = Kind::key;
    int key = 0;      // a character, or an X11 key symbol
    int x = 0, y = 0; // pixel of the shown picture; wheel: y is +1 away from the user, -1 toward
};

class Display {
public:
    virtual ~Display() = default;
    virtual void show(const Picture& picture, const Detail& detail) = 0;
    /// Waits up to `milliseconds` for events; nothing when the user closed the display. `idle`: the picture shown is final
    /// and nothing is under way.
    virtual std::optional<std::vector<Event>> poll(int milliseconds, bool idle) = 0;
    /// Draws lines of text over the picture, from the top left down.
    virtual void annotate(Picture& picture, const std::vector<std::string>& lines) = 0;
};

} // namespace rt::view
