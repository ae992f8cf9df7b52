// Progress of the trace on stderr: a bar on a terminal, lines for logs, or nothing.
#pragma once
#include <core/cli/command_line.hpp>

#include <chrono>
#include <string>

namespace rt::cli {

class Progress {
public:
    /// `automatic` is a bar if stderr is a terminal and neither TERM=dumb nor CI say otherwise, else nothing.
    Progress(ProgressStyle style, std::string title);
    ~Progress() { finish(share_); }
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// What comes before the share.
    void setTitle(std::string title) { title_ = std::move(title); }
    /// `share` of the work in [0, 1]; from one thread at a time.
    void show(double share);
    /// Says what share is done in the end and ends the bar's line; further calls do nothing.
    void finish(double share);

private:
    using Clock = std::chrono::steady_clock;
    std::string line(double share, double seconds) const;

    ProgressStyle style_;
    std::string title_;
    Clock::time_point start_ = Clock::now(), next_ = start_;
    int nextTenth_ = 1;
    double share_ = 0, saidShare_ = -1;
    bool shown_ = false;
};

/// "0.8 s", "12 s", "3 min 5 s", "2 h 4 min".
std::string spokenDuration(double seconds);

} // namespace rt::cli
