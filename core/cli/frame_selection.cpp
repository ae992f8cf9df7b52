#include <core/cli/frame_selection.hpp>

#include <core/cli/values.hpp>
#include <core/scene/diagnostic.hpp>

#include <set>

namespace rt::cli {
namespace {

constexpr std::uint32_t kMaxFrame = 1'000'000; // as animation.frames

} // namespace

FrameSelection parseFrames(std::string_view word) {
    FrameSelection selection;
    const auto number = [&](std::string_view digits) {
        try {
            return parseWhole(digits, 0, kMaxFrame);
        } catch (const UsageError&) {
            throw UsageError("must be numbers and ranges, such as 10-20,30 or 10-200:5 (got " +
                             scene::quoted(word) + ")");
        }
    };
    for (std::size_t from = 0; from <= word.size();) {
        const std::size_t to = std::min(word.find(',', from), word.size());
        std::string_view range = word.substr(from, to - from);
        FrameRange& added = selection.emplace_back(FrameRange{0, 0, 1});
        if (const std::size_t colon = range.find(':'); colon != std::string_view::npos) {
            added.step = number(range.substr(colon + 1));
            range = range.substr(0, colon);
        }
        const std::size_t dash = range.find('-');
        added.first = number(range.substr(0, dash));
        added.last = dash == std::string_view::npos ? added.first : number(range.substr(dash + 1));
        if (added.last < added.first || added.step == 0)
            throw UsageError("ranges must rise, and steps be at least 1 (got " +
                             scene::quoted(word) + ")");
        from = to + 1;
    }
    return selection;
}

std::vector<std::uint32_t> framesOf(const FrameSelection& selection, std::uint32_t count) {
    std::set<std::uint32_t> frames;
    for (const FrameRange& range : selection) {
        if (range.last >= count)
            throw UsageError("--frames: there is no frame " + std::to_string(range.last) +
                             ": the film has frames 0 to " + std::to_string(count - 1));
        for (std::uint32_t frame = range.first; frame <= range.last; frame += range.step)
            frames.insert(frame);
    }
    return {frames.begin(), frames.end()};
}

std::string spelledFrames(const std::vector<std::uint32_t>& frames) {
    std::string text;
    for (std::size_t i = 0; i < frames.size();) {
        std::size_t end = i;
        while (end + 1 < frames.size() && frames[end + 1] == frames[end] + 1) ++end;
        text += (text.empty() ? "" : ",") + std::to_string(frames[i]);
        if (end > i) text += "-" + std::to_string(frames[end]);
        i = end + 1;
    }
    return text;
}

} // namespace rt::cli
