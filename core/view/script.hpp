// Replays a script of keys and mouse events without a window, and keeps what would have been shown.
#pragma once
#include <core/scene/diagnostic.hpp>
#include <core/view/display.hpp>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace rt::view {

/// One command a line, `#` starts a comment:
///   key NAME [COUNT]      a character, or: space esc left right up down
///   click X Y             press and release
///   drag X0 Y0 X1 Y1      press, move, release
///   wheel STEPS X Y       positive: away from the user
///   wait                  until the viewer is idle
///   pause MILLISECONDS
struct Command {
    enum class Kind : std::uint8_t { events, wait, pause };
    Kind kind = Kind::events;
    std::vector<Event> events; // one poll each
    int milliseconds = 0;
};

/// Errors E0405 with the line's place.
std::optional<std::vector<Command>> parseScript(std::shared_ptr<const scene::Source> source,
                                                scene::Diagnostics& diagnostics);

/// Hands over the next event once a picture has followed the one before, or the viewer is idle without one.
class ScriptDisplay final : public Display {
public:
    struct Shown {
        const Picture& picture;
        Detail detail;
        double secondsSinceEvent; // since the last event was handed over; infinite before the first
        bool firstSinceEvent;     // the first picture that differs from the one before the event
    };
    using Annotate = std::function<void(Picture&, const std::vector<std::string>&)>;

    ScriptDisplay(std::vector<Command> commands, std::function<void(const Shown&)> record,
                  Annotate annotate);

    void show(const Picture& picture, const Detail& detail) override;
    std::optional<std::vector<Event>> poll(int milliseconds, bool idle) override;
    void annotate(Picture& picture, const std::vector<std::string>& lines) override {
        annotate_(picture, lines);
    }

private:
    std::vector<Command> commands_;
    std::function<void(const Shown&)> record_;
    Annotate annotate_;
    std::size_t command_ = 0, event_ = 0;
    bool shownSinceEvent_ = false, changedSinceEvent_ = false;
    std::vector<std::uint8_t> before_; // what was shown last, RGB
    std::optional<std::chrono::steady_clock::time_point> eventTime_, pauseUntil_;
};

} // namespace rt::view
