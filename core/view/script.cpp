#include <core/view/script.hpp>

#include <charconv>
#include <limits>
#include <thread>

namespace rt::view {

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::pair<std::string_view, int> kNamedKeys[] = {{"space", ' '},    {"esc", 27},
                                                           {"left", 0xff51},  {"up", 0xff52},
                                                           {"right", 0xff53}, {"down", 0xff54}};

std::optional<int> keyOf(std::string_view name) {
    for (const auto& [word, key] : kNamedKeys)
        if (name == word) return key;
    if (name.size() == 1) return name[0];
    return std::nullopt;
}

std::vector<std::string_view> words(std::string_view line) {
    std::vector<std::string_view> found;
    for (std::size_t i = 0; i < line.size();) {
        const std::size_t start = line.find_first_not_of(" \t\r", i);
        if (start == std::string_view::npos) break;
        i = std::min(line.find_first_of(" \t\r", start), line.size());
        found.push_back(line.substr(start, i - start));
    }
    return found;
}

} // namespace

std::optional<std::vector<Command>> parseScript(std::shared_ptr<const scene::Source> source,
                                                scene::Diagnostics& diagnostics) {
    std::vector<Command> commands;
    std::uint32_t lineNumber = 0;
    for (std::string_view rest = source->text; !rest.empty();) {
        ++lineNumber;
        const std::size_t end = std::min(rest.find('\n'), rest.size());
        std::string_view line = rest.substr(0, end);
        rest.remove_prefix(std::min(end + 1, rest.size()));
        if (const auto hash = line.find(" #"); hash != std::string_view::npos)
            line = line.substr(0, hash);
        const auto w = words(line);
        if (w.empty() || w[0].starts_with('#')) continue;

        bool good = true;
        const auto integer = [&](std::size_t i) {
            int value = 0;
            const auto [p, e] = std::from_chars(w[i].data(), w[i].data() + w[i].size(), value);
            good = good && e == std::errc() && p == w[i].data() + w[i].size();
            return value;
        };
        Command command;
        if (w[0] == "key" && (w.size() == 2 || w.size() == 3)) {
            const auto key = keyOf(w[1]);
            const int count = w.size() == 3 ? integer(2) : 1;
            good = good && key && count >= 1 && count <= 10000;
            if (good)
                command.events.assign(static_cast<std::size_t>(count),
                                      Event{Event::Kind::key, *key, 0, 0});
        } else if (w[0] == "click" && w.size() == 3) {
            const int x = integer(1), y = integer(2);
            command.events = {{Event::Kind::press, 0, x, y}, {Event::Kind::release, 0, x, y}};
        } else if (w[0] == "drag" && w.size() == 5) {
            const int x0 = integer(1), y0 = integer(2), x1 = integer(3), y1 = integer(4);
            command.events = {{Event::Kind::press, 0, x0, y0},
                              {Event::Kind::move, 0, x1, y1},
                              {Event::Kind::release, 0, x1, y1}};
        } else if (w[0] == "wheel" && w.size() == 4) {
            const int steps = integer(1), x = integer(2), y = integer(3);
            good = good && steps != 0 && std::abs(steps) <= 10000;
            if (good)
                command.events.assign(static_cast<std::size_t>(std::abs(steps)),
                                      Event{Event::Kind::wheel, 0, x, steps > 0 ? 1 : -1});
            (void)y;
        } else if (w[0] == "wait" && w.size() == 1) {
            command.kind = Command::Kind::wait;
        } else if (w[0] == "pause" && w.size() == 2) {
            command.kind = Command::Kind::pause;
            command.milliseconds = integer(1);
            good = good && command.milliseconds >= 0;
        } else {
            good = false;
        }
        if (!good) {
            const auto column = static_cast<std::uint32_t>(w[0].data() - line.data() + 1);
            const std::string near =
                scene::nearest(w[0], {"key", "click", "drag", "wheel", "wait", "pause"});
            diagnostics.error(
                scene::Code{405}, {source, lineNumber, column},
                "this is no command of a viewer script: expected key NAME [COUNT], click X Y, drag "
                "X0 Y0 X1 Y1, "
                "wheel STEPS X Y, wait or pause MILLISECONDS",
                near.empty() ? "" : "did you mean '" + near + "'?");
            continue;
        }
        commands.push_back(std::move(command));
    }
    return diagnostics.failed() ? std::nullopt : std::optional(std::move(commands));
}

ScriptDisplay::ScriptDisplay(std::vector<Command> commands,
                             std::function<void(const Shown&)> record, Annotate annotate)
    : commands_(std::move(commands)), record_(std::move(record)), annotate_(std::move(annotate)) {}

void ScriptDisplay::show(const Picture& picture, const Detail& detail) {
    const double since = eventTime_
                             ? std::chrono::duration<double>(Clock::now() - *eventTime_).count()
                             : std::numeric_limits<double>::infinity();
    const bool first = eventTime_ && !changedSinceEvent_ && picture.rgb != before_;
    changedSinceEvent_ = changedSinceEvent_ || first;
    shownSinceEvent_ = true;
    before_ = picture.rgb;
    record_({picture, detail, since, first});
}

std::optional<std::vector<Event>> ScriptDisplay::poll(int milliseconds, bool idle) {
    const auto none = [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(std::min(milliseconds, 1)));
        return std::vector<Event>{};
    };
    if (command_ == commands_.size()) return std::nullopt;
    const Command& command = commands_[command_];
    switch (command.kind) {
    case Command::Kind::wait:
        if (!idle) return none();
        ++command_;
        return std::vector<Event>{};
    case Command::Kind::pause:
        if (!pauseUntil_)
            pauseUntil_ = Clock::now() + std::chrono::milliseconds(command.milliseconds);
        if (Clock::now() < *pauseUntil_) return none();
        pauseUntil_.reset();
        ++command_;
        return std::vector<Event>{};
    case Command::Kind::events:
        break;
    }
    if (eventTime_ && !shownSinceEvent_ && !idle) return none();
    const Event event = command.events[event_];
    if (++event_ == command.events.size()) event_ = 0, ++command_;
    eventTime_ = Clock::now();
    shownSinceEvent_ = changedSinceEvent_ = false;
    return std::vector{event};
}

} // namespace rt::view
