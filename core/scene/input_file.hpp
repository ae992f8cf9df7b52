// The one way to an input file: regular files only, and with --sandbox only those of some folders.
#pragma once
#include <core/scene/diagnostic.hpp>

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace rt::scene {

/// From now on this process reads only what really lies in one of `folders`, whatever links and '..' lead there. Call once,
/// before the first file is read. Folders that do not exist hold nothing. Plugins open files themselves:
/// core/plugin_host/confined.hpp holds them to it.
void confineReading(const std::vector<std::string>& folders);
bool readingIsConfined();
/// Real paths of the folders.
const std::vector<std::string>& readableFolders();

struct FileRefusal {
    // E0401 missing, E0402 unreadable, E0403 not regular, E0404 outside of the sandbox, E0710 too large
    Code code;
    std::string reason; // a clause: "is a folder, not a file"
};

/// An open regular file. A FIFO or device is refused and never waited for; the checks hold for the very file that is open, even
/// if another takes its path meanwhile.
class InputFile {
public:
    /// `own`: a folder that rt itself writes; what really lies in it is read in spite of the sandbox.
    static std::variant<InputFile, FileRefusal> open(const std::string& path,
                                                     const std::string& own = {});
    InputFile(InputFile&& other) noexcept : fd_(std::exchange(other.fd_, -1)), size_(other.size_) {}
    InputFile& operator=(InputFile&&) = delete;
    ~InputFile();
    int fd() const { return fd_; }
    std::uint64_t size() const { return size_; } // bytes when it was opened
    /// All of it, also where it has grown since; refused with E0710 beyond `maxBytes`. Call once.
    std::variant<std::string, FileRefusal> read(std::uint64_t maxBytes = UINT64_MAX) const;

private:
    InputFile(int fd, std::uint64_t size) : fd_(fd), size_(size) {}
    int fd_;
    std::uint64_t size_;
};

/// Names of what lies in a folder, but for '.' and '..', in no order; at most `most`; none where it cannot be read. Throws only
/// std::bad_alloc, where libstdc++'s directory_iterator would end the program.
std::vector<std::string> namesIn(const std::string& folder, std::size_t most = SIZE_MAX);

inline constexpr Code kTooLarge{710};
/// "is larger than 8 MiB, the most that a text file may have"
std::string tooLarge(std::uint64_t maxBytes);

} // namespace rt::scene
