// One process at a time writes a file.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <memory>
#include <optional>
#include <string>
#include <utility>

namespace rt::cli {

/// Holds `.NAME.lock` beside an output, through symbolic links, until it is destroyed. The kernel lets go of it when the process
/// ends in whatever way; what a killed one has left, the lock and its temporary files, the next one sweeps up.
class OutputLock {
public:
    /// Nothing, and E0608 that names the other process, where one holds it already; E0605 where it cannot be made.
    static std::optional<OutputLock> take(const std::string& path, scene::Diagnostics& diagnostics);
    OutputLock(OutputLock&& other) noexcept;
    OutputLock& operator=(OutputLock&&) = delete;
    ~OutputLock();

private:
    OutputLock(int fd, std::unique_ptr<const std::string> file) : fd_(fd), file_(std::move(file)) {}
    int fd_;
    std::unique_ptr<const std::string> file_; // its text stays where it is when the lock moves
};

/// Removes the files of all locks that are held, for a signal handler that is about to end the program.
void unlinkLocks() noexcept;

} // namespace rt::cli
