// Bytes to a file that is either the old one or the complete new one.
#pragma once
#include <cstddef>
#include <span>
#include <string>

namespace rt::formats {

/// Writes `.NAME.PID.tmp` beside `path` (O_EXCL), fsyncs, reads back and compares, renames, fsyncs the folder. A symbolic
/// link keeps pointing where it did and its target is replaced; an existing file keeps its mode, and one that may not be
/// written is refused; a device or pipe is written as it is. Throws std::system_error whose text names the path; the
/// temporary file is then gone and the old file untouched (only a failing fsync of the folder comes after the rename).
void writeFileAtomically(const std::string& path, std::span<const std::byte> bytes);

/// A file that another library writes, by name: `path()` beside `target`, gone with this unless it took the target's place.
class TemporaryFile {
public:
    /// Removes what processes that are gone left behind.
    explicit TemporaryFile(std::string target);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    const std::string& path() const { return path_; }
    /// fsyncs, renames and fsyncs the folder. Throws std::system_error; the old file is then as it was.
    void replaceTarget();

private:
    std::string target_, path_;
};

} // namespace rt::formats
