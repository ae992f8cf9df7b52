#include <core/cli/progress.hpp>

#include <core/cli/console.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <unistd.h>

namespace rt::cli {

namespace {

constexpr int kBarWidth = 30;
constexpr double kPlainSeconds =
    10; // a log gets a line for each tenth of the work or each ten seconds

/// Seconds until the bar is drawn again: often at first, seldom in long runs.
double interval(double elapsed) {
    return elapsed < 5 ? 0.1 : elapsed < 60 ? 0.5 : elapsed < 600 ? 1 : 5;
}

ProgressStyle resolved(ProgressStyle style) {
    if (style != ProgressStyle::automatic) return style;
    const char* const ci = std::getenv("CI");
    return isCapableTerminal(STDERR_FILENO) && !(ci && *ci) ? ProgressStyle::bar
                                                            : ProgressStyle::none;
}

std::string oneDecimal(double value) {
    const auto tenths = static_cast<long long>(std::llround(value * 10));
    return std::to_string(tenths / 10) + "." + std::to_string(tenths % 10);
}

void say(const std::string& text) {
    if (::write(STDERR_FILENO, text.data(), text.size()) < 0) return; // nobody to tell
}

} // namespace

std::string spokenDuration(double seconds) {
    if (seconds < 10) return oneDecimal(seconds) + " s";
    const auto whole = static_cast<long long>(std::llround(seconds));
    if (whole < 60) return std::to_string(whole) + " s";
    if (whole < 3600)
        return std::to_string(whole / 60) + " min " + std::to_string(whole % 60) + " s";
    return std::to_string(whole / 3600) + " h " + std::to_string(whole % 3600 / 60) + " min";
}

Progress::Progress(ProgressStyle style, std::string title)
    : style_(resolved(style)), title_(std::move(title)) {}

std::string Progress::line(double share, double seconds) const {
    std::string text = title_ + " ";
    const int percent = static_cast<int>(share * 100);
    if (style_ == ProgressStyle::bar) {
        const int filled = static_cast<int>(share * kBarWidth);
        text += "[" + std::string(static_cast<std::size_t>(filled), '#') +
                std::string(static_cast<std::size_t>(kBarWidth - filled), ' ') + "] ";
    }
    text += std::to_string(percent) + " %, " + spokenDuration(seconds);
    // The tiles so far are a fair sample of the picture: the others cost as much on the average.
    if (share > 0 && share < 1)
        text += ", " + spokenDuration(seconds * (1 - share) / share) + " left";
    return text;
}

void Progress::show(double share) {
    if (style_ == ProgressStyle::none) return;
    share_ = std::clamp(share, 0.0, 1.0);
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start_).count();
    if (style_ == ProgressStyle::plain) {
        if (share_ * 10 < nextTenth_ && now < next_) return;
        if (!shown_ && share_ * 10 < nextTenth_ && seconds < kPlainSeconds) return;
        nextTenth_ = static_cast<int>(share_ * 10) + 1;
        next_ = now + std::chrono::duration_cast<Clock::duration>(
                          std::chrono::duration<double>(kPlainSeconds));
        shown_ = true;
        saidShare_ = share_;
        say(line(share_, seconds) + "\n");
        return;
    }
    if (now < next_) return;
    next_ = now + std::chrono::duration_cast<Clock::duration>(
                      std::chrono::duration<double>(interval(seconds)));
    shown_ = true;
    say("\r" + line(share_, seconds) + "\033[K");
}

void Progress::finish(double share) {
    const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
    if (style_ == ProgressStyle::bar && shown_) say("\r" + line(share, seconds) + "\033[K\n");
    if (style_ == ProgressStyle::plain && saidShare_ != share) say(line(share, seconds) + "\n");
    style_ = ProgressStyle::none;
}

} // namespace rt::cli
