#include <formats/atomic_file.hpp>

#include <core/scene/input_file.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace rt::formats {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& what, int error) {
    throw std::system_error(error, std::generic_category(), what);
}

/// Repeats a system call that a signal interrupted.
template <class Call> auto retried(Call call) {
    for (;;)
        if (const auto result = call(); result >= 0 || errno != EINTR) return result;
}

class File {
public:
    explicit File(int fd) : fd_(fd) {}
    File(File&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    File& operator=(File&&) = delete;
    ~File() {
        if (fd_ >= 0) ::close(fd_);
    }
    int fd() const { return fd_; }
    /// errno of close, or 0. After EINTR Linux has closed it.
    int close() { return ::close(std::exchange(fd_, -1)) < 0 && errno != EINTR ? errno : 0; }

private:
    int fd_;
};

/// errno, or 0.
int writeAll(int fd, std::span<const std::byte> bytes) {
    while (!bytes.empty()) {
        const ssize_t n = retried([&] { return ::write(fd, bytes.data(), bytes.size()); });
        if (n < 0) return errno;
        if (n == 0) return EIO;
        bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return 0;
}

/// Whether the file holds exactly `bytes`; errno, EIO for other contents, or 0.
int compareAll(const fs::path& path, std::span<const std::byte> bytes) {
    const File file(
        retried([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW); }));
    if (file.fd() < 0) return errno;
    std::array<std::byte, 65536> buffer;
    for (;;) {
        const ssize_t n = retried([&] { return ::read(file.fd(), buffer.data(), buffer.size()); });
        if (n < 0) return errno;
        if (n == 0) return bytes.empty() ? 0 : EIO;
        const std::size_t count = static_cast<std::size_t>(n);
        if (count > bytes.size() || std::memcmp(buffer.data(), bytes.data(), count) != 0)
            return EIO;
        bytes = bytes.subspan(count);
    }
}

std::string spaceReport(const fs::path& folder, std::size_t needed) {
    struct statvfs space {};
    if (::statvfs(folder.c_str(), &space) != 0) return "";
    return " (" + std::to_string(needed) + " bytes needed, " +
           std::to_string(std::uintmax_t(space.f_bavail) * space.f_frsize) + " free)";
}

/// Without this a file size limit kills the process instead of failing the write.
void ignoreFileSizeSignal() {
    struct sigaction current {};
    if (::sigaction(SIGXFSZ, nullptr, &current) == 0 && current.sa_handler == SIG_DFL)
        std::signal(SIGXFSZ, SIG_IGN);
}

/// A new file in `folder`, whose path goes to `path`. The name is cut so that it fits where the final one does.
File createTemporary(const fs::path& folder, const std::string& name, fs::path& path,
                     const std::string& what) {
    for (int attempt = 0;; ++attempt) {
        const std::string ending = "." + std::to_string(::getpid()) +
                                   (attempt ? "-" + std::to_string(attempt) : "") + ".tmp";
        path = folder / ("." + name.substr(0, NAME_MAX - 1 - ending.size()) + ending);
        const int fd = retried([&] {
            return ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC | O_NOFOLLOW, 0666);
        });
        if (fd >= 0) return File(fd);
        if (errno != EEXIST || attempt == 1000) fail(what, errno);
    }
}

struct Removal { // of the temporary file, unless it was renamed
    const fs::path& path;
    bool armed = true;
    ~Removal() {
        if (armed) ::unlink(path.c_str());
    }
};

fs::path folderOf(const fs::path& file) {
    return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

/// Makes a rename last; errno, or 0.
int syncFolder(const fs::path& folder) {
    const File directory(
        retried([&] { return ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); }));
    if (directory.fd() < 0) return 0; // a folder one may write but not list
    if (retried([&] { return ::fsync(directory.fd()); }) >= 0) return 0;
    return errno == EINVAL ? 0 : errno; // EINVAL: not on this file system
}

void writeInPlace(const std::string& path, std::span<const std::byte> bytes,
                  const std::string& what) {
    File file(retried([&] { return ::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY); }));
    if (file.fd() < 0) fail(what, errno);
    if (const int error = writeAll(file.fd(), bytes)) fail(what, error);
    if (const int error = file.close()) fail(what, error);
}

} // namespace

void writeFileAtomically(const std::string& path, std::span<const std::byte> bytes) {
    ignoreFileSizeSignal();
    const std::string what = "cannot write '" + path + "'";
    struct stat old {};
    const bool exists = ::stat(path.c_str(), &old) == 0;
    if (!exists && errno != ENOENT) fail(what, errno);
    if (path.empty()) fail(what, ENOENT);
    if (path.back() == '/' || (exists && S_ISDIR(old.st_mode))) fail(what, EISDIR);
    if (exists && !S_ISREG(old.st_mode)) return writeInPlace(path, bytes, what);
    if (exists && ::faccessat(AT_FDCWD, path.c_str(), W_OK, AT_EACCESS) != 0) fail(what, errno);

    std::error_code error;
    const fs::path target = exists ? fs::canonical(path, error) : fs::path(path);
    if (error) throw std::system_error(error, what);
    const fs::path folder = folderOf(target);

    fs::path temporary;
    File file = createTemporary(folder, target.filename().string(), temporary, what);
    Removal removal{temporary};
    const auto check = [&](int code) {
        if (code == ENOSPC || code == EDQUOT) fail(what + spaceReport(folder, bytes.size()), code);
        if (code != 0) fail(what, code);
    };
    check(writeAll(file.fd(), bytes));
    if (exists) {
        if (old.st_uid != ::geteuid() || old.st_gid != ::getegid())
            if (::fchown(file.fd(), old.st_uid, old.st_gid) != 0) {
            } // only root may; the content is what matters
        check(retried([&] { return ::fchmod(file.fd(), old.st_mode & 07777); }) < 0 ? errno : 0);
    }
    check(retried([&] { return ::fsync(file.fd()); }) < 0 ? errno : 0);
    check(file.close());
    if (compareAll(temporary, bytes) != 0)
        fail(what + ": what was read back differs from what was written", EIO);
    check(retried([&] { return ::rename(temporary.c_str(), target.c_str()); }) < 0 ? errno : 0);
    removal.armed = false;

    check(syncFolder(folder));
}

TemporaryFile::TemporaryFile(std::string target) : target_(std::move(target)) {
    std::error_code error;
    if (fs::exists(target_, error)) target_ = fs::canonical(target_).string();
    const fs::path folder = folderOf(target_);
    const std::string start = "." + fs::path(target_).filename().string() + ".";
    for (const std::string& name : scene::namesIn(folder.string())) {
        if (!name.starts_with(start) || !name.ends_with(".tmp")) continue;
        pid_t owner = 0;
        std::from_chars(name.data() + start.size(), name.data() + name.size(), owner);
        if (owner > 0 && ::kill(owner, 0) != 0 && errno == ESRCH) fs::remove(folder / name, error);
    }
    path_ = (folder / (start + std::to_string(::getpid()) + ".tmp")).string();
}

TemporaryFile::~TemporaryFile() { ::unlink(path_.c_str()); }

void TemporaryFile::replaceTarget() {
    const std::string what = "cannot write '" + target_ + "'";
    const auto check = [&](int code) {
        if (code != 0) fail(what, code);
    };
    File file(retried([&] { return ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW); }));
    check(file.fd() < 0 ? errno : 0);
    check(retried([&] { return ::fsync(file.fd()); }) < 0 ? errno : 0);
    check(::rename(path_.c_str(), target_.c_str()) < 0 ? errno : 0);
    check(syncFolder(folderOf(target_)));
}

} // namespace rt::formats
